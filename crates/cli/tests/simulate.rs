//! `adit simulate` on the scenarios that ship, with a magnetometer.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::nalgebra::Vector3;
use adit_observation::{MagneticSample, Observation, tum};
use common::{adit, files};
use std::path::{Path, PathBuf};

fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name)
}

/// What the command printed and the folder it filled.
fn simulated(name: &str, seed: &str) -> (String, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(name);
    let done = adit(folder.path(), &["simulate", path.to_str().unwrap(), "-o", ".", "--seed", seed]);
    assert_eq!((done.code, done.stderr.as_str()), (0, ""), "{name}");
    assert_eq!(files(folder.path()), [PathBuf::from("log.mcap"), PathBuf::from("truth.tum")]);
    (done.stdout, folder)
}

/// Magnetic samples of a log, after a look at the order of all of them.
fn magnetic(folder: &Path) -> Vec<MagneticSample> {
    let mut log = adit_observation::open(folder.join("log.mcap")).unwrap();
    let all: Vec<Observation> = log.by_ref().map(Result::unwrap).collect();
    assert!(log.warnings().is_empty());
    assert!(all.windows(2).all(|w| w[0].time() <= w[1].time()));
    all.iter().filter_map(|o| if let Observation::Magnetic(s) = o { Some(*s) } else { None }).collect()
}

/// The reading undone, with the A and b that the command printed.
fn field_ut(printed: &str, reading: &Vector3<f64>) -> Vector3<f64> {
    let numbers = printed.split("A = ").nth(1).unwrap().split(" µT").next().unwrap();
    let n: Vec<f64> =
        numbers.split(|c: char| !"0123456789.-".contains(c)).filter_map(|word| word.parse().ok()).collect();
    assert_eq!(n.len(), 12, "{numbers}");
    let a = adit_core::nalgebra::Matrix3::from_row_slice(&n[..9]);
    a.try_inverse().unwrap() * (reading - Vector3::new(n[9], n[10], n[11]))
}

#[test]
fn the_walk_of_s3_carries_the_field_of_its_court() {
    let (printed, folder) = simulated("s3.toml", "2");
    assert!(printed.contains("magnetic samples of an undisturbed field"), "{printed}");
    let samples = magnetic(folder.path());
    assert!((90_000..91_000).contains(&samples.len()), "{}", samples.len());
    // Flat on the floor for the first minute, toes east: the field of the file in the axes of the sensor.
    let rest: Vec<_> = samples.iter().take(5000).map(|s| field_ut(&printed, &s.field_ut)).collect();
    let mean = rest.iter().sum::<Vector3<f64>>() / rest.len() as f64;
    let truth = tum::read(folder.path().join("truth.tum")).unwrap();
    let north_east = truth.poses()[0].attitude * mean;
    let expected = Vector3::new(-4.559_65, 24.340_55, -49.424_08);
    // Bias instability of 0.016 µT, and the last digits printed: 0.00005 · 55 µT and 0.005 µT.
    assert!((north_east - expected).amax() < 0.06, "{north_east}");
}

#[test]
fn steel_cars_are_met_with_thirty_microtesla() {
    for (name, read) in [("s3-steel", true), ("s3-steel-stop", false), ("s3-steel-beside", false)] {
        let (printed, folder) = simulated(&format!("{name}.toml"), "4");
        assert!(printed.contains("disturbed by at most 30.0 µT"), "{name}: {printed}");
        if !read {
            continue;
        }
        let norms: Vec<f64> =
            magnetic(folder.path()).iter().map(|s| field_ut(&printed, &s.field_ut).norm()).collect();
        let (least, most) = norms.iter().fold((f64::MAX, 0.0_f64), |(l, m), n| (l.min(*n), m.max(*n)));
        // It shows in the norm, and by no more than 30 µT and the noise.
        assert!(most - least > 15.0, "{name}: {least} to {most}");
        assert!(least > 55.28 - 30.5 && most < 55.28 + 30.5, "{name}: {least} to {most}");
    }
}

#[test]
fn a_tumbled_tag_can_be_calibrated_by_what_is_printed() {
    for (name, turned) in [("tumble.toml", true), ("tumble-flat.toml", false), ("tumble-cap.toml", false)] {
        let (printed, folder) = simulated(name, "1");
        let samples = magnetic(folder.path());
        let norm = |v: Vector3<f64>| (v.norm() / 55.281 - 1.0).abs();
        let raw = samples.iter().map(|s| norm(s.field_ut)).fold(0.0, f64::max);
        let undone = samples.iter().map(|s| norm(field_ut(&printed, &s.field_ut))).fold(0.0, f64::max);
        // Noise of 0.05 µT (5 σ of three axes: 0.8 %), and one pole at 10 Hz in 80°/s: a blunted and late field of even
        // length.
        assert!(raw > 0.2 && undone < 0.015, "{name}: {raw} {undone}");
        let down = samples.iter().filter(|s| field_ut(&printed, &s.field_ut).z > 0.0).count();
        assert_eq!(
            down > samples.len() / 3,
            turned,
            "{name}: {down} of {} with the tag upside down",
            samples.len()
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_log() {
    let bytes = |seed| {
        let (printed, folder) = simulated("tumble.toml", seed);
        (std::fs::read(folder.path().join("log.mcap")).unwrap(), printed)
    };
    assert_eq!(bytes("1"), bytes("1"));
    assert_ne!(bytes("1"), bytes("2"));
}

#[test]
fn a_broken_scenario_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(scenario("s3-steel.toml"))
        .unwrap()
        .replace("radius_m = 0.5", "radius_m = -5");
    std::fs::write(folder.path().join("bad.toml"), &text).unwrap();
    let line = 1 + text.lines().position(|line| line.starts_with("radius_m")).unwrap();
    let done = adit(folder.path(), &["simulate", "bad.toml", "-o", "out"]);
    assert_eq!(done.code, 1);
    assert_eq!(done.stderr, format!("adit: bad.toml:{line}: radius_m is -5, expected 0.001 to 100 m\n"));
    assert_eq!(files(folder.path()), [PathBuf::from("bad.toml")]);
}
