//! Rotation algebra against 50-digit values, its own inverses and a million steps.

#![expect(clippy::unwrap_used, reason = "a test may stop at the first wrong value")]

use adit_core::attitude::{self, angle_difference, exp, from_matrix, heading, level, log, skew, turn_body};
use adit_core::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use proptest::prelude::*;

fn vector(range: core::ops::Range<f64>) -> impl Strategy<Value = Vector3<f64>> {
    [range.clone(), range.clone(), range].prop_map(Vector3::from)
}

fn direction() -> impl Strategy<Value = Vector3<f64>> {
    vector(-1.0..1.0).prop_filter_map("too short", |v| v.try_normalize(0.1))
}

/// Distance of two quaternions as rotations: blind to the sign.
fn apart(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    (a.coords - b.coords).norm().min((a.coords + b.coords).norm())
}

#[test]
fn a_quarter_turn_takes_east_to_north() {
    let turned = exp(&Vector3::new(0.0, 0.0, FRAC_PI_2)) * Vector3::x();
    assert!((turned - Vector3::y()).norm() < 1e-15);
}

/// Two ulp in every component: one for the function, one for the product with the axis. Past a radian the rounding of
/// the angle itself shows where a component passes through zero, and the ulp is that of the whole quaternion.
#[test]
fn exp_agrees_with_fifty_digits_on_both_sides_of_the_series_border() {
    for line in include_str!("reference/attitude.csv").lines().skip(1) {
        let v: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        let turn = Vector3::new(v[0], v[1], v[2]);
        let q = exp(&turn);
        for (found, expected) in [q.w, q.i, q.j, q.k].into_iter().zip(&v[3..]) {
            let scale = if turn.norm() < 0.5 { expected.abs() } else { 1.0 };
            let tolerance = 2.0 * f64::EPSILON * scale;
            assert!((found - expected).abs() <= tolerance, "{line}: {found} against {expected}");
        }
    }
}

#[test]
fn no_turn_is_the_identity() {
    assert_eq!(exp(&Vector3::zeros()), UnitQuaternion::identity());
    assert_eq!(log(&UnitQuaternion::identity()), Vector3::zeros());
}

#[test]
fn log_of_half_a_turn_has_length_pi() {
    for q in [Quaternion::new(0.0, 0.0, 0.6, 0.8), Quaternion::new(-0.0, 0.0, 0.6, 0.8)] {
        let turn = log(&UnitQuaternion::new_unchecked(q));
        assert!((turn - Vector3::new(0.0, 0.6, 0.8) * PI).norm() < 1e-15);
    }
}

#[test]
fn skew_is_the_cross_product() {
    let (a, b) = (Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.5, 4.0, -1.0));
    assert_eq!(skew(&a) * b, a.cross(&b));
}

#[test]
fn each_branch_of_shepperd_gives_the_rotation_back() {
    // Half turns (nearly) about w, x, y, z make each component the largest in turn.
    let turns = [
        Vector3::new(0.1, -0.2, 0.3),
        Vector3::new(3.1, 0.2, -0.1),
        Vector3::new(0.2, 3.1, -0.1),
        Vector3::new(0.1, -0.2, 3.1),
    ];
    for (largest, turn) in turns.iter().enumerate() {
        let q = exp(turn);
        let parts = [q.w, q.i, q.j, q.k];
        assert!(parts.iter().all(|part| part.abs() <= parts[largest].abs()), "wrong branch for {turn}");
        assert!(apart(&from_matrix(q.to_rotation_matrix().matrix()), &q) < 1e-15);
        // Exactly half a turn: the scalar is zero, where the naive formula divides by it.
        if largest > 0 {
            let half =
                UnitQuaternion::new_unchecked(Quaternion::from_parts(0.0, Vector3::ith(largest - 1, 1.0)));
            assert!(apart(&from_matrix(half.to_rotation_matrix().matrix()), &half) < 1e-15);
        }
    }
}

/// 100 Hz for 2 h 47 min. Rounding alone walks 1e-16 per step; without renormalisation the norm would drift with it.
#[test]
fn a_million_steps_keep_the_norm_and_the_angle() {
    let rate = Vector3::new(0.003, -0.02, 0.05);
    let mut body = UnitQuaternion::identity();
    let mut navigation = UnitQuaternion::identity();
    for _ in 0..1_000_000 {
        body = turn_body(&body, &rate);
        navigation = attitude::turn_navigation(&navigation, &rate);
        assert!((body.norm() - 1.0).abs() < 4e-16);
    }
    // A constant rate has a closed form: one turn by a million times the angle.
    let angle = (rate.norm() * 1e6) % TAU;
    let whole = exp(&(rate.normalize() * angle));
    // 1e6 · 5.4e-2 rad are known to 7e-12 rad as an f64; the steps add some 1e-10 of rounding.
    assert!(apart(&body, &whole) < 1e-9, "{}", apart(&body, &whole));
    assert!(apart(&navigation, &whole) < 1e-9);
}

#[test]
fn a_sensor_on_its_back_is_levelled() {
    let attitude = level(&Vector3::new(0.0, 0.0, -9.81), 0.0).unwrap();
    assert!((attitude * Vector3::z() + Vector3::z()).norm() < 1e-15);
    assert!((attitude * Vector3::x() - Vector3::y()).norm() < 1e-15, "x still points north");
}

#[test]
fn a_sensor_hung_by_its_x_axis_takes_its_heading_from_z() {
    for sign in [-1.0, 1.0] {
        let force = Vector3::new(sign * 9.81, 0.0, 0.0);
        let attitude = level(&force, 1.0).unwrap();
        assert!((attitude * force - Vector3::new(0.0, 0.0, 9.81)).norm() < 1e-14);
        let z = attitude * Vector3::z();
        assert!(angle_difference(compass(&z), 1.0).abs() < 1e-14);
    }
}

fn compass(horizontal: &Vector3<f64>) -> f64 {
    horizontal.x.atan2(horizontal.y)
}

#[test]
fn a_force_that_points_nowhere_levels_nothing() {
    let up = Vector3::new(0.0, 0.0, 9.81);
    for force in [
        Vector3::zeros(),
        Vector3::new(f64::NAN, 0.0, 9.81),
        Vector3::new(0.0, f64::INFINITY, 9.81),
        Vector3::new(1e200, 0.0, 1e200),
    ] {
        assert_eq!(level(&force, 0.0), None, "{force}");
    }
    assert_eq!(level(&up, f64::NAN), None);
    assert_eq!(level(&up, f64::INFINITY), None);
}

#[test]
fn compass_headings_run_clockwise_from_north() {
    for (counter_clockwise_from_east, compass) in
        [(0.0, FRAC_PI_2), (FRAC_PI_2, 0.0), (PI, -FRAC_PI_2), (-FRAC_PI_2, PI)]
    {
        let q = exp(&Vector3::new(0.0, 0.0, counter_clockwise_from_east));
        assert!(angle_difference(heading(&q), compass).abs() < 1e-15);
    }
}

#[test]
fn half_a_turn_apart_is_plus_pi() {
    assert_eq!(angle_difference(PI, 0.0).to_bits(), PI.to_bits());
    assert_eq!(angle_difference(0.0, PI).to_bits(), PI.to_bits());
    assert!((angle_difference(0.1, TAU - 0.1) - 0.2).abs() < 1e-15);
}

proptest! {
    /// Near π the angle comes from `atan2` and loses nothing.
    #[test]
    fn log_undoes_exp(axis in direction(), angle in 0.0..PI) {
        let turn = axis * angle;
        prop_assert!((log(&exp(&turn)) - turn).norm() < 2e-15 * (1.0 + angle));
    }

    #[test]
    fn log_undoes_exp_for_the_turn_of_one_gyro_sample(axis in direction(), exponent in -15.0..-1.0_f64) {
        let turn = axis * 10.0_f64.powf(exponent);
        prop_assert!((log(&exp(&turn)) - turn).norm() <= 4.0 * f64::EPSILON * turn.norm());
    }

    #[test]
    fn exp_undoes_log_whatever_the_sign(axis in direction(), angle in -TAU..TAU) {
        let q = exp(&(axis * angle));
        prop_assert!(log(&q).norm() <= PI);
        prop_assert!(apart(&exp(&log(&q)), &q) < 1e-15);
    }

    #[test]
    fn a_matrix_and_its_quaternion_turn_alike(axis in direction(), angle in 0.0..TAU) {
        let q = exp(&(axis * angle));
        prop_assert!(apart(&from_matrix(q.to_rotation_matrix().matrix()), &q) < 2e-15);
    }

    /// At rest `C f = (0, 0, |f|)`, and the body x axis (z axis where x is vertical) shows the heading asked for.
    #[test]
    fn any_mounting_is_levelled_with_the_heading_asked_for(up in direction(), g in 9.0..11.0, asked in -10.0..10.0) {
        let attitude = level(&(up * g), asked).unwrap();
        prop_assert!((attitude * up * g - Vector3::new(0.0, 0.0, g)).norm() < 1e-13);
        let found = if up.x.abs() < 0.999 { heading(&attitude) } else { compass(&(attitude * Vector3::z())) };
        // Where x is close to vertical its shadow is 4.5 % of its length, and the rounding grows accordingly.
        prop_assert!(angle_difference(found, asked).abs() < 1e-13);
    }

    #[test]
    fn a_turn_in_navigation_axes_is_the_turn_seen_from_there(axis in direction(), turn in vector(-0.1..0.1)) {
        let q = exp(&(axis * 2.0));
        let in_body = q.inverse() * turn;
        prop_assert!(apart(&turn_body(&q, &in_body), &attitude::turn_navigation(&q, &turn)) < 1e-15);
    }

    #[test]
    fn the_difference_of_angles_is_the_short_way(a in -100.0..100.0, b in -100.0..100.0) {
        let d = angle_difference(a, b);
        prop_assert!(-PI < d && d <= PI);
        prop_assert!(((a - b - d) / TAU - ((a - b - d) / TAU).round()).abs() < 1e-13);
    }
}
