//! What must hold for any trajectory: alignments recover motions, errors ignore what an alignment removes.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{UnitQuaternion, Vector3};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::{Alignment, RigidMotion, align};
use adit_evaluation::ape::attitude_error;
use adit_evaluation::association::PosePairs;
use adit_evaluation::rpe::{Delta, Frame, Selection, relative_errors};
use adit_evaluation::statistics::{Distribution, Statistics};
use adit_evaluation::{EvaluationError, EvaluationOptions, evaluate};
use proptest::prelude::*;

/// Rounding of coordinates of up to some kilometres through about ten operations.
const ROUNDING_M: f64 = 1e-9;

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-size..size, -size..size, -size..size].prop_map(Vector3::from)
}

fn rotation() -> impl Strategy<Value = Attitude> {
    vector(1.8).prop_map(|v| attitude::exp(&v))
}

fn motion() -> impl Strategy<Value = RigidMotion> {
    (rotation(), vector(100.0), vector(3000.0)).prop_map(|(rotation, from_m, to_m)| RigidMotion {
        rotation,
        from_m,
        to_m,
    })
}

fn level_motion() -> impl Strategy<Value = RigidMotion> {
    (motion(), -3.1..3.1).prop_map(|(motion, turn)| RigidMotion {
        rotation: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn),
        ..motion
    })
}

/// A walk of 40 poses, 0.2 s apart, that spreads in all directions.
fn walk() -> impl Strategy<Value = Trajectory> {
    prop::collection::vec((vector(1.0), rotation()), 40).prop_map(|steps| {
        let mut position_m = Vector3::new(0.0, 0.0, 0.0);
        let poses = steps.into_iter().enumerate().map(|(i, (step, attitude))| {
            // 0.8 m a step and a slow turn, on top of the random part.
            let (sin, cos) = (0.1 * i as f64).sin_cos();
            position_m += Vector3::new(0.8 * cos, 0.8 * sin, 0.0) + step * 0.3;
            Pose { time: Time::from_nanos(200_000_000 * i64::try_from(i).unwrap()), position_m, attitude }
        });
        Trajectory::new(poses.collect()).unwrap()
    })
}

fn pairs(estimate: &Trajectory, truth: &Trajectory) -> PosePairs {
    PosePairs::new(estimate.poses().to_vec(), truth.poses().to_vec()).unwrap()
}

fn largest_miss(found: &RigidMotion, estimate: &Trajectory, truth: &Trajectory) -> f64 {
    let miss = |(e, t): (&Pose, &Pose)| (found.position(&e.position_m) - t.position_m).norm();
    estimate.poses().iter().zip(truth.poses()).map(miss).fold(0.0, f64::max)
}

fn with_alignment(alignment: Alignment) -> EvaluationOptions {
    EvaluationOptions { alignment, ..EvaluationOptions::default() }
}

proptest! {
    #[test]
    fn se3_recovers_any_rigid_motion(estimate in walk(), motion in motion()) {
        let truth = motion.trajectory(&estimate).unwrap();
        let found = align(&pairs(&estimate, &truth), Alignment::Se3, 1.0).unwrap();
        prop_assert!(found.rotation.angle_to(&motion.rotation) < 1e-9);
        prop_assert!(largest_miss(&found, &estimate, &truth) < ROUNDING_M);
    }

    #[test]
    fn se2_and_start_recover_any_level_motion(estimate in walk(), motion in level_motion()) {
        let truth = motion.trajectory(&estimate).unwrap();
        for alignment in [Alignment::Se2, Alignment::Start] {
            let found = align(&pairs(&estimate, &truth), alignment, 1.0).unwrap();
            prop_assert!(found.rotation.angle_to(&motion.rotation) < 1e-9, "{alignment}");
            prop_assert!(largest_miss(&found, &estimate, &truth) < ROUNDING_M, "{alignment}");
        }
    }

    #[test]
    fn no_motion_near_the_aligned_one_is_better(
        estimate in walk(), truth in walk(), nudge in vector(0.05), turn in vector(0.02),
    ) {
        let pairs = pairs(&estimate, &truth);
        let found = align(&pairs, Alignment::Se3, 1.0).unwrap();
        let nudged = RigidMotion {
            rotation: attitude::exp(&turn) * found.rotation, to_m: found.to_m + nudge, ..found
        };
        let squares = |motion: &RigidMotion| -> f64 {
            pairs.iter().map(|(e, t)| (motion.position(&e.position_m) - t.position_m).norm_squared()).sum()
        };
        prop_assert!(squares(&found) <= squares(&nudged) * (1.0 + 1e-12));
    }

    #[test]
    fn errors_after_se2_ignore_a_level_motion_of_the_estimate(
        estimate in walk(), truth in walk(), motion in level_motion(),
    ) {
        let options = with_alignment(Alignment::Se2);
        let plain = evaluate(&estimate, &truth, &options).unwrap().report;
        let moved = evaluate(&motion.trajectory(&estimate).unwrap(), &truth, &options).unwrap().report;
        for (a, b) in plain.position.spatial_m.named().iter().zip(moved.position.spatial_m.named()) {
            // The sum of squares of 40 errors of some ten metres amplifies their rounding.
            prop_assert!((a.1 - b.1).abs() < 1e-6, "{a:?} {b:?}");
        }
        let heading = |r: &adit_evaluation::report::EvaluationReport| r.attitude.unwrap().heading_deg.rmse;
        prop_assert!((heading(&plain) - heading(&moved)).abs() < 1e-6);
    }

    #[test]
    fn relative_errors_ignore_any_rigid_motion(estimate in walk(), truth in walk(), motion in motion()) {
        let moved = motion.trajectory(&estimate).unwrap();
        let over = |estimate| {
            relative_errors(&pairs(estimate, &truth), Delta::Frames(3), Selection::All, Frame::Body).unwrap()
        };
        let (a, b) = (over(&estimate), over(&moved));
        for i in 0..a.indices.len() {
            prop_assert!((a.translation_m[i] - b.translation_m[i]).abs() < ROUNDING_M);
            prop_assert!((a.angle_rad[i] - b.angle_rad[i]).abs() < 1e-7);
        }
    }

    #[test]
    fn se3_never_fits_worse_than_se2_and_se2_never_worse_than_start_in_the_plane(
        estimate in walk(), truth in walk(),
    ) {
        let report = |alignment| evaluate(&estimate, &truth, &with_alignment(alignment)).unwrap().report;
        let (start, se2, se3) = (report(Alignment::Start), report(Alignment::Se2), report(Alignment::Se3));
        prop_assert!(se2.position.horizontal_m.rmse <= start.position.horizontal_m.rmse + ROUNDING_M);
        prop_assert!(se3.position.spatial_m.rmse <= se2.position.spatial_m.rmse + ROUNDING_M);
    }

    #[test]
    fn a_heading_error_and_a_tilt_are_told_apart(truth in rotation(), angle in 1e-9..3.1_f64, bearing in -3.1..3.1_f64) {
        let turned = attitude_error(&(attitude::exp(&(Vector3::z() * angle)) * truth), &truth);
        prop_assert!((turned.heading_rad - angle).abs() < 1e-12 && turned.inclination_rad < 1e-12);
        let axis = Vector3::new(f64::cos(bearing), f64::sin(bearing), 0.0);
        let tilted = attitude_error(&(attitude::exp(&(axis * angle)) * truth), &truth);
        prop_assert!((tilted.inclination_rad - angle).abs() < 1e-12 && tilted.heading_rad < 1e-9);
        prop_assert!((tilted.total_rad - angle).abs() < 1e-12);
    }

    #[test]
    fn percentiles_rise_and_the_distribution_undoes_them(errors in prop::collection::vec(0.0..50.0, 1..200)) {
        let s = Statistics::of(&errors).unwrap();
        let rising = [s.min, s.median, s.p90, s.p95, s.max];
        prop_assert!(rising.windows(2).all(|two| two[0] <= two[1]));
        prop_assert!(s.rmse >= s.mean - 1e-12 && (s.rmse.powi(2) - s.mean.powi(2) - s.std.powi(2)).abs() < 1e-8);
        let distribution = Distribution::of(&errors).unwrap();
        prop_assert!(distribution.share_below(s.max) >= 1.0);
        prop_assert!(distribution.share_below(s.median) >= 0.5);
    }
}

#[test]
fn se3_refuses_a_straight_line_by_name() {
    let line: Vec<Pose> = (0..20)
        .map(|i| Pose {
            time: Time::from_nanos(i * 1_000_000_000),
            position_m: Vector3::new(1.0, 2.0, 0.3) * i as f64,
            attitude: Attitude::identity(),
        })
        .collect();
    let line = Trajectory::new(line).unwrap();
    let refused = align(&pairs(&line, &line), Alignment::Se3, 1.0);
    assert!(matches!(refused, Err(EvaluationError::Degenerate { .. })), "{refused:?}");
}

#[test]
fn se3_keeps_its_digits_on_a_long_thin_gallery() {
    // 2 km long, ±1 m wide, ±5 mm high: the case in which squaring the moments would lose the roll.
    let poses = (0..400).map(|i| {
        let s = f64::from(i);
        let position_m = Vector3::new(5.0 * s, (0.7 * s).sin(), 0.005 * (1.3 * s).cos());
        Pose { time: Time::from_nanos(i64::from(i) * 1_000_000), position_m, attitude: Attitude::identity() }
    });
    let gallery = Trajectory::new(poses.collect()).unwrap();
    let motion = RigidMotion {
        rotation: attitude::exp(&Vector3::new(0.4, -0.2, 1.9)),
        from_m: Vector3::zeros(),
        to_m: Vector3::new(4000.0, -700.0, -350.0),
    };
    let truth = motion.trajectory(&gallery).unwrap();
    let found = align(&pairs(&gallery, &truth), Alignment::Se3, 1.0).unwrap();
    // Moments span 1e6 : 1, so of sixteen digits nine stay for the roll.
    assert!(found.rotation.angle_to(&motion.rotation) < 1e-8);
    assert!(largest_miss(&found, &gallery, &truth) < 1e-8);
}
