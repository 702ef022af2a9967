//! The 95 % radius against the numerically integrated one.

#![expect(clippy::unwrap_used, reason = "a test may stop at the first wrong value")]

use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Matrix2, Rotation2, Vector2, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use proptest::prelude::*;

fn with_horizontal_covariance(horizontal: Matrix2<f64>) -> Solution {
    let mut covariance = SolutionCovariance::zeros();
    covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&horizontal);
    Solution {
        time: Time::ZERO,
        position_m: Vector3::zeros(),
        velocity_m_s: Vector3::zeros(),
        attitude: Attitude::identity(),
        covariance,
        quality: Quality::Fixed,
    }
}

fn ellipse(major: f64, minor: f64, turn: f64) -> Matrix2<f64> {
    let axes = Rotation2::new(turn);
    axes.matrix()
        * Matrix2::from_diagonal(&Vector2::new(major * major, minor * minor))
        * axes.matrix().transpose()
}

/// 0.1 % is what the method's documentation promises.
#[test]
fn the_radius_is_within_a_thousandth_of_the_integrated_one_at_every_axis_ratio() {
    for line in include_str!("reference/radius_95.csv").lines().skip(1) {
        let (ratio, exact) = line.split_once(',').unwrap();
        let (ratio, exact): (f64, f64) = (ratio.parse().unwrap(), exact.parse().unwrap());
        let radius = with_horizontal_covariance(ellipse(3.0, 3.0 * ratio, 0.7)).radius_95_m() / 3.0;
        assert!((radius / exact - 1.0).abs() < 1e-3, "ratio {ratio}: {radius} against {exact}");
    }
}

#[test]
fn certainty_has_no_radius() {
    assert!(with_horizontal_covariance(Matrix2::zeros()).radius_95_m().abs() < f64::MIN_POSITIVE);
}

#[test]
fn a_filter_lost_to_nan_does_not_look_certain() {
    let nan = f64::NAN;
    for covariance in
        [Matrix2::new(nan, 0.0, 0.0, 1.0), Matrix2::new(1.0, nan, nan, 1.0), Matrix2::new(1.0, 0.0, 0.0, nan)]
    {
        assert!(with_horizontal_covariance(covariance).radius_95_m().is_nan(), "{covariance}");
    }
}

#[test]
fn a_rounding_error_below_zero_is_no_error() {
    let radius = with_horizontal_covariance(Matrix2::new(1.0, 1.0, 1.0, 1.0 - 1e-15)).radius_95_m();
    assert!((radius - 1.96 * 2.0_f64.sqrt()).abs() < 1e-6);
}

#[test]
fn the_position_covariance_is_the_upper_left_corner() {
    let mut solution = with_horizontal_covariance(Matrix2::new(1.0, 0.5, 0.5, 2.0));
    solution.covariance[(2, 2)] = 3.0;
    solution.covariance[(3, 3)] = 99.0;
    assert_eq!(solution.position_covariance().diagonal(), Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(solution.position_covariance()[(0, 1)].to_bits(), 0.5_f64.to_bits());
}

proptest! {
    #[test]
    fn the_radius_does_not_care_which_way_the_ellipse_points(
        major in 1e-3..1e3, ratio in 0.0..1.0, turn in -4.0..4.0
    ) {
        let straight = with_horizontal_covariance(ellipse(major, major * ratio, 0.0)).radius_95_m();
        let turned = with_horizontal_covariance(ellipse(major, major * ratio, turn)).radius_95_m();
        prop_assert!((straight - turned).abs() < 1e-12 * straight);
    }

    #[test]
    fn more_uncertainty_never_shrinks_the_radius(ratio in 0.0..0.99) {
        let narrow = with_horizontal_covariance(ellipse(1.0, ratio, 0.0)).radius_95_m();
        let wide = with_horizontal_covariance(ellipse(1.0, ratio + 0.01, 0.0)).radius_95_m();
        prop_assert!(wide > narrow);
    }
}
