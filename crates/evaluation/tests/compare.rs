//! Many runs in a few numbers: against errors that are known, and against χ² where the covariance is honest.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_core::trajectory::Pose;
use adit_evaluation::EvaluationError;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::compare::{
    Comparison, GRID_S, Moments, RunErrors, RunOptions, RunOutcome, TrueState, html, run_errors, summarise,
};
use proptest::test_runner::{RngAlgorithm, TestRng};

const ALL: Moments = Moments { from_s: 0.0, every_s: GRID_S, above_m_s: 0.0 };
const OPTIONS: RunOptions =
    RunOptions { alignment: Alignment::None, moments: ALL, positions: true, heights: true, attitudes: true };

fn time(tenths: i64) -> Time {
    Time::from_nanos(tenths * 100_000_000)
}

/// A straight walk north at 1 m/s, heading 30°.
fn truth(tenths: i64) -> Vec<TrueState> {
    let attitude = attitude::exp(&(Vector3::z() * 60_f64.to_radians()));
    let state = |tenth: i64| TrueState {
        pose: Pose { time: time(tenth), position_m: Vector3::new(0.0, tenth as f64 * 0.1, 0.0), attitude },
        velocity_m_s: Some(Vector3::y()),
    };
    (0..tenths).map(state).collect()
}

/// The truth off by this much: east and north (m), their velocities (m/s), clockwise heading (rad); σ 0.1 of each unit.
fn solution(truth: &TrueState, off: [f64; 5]) -> Solution {
    let [east, north, ve, vn, heading] = off;
    Solution {
        time: truth.pose.time,
        position_m: truth.pose.position_m + Vector3::new(east, north, 5.0),
        velocity_m_s: truth.velocity_m_s.unwrap() + Vector3::new(ve, vn, 0.3),
        attitude: attitude::exp(&(Vector3::z() * -heading)) * truth.pose.attitude,
        covariance: SolutionCovariance::identity() * 0.01,
        quality: Quality::Fixed,
    }
}

fn outcome(errors: RunErrors) -> RunOutcome {
    RunOutcome { errors, nis: Some((2, 10, 19.0)), time_per_step_ns: 100.0 }
}

fn near(found: f64, expected: f64) {
    // Errors are kept in single precision.
    assert!((found - expected).abs() <= 1e-6 * expected.abs().max(0.1), "{found}, expected {expected}");
}

#[test]
fn known_errors_make_known_figures() {
    let truth = truth(40);
    let runs: Vec<_> = [1.0, 2.0]
        .iter()
        .map(|gain| {
            let off = [0.3 * gain, -0.4 * gain, 0.06 * gain, 0.08 * gain, 0.02 * gain];
            let solutions: Vec<Solution> = truth.iter().map(|state| solution(state, off)).collect();
            Some(outcome(run_errors(&solutions, &truth, &OPTIONS).unwrap()))
        })
        .collect();
    let summary = summarise("foot-ins", &runs, true).unwrap();
    let position = summary.position_m.unwrap();
    near(position.mean, 0.75);
    near(position.max, 1.0);
    near(position.rmse, f64::midpoint(0.25, 1.0).sqrt());
    near(summary.velocity_m_s.unwrap().max, 0.2);
    near(summary.heading_deg.unwrap().median, 0.03_f64.to_degrees());
    near(summary.over_seeds.largest_east_m.unwrap().mean, 0.45);
    near(summary.over_seeds.end_velocity_m_s.unwrap().mean, 0.15);
    assert_eq!(summary.share_below_2m, Some(1.0));
    // (0.3² + 0.4²)/0.1² = 25, four times as much in the second run; velocity 1 and 4, heading 0.04 and 0.16.
    near(summary.nees.as_ref().unwrap().mean, 62.5);
    near(summary.consistency.velocity.as_ref().unwrap().mean, 2.5);
    near(summary.consistency.heading.as_ref().unwrap().mean, 0.1);
    near(summary.consistency.joint.as_ref().unwrap().mean, 65.1);
    near(summary.nis.unwrap().mean, 1.9);
    assert_eq!((summary.runs, summary.failed_runs), (2, 0));
}

#[test]
fn a_failed_run_is_counted_and_in_no_figure() {
    let truth = truth(10);
    let solutions: Vec<Solution> = truth.iter().map(|state| solution(state, [0.1; 5])).collect();
    let good = Some(outcome(run_errors(&solutions, &truth, &OPTIONS).unwrap()));
    let summary = summarise("foot-ins", &[good.clone(), None, good], true).unwrap();
    assert_eq!((summary.runs, summary.failed_runs), (2, 1));
    near(summary.position_m.unwrap().max, 0.1 * 2_f64.sqrt());
    let none = summarise("foot-ins", &[None], true).unwrap();
    assert_eq!((none.runs, none.position_m, none.nees), (0, None, None));
}

/// Standard normals from the sum of twelve shares: variance 1.
fn normal(rng: &mut TestRng) -> f64 {
    use proptest::prelude::Rng;
    (0..12).map(|_| rng.next_u64() as f64 / u64::MAX as f64).sum::<f64>() - 6.0
}

#[test]
fn honest_covariances_are_found_honest_and_others_not() {
    let truth = truth(300);
    let mut rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[3; 32]);
    let mut runs = |sigma: f64| -> Vec<Option<RunOutcome>> {
        let mut run = || {
            let mut off = || [(); 5].map(|()| sigma * normal(&mut rng));
            let solutions: Vec<Solution> = truth.iter().map(|state| solution(state, off())).collect();
            Some(outcome(run_errors(&solutions, &truth, &OPTIONS).unwrap()))
        };
        (0..40).map(|_| run()).collect()
    };
    let honest = summarise("a", &runs(0.1), true).unwrap().consistency;
    let joint = honest.joint.unwrap();
    // 12,000 samples of χ²(5): the mean is within 4 √(2·5/12000) = 0.12; of 300 moments 95 % ± 5 % lie inside.
    assert!((joint.mean - 5.0).abs() < 0.12 && (0.90..=1.0).contains(&joint.share_inside), "{joint:?}");
    let bold = summarise("b", &runs(0.15), true).unwrap().consistency.joint.unwrap();
    assert!(bold.mean > bold.bounds.upper && bold.share_inside < 0.05);
}

#[test]
fn what_is_not_estimated_is_not_judged() {
    let truth = truth(20);
    let mut solutions: Vec<Solution> = truth.iter().map(|state| solution(state, [0.1; 5])).collect();
    let attitude = RunOptions { positions: false, ..OPTIONS };
    let summary =
        summarise("ahrs", &[Some(outcome(run_errors(&solutions, &truth, &attitude).unwrap()))], true)
            .unwrap();
    assert!(summary.position_m.is_none() && summary.velocity_m_s.is_none() && summary.heading_deg.is_some());
    assert!(summary.consistency.joint.is_none() && summary.consistency.heading.is_some());
    // One covariance that is none, and that part has no NEES.
    solutions[7].covariance[(0, 0)] = 0.0;
    let summary =
        summarise("x", &[Some(outcome(run_errors(&solutions, &truth, &OPTIONS).unwrap()))], true).unwrap();
    assert!(summary.nees.is_none() && summary.consistency.velocity.is_some());
    let late = RunOptions { moments: Moments { from_s: 100.0, ..ALL }, ..OPTIONS };
    assert!(matches!(run_errors(&solutions, &truth, &late), Err(EvaluationError::TooFewPoses { .. })));
}

#[test]
fn moments_stand_on_a_grid_and_only_where_the_truth_moves() {
    // Walks for 10 s, stands for 10 s.
    let mut truth = truth(200);
    for state in &mut truth[100..] {
        state.pose.position_m.y = 10.0;
    }
    let solutions: Vec<Solution> = truth.iter().map(|state| solution(state, [0.1; 5])).collect();
    let judged = |moments| {
        let errors = run_errors(&solutions, &truth, &RunOptions { moments, ..OPTIONS }).unwrap();
        errors.time_s.into_iter().map(|time| (time * 10.0).round() / 10.0).collect::<Vec<f32>>()
    };
    assert_eq!(judged(Moments { every_s: 6.0, ..ALL }), [0.0, 6.0, 12.0, 18.0]);
    // A grid that falls between solutions does not drift.
    assert_eq!(judged(Moments { every_s: 6.25, ..ALL }), [0.0, 6.3, 12.5, 18.8]);
    // At the ends there is no second around the moment.
    assert_eq!(judged(Moments { every_s: 3.0, above_m_s: 0.3, ..ALL }), [3.0, 6.0, 9.0]);
    assert_eq!(judged(Moments { from_s: 5.0, every_s: 3.0, above_m_s: 0.3 }), [5.0, 8.0]);
}

#[test]
fn a_page_escapes_names_and_needs_nothing_from_elsewhere() {
    let truth = truth(30);
    let solutions: Vec<Solution> = truth.iter().map(|state| solution(state, [0.1; 5])).collect();
    let run = Some(outcome(run_errors(&solutions, &truth, &OPTIONS).unwrap()));
    let summary = summarise("foot-ins", &[run], true).unwrap();
    let comparison = Comparison {
        scenario: "<script>&".to_owned(),
        seeds: 1,
        first_seed: None,
        alignment: "none".to_owned(),
        judged_from_s: 0.0,
        judged_every_s: Some(GRID_S),
        judged_above_m_s: 0.0,
        methods: vec![("a \"b\" <c>".to_owned(), summary)],
    };
    let page = html(&comparison, &[]).unwrap();
    assert!(page.contains("&lt;script&gt;&amp;") && !page.contains("<script") && !page.contains("<c>"));
    let json = serde_json::to_value(&comparison).unwrap();
    assert!(json["methods"]["a \"b\" <c>"]["position_m"]["p95"].is_number());
    assert!(comparison.to_string().contains("1 run"));
}
