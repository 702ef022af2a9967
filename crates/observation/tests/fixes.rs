//! Position fixes in logs: read and written in every form, refused with file and line where they cannot be right.
#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;

use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::time::Time;
use adit_observation::csv_log::{CsvLogWriter, Sensors};
use adit_observation::mcap_log::Packing;
use adit_observation::{FixSource, HeightFix, LogWarning, Observation, PositionFix, open};
use common::{csv_log, error_of, mcap, read_all};

fn fixes(text: &str) -> Vec<PositionFix> {
    let (observations, _) = read_all("a.csv", text.as_bytes()).unwrap();
    observations
        .into_iter()
        .map(|o| if let Observation::Fix(fix) = o { fix } else { panic!("{o:?}") })
        .collect()
}

fn seconds(seconds: f64) -> Time {
    Time::from_seconds(seconds).unwrap()
}

#[test]
fn a_level_fix_has_a_place_and_a_spread() {
    let read =
        fixes("time_s,fix_east_m,fix_north_m,fix_sigma_m,fix_source\n20,12.5,-3,0.086,wifi\n40,13,-2,0.5,\n");
    let expected = PositionFix::level(seconds(20.0), Vector2::new(12.5, -3.0), 0.086, FixSource::Wifi);
    assert_eq!(read[0], expected);
    assert_eq!((read[0].sigma_m(), read[1].source), (Some(0.086), FixSource::Unknown));
}

#[test]
fn covariance_and_height_are_read() {
    let read = fixes(
        "fix_up_sigma_m,fix_up_m,fix_cov_n_n_m2,fix_cov_e_n_m2,fix_cov_e_e_m2,fix_north_m,fix_east_m,time_ms\n\
         0.2,-301.5,4,0.5,1,7,6,1000\n,,4,0.5,1,7,6,2000\n",
    );
    assert_eq!(read[0].covariance_m2, Matrix2::new(1.0, 0.5, 0.5, 4.0));
    assert_eq!(read[0].height, Some(HeightFix { up_m: -301.5, sigma_m: 0.2 }));
    assert_eq!((read[1].height, read[1].sigma_m()), (None, None));
}

#[test]
fn a_row_without_a_fix_leaves_its_fields_empty() {
    let mut lines = csv_log(30).lines().map(str::to_owned).collect::<Vec<_>>();
    for (nth, line) in lines.iter_mut().enumerate() {
        *line += match nth {
            0 => ",fix_east_m,fix_north_m,fix_sigma_m",
            11 => ",1,2,0.1",
            _ => ",,,",
        };
    }
    let (observations, warnings) = read_all("a.csv", lines.join("\n").as_bytes()).unwrap();
    assert!(warnings.is_empty());
    let at = observations.iter().position(|o| matches!(o, Observation::Fix(_))).unwrap();
    // The sample of the row stands first, then the magnetic reading, then the fix.
    assert!(matches!(observations[at - 1], Observation::Magnetic(_)));
    assert!(matches!(observations[at - 2], Observation::Imu(_)));
    assert_eq!(observations[at - 2].time(), observations[at].time());
    assert_eq!(observations.iter().filter(|o| matches!(o, Observation::Fix(_))).count(), 1);
}

#[test]
fn what_cannot_be_a_fix_is_an_error_with_its_line() {
    let header = "time_s,fix_east_m,fix_north_m,fix_sigma_m";
    let bad = |row: &str| error_of("a.csv", format!("{header}\n0,1,2,0.1\n{row}\n").as_bytes());
    assert_eq!(bad("1,1,2,0"), "a.csv:3: fix_cov_e_e_m2: found 0, expected the square of 1 µm to 10,000 km");
    assert!(bad("1,1,2,NaN").starts_with("a.csv:3: fix_sigma_m: found \"NaN\""));
    assert!(bad("1,1,,0.1").starts_with("a.csv:3: fix_north_m: found \"\""));
    assert_eq!(
        bad("1,2e7,2,0.1"),
        "a.csv:3: fix_east_m: found 20000000, expected at most 10,000 km from the origin"
    );
    let covariance =
        "time_s,fix_east_m,fix_north_m,fix_cov_e_e_m2,fix_cov_e_n_m2,fix_cov_n_n_m2\n0,0,0,1,2,1\n";
    assert_eq!(
        error_of("a.csv", covariance.as_bytes()),
        "a.csv:2: fix_cov_e_n_m2: found 2, expected a symmetric, positive definite covariance"
    );
    let source = format!("{header},fix_source\n0,1,2,0.1,zigbee\n");
    assert_eq!(
        error_of("a.csv", source.as_bytes()),
        "a.csv:2: fix_source: found zigbee, expected unknown, wifi, uwb, bluetooth, rfid, survey, gnss"
    );
}

#[test]
fn columns_that_are_missing_or_strange_are_named() {
    let of = |header: &str| error_of("a.csv", format!("{header}\n").as_bytes());
    assert!(of("time_s,fix_east_m,fix_sigma_m").contains("missing column fix_north_m"));
    assert!(of("time_s,fix_east_m,fix_north_m").contains("missing column fix_sigma_m"));
    assert!(
        of("time_s,fix_east_m,fix_north_m,fix_sigma_m,fix_up_m").contains("missing column fix_up_sigma_m")
    );
    assert!(of("time_s,fix_east_ft,fix_north_m,fix_sigma_m").contains("column fix_east_ft: unknown unit"));
    assert!(of("time_s,fix_east_m,fix_east_m,fix_north_m,fix_sigma_m").contains("give the same quantity"));
    assert!(
        of("time_s,fix_east_m,fix_north_m,fix_sigma_m,fix_cov_e_e_m2").contains("give the same quantity")
    );
}

#[test]
fn fixes_of_two_sources_at_one_time_are_two_and_of_one_source_a_repetition() {
    let text = "time_s,fix_east_m,fix_north_m,fix_sigma_m,fix_source\n\
                0,1,2,0.1,wifi\n0,1.5,2,0.2,uwb\n1,1,2,0.1,wifi\n1,9,9,0.1,wifi\n";
    let (observations, warnings) = read_all("a.csv", text.as_bytes()).unwrap();
    assert_eq!(observations.len(), 3);
    assert!(matches!(warnings[..], [LogWarning::RepeatedTime { count: 1, .. }]));
}

fn sample_fixes() -> Vec<Observation> {
    let fix = |nth: i64| PositionFix {
        time: Time::from_nanos(nth * 1_234_567_891),
        level_m: Vector2::new(-0.0 + nth as f64 / 3.0, 1e6 - nth as f64),
        covariance_m2: Matrix2::new(0.01, 0.002, 0.002, 0.3),
        height: (nth % 2 == 0).then_some(HeightFix { up_m: -412.25, sigma_m: 0.1 }),
        source: FixSource::ALL[usize::try_from(nth).unwrap() % FixSource::ALL.len()],
    };
    (0..20).map(|nth| Observation::Fix(fix(nth))).collect()
}

#[test]
fn what_is_written_comes_back_bit_for_bit() {
    let fixes = sample_fixes();
    for packing in [Packing::Plain, Packing::Lz4] {
        assert_eq!(read_all("a.mcap", &mcap(&fixes, packing)).unwrap().0, fixes);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fixes.csv.gz");
    let mut writer = CsvLogWriter::create(&path, Sensors::Fixes).unwrap();
    for fix in &fixes {
        writer.push(fix).unwrap();
    }
    writer.finish().unwrap();
    let back: Vec<Observation> = open(&path).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!(back, fixes);
}

#[test]
fn a_csv_log_of_fixes_takes_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = CsvLogWriter::create(folder.path().join("fixes.csv"), Sensors::Fixes).unwrap();
    let imu = read_all("a.csv", csv_log(1).as_bytes()).unwrap().0.remove(0);
    assert!(writer.push(&imu).unwrap_err().to_string().contains("Imu at 0.000000000 s in a log of Fixes"));
    let Observation::Fix(mut bad) = sample_fixes()[0] else { panic!("a fix") };
    bad.covariance_m2 *= -1.0;
    let error = writer.push(&Observation::Fix(bad)).unwrap_err().to_string();
    assert!(error.contains("fix_cov_e_e_m2 is -0.01"), "{error}");
}
