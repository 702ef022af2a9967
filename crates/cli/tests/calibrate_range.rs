//! `adit calibrate range`: a simulated hall, logs with each kind of truth, recorded sets, what is refused.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;
#[path = "common/recorded.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod recorded;

use common::{Outcome, adit};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const ANCHORS: [(&str, [f64; 3], f64); 4] = [
    ("a1", [0.0, 0.0, 3.0], 0.3),
    ("a2", [20.0, 0.0, 2.0], 0.5),
    ("a3", [20.0, 15.0, 3.0], 0.4),
    ("a4", [0.0, 15.0, 2.0], 0.6),
];

fn anchors_csv(offsets: bool) -> String {
    let mut text = format!("anchor_id,x_m,y_m,z_m{}\n", if offsets { ",range_offset_m" } else { "" });
    for (id, [x, y, z], offset) in ANCHORS {
        let more = if offsets { format!(",{offset}") } else { String::new() };
        writeln!(text, "{id},{x},{y},{z}{more}").unwrap();
    }
    text
}

/// A walk around the hall; ranges within 5 cm of the distance and the anchor's offset.
fn walk(folder: &Path, name: &str, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, 0.05).unwrap();
    let (mut log, mut truth, mut distances) = (
        String::from("time_s,anchor_id,range_m\n"),
        String::from("time_s,x_m,y_m,z_m\n"),
        String::from("time_s,anchor_id,true_range_m,class\n"),
    );
    for epoch in 0..150 {
        let time = 0.2 * f64::from(epoch);
        let angle = 0.2 * time + 0.1 * seed as f64;
        let (x, y) = (10.0 + 6.0 * angle.cos(), 7.5 + 5.0 * angle.sin());
        writeln!(truth, "{time:.1},{x},{y},0.9").unwrap();
        for (id, [east, north, up], offset) in ANCHORS {
            // The tag is 0.2 m above what the truth is of.
            let distance = (x - east).hypot(y - north).hypot(1.1 - up);
            writeln!(log, "{time:.1},{id},{:.3}", distance + offset + noise.sample(&mut random)).unwrap();
            writeln!(distances, "{time:.1},{id},{distance:.4},los").unwrap();
        }
    }
    fs::write(folder.join(format!("{name}_ranges.csv")), log).unwrap();
    fs::write(folder.join(format!("{name}_truth.csv")), truth).unwrap();
    fs::write(folder.join(format!("{name}_distances.csv")), distances).unwrap();
}

fn calibrate(folder: &Path, flags: &[&str]) -> Outcome {
    adit(folder, &[&["calibrate", "range"], flags].concat())
}

fn errors(report: &Value, kind: &str) -> f64 {
    report["held_out"][0][kind]["mae_m"].as_f64().unwrap()
}

#[test]
fn offsets_of_anchors_are_learnt_from_either_truth_and_serve_a_method() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("anchors.csv"), anchors_csv(false)).unwrap();
    fs::write(folder.join("with_offsets.csv"), anchors_csv(true)).unwrap();
    for (name, seed) in [("one", 1), ("two", 2), ("three", 3)] {
        walk(folder, name, seed);
    }
    let walks = ["one_ranges.csv", "two_ranges.csv"];
    let by_places = ["--mine", "anchors.csv", "--lever", "0,0,0.2", "-o", "ranges.toml", "--json"];
    let Outcome { code, stdout, stderr } = calibrate(folder, &[&walks[..], &by_places].concat());
    assert_eq!(code, 0, "{stderr}");
    let report: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&report["groups"], &report["ranges"]), (&10.into(), &1200.into()));
    assert_eq!(report["learnt"]["offsets"]["chosen"], "each anchor");
    for (id, _, offset) in ANCHORS {
        let found = report["learnt"]["correction"]["anchors"][id].as_f64().unwrap();
        // 300 ranges of 5 cm, shrunk by a per cent of some 0.1 m.
        assert!((found - offset).abs() < 0.02, "{id}: {found}");
    }
    // Mean size of normal errors of 5 cm: 4 cm.
    assert!(errors(&report, "raw") > 0.4 && errors(&report, "corrected") < 0.045, "{report}");

    // The distances themselves, one walk cut in five.
    fs::copy(folder.join("one_distances.csv"), folder.join("one_ranges_truth.csv")).unwrap();
    let Outcome { code, stdout, stderr } =
        calibrate(folder, &["one_ranges.csv", "-o", "one.toml", "--plot", "one.svg", "--json"]);
    assert_eq!(code, 0, "{stderr}");
    let report: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&report["groups"], &report["held_out"][1]["class"]), (&5.into(), &"LOS".into()));
    assert!(errors(&report, "corrected") < 0.05, "{report}");
    assert!(fs::read_to_string(folder.join("one.svg")).unwrap().contains("as measured"));

    // A third walk is found by either what was learnt or what the list of anchors says.
    let worst = |mine: &str, more: &[&str]| {
        fs::write(folder.join("h.toml"), "[solver]\nheight_m = 1.1\nheight_sigma_m = 0.0\n").unwrap();
        let track = [
            "track",
            "three_ranges.csv",
            "--method",
            "uwb-ls",
            "-o",
            "w.tum",
            "--config",
            "h.toml",
            "--mine",
            mine,
        ];
        let Outcome { code, stderr, .. } = adit(folder, &[&track[..], more].concat());
        assert_eq!(code, 0, "{stderr}");
        let eval = ["eval", "w.tum", "--truth", "three_truth.csv", "--align", "none", "--json"];
        let errors: Value = serde_json::from_str(&adit(folder, &eval).stdout).unwrap();
        errors["rmse_2d_m"].as_f64().unwrap()
    };
    // Four ranges of 5 cm in the middle of a hall: dilution about 1.
    assert!(worst("anchors.csv", &["--radio", "ranges.toml"]) < 0.08);
    assert!(worst("with_offsets.csv", &[]) < 0.08);
    // What was learnt replaces what the list says.
    assert!(worst("with_offsets.csv", &["--radio", "ranges.toml"]) < 0.08);
    assert!(worst("anchors.csv", &[]) > 0.1);
}

#[test]
fn recorded_halls_are_not_made_worse() {
    for (set, raw, most) in
        [("uwb-industrial", 0.231, 0.231), ("uwb-cir", 0.538, 0.2), ("uwb-outdoor", 0.244, 0.06)]
    {
        let Some(data) = recorded::folder(set) else { continue };
        let data = if set == "uwb-outdoor" { data.join("static_ranges.csv.gz") } else { data };
        let folder = tempfile::tempdir().unwrap();
        let Outcome { code, stdout, stderr } =
            calibrate(folder.path(), &[data.to_str().unwrap(), "-o", "ranges.toml", "--json"]);
        assert_eq!(code, 0, "{stderr}");
        let report: Value = serde_json::from_str(&stdout).unwrap();
        assert!((errors(&report, "raw") - raw).abs() < 1e-3, "{set}: {}", errors(&report, "raw"));
        // By groups held out, choices and all.
        assert!(errors(&report, "corrected") < most, "{set}: {}", errors(&report, "corrected"));
    }
}

#[test]
fn help_reads_as_it_should() {
    let folder = tempfile::tempdir().unwrap();
    let Outcome { code, stdout, .. } = calibrate(folder.path(), &["--help"]);
    assert_eq!(code, 0);
    insta::assert_snapshot!("help_calibrate_range", stdout);
}

#[test]
fn what_cannot_be_learnt_from_is_told_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    walk(folder, "one", 1);
    fs::write(folder.join("anchors.csv"), anchors_csv(false)).unwrap();
    fs::write(folder.join("alone_ranges.csv"), "time_s,anchor_id,range_m\n0,a1,3\n").unwrap();
    fs::write(folder.join("place.csv"), "group_id,nlos,range_m,true_range_m\nx,0,3,2.9\nx,0,4,3.9\n")
        .unwrap();
    fs::write(folder.join("other.csv"), "anchor_id,x_m,y_m,z_m\nb9,0,0,0\n").unwrap();
    fs::write(
        folder.join("odd.toml"),
        "kind = \"ranges\"\nversion = 1\n[correction.unjudged]\nsigma_m = -1.0\n",
    )
    .unwrap();
    for (flags, expected) in [
        (
            &["alone_ranges.csv", "-o", "r.toml"][..],
            "alone_ranges.csv: no truth beside it: expected alone_ranges_truth.csv",
        ),
        (
            &["one_ranges.csv", "-o", "r.toml"],
            "one_truth.csv: tells positions only: where the anchors are (--mine) is needed too",
        ),
        (
            &["one_ranges.csv", "-o", "r.toml", "--mine", "other.csv"],
            "one_ranges.csv: the distance of none of 600 ranges is known",
        ),
        (
            &["place.csv", "-o", "r.toml"],
            "the ranges are of 1 places, geometries or walks, expected 2 or more",
        ),
    ] {
        let Outcome { code, stderr, .. } = calibrate(folder, flags);
        assert_eq!(code, 1, "{flags:?}: {stderr}");
        assert!(stderr.contains(expected), "{stderr}\n{expected}");
        assert!(!folder.join("r.toml").exists(), "{flags:?}");
    }
    let track = [
        "track",
        "one_ranges.csv",
        "--method",
        "uwb-ls",
        "-o",
        "w.tum",
        "--mine",
        "anchors.csv",
        "--radio",
        "odd.toml",
    ];
    let Outcome { code, stderr, .. } = adit(folder, &track);
    assert_eq!(code, 1);
    assert!(stderr.contains("odd.toml: sigma_m: expected a number of metres above 0"), "{stderr}");
    let Outcome { code, .. } = calibrate(folder, &["place.csv", "-o", "-", "--json"]);
    assert_eq!(code, 2, "both to stdout");
}
