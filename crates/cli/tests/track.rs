//! `adit track` and `adit simulate`, end to end.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::trajectory::Trajectory;
use adit_observation::{Observation, open, tum};
use common::{G, HEADER, adit, files, log, rest};
use std::path::{Path, PathBuf};
use std::time::Duration;

const SHORT_WALK: &str = r#"
kind = "foot-walk"
seed = 3
sensor = "adis16448"
gait = "walk"
heading_deg = 0.0
legs = [{ stand = { seconds = 3.0 } }, { straight = { length_m = 12.0 } }, { stand = { seconds = 3.0 } }]
"#;

fn simulated() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("walk.toml"), SHORT_WALK).unwrap();
    let outcome = adit(folder.path(), &["simulate", "walk.toml", "-o", "sim"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    folder
}

fn track(folder: &Path, more: &[&str]) -> common::Outcome {
    let args = [&["track", "sim/log.mcap", "--method", "foot-ins"], more].concat();
    let outcome = adit(folder, &args);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    outcome
}

fn read(path: PathBuf) -> Trajectory {
    tum::read(path).unwrap()
}

fn inertial(path: &Path) -> usize {
    open(path).unwrap().filter(|o| matches!(o, Ok(Observation::Imu(_)))).count()
}

#[test]
fn poses_are_written_as_often_as_asked_and_the_first_and_the_last_always() {
    let folder = simulated();
    let all = track(folder.path(), &["-o", "all.tum", "--covariance", "all.csv"]);
    let some = track(folder.path(), &["-o", "some.tum", "--covariance", "some.csv", "--every", "0.5"]);
    let told = |outcome: &common::Outcome| {
        let lines = outcome.stdout.lines().filter(|line| !line.starts_with("speed"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(told(&all), told(&some), "what is told is of all of them");
    let (all, some) = (read(folder.path().join("all.tum")), read(folder.path().join("some.tum")));
    let (first, last) = (all.poses().first().unwrap(), all.poses().last().unwrap());
    assert_eq!((some.poses().first(), some.poses().last()), (Some(first), Some(last)));
    let every = 0.5;
    let mut cell = None;
    for pose in &some.poses()[..some.len() - 1] {
        let at_s = pose.time.seconds() + 5e-7;
        let here = (at_s / every).floor();
        assert!(cell.is_none_or(|before| here >= before + 1.0), "one in each half second: {at_s}");
        // The next sample after the half second, at 100 Hz or more.
        assert!(cell.is_none() || at_s - here * every < 0.0101, "{at_s}");
        cell = Some(here);
    }
    assert!(all.poses().iter().filter(|pose| some.poses().contains(pose)).count() == some.len());
    let seconds = (last.time - first.time).seconds();
    assert!((some.len() as f64 - seconds / every).abs() < 3.0, "{} in {seconds} s", some.len());
    let rows = |name: &str| {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let (all_rows, some_rows) = (rows("all.csv"), rows("some.csv"));
    assert_eq!(some_rows.len(), some.len() + 1);
    assert!(some_rows.iter().all(|row| all_rows.contains(row)));
}

#[test]
fn every_inertial_sample_gets_a_pose_whatever_the_mode() {
    let folder = simulated();
    let samples = inertial(&folder.path().join("sim/log.mcap"));
    for mode in [&[][..], &["--smooth"], &["--lag", "2"]] {
        let outcome = track(folder.path(), &[&["-o", "walk.tum", "--json", "walk.json"], mode].concat());
        let estimate = read(folder.path().join("walk.tum"));
        assert_eq!(estimate.len(), samples, "{mode:?}");
        for word in ["duration", "distance", "from the start", "real time"] {
            assert!(outcome.stdout.contains(word), "{mode:?}: {}", outcome.stdout);
        }
        let text = std::fs::read_to_string(folder.path().join("walk.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(report["inertial_samples"], samples);
        assert_eq!(report["poses"], samples);
        assert_eq!(report["method"], "foot-ins");
    }
}

#[test]
fn a_dash_writes_the_same_trajectory_to_stdout_and_the_summary_to_stderr() {
    let folder = simulated();
    track(folder.path(), &["-o", "walk.tum"]);
    let piped = track(folder.path(), &["-o", "-"]);
    assert_eq!(piped.stdout, std::fs::read_to_string(folder.path().join("walk.tum")).unwrap());
    assert!(piped.stderr.contains("distance"), "{}", piped.stderr);
}

#[test]
fn the_same_log_gives_the_same_bytes() {
    let folder = simulated();
    let bytes = |name: &str| {
        track(folder.path(), &["-o", name, "--covariance", "walk.csv"]);
        (
            std::fs::read(folder.path().join(name)).unwrap(),
            std::fs::read(folder.path().join("walk.csv")).unwrap(),
        )
    };
    assert!(bytes("first.tum") == bytes("second.tum"));
}

#[test]
fn parts_of_a_log_in_any_order_are_the_whole_log() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, rows: &[String]| std::fs::write(folder.path().join(name), log(rows)).unwrap();
    let rows = rest(3000);
    write("whole.csv", &rows);
    write("a.csv", &rows[..1100]);
    write("b.csv", &rows[1100..]);
    let track = |logs: &[&str], out: &str| {
        let outcome = adit(folder.path(), &[&["track"], logs, &["--method", "foot-ins", "-o", out]].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        std::fs::read_to_string(folder.path().join(out)).unwrap()
    };
    let whole = track(&["whole.csv"], "whole.tum");
    assert!(track(&["a.csv", "b.csv"], "parts.tum") == whole);
    assert!(track(&["b.csv", "a.csv"], "swapped.tum") == whole);
}

#[test]
fn logs_whose_inertial_samples_overlap_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), log(&rest(1000))).unwrap();
    std::fs::write(folder.path().join("b.csv"), log(&rest(2000)[500..])).unwrap();
    let outcome = adit(folder.path(), &["track", "a.csv", "b.csv", "--method", "foot-ins", "-o", "walk.tum"]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.contains("lies between those of"), "{}", outcome.stderr);
    assert_eq!(files(folder.path()), [PathBuf::from("a.csv"), PathBuf::from("b.csv")]);
}

#[test]
fn warnings_are_shown_once_each_and_the_work_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = rest(2000);
    // A repeated stamp twice, and a second without samples.
    rows.insert(1200, rows[1199].clone());
    rows.insert(1300, rows[1299].clone());
    rows.drain(1500..1700);
    let text = log(&rows).replace(HEADER, &HEADER.replace("time_s", "time_s,battery_v"));
    let text: String = text
        .lines()
        .map(|l| {
            if l.starts_with("time_s") {
                format!("{l}\n")
            } else {
                let (time, rest) = l.split_once(',').unwrap();
                format!("{time},3.7,{rest}\n")
            }
        })
        .collect();
    std::fs::write(folder.path().join("log.csv"), text).unwrap();
    let outcome = adit(
        folder.path(),
        &["track", "log.csv", "--method", "foot-ins", "-o", "walk.tum", "--json", "r.json"],
    );
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    for expected in [
        "ignored columns that are not known: battery_v",
        "dropped repetitions (same source, same time), from here on: 2",
        "no inertial sample for 1.00",
    ] {
        assert_eq!(outcome.stderr.matches(expected).count(), 1, "{expected}: {}", outcome.stderr);
    }
    assert!(outcome.stderr.lines().all(|l| l.starts_with("adit: warning: ")), "{}", outcome.stderr);
    let report = std::fs::read_to_string(folder.path().join("r.json")).unwrap();
    assert!(report.contains("battery_v"), "{report}");
}

#[test]
fn a_walker_who_does_not_rest_at_the_start_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let restless = |i: u32| {
        let t_s = f64::from(i) * 0.005;
        let swing = (9.0 * t_s).sin();
        format!("{t_s},{},0,{},{},{},0", 4.0 * swing, G + 2.0 * swing, 3.0 * swing, 2.0 * swing)
    };
    std::fs::write(folder.path().join("log.csv"), log(&(0..1000).map(restless).collect::<Vec<_>>())).unwrap();
    let outcome = adit(folder.path(), &["track", "log.csv", "--method", "foot-ins", "-o", "walk.tum"]);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(outcome.stderr.starts_with("adit: warning: "), "{}", outcome.stderr);
    assert_eq!(outcome.stderr.matches("not at rest at the start").count(), 1, "{}", outcome.stderr);
    assert_eq!(read(folder.path().join("walk.tum")).len(), 1000);
}

#[test]
fn a_sidecar_is_heard_and_a_config_has_the_last_word() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("log.csv", &log(&rest(1000)));
    write(
        "log.toml",
        "[mounting]\nlocation = \"waist\"\n[noise]\nangle_random_walk_rad_sqrt_s = 0.25\n\
         velocity_random_walk_m_s_sqrt_s = 0.5\ngyro_bias_walk_rad_s_sqrt_s = 1e-6\nacc_bias_walk_m_s2_sqrt_s = 1e-5\n",
    );
    write("foot.toml", "[noise]\nvelocity_random_walk_m_s_sqrt_s = 0.75\n");
    let args = ["track", "log.csv", "--method", "foot-ins", "-o", "walk.tum", "--config", "foot.toml", "-vv"];
    let outcome = adit(folder.path(), &args);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    for expected in [
        "adit: warning: the sidecar puts the sensor at \"waist\"",
        "angle_random_walk_rad_sqrt_s: 0.25",
        "velocity_random_walk_m_s_sqrt_s: 0.75",
    ] {
        assert!(outcome.stderr.contains(expected), "{expected}: {}", outcome.stderr);
    }
}

#[test]
fn the_seed_decides_the_simulation() {
    let folder = simulated();
    let log = |args: &[&str]| {
        let outcome = adit(folder.path(), &[&["simulate", "walk.toml", "-o", "again"], args].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        std::fs::read(folder.path().join("again/log.mcap")).unwrap()
    };
    let first = std::fs::read(folder.path().join("sim/log.mcap")).unwrap();
    assert!(log(&[]) == first);
    assert!(log(&["--seed", "3"]) == first);
    assert!(log(&["--seed", "4"]) != first);
    let truth = read(folder.path().join("again/truth.tum"));
    assert_eq!(truth.len(), inertial(&folder.path().join("again/log.mcap")));
}

#[test]
fn a_scenario_that_cannot_be_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for (change, expected) in [
        (("seconds = 3.0", "seconds = -3.0"), "adit: walk.toml:7: seconds is -3, expected 0 to 1e6 s"),
        (("\"walk\"", "\"hover\""), "unknown gait \"hover\", expected walk"),
        (("seed = 3", "seed = \"x\""), "adit: walk.toml:3: "),
    ] {
        std::fs::write(folder.path().join("walk.toml"), SHORT_WALK.replace(change.0, change.1)).unwrap();
        let outcome = adit(folder.path(), &["simulate", "walk.toml", "-o", "sim"]);
        assert_eq!(outcome.code, 1);
        assert!(outcome.stderr.contains(expected), "{}", outcome.stderr);
        assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
        assert!(!folder.path().join("sim").exists());
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let long = SHORT_WALK.replace("12.0", "90000.0");
    std::fs::write(folder.path().join("walk.toml"), long).unwrap();
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_adit"))
        .current_dir(folder.path())
        .args(["simulate", "walk.toml", "-o", "."])
        .spawn()
        .unwrap();
    // Until the temporary files are there.
    for _ in 0..500 {
        std::thread::sleep(Duration::from_millis(20));
        if files(folder.path()).len() == 3 {
            break;
        }
    }
    assert_eq!(files(folder.path()).len(), 3, "work under way");
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(files(folder.path()), [PathBuf::from("walk.toml")]);
}
