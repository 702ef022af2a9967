//! TUM text, truth and solutions as CSV: read, written, and refused with file and line.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_observation::LogWarning;
use adit_observation::files::Input;
use adit_observation::solution_csv::{SolutionReader, SolutionWriter};
use adit_observation::truth;
use adit_observation::tum::{self, TumReader, TumWriter};
use common::{data_set, files_with, gzip};

fn pose(nanos: i64, angle: f64) -> Pose {
    Pose {
        time: Time::from_nanos(nanos),
        position_m: Vector3::new(angle / 3.0, -0.1, 1e-17),
        attitude: attitude::exp(&Vector3::new(0.3 * angle, -angle, 0.7)),
    }
}

fn tum_error(text: &[u8]) -> String {
    TumReader::new(Input::from_bytes("t.tum", text).unwrap()).find_map(Result::err).unwrap().to_string()
}

#[test]
fn a_trajectory_written_and_read_is_the_same_bit_for_bit() {
    let poses: Vec<Pose> = (0..500_i32)
        .map(|i| pose(1_511_374_923_123_456_789 + i64::from(i) * 5_000_001, f64::from(i) * 0.01))
        .collect();
    let trajectory = Trajectory::new(poses).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.tum", "a.tum.gz"] {
        let path = folder.path().join(name);
        tum::write(&path, &trajectory).unwrap();
        assert_eq!(tum::read(&path).unwrap(), trajectory);
    }
    assert_eq!(std::fs::read(folder.path().join("a.tum.gz")).unwrap()[..2], [0x1f, 0x8b]);
}

#[test]
fn tum_errors_name_the_line() {
    let good = "# t x y z qx qy qz qw\n0.5 1 2 3 0 0 0 1\n";
    for (line, error) in [
        ("1 1 2 3 0 0 0", "t.tum:3: found 7 fields, expected 8: t x y z qx qy qz qw"),
        ("1 1 2 3 0 0 0 1 9", "t.tum:3: found 9 fields, expected 8: t x y z qx qy qz qw"),
        ("1 1 NaN 3 0 0 0 1", "t.tum:3: y: found \"NaN\", expected a finite number"),
        ("1 1 2 3 0 0 0 0", "t.tum:3: quaternion: found length 0, expected length 1"),
        ("1 1 2 3 1 1 0 0", "t.tum:3: quaternion: found length 1.4142135623730951, expected length 1"),
        (
            "0.5 1 2 3 0 0 0 1",
            "t.tum:3: time runs backwards: found 0.500000000 s, expected more than 0.500000000 s",
        ),
        (
            "x 1 2 3 0 0 0 1",
            "t.tum:3: t: found \"x\", expected a time within ±292 years, as a decimal number",
        ),
    ] {
        assert_eq!(tum_error(format!("{good}{line}\n").as_bytes()), error);
    }
    let packed = gzip(good.as_bytes());
    assert!(tum_error(&packed[..packed.len() - 4]).contains("the gzip file is cut"));
}

#[test]
fn a_tum_file_without_poses_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tum");
    std::fs::write(&path, "# nothing\n\n").unwrap();
    let error = tum::read(&path).unwrap_err().to_string();
    assert_eq!(error, format!("{}: the file ends before the first pose", path.display()));
}

#[test]
fn a_rounded_quaternion_is_made_whole() {
    let text = b"0 0 0 0 0.0 0.0 0.7071 0.7071\n";
    let pose = TumReader::new(Input::from_bytes("t.tum", text).unwrap()).next().unwrap().unwrap();
    assert!((pose.attitude.norm() - 1.0).abs() < 1e-15);
}

#[test]
fn nothing_is_left_behind_by_a_writer_that_did_not_finish() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tum");
    std::fs::write(&path, "before").unwrap();
    let mut writer = TumWriter::create(&path).unwrap();
    writer.push(&pose(0, 0.0)).unwrap();
    drop(writer);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "before");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);

    let mut writer = TumWriter::create(&path).unwrap();
    writer.push(&pose(0, 0.0)).unwrap();
    writer.finish().unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("# time_s"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_writer_refuses_what_no_reader_would_take() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = TumWriter::create(folder.path().join("a.tum")).unwrap();
    writer.push(&pose(10, 0.0)).unwrap();
    let error = writer.push(&pose(10, 0.0)).unwrap_err().to_string();
    assert!(error.contains("a pose at 0.000000010 s after one at 0.000000010 s"), "{error}");
    let error = writer.push(&pose(20, f64::NAN)).unwrap_err().to_string();
    assert!(error.contains("not a finite number"), "{error}");
    let absent = folder.path().join("absent").join("a.tum");
    let error = TumWriter::create(&absent).err().unwrap().to_string();
    assert!(error.contains("cannot create it"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_written_file_has_the_mode_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let mode = |name: &str| folder.path().join(name).metadata().unwrap().permissions().mode();
    std::fs::write(folder.path().join("plain"), "").unwrap();
    TumWriter::create(folder.path().join("a.tum")).unwrap().finish().unwrap();
    assert_eq!(mode("a.tum"), mode("plain"));
}

fn truth_of(text: &str) -> Result<truth::Truth, String> {
    truth::from_input(Input::from_bytes("w_truth.csv", text.as_bytes()).unwrap()).map_err(|e| e.to_string())
}

#[test]
fn truth_rows_with_empty_fields_are_skipped_and_counted() {
    let truth = truth_of(
        "time_s,x_m,y_m,z_m,qw,qx,qy,qz,moving,foot\n0,1,2,3,1,0,0,0,0,l\n1,1,2,3,,,,,1,l\n2,,,,1,0,0,0,1,r\n3,4,5,6,0,0,0,1,1,r\n3,4,5,6,0,0,0,1,1,r\n",
    )
    .unwrap();
    assert_eq!(truth.trajectory.len(), 2);
    assert_eq!(truth.trajectory.poses()[1].attitude.coords.as_slice(), [0.0, 0.0, 1.0, 0.0]);
    assert_eq!(truth.moving, Some(vec![false, true]));
    assert_eq!(
        truth.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "w_truth.csv:1: ignored columns that are not known: foot",
            "w_truth.csv:3: skipped rows with empty fields, from here on: 2",
            "w_truth.csv:6: dropped repetitions (same source, same time), from here on: 1"
        ]
    );
}

#[test]
fn truth_may_lack_attitude_or_position_but_not_both() {
    let truth = truth_of("time_s,x_m,y_m,z_m\n0,1,2,3\n").unwrap();
    assert!(truth.has_position && truth.has_height && !truth.has_attitude);
    let truth = truth_of("time_s,qw,qx,qy,qz\n0,1,0,0,0\n").unwrap();
    assert!(!truth.has_position && truth.has_attitude);
    let truth = truth_of("time_s,x_m,y_m,floor\n0,1,2,-2\n").unwrap();
    assert!(truth.has_position && !truth.has_height);
    for (text, error) in [
        ("time_s,steps\n0,1\n", "w_truth.csv:1: missing column x_m, y_m, z_m; found time_s, steps"),
        ("time_s,x_m,z_m\n0,1,2\n", "w_truth.csv:1: missing column y_m; found time_s, x_m, z_m"),
        ("time_s,qw,qx,qy\n0,1,0,0\n", "w_truth.csv:1: missing column qz; found time_s, qw, qx, qy"),
        ("time_s,x_mm,y_m,z_m\n0,1,2,3\n", "w_truth.csv:1: column x_mm: unknown unit, expected x_m"),
        (
            "time_s,x_m,y_m,z_m\n0,,,\n",
            "w_truth.csv: the file ends before the first row without an empty field",
        ),
        (
            "time_s,x_m,y_m,z_m\n0,1,2,3\n1,1,nan,3\n",
            "w_truth.csv:3: y_m: found \"nan\", expected a finite number",
        ),
    ] {
        assert_eq!(truth_of(text).unwrap_err(), error);
    }
}

#[test]
fn truth_may_be_tum_text() {
    let truth = truth_of("# time x y z\n1 1 2 3 0 0 0 1\n2 1 2 3 0 0 0 1\n").unwrap();
    assert_eq!((truth.trajectory.len(), truth.has_attitude), (2, true));
}

#[test]
fn recorded_truth_is_read() {
    let sets = [
        "foot-vicon",
        "foot-hallway",
        "attitude-broad",
        "uwb-imu-rig",
        "uwb-imu-walk",
        "uwb-outdoor",
        "uwb-person",
        "ble-tracks",
        "phone-walks",
    ];
    for set in sets {
        let Some(folder) = data_set(set) else { continue };
        for path in files_with(&folder, "_truth.csv") {
            // A table of true ranges, one row per tag and anchor, is no trajectory.
            if path.to_string_lossy().contains("ranges_truth") {
                continue;
            }
            let truth = truth::read(&path).unwrap();
            println!("{}: {} poses", path.display(), truth.trajectory.len());
            for warning in truth.warnings.iter().filter(|w| !matches!(w, LogWarning::IgnoredColumns { .. })) {
                println!("  {warning}");
            }
        }
    }
}

fn solution(nanos: i64, quality: Quality) -> Solution {
    let spread = SolutionCovariance::from_fn(|r, c| ((r * 9 + c) as f64 * 0.37).sin());
    let pose = pose(nanos, 0.4);
    // Exactly symmetric, as filters keep it.
    let square = spread * spread.transpose();
    Solution {
        time: pose.time,
        position_m: pose.position_m,
        velocity_m_s: Vector3::new(0.1, -0.2, 0.3),
        attitude: pose.attitude,
        covariance: SolutionCovariance::from_fn(|r, c| square[(r.min(c), r.max(c))]),
        quality,
    }
}

#[test]
fn solutions_written_and_read_are_the_same_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv.gz");
    let solutions = [
        solution(0, Quality::Fixed),
        solution(1, Quality::DeadReckoning),
        Solution { attitude: Attitude::identity(), ..solution(1_511_374_923_123_456_789, Quality::Lost) },
    ];
    let mut writer = SolutionWriter::create(&path).unwrap();
    for solution in &solutions {
        writer.push(solution).unwrap();
    }
    writer.finish().unwrap();
    let read = SolutionReader::open(&path).unwrap().collect::<Result<Vec<_>, _>>().unwrap();
    assert_eq!(read, solutions);
}

#[test]
fn solution_errors_name_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let mut writer = SolutionWriter::create(&path).unwrap();
    writer.push(&solution(5, Quality::Fixed)).unwrap();
    writer.finish().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let error = |text: &str| {
        SolutionReader::new(Input::from_bytes("s.csv", text.as_bytes()).unwrap())
            .and_then(Iterator::collect::<Result<Vec<_>, _>>)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        error(&text.replace(",fixed,", ",good,")),
        "s.csv:2: quality: found \"good\", expected fixed, dead-reckoning, lost"
    );
    let row = text.lines().nth(1).unwrap();
    assert!(error(&format!("{text}{row}\n")).starts_with("s.csv:3: time runs backwards"));
    assert!(
        error(&text.replace("cov_x_vx_m2_s", "cov_x_vx"))
            .starts_with("s.csv:1: missing column cov_x_vx_m2_s; found")
    );
}
