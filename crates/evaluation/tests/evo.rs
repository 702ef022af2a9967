//! Agreement with independent implementations on stored files: evo (Grupp) and numpy.
//!
//! `tests/evo/make_numbers.py` made the files and the numbers; its head says how to run it again.

#![expect(clippy::unwrap_used, reason = "a test that cannot read its files has failed")]

use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Quaternion, Vector3};
use adit_core::time::{Interval, Time};
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::association::Association;
use adit_evaluation::rpe::{Delta, Frame, Selection, relative_errors};
use adit_evaluation::statistics::Statistics;
use adit_evaluation::{Evaluation, EvaluationOptions, evaluate};
use serde_json::Value;

/// Both sides read the same decimal digits; what differs is the order of some ten operations in `f64`.
const TOLERANCE: f64 = 1e-9;
const EVO_NUMBERS: &str = include_str!("evo/evo.json");
const SCORE_NUMBERS: &str = include_str!("evo/score.json");

fn read_tum(text: &str) -> Trajectory {
    let poses = text.lines().filter(|line| !line.starts_with('#')).map(|line| {
        let v: Vec<f64> = line.split(' ').map(|field| field.parse().unwrap()).collect();
        Pose {
            time: Time::from_seconds(v[0]).unwrap(),
            position_m: Vector3::new(v[1], v[2], v[3]),
            attitude: Attitude::from_quaternion(Quaternion::new(v[7], v[4], v[5], v[6])),
        }
    });
    Trajectory::new(poses.collect()).unwrap()
}

fn estimate() -> Trajectory {
    read_tum(include_str!("evo/estimate.tum"))
}

fn truth() -> Trajectory {
    read_tum(include_str!("evo/truth.tum"))
}

fn as_evo_does(alignment: Alignment) -> Evaluation {
    let max_difference = Interval::from_nanos(10_000_000);
    let options = EvaluationOptions {
        association: Association::Nearest { max_difference },
        alignment,
        ..EvaluationOptions::default()
    };
    evaluate(&estimate(), &truth(), &options).unwrap()
}

fn assert_close(what: &str, ours: f64, theirs: &Value) {
    let theirs = theirs.as_f64().unwrap();
    // Sums of squares reach 1e7, where an f64 has no 1e-9 left: they are held to it relatively.
    let allowed = if what.ends_with("sse") { TOLERANCE * theirs.abs().max(1.0) } else { TOLERANCE };
    assert!((ours - theirs).abs() <= allowed, "{what}: ours {ours}, theirs {theirs}");
}

fn assert_statistics(what: &str, ours: &Statistics, theirs: &Value) {
    for (name, value) in ours.named() {
        if let Some(theirs) = theirs.get(name) {
            assert_close(&format!("{what} {name}"), value, theirs);
        }
    }
    for name in ["rmse", "mean", "median", "std", "min", "max", "sse"] {
        assert!(theirs.get(name).is_some(), "{what}: no {name} stored");
    }
}

#[test]
fn absolute_errors_equal_those_of_evo() {
    let numbers: Value = serde_json::from_str(EVO_NUMBERS).unwrap();
    for (alignment, key) in [(Alignment::None, "ape_none"), (Alignment::Se3, "ape_se3")] {
        let report = as_evo_does(alignment).report;
        assert_eq!(Some(report.poses_compared as u64), numbers["associated"].as_u64());
        assert_statistics(key, &report.position.spatial_m, &numbers[key]["translation_m"]);
        assert_statistics(key, &report.attitude.unwrap().total_deg, &numbers[key]["angle_deg"]);
    }
}

#[test]
fn path_lengths_equal_those_of_evo() {
    let numbers: Value = serde_json::from_str(EVO_NUMBERS).unwrap();
    let travel = as_evo_does(Alignment::None).report.travel;
    assert_close("truth", travel.path_sum_truth_m, &numbers["path_sum_truth_m"]);
    assert_close("estimate", travel.path_sum_estimate_m, &numbers["path_sum_estimate_m"]);
}

#[test]
fn relative_errors_equal_those_of_evo() {
    let numbers: Value = serde_json::from_str(EVO_NUMBERS).unwrap();
    let pairs = as_evo_does(Alignment::None).pairs;
    for (key, delta, selection) in [
        ("rpe_1_frame", Delta::Frames(1), Selection::Consecutive),
        ("rpe_10_frames", Delta::Frames(10), Selection::Consecutive),
        ("rpe_1_m", Delta::Metres(1.0), Selection::Consecutive),
        ("rpe_10_frames_all", Delta::Frames(10), Selection::All),
        ("rpe_2_m_all", Delta::Metres(2.0), Selection::All),
    ] {
        let errors = relative_errors(&pairs, delta, selection, Frame::Body).unwrap();
        let degrees: Vec<f64> = errors.angle_rad.iter().map(|a| a.to_degrees()).collect();
        assert_eq!(
            Some(errors.indices.len() as u64),
            numbers[key]["translation_m"]["pairs"].as_u64(),
            "{key}"
        );
        let translation = Statistics::of(&errors.translation_m).unwrap();
        assert_statistics(key, &translation, &numbers[key]["translation_m"]);
        assert_statistics(key, &Statistics::of(&degrees).unwrap(), &numbers[key]["angle_deg"]);
    }
}

#[test]
fn interpolated_errors_equal_those_of_numpy_under_every_alignment() {
    let numbers: Value = serde_json::from_str(SCORE_NUMBERS).unwrap();
    for (key, alignment, start_distance_m) in [
        ("none", Alignment::None, 1.0),
        ("start", Alignment::Start, 1.0),
        ("start_3_m", Alignment::Start, 3.0),
        ("se2", Alignment::Se2, 1.0),
        ("se3", Alignment::Se3, 1.0),
    ] {
        let options = EvaluationOptions { alignment, start_distance_m, ..EvaluationOptions::default() };
        let report = evaluate(&estimate(), &truth(), &options).unwrap().report;
        let theirs = &numbers[key];
        assert_eq!(Some(report.poses_compared as u64), theirs["n"].as_u64());
        assert_eq!(Some(report.covered_share), theirs["covered"].as_f64());
        let (horizontal, spatial) = (report.position.horizontal_m, report.position.spatial_m);
        for (name, ours) in [
            ("rmse_2d", horizontal.rmse),
            ("median_2d", horizontal.median),
            ("p90_2d", horizontal.p90),
            ("p95_2d", horizontal.p95),
            ("max_2d", horizontal.max),
            ("mean_2d", horizontal.mean),
            ("rmse_3d", spatial.rmse),
            ("median_3d", spatial.median),
            ("max_3d", spatial.max),
            ("end_2d", report.end.end_2d_m),
            ("end_z", report.end.end_vertical_m),
            ("path_truth", report.travel.path_truth_m),
            ("path_ratio", report.travel.path_ratio.unwrap()),
        ] {
            assert_close(&format!("{key} {name}"), ours, &theirs[name]);
        }
    }
}
