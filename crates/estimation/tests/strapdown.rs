//! Strapdown integration against closed forms.

mod support;

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_estimation::inertial::strapdown::{Increment, NavigationState};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use support::{Draws, at_rest};

const GRAVITY: f64 = 9.80665;

/// Integrates (mean rate, mean specific force) pairs, a constant interval apart.
fn integrate(
    mut state: NavigationState,
    samples: impl IntoIterator<Item = (Vector3<f64>, Vector3<f64>)>,
    interval_s: f64,
) -> NavigationState {
    let mut before = Increment::default();
    for (rate, force) in samples {
        let now = state.increment(&support::sample(0.0, rate, force), interval_s);
        state.propagate(&now, &before, interval_s, GRAVITY);
        before = now;
    }
    state
}

fn angle_between(a: &Attitude, b: &Attitude) -> f64 {
    attitude::log(&(a * b.inverse())).norm()
}

#[test]
fn a_still_level_sensor_does_not_drift() {
    let still = (Vector3::zeros(), Vector3::z() * GRAVITY);
    let end = integrate(at_rest(Attitude::identity()), core::iter::repeat_n(still, 100_000), 0.005);
    // What gravity gives and what is taken away is the same number: not one bit may remain.
    assert_eq!(end, at_rest(Attitude::identity()));
}

#[test]
fn a_still_sensor_with_known_biases_does_not_drift() {
    let (gyro_bias, acc_bias) = (Vector3::new(0.01, -0.02, 0.03), Vector3::new(-0.3, 0.2, 0.1));
    let start = NavigationState {
        gyro_bias_rad_s: gyro_bias,
        acc_bias_m_s2: acc_bias,
        ..at_rest(Attitude::identity())
    };
    let read = (gyro_bias, acc_bias + Vector3::z() * GRAVITY);
    let end = integrate(start, core::iter::repeat_n(read, 10_000), 0.005);
    // 50 s under a rounding error of 2⁻⁵³ × 10 m/s² would move it by 1.4e-12 m.
    assert!(end.position_m.norm() < 1e-11, "{}", end.position_m.norm());
    assert_eq!(end.attitude, Attitude::identity());
}

#[test]
fn a_constant_rate_about_a_fixed_axis_is_integrated_exactly() {
    let start = attitude::exp(&Vector3::new(0.3, -0.7, 1.9));
    // From a creeping foot to 0.5 rad in a step, past the switch from series to trigonometry in `exp`.
    for rate_rad_s in [0.01, 1.0, 20.0, 100.0] {
        let rate = Vector3::new(2.0, -1.0, 2.0) / 3.0 * rate_rad_s;
        let steps = 10_000;
        let turning = core::iter::repeat_n((rate, Vector3::zeros()), steps);
        let end = integrate(at_rest(start), turning, 0.005);
        let whole_angle = (rate_rad_s * 0.005 * steps as f64) % TAU;
        let truth = start * attitude::exp(&(rate / rate_rad_s * whole_angle));
        // Rounding of 10⁴ products at 2⁻⁵³ each, all in one direction at worst.
        let error = angle_between(&end.attitude, &truth);
        assert!(error < 2e-12, "{rate_rad_s} rad/s: {error:e} rad");
    }
}

/// Attitude of classical coning: the body turned by `half_cone` about an axis that goes round in the level.
fn coning_attitude(half_cone: f64, phase: f64) -> Attitude {
    attitude::exp(&(Vector3::new(phase.cos(), phase.sin(), 0.0) * half_cone))
}

/// Integral of its body rate (2 q* q̇) over a step: Savage 1998 part 1, §7.1, with the rate known in closed form.
fn coning_increment(half_cone: f64, from: f64, to: f64) -> Vector3<f64> {
    let level = half_cone.sin();
    let drift = -2.0 * (0.5 * half_cone).sin().powi(2);
    Vector3::new(level * (to.cos() - from.cos()), level * (to.sin() - from.sin()), drift * (to - from))
}

#[test]
fn coning_drifts_as_the_closed_form_says_and_far_less_than_uncorrected() {
    // A foot that shakes by 1° at 5 Hz, sampled at 200 Hz for a minute.
    let half_cone = PI / 180.0;
    let (steps, dt) = (12_000_u32, 0.005);
    let step_phase = TAU * 5.0 * dt;
    let increment =
        |k: u32| coning_increment(half_cone, f64::from(k) * step_phase, f64::from(k + 1) * step_phase);
    let start = coning_attitude(half_cone, 0.0);
    let samples = (0..steps).map(|k| (increment(k) / dt, Vector3::zeros()));
    let corrected = integrate(at_rest(start), samples, dt).attitude;
    let uncorrected = (0..steps).fold(start, |q, k| attitude::turn_body(&q, &increment(k)));
    let drift = |q: &Attitude| attitude::log(&(q * start.inverse())).z;

    // Per step: what commutes not is ½ sin²α (β − sin β), of which 1/12 Δθ₋₁ × Δθ takes sin²α (1 − cos β) sin β / 6.
    let (sin_cone, beta) = (half_cone.sin(), step_phase);
    let lost = 0.5 * sin_cone * sin_cone * (beta - beta.sin());
    let regained = sin_cone * sin_cone * (1.0 - beta.cos()) * beta.sin() / 6.0;
    let steps = f64::from(steps);
    // The formulas hold to α²/12; the first step has no step before it.
    let expected = lost * steps;
    assert!(
        (drift(&uncorrected) + expected).abs() < 1e-3 * expected,
        "{:e} {expected:e}",
        drift(&uncorrected)
    );
    let expected = lost * steps - regained * (steps - 1.0);
    assert!((drift(&corrected) + expected).abs() < 1e-2 * expected, "{:e} {expected:e}", drift(&corrected));
    // β²/5 with β = 9°.
    assert!(drift(&corrected).abs() < 0.006 * drift(&uncorrected).abs());
}

#[test]
fn uniform_acceleration_gives_the_parabola() {
    let (acceleration, first) = (Vector3::new(1.5, -0.7, 0.4), Vector3::new(-2.0, 1.0, 0.3));
    for attitude in [Attitude::identity(), attitude::exp(&Vector3::new(0.4, -1.2, 2.2))] {
        let force = attitude.inverse_transform_vector(&(acceleration + Vector3::z() * GRAVITY));
        let start = NavigationState { velocity_m_s: first, ..at_rest(attitude) };
        let end = integrate(start, core::iter::repeat_n((Vector3::zeros(), force), 2_000), 0.005);
        let t = 10.0;
        let position = first * t + acceleration * (0.5 * t * t);
        // Rounding of 2000 sums of velocities up to 15 m/s.
        assert!((end.velocity_m_s - first - acceleration * t).norm() < 1e-11);
        assert!((end.position_m - position).norm() < 1e-10, "{:e}", (end.position_m - position).norm());
    }
}

#[test]
fn sculling_drifts_far_less_than_uncorrected() {
    // Rocking about x in step with shaking along y pushes along z by ½ α a on average (Savage 1998 part 2, §7.2).
    let (amplitude_rad, shake_m_s2, dt) = (0.02, 5.0, 0.005);
    let step_phase = TAU * 5.0 * dt;
    let steps = 4_000_u32;
    let sample = |k: u32| {
        let (from, to) = (f64::from(k) * step_phase, f64::from(k + 1) * step_phase);
        let angle = Vector3::x() * (amplitude_rad * (to.sin() - from.sin()));
        // ∫ a sin φ dt, and the reaction against gravity left out: gravity is given as zero below.
        let velocity = Vector3::y() * (shake_m_s2 * (from.cos() - to.cos()) * dt / step_phase);
        Increment { angle, velocity }
    };
    let run = |correct: bool| {
        let mut state = at_rest(Attitude::identity());
        let mut before = sample(0);
        for k in 1..=steps {
            let now = sample(k);
            let known = if correct { before } else { Increment::default() };
            state.propagate(&now, &known, dt, 0.0);
            before = now;
        }
        state.velocity_m_s.z / (f64::from(steps) * dt)
    };
    let rectified = 0.5 * amplitude_rad * shake_m_s2;
    let (with, without) = ((run(true) - rectified).abs(), (run(false) - rectified).abs());
    assert!(without > 1e-3 * rectified, "{without:e}: the motion must need the correction");
    // sin α ≈ α leaves α²/8 of it, the correction itself β²/5 of what it mends.
    assert!(with < 0.02 * without, "{with:e} of {without:e} m/s²");
}

#[test]
fn a_sensor_spinning_at_rest_drifts_no_more_than_the_third_order_allows() {
    // Gravity seen from a body that turns steadily about a level axis; mean force over a step in closed form.
    let (rate_rad_s, dt, steps) = (8.0, 0.005, 200_u32);
    let beta = rate_rad_s * dt;
    let samples = (0..steps).map(|k| {
        let (from, to) = (f64::from(k) * beta, f64::from(k + 1) * beta);
        let mean = Vector3::new(0.0, from.cos() - to.cos(), to.sin() - from.sin()) * (GRAVITY / beta);
        (Vector3::x() * rate_rad_s, mean)
    });
    let end = integrate(at_rest(Attitude::identity()), samples, dt);
    // The first neglected term, 1/24 Δθ × (Δθ × (Δθ × Δv)), is β³/24 of gravity; a sixth more for the terms after it.
    let bound = GRAVITY * beta * beta * beta / 24.0 * f64::from(steps) * dt * 7.0 / 6.0;
    assert!(end.velocity_m_s.norm() < bound, "{} of {bound} m/s", end.velocity_m_s.norm());
}

#[test]
fn any_mounting_gives_the_same_path() {
    let mut draws = Draws::new(5);
    let samples: Vec<_> =
        (0..2_000).map(|_| (draws.vector(3.0), Vector3::z() * GRAVITY + draws.vector(5.0))).collect();
    let start = at_rest(attitude::exp(&Vector3::new(0.1, 0.2, 0.3)));
    let path = integrate(start, samples.iter().copied(), 0.005);
    let upside_down = Vector3::x() * PI;
    let sideways = Vector3::y() * FRAC_PI_2;
    for mounting in [upside_down, sideways, draws.vector(1.0), draws.vector(1.0)] {
        let mounting = attitude::exp(&mounting);
        let seen = |v: &Vector3<f64>| mounting.inverse_transform_vector(v);
        let turned = samples.iter().map(|(rate, force)| (seen(rate), seen(force)));
        let end = integrate(at_rest(start.attitude * mounting), turned, 0.005);
        // 10 s with rounding of 2⁻⁵³ in attitude and force.
        assert!((end.position_m - path.position_m).norm() < 1e-10);
        assert!(angle_between(&end.attitude, &(path.attitude * mounting)) < 1e-12);
    }
}
