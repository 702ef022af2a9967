//! `adit compare` of a suite: simulated and recorded parts in one report.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use assert_cmd::Command;
use common::{G, Outcome, log};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;

const SUITE: &str = r#"kind = "suite"
title = "Small & all"
about = "One walk, one room, nothing at hand."
data = "sets"
runs = [{ method = "foot-ins" }]

[[parts]]
name = "walk"
about = "Simulated."
scenario = "walk.toml"
seeds = 3
runs = [{ method = "marg-ins" }, { name = "loose", method = "foot-ins", config = { zero_velocity = { sigma_m_s = 0.2 } } }]
figure = "rmse-2d"

[[parts]]
name = "room"
about = "Ranges among four anchors."
align = "none"
runs = [{ method = "uwb-ls", only = ["range"] }, { name = "deaf", method = "uwb-ls", only = ["imu"] }]
figure = "rmse-3d"
set = { folder = "room", logs = ["imu", "ranges"], within = "ranges", truth = "ranges_truth", truth_row = { column = "tag_id", is = "7" }, places = {} }

[[parts]]
name = "loops"
about = "Closed."
figure = "end-3d"
set = { folder = "room", closed = true, names = ["st*"] }

[[parts]]
name = "spots"
about = "Strengths on a grid."
figure = "mean-2d"
table = ["path-loss map"]
survey = { folder = "room", fit = "train", leave_out = 0.2, draws = 2 }

[[parts]]
name = "tracks"
about = "Strengths along two walks."
align = "none"
figure = "mean-2d"
runs = [{ method = "wifi" }]
set = { folder = "tracks", logs = ["rssi"], places = { file = "aps.csv" }, learn = ["path-loss"] }

[[parts]]
name = "elsewhere"
about = "Not at hand."
figure = "rmse-2d"
set = { folder = "nowhere" }
"#;

const WALK: &str = r#"kind = "foot-walk"
sensor = "adis16448"
gait = "walk"
heading_deg = 90.0
legs = [{ stand = { seconds = 2.0 } }, { straight = { length_m = 8.0 } }, { stand = { seconds = 1.0 } }]
[compare]
align = "start"
runs = []
"#;

/// Four anchors, a tag that goes east at 0.5 m/s at a height of 1 m, ranges to it without errors; another tag beside it.
fn room(folder: &Path) {
    let anchors = [[0.0, 0.0, 3.0], [10.0, 0.0, 2.0], [10.0, 8.0, 3.0], [0.0, 8.0, 0.5]];
    let mut list = "anchor_id,x_m,y_m,z_m\n".to_owned();
    let mut ranges = "time_s,tag_id,anchor_id,range_m\n".to_owned();
    let mut truth = "time_s,tag_id,anchor_id,true_range_m,tag_x_m,tag_y_m,tag_z_m\n".to_owned();
    for (nth, [x, y, z]) in anchors.iter().enumerate() {
        writeln!(list, "a{nth},{x},{y},{z}").unwrap();
    }
    for step in 0..100 {
        let time = 0.1 * f64::from(step);
        let tag = [2.0 + 0.5 * time, 4.0, 1.0];
        for (nth, anchor) in anchors.iter().enumerate() {
            let squares: f64 = tag.iter().zip(anchor).map(|(a, b): (&f64, &f64)| (a - b).powi(2)).sum();
            writeln!(ranges, "{time:.1},7,a{nth},{:.4}", squares.sqrt()).unwrap();
            writeln!(truth, "{time:.1},7,a{nth},{:.4},{},{},{}", squares.sqrt(), tag[0], tag[1], tag[2])
                .unwrap();
        }
        // A row that is not chosen must not be taken for the place of the tag.
        writeln!(truth, "{:.2},8,a0,1,90,90,90", time + 0.05).unwrap();
    }
    let still: Vec<String> =
        (0..2000).map(|i| format!("{},0.01,-0.02,{G},0.001,0,-0.001", f64::from(i) * 0.005)).collect();
    for (name, text) in [
        ("east_anchors.csv", list),
        ("east_ranges.csv", ranges),
        ("east_ranges_truth.csv", truth),
        ("east_imu.csv", log(&still)),
        ("still_imu.csv", log(&still)),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
}

/// Strength at a place, dBm: 40 dB lost on the first metre, 25 more with each tenfold distance.
fn strength(place: [f64; 2], access_point: [f64; 2]) -> f64 {
    let distance = (place[0] - access_point[0]).hypot(place[1] - access_point[1]).max(0.5);
    (-40.0 - 25.0 * distance.log10()).round()
}

/// Four access points about a floor: a survey of it, and two walks across.
fn radio(survey: &Path, tracks: &Path) {
    let access_points = [[0.0, 0.0], [12.0, 0.0], [12.0, 9.0], [0.0, 9.0]];
    let mut list = "ap,x_m,y_m\n".to_owned();
    for (nth, [x, y]) in access_points.iter().enumerate() {
        writeln!(list, "w{nth},{x},{y}").unwrap();
    }
    let heard = |place| access_points.map(|at| strength(place, at));
    let mut rows = "x_m,y_m,w0_rssi_dBm,w1_rssi_dBm,w2_rssi_dBm,w3_rssi_dBm\n".to_owned();
    for spot in 0..120 {
        let place = [f64::from(spot % 12) + 0.5, f64::from(spot / 12) * 0.9];
        let [a, b, c, d] = heard(place);
        writeln!(rows, "{},{},{a},{b},{c},{d}", place[0], place[1]).unwrap();
    }
    fs::write(survey.join("floor_train.csv"), rows).unwrap();
    fs::write(survey.join("floor_access_points.csv"), &list).unwrap();
    fs::write(tracks.join("aps.csv"), &list).unwrap();
    for (name, from, to) in [("one", [1.0, 1.0], [11.0, 8.0]), ("two", [1.0, 7.0], [11.0, 2.0])] {
        let mut log = "time_s,access_point,rssi_dBm\n".to_owned();
        let mut truth = "time_s,x_m,y_m,z_m\n".to_owned();
        for step in 0..=100 {
            let (time, share) = (0.2 * f64::from(step), f64::from(step) / 100.0);
            let place = [0, 1].map(|axis: usize| from[axis] + share * (to[axis] - from[axis]));
            writeln!(truth, "{time:.1},{},{},0", place[0], place[1]).unwrap();
            for (nth, dbm) in heard(place).iter().enumerate() {
                writeln!(log, "{time:.1},w{nth},{dbm}").unwrap();
            }
        }
        fs::write(tracks.join(format!("{name}_rssi.csv")), log).unwrap();
        fs::write(tracks.join(format!("{name}_truth.csv")), truth).unwrap();
    }
}

fn run(folder: &Path, more: &[&str]) -> (Outcome, Value) {
    let mut args = vec!["compare", "all.toml", "-o", "all.html", "--json", "all.json"];
    args.extend(more);
    // The sets of the test, not those that may be at hand.
    let mut command = Command::cargo_bin("adit").unwrap();
    let output = command.current_dir(folder).env_remove("ADIT_DATA").args(args).output().unwrap();
    let outcome = Outcome {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    };
    let report = fs::read_to_string(folder.join("all.json")).map(|text| serde_json::from_str(&text).unwrap());
    (outcome, report.unwrap_or_default())
}

fn small() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("sets/room")).unwrap();
    fs::write(folder.path().join("all.toml"), SUITE).unwrap();
    fs::write(folder.path().join("walk.toml"), WALK).unwrap();
    fs::create_dir_all(folder.path().join("sets/tracks")).unwrap();
    room(&folder.path().join("sets/room"));
    radio(&folder.path().join("sets/room"), &folder.path().join("sets/tracks"));
    folder
}

#[test]
fn a_suite_is_one_report_of_all_its_parts() {
    let folder = small();
    let (Outcome { code, stdout, stderr }, report) = run(folder.path(), &[]);
    assert_eq!(code, 0, "{stderr}");
    assert!(stderr.contains("elsewhere: SKIPPED (no test data): nowhere"), "{stderr}");
    assert!(stdout.contains("all.toml: 6 parts"), "{stdout}");
    let part = |nth: usize| &report["parts"][nth];
    let number = |value: &Value| value.as_f64().unwrap();

    // The walk: three runs each, paired; the merit is the mean of the runs' own figures.
    let walk = part(0);
    assert_eq!((walk["seeds"].as_u64(), walk["alignment"].as_str()), (Some(3), Some("start")));
    assert_eq!(walk["run_names"][2], "seed 2");
    let foot = &walk["merit"]["foot-ins"];
    let each: Vec<f64> = foot["of_runs"].as_array().unwrap().iter().map(number).collect();
    assert!((number(&foot["mean"]) - each.iter().sum::<f64>() / 3.0).abs() < 1e-12);
    assert!(number(&foot["worst"]) < 1.0, "{foot}");
    // The figures of today's comparison stand beside it.
    assert_eq!(walk["methods"]["foot-ins"]["runs"], 3);
    let differences = walk["differences"].as_array().unwrap();
    assert!(!differences.is_empty());
    for difference in differences {
        assert_eq!(difference["minus"], walk["best"][0]);
        assert!(number(&difference["lower"]) <= number(&difference["mean"]));
        assert_eq!(difference["runs"], 3);
    }

    // The room: exact ranges give the place to the rounding of the file; who hears none has failed.
    let room = part(1);
    assert_eq!(room["best"][0], "uwb-ls");
    assert_eq!(room["run_names"], serde_json::json!(["east"]));
    // Ranges of four decimals; in space it is the height that the solver takes for likely which pulls, by centimetres.
    let level = number(&room["methods"]["uwb-ls"]["position_m"]["rmse"]);
    let space = number(&room["merit"]["uwb-ls"]["mean"]);
    assert!(level < 0.02 && level < space && space < 0.05, "{level} {space}");
    assert_eq!((&room["merit"]["deaf"]["mean"], &room["merit"]["deaf"]["runs"]), (&Value::Null, &0.into()));
    assert_eq!(room["judged_every_s"], Value::Null);

    // A sensor that does not move ends where it began.
    assert_eq!(part(2)["run_names"], serde_json::json!(["still"]));
    assert!(number(&part(2)["merit"]["foot-ins"]["mean"]) < 0.02, "{}", part(2));
    // Strengths without scatter but their rounding, half a decibel: 5 % of a distance that is below 12 m, in a mesh of places 1 m apart.
    let spots = &part(3)["merit"]["path-loss map"];
    assert_eq!((&spots["runs"], &part(3)["run_names"][1]), (&2.into(), &"floor, draw 2".into()));
    assert!(number(&spots["mean"]) < 0.8, "{spots}");
    // The same, of a walk: a fix speaks of the seconds before it.
    let tracks = &part(4)["merit"]["wifi"];
    assert_eq!(tracks["runs"], 2);
    assert!(number(&tracks["mean"]) < 1.5, "{tracks}");
    assert_eq!(part(5)["skipped"], "SKIPPED (no test data): nowhere");

    let page = fs::read_to_string(folder.path().join("all.html")).unwrap();
    for expected in
        ["Small &amp; all", "id=\"room\"", "class=\"best\"", "SKIPPED (no test data): nowhere", "<svg"]
    {
        assert!(page.contains(expected), "{expected}");
    }
    for unwanted in ["<script", "http://www.w3.org/1999/xlink", "src=\""] {
        assert!(!page.contains(unwanted), "{unwanted}");
    }
    assert_eq!(page.matches("<h2").count(), 6);
}

#[test]
fn seeds_and_methods_of_the_command_line_go_before_those_of_the_suite() {
    let folder = small();
    let (Outcome { code, stderr, .. }, report) =
        run(folder.path(), &["--seeds", "2", "--methods", "foot-ins"]);
    assert_eq!(code, 0, "{stderr}");
    assert_eq!(report["columns"], serde_json::json!(["foot-ins"]));
    assert_eq!(report["parts"][0]["seeds"], 2);
    assert_eq!(report["parts"][0]["merit"].as_object().unwrap().len(), 2);
    // It is run on the room as well, where nothing is its to find.
    assert!(report["parts"][1]["merit"]["foot-ins"]["mean"].as_f64().unwrap() > 1.0);
}

#[test]
fn what_cannot_be_run_is_told_with_its_place() {
    let folder = small();
    let failed = |from: &str, to: &str, more: &[&str]| {
        assert!(SUITE.contains(from), "{from}");
        fs::write(folder.path().join("all.toml"), SUITE.replacen(from, to, 1)).unwrap();
        let (Outcome { code, stderr, .. }, _) = run(folder.path(), more);
        assert_eq!((code, stderr.lines().count()), (1, 1), "{stderr}");
        stderr
    };
    let told = failed("truth = \"ranges_truth\"", "truth = \"truth\"", &[]);
    assert!(
        told.contains("room: no runs in this folder, expected NAME_imu.csv with NAME_ranges.csv"),
        "{told}"
    );
    let told = failed("is = \"7\"", "is = \"9\"", &[]);
    assert!(told.contains("east_ranges_truth.csv"), "{told}");
    let told = failed("column = \"tag_id\"", "column = \"tag\"", &[]);
    assert!(told.contains("east_ranges_truth.csv:1: no column tag; found time_s, tag_id"), "{told}");
    let told = failed("zero_velocity = {", "zero_speed = {", &[]);
    assert!(told.contains("walk: loose: seed ") && told.contains("unknown field `zero_speed`"), "{told}");
    let told = failed("title", "title", &["--align", "se2"]);
    assert!(told.contains("have no use with a suite"), "{told}");
}
