//! `adit track` on logs with what comes by radio: late, ahead, twice, in files of its own.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::time::{Interval, Time};
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{DeviceId, Observation, Radio, SignalStrength, open};
use common::{Outcome, adit, log, rest};
use std::path::Path;

fn track(folder: &Path, logs: &[&str], out: &str) -> Outcome {
    let outcome = adit(folder, &[&["track"], logs, &["--method", "foot-ins", "-o", out]].concat());
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    outcome
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

#[test]
fn radio_in_a_file_of_its_own_changes_no_pose_of_a_foot() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("imu.csv"), log(&rest(2000))).unwrap();
    let beacons = "time_s,beacon,rssi_dBm\n1,b1,-70\n1,b2,-71\n6,b1,-70\n2.5,b1,-75\n6,b1,-70\n";
    std::fs::write(at("ble.csv"), beacons).unwrap();
    std::fs::write(at("uwb.csv"), "time_s,range_a0_m,range_a1_m\n1,3.5,4.5\n2,3.5,4.5\n").unwrap();
    std::fs::write(at("baro.csv"), "time_s,pressure_hPa\n0.5,1013\n1.5,1013.1\n").unwrap();
    track(folder.path(), &["imu.csv"], "alone.tum");
    let outcome = track(folder.path(), &["imu.csv", "ble.csv", "uwb.csv", "baro.csv"], "all.tum");
    assert!(bytes(folder.path(), "alone.tum") == bytes(folder.path(), "all.tum"));
    assert_eq!(
        outcome.stderr,
        "adit: warning: ble.csv:5: observations by radio came late, from here on: 1, at most 3.5 s\n\
         adit: warning: ble.csv:6: dropped repetitions (same source, same time), from here on: 1\n"
    );
}

#[test]
fn radio_ahead_of_its_log_does_not_hold_up_the_sensors() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let rows = rest(2000);
    std::fs::write(at("whole.csv"), log(&rows)).unwrap();
    std::fs::write(at("first.csv"), log(&rows[..1000])).unwrap();
    std::fs::write(at("second.csv"), log(&rows[1000..])).unwrap();
    // A packet stamped by a clock that is a quarter of an hour ahead, in the first of two parts.
    let mut first = McapLogWriter::create(at("first.mcap"), Packing::Lz4).unwrap();
    for (index, observation) in open(at("first.csv")).unwrap().map(Result::unwrap).enumerate() {
        if index == 500 {
            let time: Time = observation.time() + Interval::from_seconds(900.0).unwrap();
            let transmitter = DeviceId::new("b1").unwrap();
            let signal = SignalStrength { time, transmitter, rssi_dbm: -70.0, radio: Radio::Ble };
            first.push(&Observation::Signal(signal)).unwrap();
        }
        first.push(&observation).unwrap();
    }
    first.finish().unwrap();
    track(folder.path(), &["whole.csv"], "whole.tum");
    let outcome = track(folder.path(), &["second.csv", "first.mcap"], "parts.tum");
    assert_eq!(outcome.stderr, "");
    assert!(bytes(folder.path(), "whole.tum") == bytes(folder.path(), "parts.tum"));
}
