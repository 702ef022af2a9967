//! Tilt-compensated heading: every orientation, the pole, dip, declination, and the textbook formula.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::attitude::{self, Attitude, angle_difference};
use adit_core::nalgebra::Vector3;
use adit_estimation::magnetic::heading::{LevelField, tilt_compensated};
use proptest::prelude::*;

const G: f64 = 9.80665;

/// The Earth's field in east, north, up, µT.
fn earth(norm_ut: f64, dip_rad: f64, declination_rad: f64) -> Vector3<f64> {
    let (horizontal, down) = (norm_ut * dip_rad.cos(), norm_ut * dip_rad.sin());
    Vector3::new(horizontal * declination_rad.sin(), horizontal * declination_rad.cos(), -down)
}

/// What a sensor in that attitude reads at rest.
fn readings(attitude: &Attitude, field: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (attitude.inverse() * Vector3::new(0.0, 0.0, G), attitude.inverse() * field)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_attitude_comes_back_from_any_orientation(
        turn in prop::array::uniform3(-4.0..4.0_f64), norm_ut in 22.0..67.0, dip_deg in -85.0..85.0_f64, declination in -3.1..3.1
    ) {
        let truth = attitude::exp(&Vector3::from(turn));
        let (force, field) = readings(&truth, &earth(norm_ut, dip_deg.to_radians(), declination));
        // Only where the body's x axis and its stand-in z change places, 2.6° about the vertical, is the heading that of
        // another axis: see the test of the pole.
        prop_assume!((truth * Vector3::x()).z.abs() < 0.998);
        let compass = tilt_compensated(&force, &field, declination).unwrap();
        // 5° from the magnetic pole the horizontal part is 1/12 of the field: rounding grows by as much.
        prop_assert!(compass.attitude.angle_to(&truth) < 1e-12);
        prop_assert!(angle_difference(compass.heading_rad, attitude::heading(&truth)).abs() < 1e-11);
        prop_assert!((compass.field.norm_ut - norm_ut).abs() < 1e-12 * norm_ut);
        prop_assert!((compass.field.dip_rad - dip_deg.to_radians()).abs() < 1e-12);
    }

    /// Ozyagcilar 2015, AN4248, eq. 22, for a forward-right-down body with roll φ and pitch θ, and Groves 2013, eq. 6.5–6.6.
    #[test]
    fn it_is_the_textbook_formula(
        roll in -3.1..3.1_f64, pitch in -1.5..1.5_f64, yaw in -3.1..3.1_f64, dip_deg in -80.0..80.0_f64, declination in -0.5..0.5
    ) {
        // Forward-right-down axes seen from north-east-down by yaw, pitch, roll, in matrices of their own.
        let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
        let north = Vector3::new(cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy);
        let east = Vector3::new(cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy);
        let down = Vector3::new(-sp, sr * cp, cr * cp);
        let (horizontal, vertical) = (dip_deg.to_radians().cos(), dip_deg.to_radians().sin());
        let (sd, cd) = f64::sin_cos(declination);
        let b = 48.0 * ((north * cd + east * sd) * horizontal + down * vertical);
        let textbook = declination
            + f64::atan2(b.z * sr - b.y * cr, b.x * cp + b.y * sp * sr + b.z * sp * cr);
        prop_assert!(angle_difference(textbook, yaw).abs() < 1e-10);

        // The same readings with x forward, y left, z up.
        let flip = |v: Vector3<f64>| Vector3::new(v.x, -v.y, -v.z);
        let compass = tilt_compensated(&flip(down * -G), &flip(b), declination).unwrap();
        // Beyond 87.4° of pitch the z axis stands in for x.
        prop_assume!(pitch.abs() < 1.52);
        prop_assert!(angle_difference(compass.heading_rad, textbook).abs() < 1e-10);
    }
}

#[test]
fn at_the_pole_the_attitude_is_still_right() {
    let field = earth(50.0, 1.1, 0.1);
    for up in [1.0, -1.0] {
        for tilt_deg in [0.0, 1e-9, 0.01, 1.0, 2.5, 2.7, 5.0_f64] {
            for around in 0..12 {
                // x straight up or down, then a little off, then turned about the vertical.
                let pole = attitude::exp(&Vector3::new(0.0, -up * std::f64::consts::FRAC_PI_2, 0.0));
                let off = attitude::exp(&Vector3::new(tilt_deg.to_radians(), 0.0, 0.0));
                let turn = attitude::exp(&Vector3::new(0.0, 0.0, f64::from(around) * 0.5));
                let truth = turn * off * pole;
                let (force, reading) = readings(&truth, &field);
                let compass = tilt_compensated(&force, &reading, 0.1).unwrap();
                assert!(compass.attitude.angle_to(&truth) < 1e-9, "{up} {tilt_deg} {around}");
            }
        }
    }
}

#[test]
fn no_heading_comes_from_nothing() {
    let up = Vector3::z();
    let field = Vector3::new(0.0, 20.0, -40.0);
    assert!(tilt_compensated(&up, &field, 0.0).is_some());
    for (force, field, declination) in [
        (Vector3::zeros(), field, 0.0),
        (up, Vector3::zeros(), 0.0),
        (up, Vector3::z() * 50.0, 0.0),
        (up * f64::NAN, field, 0.0),
        (up, field * f64::INFINITY, 0.0),
        (up, field, f64::NAN),
    ] {
        assert!(tilt_compensated(&force, &field, declination).is_none(), "{force} {field} {declination}");
    }
}

#[test]
fn a_tilt_error_costs_its_tangent_of_dip_and_a_field_error_its_share_of_the_horizontal() {
    let (norm_ut, dip) = (50.0, 66.0_f64.to_radians());
    let field = earth(norm_ut, dip, 0.0);
    let heading = |force: Vector3<f64>, field: Vector3<f64>| tilt_compensated(&force, &field, 0.0).unwrap();
    let straight = heading(Vector3::z(), field);

    // A tilt about the meridian by 0.1°: sideways force seen, to second order in the tilt.
    let tilt = 0.1_f64.to_radians();
    let tilted = heading(Vector3::new(tilt.sin(), 0.0, tilt.cos()), field);
    let turned = angle_difference(tilted.heading_rad, straight.heading_rad);
    assert!((turned.abs() / (tilt * dip.tan()) - 1.0).abs() < 1e-2, "{turned}");
    let sigma = straight.field.heading_sigma_rad(0.0, tilt);
    assert!((sigma / (tilt * dip.tan()) - 1.0).abs() < 1e-12);

    let disturbed = heading(Vector3::z(), field + Vector3::x() * 0.2);
    let turned = angle_difference(disturbed.heading_rad, straight.heading_rad).abs();
    assert!((turned / straight.field.heading_sigma_rad(0.2, 0.0) - 1.0).abs() < 1e-3, "{turned}");

    // Never more than knowing nothing.
    let unknown = std::f64::consts::PI / 3.0_f64.sqrt();
    let polar = LevelField::new(&Vector3::new(0.0, 1e-9, -60.0)).unwrap();
    assert!((polar.heading_sigma_rad(1.0, 0.01) - unknown).abs() < 1e-15);
}

#[test]
fn the_gradient_of_the_azimuth_is_numerical() {
    let field = Vector3::new(13.0, -17.0, -44.0);
    let gradient = LevelField::new(&field).unwrap().azimuth_gradient();
    let step = 1e-4;
    for axis in 0..3 {
        let by = Vector3::ith(axis, step);
        let azimuth = |field: Vector3<f64>| LevelField::new(&field).unwrap().azimuth_rad;
        let numerical = angle_difference(azimuth(field + by), azimuth(field - by)) / (2.0 * step);
        // Second differences of order step²/H³.
        assert!((gradient[axis] - numerical).abs() < 1e-11, "{axis}: {numerical}");
    }
}
