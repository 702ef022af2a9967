//! `adit calibrate pathloss` and `adit calibrate fingerprint`: simulated surveys and walks, recorded sets, what is refused.
#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;

use adit_estimation::radio::path_loss::mean_dbm;
use adit_estimation::radio::{PathLoss, RadioMap};
use adit_mine::plan::AccessPoint;
use common::{Outcome, adit};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const PLACES: [(f64, f64); 5] = [(0.0, 0.0), (24.0, 0.0), (0.0, 16.0), (24.0, 16.0), (12.0, 9.0)];
const MODEL: PathLoss =
    PathLoss { rssi_at_1m_dbm: -42.0, exponent: 2.6, breakpoint_m: None, exponent_beyond: None };
/// What each device adds to its ranges, m.
const OFFSETS_M: [f64; 5] = [1.0, 1.3, 0.8, 1.6, 1.2];

fn places_csv(names: &str) -> String {
    let rows = PLACES.iter().enumerate().map(|(k, (x, y))| format!("ap{k},{x},{y}\n"));
    format!("{names},x_m,y_m\n{}", rows.collect::<String>())
}

/// Scans a metre apart in a hall of 24 × 16 m, strengths within 3 dB and ranges within 0.4 m.
fn survey_csv(seed: u64, shift: f64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, 1.0).unwrap();
    let columns = |unit: &str| (0..5).map(|k| format!(",ap{k}_{unit}")).collect::<Vec<_>>().concat();
    let mut text = format!("x_m,y_m{}{}\n", columns("rssi_dBm"), columns("range_m"));
    for i in 0..12 {
        for j in 0..8 {
            let (x, y) = (2.0 * f64::from(i) + 1.0 + shift, 2.0 * f64::from(j) + 1.0 + shift);
            write!(text, "{x},{y}").unwrap();
            let away = PLACES.map(|(ax, ay)| (ax - x).hypot(ay - y));
            for d in away {
                write!(text, ",{:.1}", mean_dbm(&MODEL, d) + 3.0 * noise.sample(&mut random)).unwrap();
            }
            for (d, offset) in away.iter().zip(OFFSETS_M) {
                write!(text, ",{:.2}", d + offset + 0.4 * noise.sample(&mut random)).unwrap();
            }
            text.push('\n');
        }
    }
    text
}

/// A walk along the hall and its truth.
fn walk_csv(seed: u64, north_m: f64) -> (String, String) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, 4.0).unwrap();
    let (mut log, mut truth) = ("time_s,receiver,rssi_dBm\n".to_owned(), "time_s,x_m,y_m,z_m\n".to_owned());
    for step in 0..300_u32 {
        let time = f64::from(step) * 0.2;
        let x = 1.0 + 22.0 * f64::from(step) / 300.0;
        writeln!(truth, "{time},{x},{north_m},0").unwrap();
        let k = (step % 5) as usize;
        let d = (PLACES[k].0 - x).hypot(PLACES[k].1 - north_m);
        writeln!(log, "{time},ap{k},{:.1}", mean_dbm(&MODEL, d) + noise.sample(&mut random)).unwrap();
    }
    (log, truth)
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn json(folder: &Path, args: &[&str]) -> Value {
    let Outcome { code, stdout, stderr } = adit(folder, args);
    assert_eq!(code, 0, "{stderr}");
    serde_json::from_str(&stdout).unwrap()
}

/// Mean error of a method in a table of the report.
fn mean_m(report: &Value, table: usize, method: &str) -> f64 {
    figure(report, table, method, "mean_m")
}

fn figure(report: &Value, table: usize, method: &str, which: &str) -> f64 {
    let methods = report["judged"][table]["methods"].as_array().unwrap();
    let row = methods.iter().find(|row| row["method"] == method);
    row.unwrap_or_else(|| panic!("{method}: {methods:?}"))[which].as_f64().unwrap()
}

#[test]
fn the_path_loss_of_a_survey_comes_back_and_its_methods_are_judged() {
    let (train, test) = (survey_csv(1, 0.0), survey_csv(2, 0.7));
    let folder = folder(&[("train.csv", &train), ("test.csv", &test), ("aps.csv", &places_csv("ap"))]);
    let args = ["calibrate", "pathloss", "train.csv", "--access-points", "aps.csv", "-o", "hall.toml"];
    let report = json(
        folder.path(),
        &[&args[..], &["--evaluate", "test.csv", "--leave-out", "0.2", "--json"]].concat(),
    );
    let common = &report["path_loss"]["common"];
    // 480 values of 3 dB over a decade of distance.
    assert!((common[0].as_f64().unwrap() - MODEL.rssi_at_1m_dbm).abs() < 1.5, "{common}");
    assert!((common[1].as_f64().unwrap() - MODEL.exponent).abs() < 0.15, "{common}");
    let offsets = report["ranges"]["models"].as_array().unwrap();
    for (model, offset) in offsets.iter().zip(OFFSETS_M) {
        let at_10_m = model["offset_m"].as_f64().unwrap() + 10.0 * (model["scale"].as_f64().unwrap() - 1.0);
        assert!((at_10_m - offset).abs() < 0.15, "{model} {offset}");
    }
    assert_eq!(report["judged"].as_array().unwrap().len(), 2);
    assert_eq!(report["judged"][0]["of"], "spots left out");
    assert_eq!(figure(&report, 0, "robust fit", "asked").to_string(), "19");
    assert_eq!(figure(&report, 1, "robust fit", "asked").to_string(), "96");
    // A strength falls by 1.1 dB in a metre 10 m away: five of 3 dB leave 1.7 m each way, 2.1 m in the plane.
    assert!(mean_m(&report, 1, "path-loss map") < 2.4 && mean_m(&report, 1, "robust fit") < 2.8, "{report}");
    assert!(mean_m(&report, 1, "ranges, robust fit") < 0.6 && mean_m(&report, 1, "ranges, map") < 0.6);
    assert!(mean_m(&report, 1, "ranges, linear, as read") > mean_m(&report, 1, "ranges, robust fit"));
    assert!(figure(&report, 1, "path-loss map", "inside_95") > 0.85);

    let text = fs::read_to_string(folder.path().join("hall.toml")).unwrap();
    let file: toml::Table = text.parse().unwrap();
    let access_points: Vec<AccessPoint> = file["access_points"].clone().try_into().unwrap();
    assert_eq!(access_points.len(), 5);
    assert!((access_points[4].path_loss.unwrap().exponent - MODEL.exponent).abs() < 0.4);
    // The same again, to the byte.
    adit(folder.path(), &args);
    assert_eq!(fs::read_to_string(folder.path().join("hall.toml")).unwrap(), text);
}

#[test]
fn a_map_of_fingerprints_is_made_and_judged_with_and_without_places() {
    let (train, test) = (survey_csv(1, 0.0), survey_csv(2, 0.7));
    let folder = folder(&[("train.csv", &train), ("test.csv", &test), ("aps.csv", &places_csv("ap"))]);
    for places in [&["--access-points", "aps.csv"][..], &[]] {
        let args =
            ["calibrate", "fingerprint", "train.csv", "-o", "hall.json", "--evaluate", "test.csv", "--json"];
        let report = json(folder.path(), &[&args[..], places].concat());
        assert!(mean_m(&report, 0, "process map") < 2.4, "{report}");
        assert!(mean_m(&report, 0, "process map") < mean_m(&report, 0, "nearest 5"));
        assert!(mean_m(&report, 0, "ranges, process map") < 0.8);
        assert!(figure(&report, 0, "process map", "inside_95") > 0.85);
        let file: Value =
            serde_json::from_str(&fs::read_to_string(folder.path().join("hall.json")).unwrap()).unwrap();
        assert_eq!(file["transmitters"].as_array().unwrap().len(), 5);
        let map: RadioMap = serde_json::from_value(file["strengths"].clone()).unwrap();
        assert_eq!(map.transmitters(), 5);
    }
}

#[test]
fn walks_are_followed_and_one_is_left_out_at_a_time() {
    let walks = [(1, 3.0), (2, 8.0), (3, 13.0)].map(|(seed, north)| walk_csv(seed, north));
    let names = ["a_rssi.csv", "b_rssi.csv", "c_rssi.csv"];
    let truths = ["a_truth.csv", "b_truth.csv", "c_truth.csv"];
    let places = places_csv("receiver");
    let mut files: Vec<(&str, &str)> = vec![("receivers.csv", &places)];
    for ((log, truth), (name, truth_name)) in walks.iter().zip(names.into_iter().zip(truths)) {
        files.push((name, log));
        files.push((truth_name, truth));
    }
    let folder = folder(&files);
    for (verb, method, out) in
        [("pathloss", "path-loss walk", "o.toml"), ("fingerprint", "process walk", "o.json")]
    {
        let args = [
            "calibrate",
            verb,
            ".",
            "--access-points",
            "receivers.csv",
            "-o",
            out,
            "--leave-out",
            "each",
            "--json",
        ];
        let report = json(folder.path(), &args);
        assert_eq!(report["judged"][0]["trials"].as_array().unwrap().len(), 3);
        let smoothed = format!("{method}, smoothed");
        assert!(mean_m(&report, 0, method) < 2.5, "{report}");
        assert!(mean_m(&report, 0, &smoothed) < mean_m(&report, 0, method), "{report}");
    }
}

#[test]
fn what_cannot_be_calibrated_is_told_in_a_line() {
    let (survey, (log, truth)) = (survey_csv(1, 0.0), walk_csv(1, 3.0));
    let short = survey.lines().take(2).collect::<Vec<_>>().join("\n");
    let folder = folder(&[
        ("train.csv", &survey),
        ("short.csv", &short),
        ("a_rssi.csv", &log),
        ("a_truth.csv", &truth),
        ("b_rssi.csv", &log),
        ("aps.csv", &places_csv("ap")),
        ("others.csv", "ap,x_m,y_m\nz,0,0\n"),
        ("broken.csv", "x_m,y_m,ap0_rssi_dBm\n0,0,loud\n"),
    ]);
    for (args, expected) in [
        (&["broken.csv"][..], "broken.csv:2: ap0_rssi_dBm: found \"loud\""),
        (&["nowhere.csv"], "nowhere.csv: cannot open it"),
        (&["train.csv", "a_rssi.csv"], "expected files of one kind"),
        (&["b_rssi.csv"], "b_rssi.csv: no truth beside it: expected b_truth.csv"),
        (&["train.csv", "--leave-out", "0.001"], "leaves nothing to fit or nothing to judge"),
        (&["train.csv", "--leave-out", "each"], "nothing is left to fit when it is left out"),
        (&["a_rssi.csv", "--leave-out", "0.2"], "use --leave-out each for walks"),
        (
            &["train.csv", "--evaluate", "a_rssi.csv"],
            "a_rssi.csv: expected the same kind of data as is fitted",
        ),
        (&["short.csv"], "5 readings of the radio, expected 10 or more"),
        (
            &["train.csv", "--access-points", "others.csv"],
            "others.csv: has none of the transmitters that the data hears",
        ),
    ] {
        let places: &[&str] =
            if args.contains(&"--access-points") { &[] } else { &["--access-points", "aps.csv"] };
        let args = [&["calibrate", "pathloss"], args, places, &["-o", "hall.toml"]].concat();
        let Outcome { code, stderr, .. } = adit(folder.path(), &args);
        let said: Vec<&str> = stderr.lines().filter(|line| !line.contains("warning")).collect();
        assert_eq!((code, said.len()), (1, 1), "{args:?}: {stderr}");
        assert!(said[0].contains(expected), "{args:?}: {stderr}");
        assert!(!folder.path().join("hall.toml").exists());
    }
    for flags in
        [&["--leave-out", "1.5"][..], &["--leave-out", "some"], &["--draws", "0"], &["-o", "-", "--json"]]
    {
        let out: &[&str] = if flags.contains(&"-o") { &[] } else { &["-o", "hall.json"] };
        let args = [&["calibrate", "fingerprint", "train.csv"], flags, out].concat();
        assert_eq!(adit(folder.path(), &args).code, 2, "{args:?}");
    }
}

#[test]
fn help_of_the_radio_calibrations_reads_as_it_should() {
    let here = Path::new(".");
    insta::assert_snapshot!(
        "help_calibrate_pathloss",
        adit(here, &["calibrate", "pathloss", "--help"]).stdout
    );
    insta::assert_snapshot!(
        "help_calibrate_fingerprint",
        adit(here, &["calibrate", "fingerprint", "--help"]).stdout
    );
}

/// The folder of a recorded set; `None`, after saying so, where it is not at hand.
fn recorded(set: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("ADIT_DATA").map_or_else(beside, PathBuf::from).join(set);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("SKIPPED (no test data): {set}");
    None
}

/// One setting for all sets; the figures of the targets.
#[test]
fn recorded_corridors_are_positioned() {
    let Some(set) = recorded("rssi-corridor") else { return };
    let here = tempfile::tempdir().unwrap();
    let (mut fingerprints, mut ranges) = (0.0, 0.0);
    let sites = ["corridor", "lecture_theatre", "office"];
    for site in sites {
        let train = set.join(format!("{site}_train.csv.gz")).display().to_string();
        let places = set.join(format!("{site}_access_points.csv")).display().to_string();
        let args = |verb: &'static str| {
            [
                "calibrate",
                verb,
                &train,
                "--access-points",
                &places,
                "-o",
                "o",
                "--leave-out",
                "0.2",
                "--draws",
                "5",
                "--json",
            ]
            .map(str::to_owned)
        };
        let report = |verb| {
            let args = args(verb);
            json(here.path(), &args.iter().map(String::as_str).collect::<Vec<_>>())
        };
        fingerprints += mean_m(&report("fingerprint"), 0, "process map") / 3.0;
        ranges += mean_m(&report("pathloss"), 0, "ranges, map") / 3.0;
    }
    // First step 2.1 m, goal 1.5 m; five draws of a fifth of the spots.
    assert!(fingerprints < 1.75, "{fingerprints}");
    // Goal without fingerprints of ranges: 1.5 m.
    assert!(ranges < 0.8, "{ranges}");
}

#[test]
fn recorded_floors_are_positioned() {
    let Some(set) = recorded("rssi-floors") else { return };
    let here = tempfile::tempdir().unwrap();
    for (building, most_m) in [("hcxy", 2.4), ("cetc331", 2.5)] {
        let file = |part: &str| set.join(format!("{building}_{part}.csv")).display().to_string();
        let (train, test, places) = (file("train"), file("test"), file("access_points"));
        let args = [
            "calibrate",
            "fingerprint",
            &train,
            "--access-points",
            &places,
            "-o",
            "o",
            "--evaluate",
            &test,
            "--json",
        ];
        let report = json(here.path(), &args);
        assert!(mean_m(&report, 0, "process map") < most_m, "{building}: {report}");
        // The target: every floor right.
        assert!((figure(&report, 0, "process map", "right_floor") - 1.0).abs() < 1e-12);
        assert!(figure(&report, 0, "process map", "inside_95") > 0.8);
    }
}

#[test]
fn recorded_tracks_are_followed() {
    let Some(set) = recorded("ble-tracks") else { return };
    let here = tempfile::tempdir().unwrap();
    let (data, places) = (set.display().to_string(), set.join("receivers.csv").display().to_string());
    let follow = |verb, method: &str| {
        let args = [
            "calibrate",
            verb,
            &data,
            "--access-points",
            &places,
            "-o",
            "o",
            "--leave-out",
            "each",
            "--json",
        ];
        let report = json(here.path(), &args);
        let methods = report["judged"][0]["methods"].as_array().unwrap().clone();
        let row = methods.iter().find(|row| row["method"] == method).unwrap();
        let tracks: Vec<f64> =
            row["trial_means_m"].as_array().unwrap().iter().map(|mean| mean.as_f64().unwrap()).collect();
        tracks.iter().sum::<f64>() / tracks.len() as f64
    };
    // First step 2.0 m, goal 1.5 m, mean of the tracks, each with what the others taught.
    assert!(follow("fingerprint", "process walk") < 1.5);
    assert!(follow("fingerprint", "process walk, smoothed") < 1.15);
    assert!(follow("pathloss", "path-loss walk, smoothed") < 1.45);
}
