//! `adit calibrate mag` on the recorded tumbles: field steady to the target, held out too; parts of a tumble refused.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::adit;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn recorded(file: &str) -> Option<PathBuf> {
    let given = std::env::var_os("ADIT_DATA").map(PathBuf::from);
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = given.unwrap_or(beside).join("magcal").join(file);
    if path.exists() {
        return Some(path);
    }
    println!("SKIPPED (no test data): magcal");
    None
}

fn calibrate(logs: &[&Path]) -> Result<serde_json::Value, String> {
    let folder = tempfile::tempdir().unwrap();
    let logs = logs.iter().map(|path| path.to_str().unwrap());
    let args: Vec<&str> =
        ["calibrate", "mag"].into_iter().chain(logs).chain(["-o", "tag.toml", "--json"]).collect();
    let outcome = adit(folder.path(), &args);
    if outcome.code == 0 { Ok(serde_json::from_str(&outcome.stdout).unwrap()) } else { Err(outcome.stderr) }
}

#[test]
fn the_field_of_a_recorded_tumble_is_steady() {
    let (Some(mag), Some(acc)) = (recorded("full_sphere_mag.csv.gz"), recorded("full_sphere_acc.csv.gz"))
    else {
        return;
    };
    let calibration = &calibrate(&[&mag, &acc]).unwrap()["calibration"];
    let percent = |which: &str| calibration[which]["sd_percent"].as_f64().unwrap();
    assert!(percent("before") > 13.0, "{calibration}");
    // The target is 1 %.
    assert!(percent("after") < 0.5, "{calibration}");
    assert!(percent("held_out") < 0.6, "{calibration}");
    assert_eq!(calibration["alignment"]["source"], "gravity");
    // Field and gravity keep their angle: 2° is what place and accelerometer leave.
    assert!(calibration["alignment"]["dip_spread_deg"].as_f64().unwrap() < 2.0, "{calibration}");
}

#[test]
fn a_short_recorded_tumble_is_steady_too() {
    let Some(log) = recorded("hi91_sphere.csv") else { return };
    let calibration = &calibrate(&[&log]).unwrap()["calibration"];
    let percent = |which: &str| calibration[which]["sd_percent"].as_f64().unwrap();
    assert!(percent("after") < 0.75 && percent("held_out") < 1.0 && percent("before") > 1.5, "{calibration}");
    assert_eq!(calibration["alignment"]["source"], "gyro");
}

/// Rows of the recorded tumble whose calibrated direction is wanted.
fn part(log: &Path, keep: impl Fn(f64, [f64; 3]) -> bool) -> Result<serde_json::Value, String> {
    let rows: Vec<_> = adit_observation::SensorRows::open(log).unwrap().map(Result::unwrap).collect();
    let folder = tempfile::tempdir().unwrap();
    let mut text = "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n".to_owned();
    for row in rows {
        let field = row.field_ut.unwrap();
        if keep(row.time.seconds(), field.into()) {
            writeln!(text, "{},{},{},{}", row.time, field.x, field.y, field.z).unwrap();
        }
    }
    let path = folder.path().join("part.csv");
    std::fs::write(&path, text).unwrap();
    calibrate(&[&path])
}

#[test]
fn parts_of_a_recorded_tumble_are_refused() {
    let Some(log) = recorded("full_sphere_mag.csv.gz") else { return };
    // Half spaces, about the centre of the readings to some µT.
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let error =
                part(&log, |_, field| sign * (field[axis] - [0.0, -10.0, 2.0][axis]) > 5.0).unwrap_err();
            let missing = format!("{}{}", if sign > 0.0 { '-' } else { '+' }, ["x", "y", "z"][axis]);
            assert!(
                error.contains("directions of the field") && error.contains(&missing),
                "{missing}: {error}"
            );
        }
    }
    // A ring, as from a turntable.
    let error = part(&log, |_, field| (field[2] - 2.0).abs() < 6.0).unwrap_err();
    assert!(error.contains("plane") || error.contains("directions of the field"), "{error}");
    // The first seconds of the tumble.
    for seconds in [5.0, 10.0, 15.0] {
        let error = part(&log, |time, _| time < seconds).unwrap_err();
        assert!(error.contains("adit: "), "{error}");
    }
}
