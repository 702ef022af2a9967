//! `adit track --method uwb-ls` in the laboratory of system S4, with the anchors of a mine file and of a bare list.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Outcome, adit};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// As in `mines/lab.toml`.
const ANCHORS: [(&str, [f64; 3]); 4] =
    [("a1", [2.0, 0.2, 3.2]), ("a2", [18.0, 0.2, 2.0]), ("a3", [22.0, 15.8, 3.2]), ("a4", [6.0, 15.8, 2.0])];

/// A tag at 1.1 m goes straight through the laboratory; ranges to 1 mm, and some to an anchor that nobody knows.
fn laboratory() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (mut log, mut truth) =
        (String::from("time_s,anchor_id,range_m\n"), String::from("time_s,x_m,y_m,z_m\n"));
    let mut anchors = String::from("anchor_id,x_m,y_m,z_m\n");
    for (id, [x, y, z]) in ANCHORS {
        writeln!(anchors, "{id},{x},{y},{z}").unwrap();
    }
    for epoch in 0..200 {
        let time = 0.1 * f64::from(epoch);
        let (x, y) = (4.0 + 0.8 * time, 3.0 + 0.5 * time);
        writeln!(truth, "{time:.1},{x},{y},1.1").unwrap();
        for (id, [east, north, up]) in ANCHORS {
            let range = (x - east).hypot(y - north).hypot(1.1 - up);
            writeln!(log, "{time:.1},{id},{range:.3}").unwrap();
        }
        if epoch % 10 == 0 {
            writeln!(log, "{time:.1},stranger,5.0").unwrap();
        }
    }
    let files = [
        ("ranges.csv", log),
        ("truth.csv", truth),
        ("anchors.csv", anchors),
        ("height.toml", "[solver]\nheight_m = 1.1\nheight_sigma_m = 0.0\n".into()),
        ("linear.toml", "[solver]\nkind = \"linear\"\nheight_m = 1.1\n".into()),
        ("space.toml", "[solver]\nkind = \"linear-3d\"\n".into()),
        ("bad.toml", "[solver]\nkind = \"cubic\"\n".into()),
        ("none.csv", "time_s,anchor_id,range_m\n0.0,x1,2.0\n0.1,x1,2.0\n".into()),
    ];
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn track(folder: &Path, log: &str, flags: &[&str]) -> Outcome {
    adit(
        folder,
        &[&["track", log, "--method", "uwb-ls", "-o", "walk.tum", "--json", "walk.json"], flags].concat(),
    )
}

#[test]
fn a_walk_is_found_by_ranges_with_either_list_of_anchors() {
    let folder = laboratory();
    let folder = folder.path();
    let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/lab.toml");
    for flags in [
        &["--mine", lab, "--config", "height.toml"][..],
        &["--mine", "anchors.csv", "--config", "height.toml"],
        &["--mine", "anchors.csv", "--config", "linear.toml"],
        &["--mine", "anchors.csv", "--config", "space.toml"],
    ] {
        let Outcome { code, stderr, .. } = track(folder, "ranges.csv", flags);
        assert_eq!(code, 0, "{flags:?}: {stderr}");
        assert!(stderr.contains("20 ranges to 1 unknown anchors (stranger)"), "{stderr}");
        let report: Value = serde_json::from_slice(&fs::read(folder.join("walk.json")).unwrap()).unwrap();
        let counts =
            ["ranges", "unknown_ranges", "epochs", "fixes"].map(|name| &report["method_report"][name]);
        assert_eq!(counts.map(|count| count.as_u64().unwrap()), [820, 20, 200, 200], "{flags:?}");
        let eval = ["eval", "walk.tum", "--truth", "truth.csv", "--align", "none", "--json"];
        let Outcome { code, stdout, stderr } = adit(folder, &eval);
        assert_eq!(code, 0, "{stderr}");
        let errors: Value = serde_json::from_str(&stdout).unwrap();
        // Half a millimetre of rounding, by the dilution of the laboratory.
        assert!(errors["max_2d_m"].as_f64().unwrap() < 0.01, "{flags:?}: {errors}");
    }
}

#[test]
fn what_cannot_be_tracked_is_told_in_a_line() {
    let folder = laboratory();
    let folder = folder.path();
    for (log, flags, code, expected) in [
        ("ranges.csv", &[][..], 2, "uwb-ls needs the radio of the site: --mine MINE"),
        ("ranges.csv", &["--mine", "anchors.csv", "--smooth"], 2, "uwb-ls has no smoother: --smooth"),
        ("ranges.csv", &["--mine", "anchors.csv", "--config", "bad.toml"], 1, "bad.toml:2"),
        (
            "none.csv",
            &["--mine", "anchors.csv"],
            1,
            "no position: of 2 ranges in the log, 2 are to anchors that are not known (x1)",
        ),
    ] {
        let outcome = track(folder, log, flags);
        assert_eq!(outcome.code, code, "{flags:?}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(expected), "{flags:?}: {}", outcome.stderr);
        assert!(!folder.join("walk.tum").exists());
    }
}

#[test]
fn ranges_that_tell_how_they_came_are_judged_on_their_way() {
    let folder = laboratory();
    let here = folder.path();
    let head = "time_s,anchor_id,range_m,rx_power_dBm,first_path_power_dBm,preamble_count\n";
    let mut log = String::from(head);
    for epoch in 0..5 {
        for (id, [east, north, up]) in ANCHORS {
            let range = (4.0_f64 - east).hypot(3.0 - north).hypot(1.1 - up);
            let told = if epoch == 4 { ",," } else { "-80,-83,300" };
            writeln!(log, "0.{epoch},{id},{range:.3},{told}").unwrap();
        }
    }
    fs::write(here.join("told.csv"), log).unwrap();
    let flags = ["--mine", "anchors.csv", "--config", "height.toml", "--nlos", "flat"];
    let Outcome { code, stderr, .. } = track(here, "told.csv", &flags);
    assert_eq!((code, stderr.as_str()), (0, ""));
    let report: Value = serde_json::from_slice(&fs::read(here.join("walk.json")).unwrap()).unwrap();
    assert_eq!(report["judged_ranges"], 16);
    let Outcome { stderr, .. } = track(here, "ranges.csv", &flags);
    assert!(stderr.contains("--nlos: no range of the log tells how its signal came in"), "{stderr}");
    let missing = ["--mine", "anchors.csv", "--nlos", "no.safetensors"];
    let Outcome { code, stderr, .. } = track(here, "told.csv", &missing);
    let expected = "adit: no.safetensors: cannot read it, and the models that ship are flat, mine";
    assert!(code == 1 && stderr.starts_with(expected), "{stderr}");
    let steps = ["track", "told.csv", "--method", "foot-ins", "--nlos", "flat", "-o", "x.tum"];
    let Outcome { code, stderr, .. } = adit(here, &steps);
    assert!(code == 2 && stderr.contains("foot-ins makes no use of ranges"), "{stderr}");
}

#[test]
fn filters_follow_the_tag_and_tell_what_they_found() {
    let folder = laboratory();
    let folder = folder.path();
    fs::write(folder.join("filter.toml"), "[filter.height]\nheight_m = 1.1\nsigma_m = 0.05\n").unwrap();
    for method in ["uwb-ekf", "uwb-rkf", "uwb-aekf"] {
        let walk = ["track", "ranges.csv", "--method", method, "--mine", "anchors.csv"];
        let to = ["--config", "filter.toml", "-o", "walk.tum", "--json", "walk.json"];
        let Outcome { code, stderr, .. } = adit(folder, &[&walk[..], &to].concat());
        assert_eq!(code, 0, "{method}: {stderr}");
        let report: Value = serde_json::from_slice(&fs::read(folder.join("walk.json")).unwrap()).unwrap();
        let report = &report["method_report"];
        assert_eq!((&report["ranges"], &report["unknown_ranges"]), (&820.into(), &20.into()), "{method}");
        let filter = &report["filter"];
        let counted = filter["used"].as_u64().unwrap() + filter["before_start"].as_u64().unwrap();
        assert_eq!((counted, filter["refused"].as_u64().unwrap()), (800, 0), "{method}: {filter}");
        assert_eq!(filter["offsets"].as_array().unwrap().len(), 4, "{method}: {filter}");
        let eval = ["eval", "walk.tum", "--truth", "truth.csv", "--align", "none", "--json"];
        let Outcome { code, stdout, stderr } = adit(folder, &eval);
        assert_eq!(code, 0, "{method}: {stderr}");
        let errors: Value = serde_json::from_str(&stdout).unwrap();
        // Without noise: the offset is not known at first, and the height only to 5 cm.
        assert!(errors["rmse_2d_m"].as_f64().unwrap() < 0.1, "{method}: {errors}");
    }
    fs::write(folder.join("bad.toml"), "[weighting]\nkind = \"igg3\"\nnone = 0.5\n").unwrap();
    let bad = [
        "track",
        "ranges.csv",
        "--method",
        "uwb-rkf",
        "--mine",
        "anchors.csv",
        "--config",
        "bad.toml",
        "-o",
        "x.tum",
    ];
    let Outcome { code, stderr, .. } = adit(folder, &bad);
    assert!(code == 1 && stderr.contains("setting weighting.none of uwb-rkf cannot be used"), "{stderr}");
}
