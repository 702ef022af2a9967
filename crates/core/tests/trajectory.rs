//! Trajectories: what is refused, and what lies between two poses.

#![expect(clippy::unwrap_used, reason = "a test may stop at the first wrong value")]

use adit_core::attitude::{exp, heading};
use adit_core::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory, TrajectoryError};
use core::f64::consts::PI;
use proptest::prelude::*;

fn pose(nanos: i64, x: f64, turn: f64) -> Pose {
    Pose {
        time: Time::from_nanos(nanos),
        position_m: Vector3::new(x, 0.0, 0.0),
        attitude: exp(&Vector3::new(0.0, 0.0, turn)),
    }
}

#[test]
fn an_empty_trajectory_has_no_pose_at_any_time() {
    let empty = Trajectory::new(vec![]).unwrap();
    assert!(empty.is_empty());
    assert_eq!((empty.len(), empty.at(Time::ZERO)), (0, None));
}

#[test]
fn time_that_stands_still_or_runs_backwards_is_refused_with_the_place() {
    for second in [5, 4] {
        let error =
            Trajectory::new(vec![pose(0, 0.0, 0.0), pose(5, 1.0, 0.0), pose(second, 2.0, 0.0)]).unwrap_err();
        let expected = TrajectoryError::TimeNotRising {
            index: 2,
            found: Time::from_nanos(second),
            before: Time::from_nanos(5),
        };
        assert_eq!(error, expected);
        assert_eq!(
            error.to_string(),
            format!("pose 2: time 0.00000000{second} s does not come after 0.000000005 s")
        );
    }
}

#[test]
fn a_component_that_is_no_number_is_refused_with_the_place() {
    let broken_attitude = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    for broken in [
        pose(7, f64::NAN, 0.0),
        pose(7, f64::INFINITY, 0.0),
        Pose { attitude: broken_attitude, ..pose(7, 0.0, 0.0) },
    ] {
        let error = Trajectory::new(vec![pose(0, 0.0, 0.0), broken]).unwrap_err();
        assert_eq!(error, TrajectoryError::NotFinite { index: 1, time: Time::from_nanos(7) });
    }
}

#[test]
fn there_is_no_pose_outside_the_span() {
    let walk = Trajectory::new(vec![pose(10, 0.0, 0.0), pose(20, 1.0, 1.0)]).unwrap();
    assert_eq!(walk.at(Time::from_nanos(9)), None);
    assert_eq!(walk.at(Time::from_nanos(21)), None);
    assert_eq!(walk.at(Time::from_nanos(10)), Some(walk.poses()[0]));
    assert_eq!(walk.at(Time::from_nanos(20)), Some(walk.poses()[1]));
}

#[test]
fn a_single_pose_answers_at_its_own_time_only() {
    let one = Trajectory::new(vec![pose(10, 3.0, 0.0)]).unwrap();
    assert_eq!(one.at(Time::from_nanos(10)), Some(one.poses()[0]));
    assert_eq!(one.at(Time::from_nanos(11)), None);
    assert_eq!(one.at(Time::from_nanos(9)), None);
}

#[test]
fn a_quarter_of_the_way_is_a_quarter_of_the_turn() {
    let walk = Trajectory::new(vec![pose(0, 0.0, 0.0), pose(1000, 8.0, 1.2)]).unwrap();
    let quarter = walk.at(Time::from_nanos(250)).unwrap();
    assert!((quarter.position_m.x - 2.0).abs() < 1e-15);
    assert!(quarter.attitude.angle_to(&exp(&Vector3::new(0.0, 0.0, 0.3))) < 1e-15);
}

#[test]
fn the_turn_between_two_poses_takes_the_short_way_round() {
    // From 10° west of north to 10° east of it, the second quaternion given with the other sign.
    let ten = 10.0_f64.to_radians();
    let mut east = pose(1000, 0.0, PI / 2.0 - ten);
    east.attitude = UnitQuaternion::new_unchecked(-east.attitude.into_inner());
    let walk = Trajectory::new(vec![pose(0, 0.0, PI / 2.0 + ten), east]).unwrap();
    assert!(heading(&walk.at(Time::from_nanos(500)).unwrap().attitude).abs() < 1e-15);
}

proptest! {
    #[test]
    fn every_pose_between_lies_on_the_chord_with_a_unit_attitude(
        share in 1_i64..1_000_000_000, x in -1e4..1e4, turn in proptest::array::uniform3(-1.5..1.5)
    ) {
        let (position_m, attitude) = (Vector3::new(x, 2.0, -x), exp(&turn.into()));
        let end = Pose { time: Time::from_nanos(1_000_000_000), position_m, attitude };
        let walk = Trajectory::new(vec![pose(0, 0.0, 0.0), end]).unwrap();
        let found = walk.at(Time::from_nanos(share)).unwrap();
        let along = Time::from_nanos(share).seconds();
        prop_assert!((found.position_m - position_m * along).norm() < 1e-11);
        prop_assert!((found.attitude.norm() - 1.0).abs() < 4e-16);
        prop_assert!(found.attitude.angle_to(&exp(&(Vector3::from(turn) * along))) < 1e-14);
    }
}
