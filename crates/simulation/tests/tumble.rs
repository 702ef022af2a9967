//! The tumbling tag: exact derivatives, true rest, and the sides of the sphere that it shows to the field.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_simulation::{EarthField, Motion, Tumble};

fn all() -> [Tumble; 3] {
    [Tumble::over_the_sphere(60.0), Tumble::level_turns(60.0), Tumble::waist(60.0)]
}

fn times(motion: &Tumble, step_s: f64) -> impl Iterator<Item = f64> {
    let end_s = motion.duration_s();
    (0..).map(move |i| f64::from(i) * step_s).take_while(move |t| *t < end_s)
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let h = 1e-4;
    for motion in all() {
        motion.check().unwrap();
        for t in times(&motion, 0.037) {
            let (before, now, after) = (motion.at(t - h), motion.at(t), motion.at(t + h));
            let velocity = (after.position_m - before.position_m) / (2.0 * h);
            let acceleration = (after.velocity_m_s - before.velocity_m_s) / (2.0 * h);
            let rate = attitude::log(&(before.attitude.inverse() * after.attitude)) / (2.0 * h);
            // h²/6 times the third derivative: (2π · 1.8 Hz)³ · 3 cm is 50 m/s³, angles (12 rad/s)³ · 0.1 and 2 rad/s cubed.
            assert!((velocity - now.velocity_m_s).norm() < 2e-7, "velocity at {t}");
            assert!((acceleration - now.acceleration_m_s2).norm() < 2e-6, "acceleration at {t}");
            assert!((rate - now.angular_rate_rad_s).norm() < 1e-6, "rate at {t}");
        }
    }
}

#[test]
fn it_lies_still_before_and_after() {
    for motion in all() {
        let end_s = motion.duration_s();
        for t in [-1.0, 0.0, 1.9, end_s - 1.9, end_s, end_s + 5.0] {
            let state = motion.at(t);
            assert!(state.stance);
            assert_eq!((state.velocity_m_s, state.angular_rate_rad_s), (Vector3::zeros(), Vector3::zeros()));
        }
        assert!(!motion.at(0.5 * end_s).stance);
        assert!(motion.at(0.0).position_m.norm() < 1e-15);
    }
}

/// Share of 96 cells of the sphere (six faces of a cube, 4 × 4 each) from which the field came, seen from the tag.
fn coverage(motion: &Tumble) -> f64 {
    let field = EarthField::harbin().enu_ut();
    let mut seen = [false; 96];
    for t in times(motion, 0.01) {
        let from = motion.at(t).attitude.inverse_transform_vector(&field);
        let face = from.iamax();
        let (u, v) = (from[(face + 1) % 3] / from[face], from[(face + 2) % 3] / from[face]);
        let cell = |w: f64| [-0.5, 0.0, 0.5].iter().filter(|edge| w >= **edge).count();
        seen[(2 * face + usize::from(from[face] > 0.0)) * 16 + 4 * cell(u) + cell(v)] = true;
    }
    seen.iter().filter(|seen| **seen).count() as f64 / 96.0
}

#[test]
fn the_calibration_tumble_shows_every_side_to_the_field_and_level_turns_do_not() {
    assert!(coverage(&Tumble::over_the_sphere(60.0)) > 0.95, "{}", coverage(&Tumble::over_the_sphere(60.0)));
    assert!(coverage(&Tumble::level_turns(60.0)) < 0.35, "{}", coverage(&Tumble::level_turns(60.0)));
}

#[test]
fn a_tumble_that_cannot_be_is_refused() {
    let refused = |change: &dyn Fn(&mut Tumble)| {
        let mut motion = Tumble::waist(30.0);
        change(&mut motion);
        motion.check().is_err()
    };
    assert!(!refused(&|_| ()));
    assert!(refused(&|m| m.moving_s = f64::NAN));
    assert!(refused(&|m| m.ramp_s = 0.0));
    assert!(refused(&|m| m.ramp_s = 16.0));
    assert!(refused(&|m| m.yaw.rate = f64::INFINITY));
    assert!(refused(&|m| m.position[2].frequency_hz = -1.0));
}
