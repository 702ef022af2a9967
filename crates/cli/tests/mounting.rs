//! `adit track` refuses a tag that is not worn the way its sidecar says.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{G, HEADER, Outcome, adit, files};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A log at 200 Hz with this specific force, two seconds of motion before it when asked for.
fn log(force: [f64; 3], moving_at_start: bool) -> String {
    let mut text = format!("{HEADER}\n");
    let moving = if moving_at_start { 400 } else { 0 };
    for i in 0..moving + 600 {
        let t_s = f64::from(i) * 0.005;
        let swing = if i < moving { (9.0 * t_s).sin() } else { 0.0 };
        let [x, y, z] = force;
        writeln!(text, "{t_s},{},{y},{},{},0.001,0", x + 4.0 * swing, z + 3.0 * swing, 3.0 * swing).unwrap();
    }
    text
}

fn track(folder: &Path, log: &str, sidecar: &str, method: &str) -> Outcome {
    std::fs::write(folder.join("log.csv"), log).unwrap();
    std::fs::write(folder.join("log.toml"), sidecar).unwrap();
    adit(folder, &["track", "log.csv", "--method", method, "-o", "walk.tum"])
}

const ON_THE_FOOT: &str = "[mounting]\nlocation = \"foot\"\nrotation = \"x-forward, y-left, z-up\"\n";

#[test]
fn an_upside_down_tag_is_refused_by_every_method_with_what_would_fit() {
    for method in ["foot-ins", "marg-ins"] {
        for moving_at_start in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let log = log([0.3, -0.2, -G], moving_at_start);
            let Outcome { code, stderr, .. } = track(folder.path(), &log, ON_THE_FOOT, method);
            assert_eq!(code, 1, "{stderr}");
            for expected in [
                "adit: log.csv: the sensor is worn upside down",
                "\"x-forward, y-left, z-up\"",
                "up 178° off the vertical, expected at most 65° at the foot",
                "the sensor's z axis points down",
                "rotation = \"x-forward, y-right, z-down\" would fit",
            ] {
                assert!(stderr.contains(expected), "{expected}: {stderr}");
            }
            assert_eq!(stderr.lines().count(), 1, "{stderr}");
            assert_eq!(files(folder.path()), [PathBuf::from("log.csv"), PathBuf::from("log.toml")]);
        }
    }
}

#[test]
fn a_sideways_tag_is_refused_and_the_suggestion_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let log = log([0.2, G, 0.4], false);
    let waist = ON_THE_FOOT.replace("foot", "waist");
    let Outcome { code, stderr, .. } = track(folder.path(), &log, &waist, "foot-ins");
    assert_eq!(code, 1);
    assert!(stderr.contains("worn sideways") && stderr.contains("at the waist"), "{stderr}");
    let suggestion = "x-forward, y-up, z-right";
    assert!(stderr.contains(&format!("rotation = \"{suggestion}\" would fit")), "{stderr}");
    let corrected = waist.replace("x-forward, y-left, z-up", suggestion);
    let Outcome { code, stderr, .. } = track(folder.path(), &log, &corrected, "foot-ins");
    assert_eq!(code, 0, "{stderr}");
}

#[test]
fn an_upside_down_tag_without_a_declared_rotation_is_levelled() {
    let folder = tempfile::tempdir().unwrap();
    let sidecar = "[mounting]\nlocation = \"foot\"\n";
    for method in ["foot-ins", "marg-ins"] {
        let Outcome { code, stderr, .. } =
            track(folder.path(), &log([0.3, -0.2, -G], false), sidecar, method);
        assert_eq!(code, 0, "{stderr}");
    }
}

#[test]
fn a_tag_that_turns_over_during_the_run_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let (before, after) = (log([0.0, 0.0, G], false), log([0.0, 0.0, -G], false));
    let later = after.lines().skip(1).map(|row| {
        let (time, rest) = row.split_once(',').unwrap();
        format!("{},{rest}\n", time.parse::<f64>().unwrap() + 3.1)
    });
    let whole = later.fold(before, |text, row| text + &row);
    let Outcome { code, stderr, .. } = track(folder.path(), &whole, ON_THE_FOOT, "foot-ins");
    assert_eq!(code, 0, "{stderr}");
    assert_eq!(stderr.matches("the sensor has turned over").count(), 1, "{stderr}");
}
