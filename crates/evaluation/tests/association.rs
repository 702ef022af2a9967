//! Which poses are compared, and when a comparison is refused.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::association::{Association, associate};
use adit_evaluation::{EvaluationError, EvaluationOptions, evaluate};

/// Poses at these milliseconds, at `x = t` metres, turning 0.1 rad/s.
fn at(milliseconds: impl IntoIterator<Item = i64>) -> Trajectory {
    let pose = |ms: i64| {
        let seconds = ms as f64 * 1e-3;
        Pose {
            time: Time::from_nanos(ms * 1_000_000),
            position_m: Vector3::new(seconds, 0.0, 0.0),
            attitude: attitude::exp(&Vector3::new(0.0, 0.0, 0.1 * seconds)),
        }
    };
    Trajectory::new(milliseconds.into_iter().map(pose).collect()).unwrap()
}

fn within(milliseconds: i64) -> Association {
    Association::Nearest { max_difference: Interval::from_nanos(milliseconds * 1_000_000) }
}

fn milliseconds(poses: &[Pose]) -> Vec<i64> {
    poses.iter().map(|pose| pose.time.nanos() / 1_000_000).collect()
}

#[test]
fn the_estimate_is_read_at_the_stamps_of_the_truth() {
    let found =
        associate(&at([0, 700, 2000]), &at((0..=20).map(|i| i * 100)), &Association::default()).unwrap();
    assert_eq!(found.pairs.len(), 21);
    for (estimate, truth) in found.pairs.iter() {
        assert_eq!(estimate.time, truth.time);
        assert!((estimate.position_m - truth.position_m).norm() < 1e-15);
        assert!(estimate.attitude.angle_to(&truth.attitude) < 1e-7);
    }
}

#[test]
fn truth_outside_the_span_of_the_estimate_is_left_out_and_counted() {
    let (estimate, truth) = (at((2..=99).map(|i| i * 10)), at((0..100).map(|i| i * 10)));
    let found = associate(&estimate, &truth, &Association::default()).unwrap();
    assert_eq!(found.pairs.len(), 98);
    assert!((found.covered_share - 0.98).abs() < 1e-15);
}

#[test]
fn an_estimate_that_covers_too_little_is_refused_with_both_shares() {
    let refused = associate(&at([0, 900]), &at((0..100).map(|i| i * 10)), &Association::default());
    let Err(EvaluationError::CoverageTooLow { found, expected, .. }) = refused else {
        unreachable!("{refused:?}")
    };
    assert!((found - 0.91).abs() < 1e-15 && (expected - 0.95).abs() < 1e-15);
    assert_eq!(
        refused.unwrap_err().to_string(),
        "the estimate (0.000000000 s to 0.900000000 s) covers 91.0 % of the truth (0.000000000 s to 0.990000000 s), \
         at least 95.0 % is asked for"
    );
    let lenient = Association::Interpolate { minimum_covered_share: 0.9 };
    assert!(associate(&at([0, 900]), &at((0..100).map(|i| i * 10)), &lenient).is_ok());
}

#[test]
fn the_sparser_trajectory_takes_the_nearest_stamps_of_the_denser() {
    let found = associate(&at([4, 11, 52, 207]), &at((0..30).map(|i| i * 10)), &within(3)).unwrap();
    assert_eq!(milliseconds(found.pairs.estimate()), [11, 52, 207]);
    assert_eq!(milliseconds(found.pairs.truth()), [10, 50, 210]);
}

#[test]
fn of_two_equally_near_stamps_the_earlier_is_taken() {
    let found = associate(&at([5, 15]), &at([0, 10, 20]), &within(5)).unwrap();
    assert_eq!(milliseconds(found.pairs.truth()), [0, 10]);
}

#[test]
fn a_truth_shared_by_two_poses_counts_once_as_covered() {
    let found = associate(&at([9, 11, 40]), &at([10, 20, 30, 40]), &within(2)).unwrap();
    assert_eq!(milliseconds(found.pairs.truth()), [10, 10, 40]);
    assert!((found.covered_share - 0.5).abs() < 1e-15);
}

#[test]
fn trajectories_of_different_days_do_not_match() {
    let refused = associate(&at([0, 10]), &at([86_400_000, 86_400_010]), &within(10));
    assert!(matches!(refused, Err(EvaluationError::NoMatch { .. })), "{refused:?}");
    let refused = associate(&at([0, 10]), &at([86_400_000, 86_400_010]), &Association::default());
    assert!(matches!(refused, Err(EvaluationError::CoverageTooLow { .. })), "{refused:?}");
}

#[test]
fn one_pose_is_no_trajectory() {
    for (estimate, truth, side) in
        [(at([0]), at([0, 10]), "the estimate"), (at([0, 10]), at([]), "the truth")]
    {
        let refused = associate(&estimate, &truth, &Association::default());
        assert!(
            matches!(refused, Err(EvaluationError::TooFewPoses { what, .. }) if what == side),
            "{refused:?}"
        );
    }
}

#[test]
fn a_perfect_estimate_has_no_error_and_a_whole_ratio() {
    let truth = at((0..=60).map(|i| i * 100));
    let report = evaluate(&truth, &truth, &EvaluationOptions::default()).unwrap().report;
    assert!(report.position.spatial_m.max < 1e-15 && report.attitude.unwrap().total_deg.max < 1e-6);
    assert_eq!((report.end.end_share, report.travel.path_ratio), (Some(0.0), Some(1.0)));
    // 6 m on chords of at least 0.25 m, taken every 0.3 m.
    assert!((report.travel.path_truth_m - 6.0).abs() < 1e-12);
    assert_eq!((report.relative[0].pairs, report.relative[1].pairs), (6, 0));
}

#[test]
fn nobody_who_stood_still_is_given_a_share_of_his_path() {
    let still = |offset: f64| {
        let pose = |i: i64| Pose {
            time: Time::from_nanos(i * 1_000_000_000),
            position_m: Vector3::new(offset, 0.0, 0.0),
            attitude: Attitude::identity(),
        };
        Trajectory::new((0..5).map(pose).collect()).unwrap()
    };
    let options = EvaluationOptions {
        alignment: adit_evaluation::alignment::Alignment::None,
        attitude: false,
        ..EvaluationOptions::default()
    };
    let report = evaluate(&still(0.5), &still(0.0), &options).unwrap().report;
    assert_eq!((report.end.end_share, report.travel.path_ratio), (None, None));
    assert!((report.position.horizontal_m.rmse - 0.5).abs() < 1e-15);
}
