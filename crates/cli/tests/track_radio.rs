//! `adit track` with the radio of a site: `--mine`, `--radio`, what they refuse, and recorded walks with a phone.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Outcome, adit};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const PLACES: [(f64, f64); 5] = [(0.0, 0.0), (24.0, 0.0), (0.0, 16.0), (24.0, 16.0), (12.0, 9.0)];

/// −42 dBm at 1 m, exponent 2.6; off by a wave of some decibels that tells places apart by no more than noise would.
fn heard_dbm(k: usize, x: f64, y: f64) -> f64 {
    let d = (PLACES[k].0 - x).hypot(PLACES[k].1 - y).max(0.3);
    let wave = 2.0 * (1.7 * x + 2.3 * y + PLACES[k].0).sin();
    -42.0 - 26.0 * d.log10() + wave
}

fn site() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (mut survey, mut log, mut truth) = (
        String::from("x_m,y_m,ap0_rssi_dBm,ap1_rssi_dBm,ap2_rssi_dBm,ap3_rssi_dBm,ap4_rssi_dBm\n"),
        String::from("time_s,access_point,rssi_dBm\n"),
        String::from("time_s,x_m,y_m,z_m\n"),
    );
    for i in 0..12 {
        for j in 0..8 {
            let (x, y) = (2.0 * f64::from(i) + 1.0, 2.0 * f64::from(j) + 1.0);
            write!(survey, "{x},{y}").unwrap();
            for k in 0..5 {
                write!(survey, ",{:.1}", heard_dbm(k, x, y)).unwrap();
            }
            survey.push('\n');
        }
    }
    for second in 0..60 {
        let time = f64::from(second);
        let (x, y) = (2.0 + time / 3.0, 5.3);
        writeln!(truth, "{time},{x},{y},0").unwrap();
        for k in 0..5 {
            writeln!(log, "{time},ap{k},{:.1}", heard_dbm(k, x, y)).unwrap();
        }
        writeln!(log, "{time},neighbour,-80").unwrap();
    }
    let rows = PLACES.iter().enumerate().map(|(k, (x, y))| format!("ap{k},{x},{y},0\n"));
    let places = format!("anchor_id,x_m,y_m,z_m\n{}", rows.collect::<String>());
    for (name, text) in
        [("survey.csv", survey), ("walk_rssi.csv", log), ("truth.csv", truth), ("places.csv", places)]
    {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn done(folder: &Path, args: &[&str]) -> String {
    let Outcome { code, stdout, stderr } = adit(folder, args);
    assert_eq!(code, 0, "{args:?}: {stderr}");
    stdout + &stderr
}

/// Mean error of a walk tracked with these flags, and the report.
fn track(folder: &Path, flags: &[&str]) -> (f64, Value) {
    let args = ["track", "walk_rssi.csv", "--method", "wifi", "-o", "walk.tum", "--json", "walk.json"];
    done(folder, &[&args, flags].concat());
    let eval = ["eval", "walk.tum", "--truth", "truth.csv", "--align", "none", "--json"];
    let Outcome { code, stdout, stderr } = adit(folder, &eval);
    assert_eq!(code, 0, "{stderr}");
    let errors: Value = serde_json::from_str(&stdout).unwrap();
    let report = serde_json::from_slice(&fs::read(folder.join("walk.json")).unwrap()).unwrap();
    (errors["mean_2d_m"].as_f64().unwrap(), report)
}

#[test]
fn calibrations_and_lists_of_places_are_tracked_with() {
    let folder = site();
    let folder = folder.path();
    let calibrate =
        ["calibrate", "pathloss", "survey.csv", "--access-points", "places.csv", "-o", "site.toml"];
    done(folder, &calibrate);
    done(folder, &["calibrate", "fingerprint", "survey.csv", "-o", "site.json"]);
    fs::write(folder.join("fit.toml"), "[locator]\nmethod = \"fit\"\n").unwrap();
    fs::write(folder.join("nearest.toml"), "[locator]\nmethod = \"nearest\"\n").unwrap();
    // Errors of 1.4 dB at 10 m and n = 2.6 are 1.2 m for each circle; spots 2 m apart are not told apart better by the nearest.
    let fingerprint = ["--radio", "site.json"];
    for (flags, within_m) in [
        (vec!["--radio", "site.toml"], 1.5),
        (vec!["--radio", "site.toml", "--config", "fit.toml"], 1.5),
        (fingerprint.to_vec(), 1.5),
        ([&fingerprint[..], &["--config", "nearest.toml"]].concat(), 2.0),
        (vec!["--mine", "places.csv", "--radio", "site.toml"], 1.5),
    ] {
        let (mean_m, report) = track(folder, &flags);
        assert!(mean_m < within_m, "{flags:?}: {mean_m}");
        assert_eq!(report["estimates"], "position");
        let heard = &report["method_report"]["heard"];
        assert_eq!((heard["signals"].as_u64(), heard["unknown_signals"].as_u64()), (Some(360), Some(60)));
        assert_eq!(heard["fixes"], 20, "{flags:?}");
        assert!(report["warnings"].to_string().contains("1 unknown transmitters (neighbour)"), "{report}");
    }
    // Places alone, with a path loss that is another: worse, but on the spot.
    let (mean_m, _) = track(folder, &["--mine", "places.csv"]);
    assert!((1.5..8.0).contains(&mean_m), "{mean_m}");
}

#[test]
fn models_that_cannot_be_used_are_told_in_a_line() {
    let folder = site();
    let folder = folder.path();
    done(folder, &["calibrate", "fingerprint", "survey.csv", "-o", "site.json"]);
    let model = fs::read_to_string(folder.join("site.json")).unwrap();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("future.json", &model.replacen("\"version\":1", "\"version\":2", 1));
    write("nameless.json", &model.replacen("\"ap0\",", "", 1));
    write("other.toml", "[mean]\nx = 1\n");
    write("broken.json", "{\"kind\": ");
    let track = ["track", "walk_rssi.csv", "--method", "wifi", "-o", "walk.tum"];
    for (flags, expected) in [
        (["--radio", "future.json"], "future.json: version 2, expected 1"),
        (["--radio", "nameless.json"], "4 names, a map of 5 transmitters"),
        (["--radio", "other.toml"], "no \"kind\", expected a file of adit calibrate"),
        (["--radio", "broken.json"], "broken.json:1: EOF"),
        (["--radio", "absent.json"], "cannot read it"),
    ] {
        let Outcome { code, stderr, .. } = adit(folder, &[&track[..], &flags].concat());
        assert_eq!(code, 1, "{stderr}");
        assert!(stderr.contains(expected) && stderr.lines().count() == 1, "{stderr}");
    }
    assert!(!folder.join("walk.tum").exists());
}

#[test]
fn a_walk_of_signals_that_nobody_knows_has_no_position() {
    let folder = site();
    fs::write(folder.path().join("elsewhere.csv"), "anchor_id,x_m,y_m,z_m\nother,0,0,0\n").unwrap();
    let args = ["track", "walk_rssi.csv", "--method", "wifi", "-o", "w.tum", "--mine", "elsewhere.csv"];
    let Outcome { code, stderr, .. } = adit(folder.path(), &args);
    assert_eq!(code, 1);
    assert!(stderr.contains("of 360 signal strengths in the log, 360 are of transmitters that are not known (ap0, ap1, ap2, …)"), "{stderr}");
}
