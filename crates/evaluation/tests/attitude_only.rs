//! Attitude without positions: signs, alignments, marks, figures.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::ape::{attitude_error, carries_position};
use adit_evaluation::marks::Judged;
use adit_evaluation::plot::attitude_figure;
use adit_evaluation::{
    AttitudeEvaluation, EvaluationError, EvaluationOptions, WithoutPosition, evaluate, evaluate_attitude,
};
use proptest::prelude::*;

/// Rounding of about ten operations on angles of up to π, through square roots near zero.
const ROUNDING_RAD: f64 = 1e-7;

fn rotation() -> impl Strategy<Value = Attitude> {
    [-1.8..1.8, -1.8..1.8, -1.8..1.8].prop_map(|v: [f64; 3]| attitude::exp(&Vector3::from(v)))
}

fn up(angle_rad: f64) -> Attitude {
    attitude::exp(&Vector3::new(0.0, 0.0, angle_rad))
}

/// Any attitudes, 0.1 s apart, at the origin.
fn trajectory(attitudes: impl IntoIterator<Item = Attitude>) -> Trajectory {
    let pose = |(index, attitude): (i64, Attitude)| Pose {
        time: Time::from_nanos(index * 100_000_000),
        position_m: Vector3::zeros(),
        attitude,
    };
    Trajectory::new((0..).zip(attitudes).map(pose).collect()).unwrap()
}

fn hand(seconds: i32) -> Trajectory {
    let turned = |i: i32| {
        let t = f64::from(i) * 0.1;
        up(0.3 * t) * attitude::exp(&Vector3::new(0.7 * t.sin(), 0.4 * (1.3 * t).cos(), 0.0))
    };
    trajectory((0..10 * seconds).map(turned))
}

fn turned(trajectory: &Trajectory, error: impl Fn(f64) -> Attitude) -> Trajectory {
    let poses = trajectory
        .poses()
        .iter()
        .map(|pose| Pose { attitude: error(pose.time.seconds()) * pose.attitude, ..*pose });
    Trajectory::new(poses.collect()).unwrap()
}

fn judge(
    estimate: &Trajectory,
    truth: &Trajectory,
    alignment: Alignment,
    marked: Option<Vec<bool>>,
) -> AttitudeEvaluation {
    let options = EvaluationOptions { alignment, marked, ..EvaluationOptions::default() };
    evaluate_attitude(estimate, truth, WithoutPosition::Truth, &options).unwrap()
}

proptest! {
    #[test]
    fn the_signed_heading_is_the_turn_that_was_made(
        truth in rotation(), clockwise in -3.1..3.1_f64, tilt in -0.5..0.5_f64, about in -3.1..3.1_f64,
    ) {
        let axis = Vector3::new(about.cos(), about.sin(), 0.0);
        let estimate = (attitude::exp(&(axis * tilt)) * up(clockwise)) * truth;
        let error = attitude_error(&estimate, &truth);
        // A turn about the vertical and one about a horizontal axis are what the error is split into.
        prop_assert!((error.signed_heading_rad + clockwise).abs() < ROUNDING_RAD, "{error:?}");
        prop_assert!((error.inclination_rad - tilt.abs()).abs() < ROUNDING_RAD, "{error:?}");
        prop_assert!((error.heading_rad - clockwise.abs()).abs() < ROUNDING_RAD, "{error:?}");
    }

    #[test]
    fn se2_and_start_take_any_heading_away(turn in -3.1..3.1_f64) {
        let truth = hand(30);
        for alignment in [Alignment::Start, Alignment::Se2] {
            let found = judge(&turned(&truth, |_| up(turn)), &truth, alignment, None);
            prop_assert!(found.turn.angle_to(&up(-turn)) < ROUNDING_RAD);
            prop_assert!(found.report.attitude.total_deg.max.to_radians() < ROUNDING_RAD);
        }
    }

    #[test]
    fn se3_takes_any_turn_away(turn in rotation()) {
        let truth = hand(30);
        let found = judge(&turned(&truth, |_| turn), &truth, Alignment::Se3, None);
        prop_assert!(found.report.attitude.total_deg.max.to_radians() < ROUNDING_RAD);
    }

    #[test]
    fn no_other_heading_is_better_than_that_of_se2(turns in prop::collection::vec(rotation(), 30), off in -0.5..0.5_f64) {
        // The average of quaternions maximises Σ cos², so 4 Σ sin² of the half angles is least.
        let truth = trajectory(turns.iter().map(|_| Attitude::identity()));
        let estimate = trajectory(turns);
        let cost = |e: &AttitudeEvaluation, more: Attitude| -> f64 {
            let half = |p: &Pose| (0.5 * (more * e.turn * p.attitude).angle()).sin().powi(2);
            estimate.poses().iter().map(half).sum()
        };
        let best = judge(&estimate, &truth, Alignment::Se2, None);
        prop_assert!(cost(&best, Attitude::identity()) <= cost(&best, up(off)) + 1e-9);
        let space = judge(&estimate, &truth, Alignment::Se3, None);
        prop_assert!(cost(&space, Attitude::identity()) <= cost(&best, Attitude::identity()) + 1e-9);
    }
}

#[test]
fn a_heading_that_drifts_is_forgiven_its_start_or_its_middle() {
    let truth = hand(60);
    let drifting = turned(&truth, |t| up(-0.001 * t));
    let started = judge(&drifting, &truth, Alignment::Start, None).report.attitude;
    let fitted = judge(&drifting, &truth, Alignment::Se2, None).report.attitude;
    // The first 2 s have 21 samples: their middle is 1 s; the whole 60 s end at 59.9 s.
    let degrees = |drift_s: f64| (0.001 * drift_s).to_degrees();
    assert!((started.heading_deg.max - degrees(58.9)).abs() < 1e-4, "{started:?}");
    assert!((started.heading_bias_deg - degrees(29.95 - 1.0)).abs() < 1e-4, "{started:?}");
    assert!((fitted.heading_deg.max - degrees(29.95)).abs() < 1e-4, "{fitted:?}");
    assert!(fitted.heading_bias_deg.abs() < 1e-9, "{fitted:?}");
}

#[test]
fn rows_that_are_not_marked_count_for_nothing() {
    let truth = hand(60);
    // Wild outside the middle, where nothing is marked.
    let wild = |t: f64| if (20.0..40.0).contains(&t) { up(0.02) } else { attitude::exp(&Vector3::repeat(t)) };
    let estimate = turned(&truth, wild);
    let marked: Vec<bool> = (0..600).map(|i| (200..400).contains(&i)).collect();
    let found = judge(&estimate, &truth, Alignment::None, Some(marked.clone()));
    assert!((found.report.attitude.heading_deg.max - 0.02_f64.to_degrees()).abs() < 1e-9);
    assert_eq!((found.report.poses_unmarked, found.report.poses_compared), (400, 200));
    assert_eq!((found.errors.len(), found.judged_errors.len()), (600, 200));
    let seconds: Vec<(f64, f64)> =
        found.unmarked.iter().map(|p| (p.start.seconds(), p.end.seconds())).collect();
    assert_eq!(seconds, [(0.0, 19.9), (40.0, 59.9)]);

    // Positions and distance as if the rows were not in the file.
    let walked = |trajectory: &Trajectory| {
        let pose = |p: &Pose| Pose { position_m: Vector3::x() * p.time.seconds() * 2.0, ..*p };
        Trajectory::new(trajectory.poses().iter().map(pose).collect()).unwrap()
    };
    let (estimate, truth) = (walked(&estimate), walked(&truth));
    let options = EvaluationOptions { marked: Some(marked), ..EvaluationOptions::default() };
    let marked = evaluate(&estimate, &truth, &options).unwrap();
    let shorter = Trajectory::new(truth.poses()[200..400].to_vec()).unwrap();
    let mut alone = evaluate(&estimate, &shorter, &EvaluationOptions::default()).unwrap().report;
    (alone.poses_truth, alone.poses_unmarked) = (600, 400);
    assert_eq!(marked.report, alone);
    assert_eq!(marked.truth.len(), 600);
}

#[test]
fn marks_must_be_as_many_as_poses() {
    let truth = hand(10);
    let few = Judged::of(&truth, Some(&[true; 7]));
    assert_eq!(few, Err(EvaluationError::MarksDiffer { found: 7, expected: 100 }));
    let none = EvaluationOptions { marked: Some(vec![false; 100]), ..EvaluationOptions::default() };
    let refused = evaluate_attitude(&truth, &truth, WithoutPosition::Truth, &none);
    assert_eq!(refused, Err(EvaluationError::TooFewPoses { what: "the truth", found: 0, expected: 2 }));
}

#[test]
fn a_covariance_is_judged_where_rows_are_marked() {
    let truth = hand(60);
    let estimate = turned(&truth, |t| up(if (20.0..40.0).contains(&t) { 0.02 } else { 1.0 }));
    let mut covariance = SolutionCovariance::zeros();
    covariance.fixed_view_mut::<3, 3>(6, 6).fill_diagonal(0.02 * 0.02);
    let solution = |p: &Pose| Solution {
        time: p.time,
        position_m: Vector3::zeros(),
        velocity_m_s: Vector3::zeros(),
        attitude: p.attitude,
        covariance,
        quality: Quality::Fixed,
    };
    let solutions: Vec<Solution> = estimate.poses().iter().map(solution).collect();
    let marked: Vec<bool> = (0..600).map(|i| (200..400).contains(&i)).collect();
    let options = EvaluationOptions {
        marked: Some(marked),
        alignment: Alignment::None,
        ..EvaluationOptions::default()
    };
    let mut found = evaluate_attitude(&estimate, &truth, WithoutPosition::Estimate, &options).unwrap();
    found.judge_covariance(&solutions, &truth, &options).unwrap();
    let nees = found.report.nees.unwrap();
    let attitude = nees.attitude.unwrap();
    assert_eq!((attitude.samples, nees.horizontal, nees.position), (200, None, None));
    assert!((attitude.mean - 1.0).abs() < 1e-9, "{attitude:?}");
}

#[test]
fn attitude_alone_is_known_by_its_zero_positions() {
    let still = hand(10);
    assert!(!carries_position(&still));
    let mut poses = still.poses().to_vec();
    poses[50].position_m.z = -1e-9;
    assert!(carries_position(&Trajectory::new(poses).unwrap()));
}

#[test]
fn a_figure_keeps_its_scale_however_far_off_an_unscored_phase_is() {
    let truth = hand(60);
    let lost = |t: f64| up(if t < 15.0 { -2.5 } else { 0.01 * (0.5 * t).sin() });
    let marked: Vec<bool> = (0..600).map(|i| (200..500).contains(&i)).collect();
    let found = judge(&turned(&truth, lost), &truth, Alignment::None, Some(marked));
    let svg = attitude_figure(&found, "hand against cameras").unwrap();
    std::fs::write(format!("{}/attitude.svg", env!("CARGO_TARGET_TMPDIR")), &svg).unwrap();
    assert!(svg.starts_with("<svg xmlns=") && svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    for text in ["not scored, cut off where far out", "clockwise above 0", "heading, RMSE 0.", "0.5"] {
        assert!(svg.contains(text), "{text}");
    }
    // 143° off are not on the axis.
    assert!(!svg.contains(">100<") && !svg.contains(">140<"));
}
