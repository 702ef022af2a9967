//! `adit eval` where one side has no positions, and where the truth marks the rows that count.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::attitude::{Attitude, exp};
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::{EvaluationOptions, WithoutPosition, evaluate, evaluate_attitude};
use adit_observation::solution_csv::SolutionWriter;
use adit_observation::tum;
use common::{Outcome, adit};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// Of files with 16 digits the scorer's arc cosines keep eight in an angle of a degree.
const SCORER_TOLERANCE_DEG: f64 = 1e-6;

/// A hand on a walk; `off` degrees too far clockwise. Positions are left out with `place` false.
fn hand(off_deg: f64, place: bool) -> Trajectory {
    let pose = |i: i32| {
        let t = f64::from(i) * 0.05;
        let position_m = Vector3::new(t, (0.3 * t).sin() * 4.0, 0.1) * f64::from(u8::from(place));
        let attitude = exp(&Vector3::new(0.0, 0.0, -off_deg.to_radians()))
            * exp(&Vector3::new(0.3 * (0.8 * t).sin(), 0.2 * (1.1 * t).cos(), 0.5 * t));
        Pose { time: Time::from_seconds(t).unwrap(), position_m, attitude }
    };
    Trajectory::new((0..600).map(pose).collect()).unwrap()
}

/// Truth as CSV; `marked` writes the column `moving`.
fn csv(path: &Path, truth: &Trajectory, place: bool, marked: Option<fn(usize) -> bool>) {
    let mut text = "time_s,qw,qx,qy,qz".to_owned();
    text += if place { ",x_m,y_m,z_m" } else { "" };
    text += if marked.is_some() { ",moving\n" } else { "\n" };
    for (index, Pose { time, position_m: p, attitude: q }) in truth.poses().iter().enumerate() {
        write!(text, "{time},{},{},{},{}", q.w, q.i, q.j, q.k).unwrap();
        if place {
            write!(text, ",{},{},{}", p.x, p.y, p.z).unwrap();
        }
        if let Some(marked) = marked {
            write!(text, ",{}", u8::from(marked(index))).unwrap();
        }
        text.push('\n');
    }
    std::fs::write(path, text).unwrap();
}

fn middle(index: usize) -> bool {
    (150..450).contains(&index)
}

/// `est.tum` without positions, `path.tum` with them, 3° too far clockwise both; truths with and without.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    tum::write(path("est.tum"), &hand(3.0, false)).unwrap();
    tum::write(path("path.tum"), &hand(3.0, true)).unwrap();
    tum::write(path("pose.tum"), &hand(0.0, true)).unwrap();
    csv(&path("attitude.csv"), &hand(0.0, false), false, None);
    csv(&path("marked.csv"), &hand(0.0, false), false, Some(middle));
    csv(&path("marked_path.csv"), &hand(0.0, true), true, Some(middle));
    let mut places = "time_s,x_m,y_m\n".to_owned();
    hand(0.0, true).poses().iter().for_each(|p| {
        writeln!(places, "{},{},{}", p.time, p.position_m.x, p.position_m.y).unwrap();
    });
    std::fs::write(path("places.csv"), places).unwrap();
    folder
}

fn eval(folder: &Path, args: &[&str]) -> Outcome {
    adit(folder, &[&["eval"], args].concat())
}

fn written(folder: &Path, args: &[&str]) -> String {
    let Outcome { code, stdout, stderr } = eval(folder, &[args, &["--json"]].concat());
    assert_eq!((code, stderr.as_str()), (0, ""), "{args:?}");
    stdout
}

fn json(folder: &Path, args: &[&str]) -> Value {
    serde_json::from_str(&written(folder, args)).unwrap()
}

/// A report as the crate itself writes it: every digit counts.
fn text(report: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(report).unwrap() + "\n"
}

fn number(report: &Value, name: &str) -> f64 {
    assert!(report[name].is_f64(), "no {name} in {report}");
    report[name].as_f64().unwrap()
}

#[test]
fn figures_equal_those_of_the_independent_scorer() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("estimate.tum", include_str!("attitude/estimate.tum")),
        ("truth.csv", include_str!("attitude/truth.csv")),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let Outcome { code, stdout, .. } =
        eval(folder.path(), &["estimate.tum", "--truth", "truth.csv", "--json"]);
    assert_eq!(code, 0);
    let ours: Value = serde_json::from_str(&stdout).unwrap();
    let theirs: Value = serde_json::from_str(include_str!("attitude/score.json")).unwrap();
    for (name, part) in [("attitude", "total"), ("heading", "heading"), ("inclination", "inclination")] {
        let (ours, theirs) = (number(&ours, &format!("rmse_{name}_deg")), number(&theirs, part));
        assert!((ours - theirs).abs() < SCORER_TOLERANCE_DEG, "{name}: ours {ours}, theirs {theirs}");
    }
}

#[test]
fn a_truth_without_positions_judges_attitude_alone_and_forgives_nothing() {
    let folder = folder();
    for estimate in ["est.tum", "path.tum"] {
        let found = json(folder.path(), &[estimate, "--truth", "attitude.csv"]);
        assert_eq!((&found["judged"], &found["without_position"]), (&"attitude".into(), &"truth".into()));
        assert_eq!(found["alignment"]["method"], "none");
        assert_eq!(found["poses_compared"], 600);
        assert!((number(&found, "rmse_heading_deg") - 3.0).abs() < 1e-9, "{found}");
        assert!((number(&found, "bias_heading_deg") - 3.0).abs() < 1e-9, "{found}");
        assert!(number(&found, "max_inclination_deg") < 1e-6, "{found}");
        assert!(!found.as_object().unwrap().keys().any(|key| key.ends_with("_m")), "{found}");
    }
}

#[test]
fn an_estimate_of_attitude_alone_is_judged_by_the_attitudes_of_a_whole_truth() {
    let folder = folder();
    let found = json(folder.path(), &["est.tum", "--truth", "pose.tum"]);
    assert_eq!((&found["judged"], &found["without_position"]), (&"attitude".into(), &"estimate".into()));
    assert_eq!(found["alignment"]["method"], "none");
    assert!((number(&found, "rmse_heading_deg") - 3.0).abs() < 1e-9, "{found}");

    let Outcome { code, stderr, .. } = eval(folder.path(), &["est.tum", "--truth", "places.csv"]);
    assert_eq!(code, 1);
    assert!(stderr.contains("est.tum against places.csv: the estimate holds attitudes alone"), "{stderr}");
}

#[test]
fn the_heading_is_forgiven_when_asked_for() {
    let folder = folder();
    for (name, words) in
        [("start", "heading of the first 2 s"), ("se2", "heading over the run"), ("se3", "all three angles")]
    {
        let args = ["est.tum", "--truth", "attitude.csv", "--align", name];
        let found = json(folder.path(), &args);
        // Clockwise is a negative turn about the vertical; the alignment turns back.
        assert!((number(&found["alignment"], "yaw_deg") - 3.0).abs() < 1e-9, "{found}");
        assert!(number(&found, "rmse_attitude_deg") < 1e-6, "{found}");
        let table = eval(folder.path(), &args).stdout;
        assert!(table.contains(&format!("aligned     {name} ({words}")), "{table}");
    }
}

#[test]
fn only_marked_rows_are_scored_unless_all_are_asked_for() {
    let folder = folder();
    let marks: Vec<bool> = (0..600).map(middle).collect();
    let (estimate, truth) = (hand(3.0, false), hand(0.0, false));
    for (flag, marked) in [(&[][..], Some(marks.clone())), (&["--all-rows"][..], None)] {
        let options =
            EvaluationOptions { alignment: Alignment::None, marked, ..EvaluationOptions::default() };
        let expected = evaluate_attitude(&estimate, &truth, WithoutPosition::Truth, &options).unwrap();
        let found = written(folder.path(), &[&["est.tum", "--truth", "marked.csv"], flag].concat());
        assert_eq!(found, text(&expected.report));
        assert_eq!(expected.report.poses_compared, if flag.is_empty() { 300 } else { 600 });
    }
    let table = eval(folder.path(), &["est.tum", "--truth", "marked.csv"]).stdout;
    assert!(table.contains("scored      300 of 600 rows of the truth"), "{table}");

    let options = EvaluationOptions { marked: Some(marks), ..EvaluationOptions::default() };
    let expected = evaluate(&hand(3.0, true), &hand(0.0, true), &options).unwrap().report;
    let found = written(folder.path(), &["path.tum", "--truth", "marked_path.csv"]);
    assert_eq!(found, text(&expected));
    assert_eq!((expected.poses_compared, expected.poses_unmarked), (300, 300));
}

#[test]
fn a_covariance_of_attitude_alone_is_judged_too() {
    let folder = folder();
    let mut covariance = SolutionCovariance::zeros();
    covariance.fixed_view_mut::<3, 3>(6, 6).fill_with_identity();
    let mut file = SolutionWriter::create(folder.path().join("est.csv")).unwrap();
    for Pose { time, attitude, .. } in hand(3.0, false).poses() {
        let (position_m, velocity_m_s) = (Vector3::zeros(), Vector3::zeros());
        let quality = Quality::Fixed;
        let attitude: Attitude = *attitude;
        file.push(&Solution { time: *time, position_m, velocity_m_s, attitude, covariance, quality })
            .unwrap();
    }
    file.finish().unwrap();
    let found = json(folder.path(), &["est.tum", "--truth", "marked.csv", "--covariance", "est.csv"]);
    // A variance of 1 rad² everywhere, an error of 3° everywhere.
    assert!(
        (number(&found["nees"]["attitude"], "mean") - 3_f64.to_radians().powi(2)).abs() < 1e-9,
        "{found}"
    );
    assert_eq!(found["nees"]["attitude"]["samples"], 300);
    assert!(found["nees"]["horizontal"].is_null() && found["nees"]["position"].is_null(), "{found}");
}

#[test]
fn the_figure_shows_signed_headings_and_what_is_not_scored() {
    let folder = folder();
    let Outcome { code, stdout, .. } =
        eval(folder.path(), &["est.tum", "--truth", "marked.csv", "--plot", "hand.svg"]);
    assert_eq!(code, 0);
    assert!(stdout.contains("figure      hand.svg"), "{stdout}");
    let figure = std::fs::read_to_string(folder.path().join("hand.svg")).unwrap();
    for text in ["heading, RMSE 3.00°", "clockwise above 0", "not scored", "whole angle", "inclination"] {
        assert!(figure.contains(text), "{text}");
    }
    let all = ["est.tum", "--truth", "marked.csv", "--all-rows", "--plot", "all.svg"];
    assert_eq!(eval(folder.path(), &all).code, 0);
    assert!(!std::fs::read_to_string(folder.path().join("all.svg")).unwrap().contains("not scored"));
}
