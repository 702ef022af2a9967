//! Every recorded inertial log is read without an error, and writing it again changes nothing.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_observation::csv_log::{CsvLogWriter, RowReader, Sensors};
use adit_observation::files::Input;
use adit_observation::{LogWarning, Observation, Warnings, open};
use common::{data_set, files_with};
use std::io::Read;
use std::path::Path;

const SETS: [&str; 8] = [
    "foot-vicon",
    "foot-hallway",
    "foot-loops",
    "attitude-broad",
    "gait-lowback",
    "uwb-imu-rig",
    "uwb-imu-walk",
    "magcal",
];

fn read(path: &Path) -> (Vec<Observation>, Vec<LogWarning>) {
    let mut log = open(path).unwrap();
    let observations = log.by_ref().collect::<Result<Vec<_>, _>>().unwrap();
    assert_eq!(Some(log.bytes_read()), log.bytes_total(), "{}", path.display());
    (observations, log.warnings().to_vec())
}

#[test]
fn all_recorded_inertial_logs_pass_the_checks() {
    for set in SETS {
        let Some(folder) = data_set(set) else { continue };
        let mut files = files_with(&folder, "_imu.csv");
        files.extend(files_with(&folder, "sphere_mag.csv"));
        files.extend(files_with(&folder, "sphere.csv"));
        for path in files {
            let (observations, warnings) = read(&path);
            let imu = observations.iter().filter(|o| matches!(o, Observation::Imu(_))).count();
            println!("{}: {imu} inertial of {}", path.display(), observations.len());
            for warning in &warnings {
                println!("  {warning}");
            }
            assert!(observations.len() > 100);
        }
    }
}

#[test]
fn accelerometer_logs_are_read_row_by_row() {
    let Some(folder) = data_set("steps") else { return };
    for path in files_with(&folder, "_imu.csv") {
        let (observations, _) = read(&path);
        assert!(observations.iter().all(|o| matches!(o, Observation::Acceleration(_))));

        let mut rows = RowReader::new(Input::open(&path).unwrap(), &mut Warnings::default()).unwrap();
        let mut count = 0;
        while let Some((row, _)) = rows.next_row().unwrap() {
            assert!(row.specific_force_m_s2.is_some() && row.angular_rate_rad_s.is_none());
            count += 1;
        }
        assert!(count > 10_000, "{count}");
    }
}

#[test]
fn a_recorded_log_written_again_is_the_same_text() {
    for (set, sensors) in [("foot-hallway", Sensors::ImuMagnetic), ("foot-vicon", Sensors::Imu)] {
        let Some(folder) = data_set(set) else { continue };
        let path = &files_with(&folder, "_imu.csv")[0];
        let target = tempfile::tempdir().unwrap();
        let again = target.path().join("again.csv");
        let mut writer = CsvLogWriter::create(&again, sensors).unwrap();
        for observation in read(path).0 {
            writer.push(&observation).unwrap();
        }
        writer.finish().unwrap();
        let mut before = String::new();
        Input::open(path).unwrap().reader.read_to_string(&mut before).unwrap();
        assert!(std::fs::read_to_string(&again).unwrap() == before, "{}", path.display());
    }
}
