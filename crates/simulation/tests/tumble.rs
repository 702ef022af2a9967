//! A tumbled tag: exact derivatives, rest at either end, directions covered.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_simulation::{
    EarthField, Emission, Generator, IdealImu, ImuErrorModel, MagneticWorld, MagnetometerModel, Motion,
    Swing, Tumble,
};
use std::collections::BTreeSet;

/// All about and hither and thither.
fn wild() -> Tumble {
    let swing =
        |amplitude, frequency_hz| Swing { amplitude, frequency_hz, phase_rad: 0.7, ..Swing::default() };
    Tumble { position: [swing(0.3, 0.5), swing(0.2, 0.8), swing(0.1, 1.1)], ..Tumble::over_the_sphere(30.0) }
}

#[test]
fn velocity_acceleration_and_rate_are_the_derivatives_of_the_pose() {
    let half_s = 1e-4;
    for tumble in [wild(), Tumble::waist(20.0)] {
        for i in 0..1000 {
            let time_s = f64::from(i) * 0.034_1;
            let (before, now, after) =
                (tumble.at(time_s - half_s), tumble.at(time_s), tumble.at(time_s + half_s));
            let velocity = (after.position_m - before.position_m) / (2.0 * half_s);
            let acceleration = (after.velocity_m_s - before.velocity_m_s) / (2.0 * half_s);
            let rate = attitude::log(&(before.attitude.inverse() * after.attitude)) / (2.0 * half_s);
            // h²/6 of a third derivative below 200 m/s³ and 200 rad/s³, and of 2000 m/s⁴: 3.3e-7, 3.3e-6.
            assert!((velocity - now.velocity_m_s).norm() < 5e-7, "{time_s} s");
            assert!((acceleration - now.acceleration_m_s2).norm() < 5e-6, "{time_s} s");
            assert!((rate - now.angular_rate_rad_s).norm() < 1e-6, "{time_s} s");
        }
    }
}

#[test]
fn it_rests_at_either_end_and_only_there() {
    let tumble = wild();
    for time_s in [-1.0, 0.0, 1.9, 32.1, 34.0, 50.0] {
        let state = tumble.at(time_s);
        assert!(state.stance && state.velocity_m_s.norm() == 0.0 && state.angular_rate_rad_s.norm() == 0.0);
    }
    assert!(!tumble.at(2.5).stance && !tumble.at(31.5).stance);
    assert_eq!(tumble.at(0.0).attitude.angle().to_bits(), 0.0_f64.to_bits(), "level, facing east");
    assert!((tumble.duration_s() - 34.0).abs() < 1e-12);
}

/// Share of 72 cells of equal area from which the field comes, in the axes of the tag, and the smallest eigenvalue of
/// the mean of its direction squared (1/3 for an even sphere).
fn coverage(tumble: &Tumble) -> (f64, f64) {
    let imu = Generator::new(*tumble, IdealImu::default(), 100.0, &ImuErrorModel::default(), 1).unwrap();
    let world = MagneticWorld::undisturbed(EarthField::harbin());
    let both = imu.with_magnetometer(world, &MagnetometerModel::ideal(), 1).unwrap();
    let (mut cells, mut squares, mut count) = (BTreeSet::new(), Matrix3::zeros(), 0.0);
    for emission in both {
        let Emission::Magnetic(sample, _) = emission else { continue };
        let from: Vector3<f64> = sample.field_ut.normalize();
        // Rings of equal height on a sphere have equal areas (Archimedes).
        let ring = ((from.z + 1.0) * 3.0).floor().min(5.0);
        let sector = ((from.y.atan2(from.x) / core::f64::consts::TAU + 0.5) * 12.0).floor().min(11.0);
        cells.insert((ring.to_bits(), sector.to_bits()));
        squares += from * from.transpose();
        count += 1.0;
    }
    (cells.len() as f64 / 72.0, (squares / count).symmetric_eigenvalues().min())
}

#[test]
fn the_calibration_tumble_covers_the_sphere_and_level_turns_do_not() {
    let (cells, least) = coverage(&Tumble::over_the_sphere(60.0));
    assert!(cells > 0.95 && least > 0.2, "{cells} {least}");
    // A cone of 27° half angle about the vertical, 10° thick: two rings of six.
    let (cells, least) = coverage(&Tumble::level_turns(60.0));
    assert!(cells < 0.35 && least < 0.15, "{cells} {least}");
}

#[test]
fn a_waist_sways_and_turns_like_one() {
    let tumble = Tumble::waist(60.0);
    for i in 0..6600 {
        let state = tumble.at(f64::from(i) * 0.01);
        let up = state.attitude * Vector3::z();
        // Pitch and roll: 0.06 and 0.07 rad of swing about a start at their phase, twice that at most.
        assert!(up.z.acos() < 0.2 && state.position_m.amax() < 0.1);
        assert!(state.acceleration_m_s2.norm() < 6.0 && state.angular_rate_rad_s.norm() < 2.0);
    }
}

#[test]
fn refuses_a_motion_that_no_hand_makes() {
    let refused = |change: &dyn Fn(&mut Tumble)| {
        let mut tumble = wild();
        change(&mut tumble);
        tumble.check().unwrap_err().to_string()
    };
    wild().check().unwrap();
    assert!(refused(&|t| t.moving_s = 0.0).starts_with("moving_s is 0"));
    assert!(refused(&|t| t.ramp_s = 20.0).starts_with("ramp_s is 20, expected 0.001 s to half"));
    assert!(refused(&|t| t.rest_s = f64::NAN).starts_with("rest_s"));
    assert!(refused(&|t| t.roll.rate = 1e3).starts_with("roll"));
    assert!(refused(&|t| t.position[2].amplitude = f64::INFINITY).starts_with("position"));
    assert!(refused(&|t| t.yaw.frequency_hz = -1.0).starts_with("frequency_hz"));
}
