//! `adit nlos`: help, learning and judging, what is refused, the recorded sets.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;
#[path = "common/recorded.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod recorded;

use common::adit;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Twelve places, half in sight, whose diagnostics overlap: 6 dB between first path and whole signal against 3 dB, within 2 dB from place to place and 1 dB in one.
fn hall(seed: u64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let mut text =
        "tag_location_id,nlos,range_m,rx_power_dBm,first_path_power_dBm,preamble_count\n".to_owned();
    for place in 0..12_i32 {
        let nlos = place % 2;
        let of_place = 2.0 * normal.sample(&mut random);
        for _ in 0..40 {
            let difference = f64::from(3 + 3 * nlos) + 0.5 * of_place + normal.sample(&mut random);
            let power = -80.0 + normal.sample(&mut random);
            let first = power - difference.max(0.1);
            writeln!(text, "{place},{nlos},{:.2},{power:.2},{first:.2},300", 3.0 + 0.3 * f64::from(place))
                .unwrap();
        }
    }
    text
}

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

#[test]
fn help() {
    let here = Path::new(".");
    insta::assert_snapshot!("help_nlos", adit(here, &["nlos", "--help"]).stdout);
    insta::assert_snapshot!("help_nlos_train", adit(here, &["nlos", "train", "--help"]).stdout);
    insta::assert_snapshot!("help_nlos_eval", adit(here, &["nlos", "eval", "--help"]).stdout);
}

#[test]
fn what_is_learnt_at_some_places_serves_at_others() {
    let folder = TempDir::new().unwrap();
    let (here, path) = (folder.path(), |name: &str| folder.path().join(name));
    fs::write(path("hall.csv"), hall(1)).unwrap();
    fs::write(path("other.csv"), hall(2)).unwrap();
    let train = |out: &str| adit(here, &["nlos", "train", "hall.csv", "--baseline", "--json", "-o", out]);
    let report: Value = serde_json::from_str(&train("hall.safetensors").stdout).unwrap();
    assert_eq!(report["folds"], 12);
    train("again.safetensors");
    assert_eq!(
        fs::read(path("hall.safetensors")).unwrap(),
        fs::read(path("again.safetensors")).unwrap(),
        "the same by seed"
    );
    let judged = adit(here, &["nlos", "eval", "other.csv", "--model", "hall.safetensors", "--json"]);
    let report: Value = serde_json::from_str(&judged.stdout).unwrap();
    assert_eq!(report["classes"], serde_json::json!(["LOS", "NLOS"]));
    // 3 dB between the means, √2 dB of scatter: Φ(3/(2√2)) = 0.856 of them can be told; 12 places scatter about that.
    let accuracy = number(&report, "/accuracy");
    assert!((0.75..0.95).contains(&accuracy), "{accuracy}");
    let confusion: Vec<Vec<u64>> = serde_json::from_value(report["confusion"].clone()).unwrap();
    let right = (confusion[0][0] + confusion[1][1]) as f64;
    assert!((right / 480.0 - accuracy).abs() < 1e-9);
    for key in ["balanced_accuracy", "macro_f1", "binary"] {
        assert!(!report[key].is_null(), "{key}");
    }
    // The model that ships tells three classes; asked of two it is judged on two.
    let shipped = adit(here, &["nlos", "eval", "other.csv", "--json"]);
    let report: Value = serde_json::from_str(&shipped.stdout).unwrap();
    assert_eq!(report["classes"], serde_json::json!(["LOS", "NLOS"]));
}

#[test]
fn what_cannot_be_learnt_or_read_is_one_line() {
    let folder = TempDir::new().unwrap();
    let (here, path) = (folder.path(), |name: &str| folder.path().join(name));
    fs::write(path("one.csv"), "geometry_id,nlos,rx_power_dBm\n1,0,-80\n1,0,-81\n2,1,-90\n3,1,-91\n")
        .unwrap();
    fs::write(path("bad.csv"), "geometry_id,nlos,rx_power_dBm\n1,0,-80\n1,7,-81\n").unwrap();
    fs::write(path("bare.csv"), "geometry_id,nlos\n1,0\n2,0\n3,1\n4,1\n").unwrap();
    fs::create_dir(path("empty")).unwrap();
    for (name, expected) in [
        ("one.csv", "1 geometries of class LOS, expected 2 or more"),
        ("bad.csv", "bad.csv:3: nlos: found \"7\", expected 0 or 1"),
        ("bare.csv", "tell neither diagnostics nor an impulse response"),
        ("empty", "expected meta.csv and cir_i16le.bin, or ranges.csv"),
    ] {
        let outcome = adit(here, &["nlos", "train", "--baseline", "-o", "m.safetensors", name]);
        assert!(
            outcome.stderr.contains(expected) && outcome.stderr.lines().count() == 1,
            "{}",
            outcome.stderr
        );
        assert!(outcome.code == 1 && !path("m.safetensors").exists());
    }
    fs::write(path("no.safetensors"), "no model").unwrap();
    let outcome = adit(here, &["nlos", "eval", "one.csv", "--model", "no.safetensors"]);
    assert!(
        outcome.code == 1 && outcome.stderr.contains("this is no safetensors file"),
        "{}",
        outcome.stderr
    );
}

/// The first step of the recorded sets, on geometries and places held out, by the discriminant alone.
#[test]
fn recorded_sets_are_told_on_geometries_held_out() {
    // Targets: a forest on eleven features.
    for (set, folds, floors) in
        [("uwb-cir", "24", [0.895, 0.838, 0.934]), ("uwb-industrial", "10", [0.88, 0.85, 0.91])]
    {
        let Some(data) = recorded::folder(set) else { continue };
        let folder = TempDir::new().unwrap();
        let data = data.display().to_string();
        let outcome = adit(
            folder.path(),
            &["nlos", "train", &data, "--baseline", "--json", "--folds", folds, "-o", "m.safetensors"],
        );
        let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
        for (key, floor) in ["accuracy", "balanced_accuracy", "f1"].into_iter().zip(floors) {
            let found = number(&report, &format!("/binary/{key}"));
            assert!(found >= floor, "{set} {key}: {found}, expected {floor} or more");
        }
    }
}

/// Folders of a simulation are labelled ranges: of what is in the way, and of line of sight for a model that tells no more.
#[test]
fn folders_of_a_simulation_are_labelled_ranges() {
    let folder = TempDir::new().unwrap();
    let here = folder.path();
    let mine = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/lab.toml");
    let scenario = format!(
        "kind = \"mine\"\nsensor = \"mpu6050\"\nrate_hz = 50.0\n[mine]\nfile = \"{mine}\"\nduration_s = 60.0\n[mine.tag]\nmount = \"belt-front\"\n\
         radio = {{ scan_hz = 0.0, ranging_hz = 5.0, portal_hz = 0.0, detail = \"impulse-response\" }}\n[mine.population]\n\
         persons = [{{ start = {{ roadway = {{ id = \"ring\", along_m = 2.0 }} }}, errands = [{{ go = {{ to = {{ roadway = {{ id = \"ring\", along_m = 30.0 }} }} }} }}, \
         {{ go = {{ to = {{ roadway = {{ id = \"between-pillars\", along_m = 6.0 }} }} }} }}] }}]\n"
    );
    fs::write(here.join("lab.toml"), scenario).unwrap();
    for seed in 1..=5 {
        let (out, seed) = (format!("lab{seed}"), seed.to_string());
        assert_eq!(adit(here, &["simulate", "lab.toml", "-o", &out, "--seed", &seed]).code, 0);
    }
    let train = ["nlos", "train", "lab1", "lab2", "lab3", "lab4", "--baseline", "-o", "m.safetensors"];
    let outcome = adit(here, &train);
    // No rock in the laboratory: a class that never comes cannot be held out.
    assert!(outcome.stderr.contains("0 geometries of class rock, expected 2 or more"), "{}", outcome.stderr);
    let judged = adit(here, &["nlos", "eval", "lab5", "--json"]);
    let report: Value = serde_json::from_str(&judged.stdout).unwrap();
    assert_eq!(
        report["classes"],
        serde_json::json!(["LOS", "NLOS"]),
        "flat does not tell what is in the way"
    );
    let (one, kept) = (number(&report, "/binary/accuracy"), number(&report, "/filtered/binary/accuracy"));
    assert!(one > 0.7 && kept > one - 0.05, "{one} {kept}");
    assert_eq!(report["each"].as_array().map(Vec::len), Some(2));
}
