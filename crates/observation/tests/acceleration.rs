//! Logs with an accelerometer alone.
#![expect(clippy::unwrap_used, clippy::panic, clippy::format_collect, reason = "tests")]

mod common;

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::csv_log::{CsvLogWriter, Sensors};
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{AccelerationSample, Observation, open};
use common::{error_of, read_all};

fn samples(count: i64) -> Vec<Observation> {
    let sample = |index: i64| AccelerationSample {
        time: Time::from_nanos(index * 10_000_000),
        specific_force_m_s2: Vector3::new(0.1, -0.2, 9.8 + 0.001 * index as f64),
    };
    (0..count).map(|index| Observation::Acceleration(sample(index))).collect()
}

fn text(count: i64) -> String {
    let row = |index: i64| format!("{},0.1,-0.2,9.81\n", index as f64 / 100.0);
    "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2\n".to_owned() + &(0..count).map(row).collect::<String>()
}

#[test]
fn an_accelerometer_without_a_gyro_is_a_kind_of_its_own() {
    let (read, warnings) = read_all("a.csv", text(40).as_bytes()).unwrap();
    assert_eq!((read.len(), warnings.len()), (40, 0));
    let Observation::Acceleration(sample) = &read[3] else { panic!("{read:?}") };
    assert_eq!(sample.specific_force_m_s2, Vector3::new(0.1, -0.2, 9.81));
    assert_eq!(sample.time, Time::from_nanos(30_000_000));
    // A gyro without an accelerometer is still none.
    let gyro = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n0,0,0,0\n";
    assert!(error_of("a.csv", gyro.as_bytes()).starts_with("a.csv:1: missing column acc_x_m_s2"));
}

#[test]
fn it_is_checked_as_any_other() {
    let rows: String = (0..60).map(|i| format!("{},0,0,1\n", f64::from(i) / 100.0)).collect();
    let g = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2\n".to_owned() + &rows;
    assert!(error_of("a.csv", g.as_bytes()).contains("this looks like g, not m/s²"));
    let gap = text(40) + "2,0.1,-0.2,9.81\n2,0.1,-0.2,9.81\n";
    let (read, warnings) = read_all("a.csv", gap.as_bytes()).unwrap();
    assert_eq!(read.len(), 41);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    let back = text(40) + "0.2,0.1,-0.2,9.81\n";
    assert!(error_of("a.csv", back.as_bytes()).contains("a.csv:42"));
}

#[test]
fn it_is_the_same_after_csv_and_after_mcap() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, mcap) = (folder.path().join("a.csv"), folder.path().join("a.mcap"));
    let samples = samples(300);
    let mut writer = CsvLogWriter::create(&csv, Sensors::Acceleration).unwrap();
    let mut messages = McapLogWriter::create(&mcap, Packing::Lz4).unwrap();
    for sample in &samples {
        writer.push(sample).unwrap();
        messages.push(sample).unwrap();
    }
    writer.finish().unwrap();
    messages.finish().unwrap();
    for path in [&csv, &mcap] {
        let read: Vec<Observation> = open(path).unwrap().map(Result::unwrap).collect();
        assert!(read == samples, "{}", path.display());
    }
}

#[test]
fn its_mounting_and_its_sign_are_applied() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    std::fs::write(&path, text(40)).unwrap();
    let sidecar =
        "[mounting]\nrotation = \"x-forward, y-right, z-down\"\n[frame]\nacceleration = \"gravity\"\n";
    std::fs::write(folder.path().join("a.toml"), sidecar).unwrap();
    let first = open(&path).unwrap().next().unwrap().unwrap();
    let Observation::Acceleration(sample) = first else { panic!("{first:?}") };
    assert_eq!(sample.specific_force_m_s2, Vector3::new(-0.1, -0.2, 9.81));
}
