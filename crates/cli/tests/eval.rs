//! `adit eval` says what the evaluation crate says.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::attitude::{Attitude, exp};
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::report::EvaluationReport;
use adit_evaluation::{EvaluationOptions, evaluate, evaluate_solutions};
use adit_observation::solution_csv::SolutionWriter;
use adit_observation::tum;
use common::{Outcome, adit};
use std::fmt::Write;
use std::path::Path;

fn walk(stretch: f64) -> Trajectory {
    let pose = |i: i32| {
        let t = f64::from(i) * 0.05;
        Pose {
            time: Time::from_seconds(t).unwrap(),
            position_m: Vector3::new(t * stretch, (0.3 * t).sin() * 4.0, 0.02 * stretch * t),
            attitude: exp(&Vector3::new(0.01 * stretch, 0.0, 0.1 * t)),
        }
    };
    Trajectory::new((0..600).map(pose).collect()).unwrap()
}

fn solutions(path: &Trajectory) -> Vec<Solution> {
    let solution = |p: &Pose| Solution {
        time: p.time,
        position_m: p.position_m,
        velocity_m_s: Vector3::zeros(),
        attitude: p.attitude,
        covariance: SolutionCovariance::identity() * 0.01,
        quality: Quality::DeadReckoning,
    };
    path.poses().iter().map(solution).collect()
}

/// A folder with `est.tum`, `est.csv`, `truth.tum` and `walk_truth.csv` (positions alone).
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    tum::write(path("est.tum"), &walk(1.03)).unwrap();
    tum::write(path("truth.tum"), &walk(1.0)).unwrap();
    let mut csv = "time_s,x_m,y_m,z_m\n".to_owned();
    for pose in walk(1.0).poses() {
        let p = pose.position_m;
        writeln!(csv, "{},{},{},{}", pose.time, p.x, p.y, p.z).unwrap();
    }
    std::fs::write(path("walk_truth.csv"), csv).unwrap();
    let mut file = SolutionWriter::create(path("est.csv")).unwrap();
    for solution in solutions(&walk(1.03)) {
        file.push(&solution).unwrap();
    }
    file.finish().unwrap();
    folder
}

fn json(folder: &Path, args: &[&str]) -> String {
    let Outcome { code, stdout, stderr } = adit(folder, &[&["eval", "est.tum", "--json"], args].concat());
    assert_eq!((code, stderr.as_str()), (0, ""));
    stdout
}

/// A report as the crate itself writes it: every digit counts.
fn written(report: &EvaluationReport) -> String {
    serde_json::to_string_pretty(report).unwrap() + "\n"
}

#[test]
fn figures_are_those_of_the_evaluation_crate() {
    let folder = folder();
    for (name, alignment) in [
        ("none", Alignment::None),
        ("start", Alignment::Start),
        ("se2", Alignment::Se2),
        ("se3", Alignment::Se3),
    ] {
        let options = EvaluationOptions { alignment, start_distance_m: 2.0, ..EvaluationOptions::default() };
        let expected = evaluate(&walk(1.03), &walk(1.0), &options).unwrap().report;
        let found = json(folder.path(), &["--truth", "truth.tum", "--align", name, "--start-distance", "2"]);
        assert_eq!(found, written(&expected), "{name}");
    }
}

#[test]
fn a_truth_of_positions_alone_judges_no_attitude() {
    let folder = folder();
    let found = json(folder.path(), &["--truth", "walk_truth.csv"]);
    let options = EvaluationOptions { attitude: false, ..EvaluationOptions::default() };
    let expected = evaluate(&walk(1.03), &walk(1.0), &options).unwrap().report;
    assert_eq!(found, written(&expected));
    assert!(!found.contains("heading"));
}

#[test]
fn a_covariance_adds_the_nees() {
    let folder = folder();
    let found = json(folder.path(), &["--truth", "truth.tum", "--covariance", "est.csv"]);
    let expected = evaluate_solutions(&solutions(&walk(1.03)), &walk(1.0), &EvaluationOptions::default())
        .unwrap()
        .report;
    assert_eq!(found, written(&expected));
    assert!(expected.nees.unwrap().position.unwrap().mean > 0.0);
}

#[test]
fn the_table_has_units_and_the_figure_is_an_svg() {
    let folder = folder();
    let Outcome { code, stdout, .. } =
        adit(folder.path(), &["eval", "est.tum", "--truth", "truth.tum", "--plot", "walk.svg"]);
    assert_eq!(code, 0);
    for word in ["se2", "rmse", " m ", "°", "end error", "ratio", "walk.svg"] {
        assert!(stdout.contains(word), "{word}: {stdout}");
    }
    let figure = std::fs::read_to_string(folder.path().join("walk.svg")).unwrap();
    assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
}

#[test]
fn what_cannot_be_scored_is_told_with_exit_code_1() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let half: Vec<Pose> = walk(1.0).poses()[..300].to_vec();
    tum::write(path("half.tum"), &Trajectory::new(half).unwrap()).unwrap();
    let straight = |i: i32| Pose {
        time: Time::from_seconds(f64::from(i)).unwrap(),
        position_m: Vector3::new(f64::from(i), 0.0, 0.0),
        attitude: Attitude::identity(),
    };
    tum::write(path("line.tum"), &Trajectory::new((0..20).map(straight).collect()).unwrap()).unwrap();
    std::fs::write(path("bad.tum"), "0 0 0 0 0 0 0 1\n1 0 0 zero 0 0 0 1\n").unwrap();
    std::fs::write(path("turn_truth.csv"), "time_s,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0\n").unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&["half.tum", "--truth", "truth.tum"], "half.tum against truth.tum: the estimate"),
        (&["line.tum", "--truth", "line.tum", "--align", "se3"], "align by se2, start or none"),
        (&["bad.tum", "--truth", "truth.tum"], "bad.tum:2: z: found \"zero\", expected a finite number"),
        (&["none.tum", "--truth", "truth.tum"], "none.tum: cannot open it"),
        (&["est.tum", "--truth", "none.csv"], "none.csv: cannot open it"),
        (&["est.tum", "--truth", "turn_truth.csv", "--covariance", "half.csv"], "half.csv: cannot open it"),
        (&["line.tum", "--truth", "line.tum", "--covariance", "est.csv"], "found 600 solutions, expected 20"),
        (&["est.csv", "--truth", "truth.tum"], "est.csv:1: found"),
    ];
    for (args, expected) in cases {
        let plot = ["--plot", "never.svg"];
        let Outcome { code, stdout, stderr } = adit(folder.path(), &[&["eval"], args, &plot].concat());
        assert_eq!((code, stdout.as_str()), (1, ""), "{args:?}");
        assert!(stderr.starts_with("adit: ") && stderr.contains(expected), "{args:?}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(!path("never.svg").exists());
    }
}
