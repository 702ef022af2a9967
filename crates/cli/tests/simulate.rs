//! `adit simulate` as a user runs it.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::time::Time;
use adit_observation::{Observation, open};
use common::{Outcome, adit};

fn scenario(name: &str) -> String {
    format!("{}/../../scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn a_log_with_a_magnetometer_reads_back_in_order_of_time() {
    let folder = tempfile::tempdir().unwrap();
    let Outcome { code, stdout, stderr } =
        adit(folder.path(), &["simulate", &scenario("s3-raw"), "-o", "raw"]);
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.contains("6400 samples over 64.0 s"), "{stdout}");
    assert!(stdout.contains("with 6400 magnetic samples of an undisturbed field"), "{stdout}");
    let log = open(folder.path().join("raw/log.mcap")).unwrap();
    let declination = log.sidecar().unwrap().frame.magnetic_declination_deg;
    assert_eq!(declination, Some(-10.61));
    let observations: Vec<Observation> = log.map(Result::unwrap).collect();
    let stamps: Vec<Time> = observations.iter().map(Observation::time).collect();
    assert!(stamps.is_sorted());
    let magnetic = observations.iter().filter(|o| matches!(o, Observation::Magnetic(_))).count();
    assert_eq!((observations.len() - magnetic, magnetic), (6400, 6400));
}

#[test]
fn the_same_seed_makes_the_same_files_and_another_seed_others() {
    let folder = tempfile::tempdir().unwrap();
    let log = |name: &str, seed: &str| {
        let args = ["simulate", &scenario("s3-raw-level"), "-o", name, "--seed", seed];
        let Outcome { code, stderr, .. } = adit(folder.path(), &args);
        assert_eq!(code, 0, "{stderr}");
        std::fs::read(folder.path().join(name).join("log.mcap")).unwrap()
    };
    let first = log("a", "5");
    assert!(first == log("b", "5"));
    assert!(first != log("c", "6"));
}

#[test]
fn a_disturbance_is_told_with_its_time() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(scenario("s3-raw")).unwrap();
    let text = format!(
        "{text}\n[[magnetic.steel]]\nat_m = [0.0, 2.0, 0.0]\nmoment_a_m2 = [0.0, 0.0, 100.0]\npeak_at_sensor_ut = 12.5\n"
    );
    std::fs::write(folder.path().join("steel.toml"), text).unwrap();
    let Outcome { code, stdout, stderr } = adit(folder.path(), &["simulate", "steel.toml", "-o", "steel"]);
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.contains("6400 magnetic samples, disturbed by at most 12.5 µT at "), "{stdout}");
}

#[test]
fn a_scenario_that_cannot_be_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        std::fs::read_to_string(scenario("s3")).unwrap().replace("dip_deg = 63.387", "dip_deg = 633.87");
    std::fs::write(folder.path().join("s3.toml"), text).unwrap();
    let Outcome { code, stdout, stderr } = adit(folder.path(), &["simulate", "s3.toml", "-o", "out"]);
    assert_eq!((code, stdout.as_str()), (1, ""));
    assert!(
        stderr.starts_with("adit: s3.toml:") && stderr.contains("expected -90 to 90 degrees"),
        "{stderr}"
    );
    assert!(!folder.path().join("out").exists());
}
