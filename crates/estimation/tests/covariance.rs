//! The block covariance against dense matrices and against the strapdown itself.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::attitude::{self, exp};
use adit_core::nalgebra::{Cholesky, Matrix3, SMatrix, SVector, Vector3};
use adit_estimation::inertial::covariance::{
    ACC_BIAS, ATTITUDE, BLOCKS, CONTACT, Covariance, ErrorVector, GYRO_BIAS, POSITION, ProcessNoise, STATES,
    VELOCITY,
};
use adit_estimation::inertial::filter::FilterState;
use adit_estimation::inertial::strapdown::Increment;
use adit_estimation::kalman::{Derivative, Linearised};
use proptest::prelude::*;
use support::{Dense, Draws, at_rest, difference, initial_covariance, sample, transition};

const GRAVITY: f64 = 9.80665;

/// Rounding of sums of 36 products of 2⁻⁵³ each, with a hundredfold for cancellation.
const ROUNDING: f64 = 1e-12;

fn noise(draws: &mut Draws, interval_s: f64) -> ProcessNoise {
    ProcessNoise {
        attitude: draws.variance(1e-5 * interval_s),
        velocity: 0.02 * draws.normal().abs() * interval_s,
        gyro_bias: 1e-8 * interval_s,
        acc_bias: 1e-6 * interval_s,
    }
}

fn dense_noise(noise: &ProcessNoise) -> Dense {
    let mut q = Dense::zeros();
    let per_axis = |variance: f64| Matrix3::identity() * variance;
    for (block, value) in [
        (ATTITUDE, noise.attitude),
        (VELOCITY, per_axis(noise.velocity)),
        (GYRO_BIAS, per_axis(noise.gyro_bias)),
        (ACC_BIAS, per_axis(noise.acc_bias)),
    ] {
        q.fixed_view_mut::<3, 3>(3 * block, 3 * block).copy_from(&value);
    }
    q
}

/// A measurement of `N` blocks chosen at random, none twice.
fn measurement<const N: usize>(draws: &mut Draws, sigma: f64) -> Linearised<N> {
    let mut order: [usize; BLOCKS] = core::array::from_fn(|i| i);
    let keys: [f64; BLOCKS] = core::array::from_fn(|_| draws.normal());
    order.sort_by(|a, b| keys[*a].total_cmp(&keys[*b]));
    Linearised {
        residual: draws.vector(sigma),
        jacobian: core::array::from_fn(|i| (order[i], Derivative::Matrix(draws.matrix()))),
        noise: draws.variance(sigma * sigma),
    }
}

fn dense_jacobian<const N: usize>(measurement: &Linearised<N>) -> SMatrix<f64, 3, STATES> {
    let mut h = SMatrix::<f64, 3, STATES>::zeros();
    for (block, jacobian) in &measurement.jacobian {
        h.fixed_view_mut::<3, 3>(0, 3 * block).copy_from(&jacobian.matrix());
    }
    h
}

fn stacked(blocks: &[Matrix3<f64>; BLOCKS]) -> SMatrix<f64, STATES, 3> {
    SMatrix::from_fn(|i, j| blocks[i / 3][(i % 3, j)])
}

fn stacked_vector(blocks: &ErrorVector) -> SVector<f64, STATES> {
    SVector::from_fn(|i, _| blocks[i / 3][i % 3])
}

/// A covariance in which everything is correlated with everything.
fn correlated(draws: &mut Draws) -> Covariance {
    let mut covariance = initial_covariance(draws);
    for _ in 0..5 {
        covariance.propagate(&draws.step(0.05), &noise(draws, 0.05));
        let seen = measurement::<3>(draws, 0.1);
        let (innovation, gain) = covariance.innovation(&seen).unwrap();
        covariance.update(&innovation, &gain);
    }
    covariance
}

/// Runs one update both ways and compares them.
fn update_equals_joseph<const N: usize>(draws: &mut Draws) -> Result<(), TestCaseError> {
    let mut covariance = correlated(draws);
    let seen = measurement::<N>(draws, 0.05);
    let (p, h) = (covariance.to_matrix(), dense_jacobian(&seen));
    let s = h * p * h.transpose() + seen.noise;
    let inverse = s.try_inverse().unwrap();
    let k = p * h.transpose() * inverse;
    let rest = Dense::identity() - k * h;
    let joseph = rest * p * rest.transpose() + k * seen.noise * k.transpose();

    let (innovation, gain) = covariance.innovation(&seen).unwrap();
    let correction = covariance.update(&innovation, &gain);
    prop_assert!((innovation.covariance - s).amax() < ROUNDING * s.amax());
    let nis = seen.residual.dot(&(inverse * seen.residual));
    prop_assert!((innovation.nis - nis).abs() < 1e-9 * nis.max(1.0), "{} {nis}", innovation.nis);
    let expected = k * seen.residual;
    for (i, (found, expected)) in stacked_vector(&correction).iter().zip(&expected).enumerate() {
        // In units of what the state may be off by.
        prop_assert!((found - expected).abs() < 1e-10 * p[(i, i)].sqrt() * nis.sqrt().max(1.0));
    }
    let error = difference(&covariance.to_matrix(), &joseph, &p);
    prop_assert!(error < ROUNDING, "{error:e}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn propagation_in_blocks_equals_the_dense_one(seed: u64, interval_s in 1e-4..0.3) {
        let mut draws = Draws::new(seed);
        let mut covariance = correlated(&mut draws);
        for _ in 0..4 {
            let step = draws.step(interval_s);
            let noise = noise(&mut draws, interval_s);
            let f = transition(&step);
            let dense = f * covariance.to_matrix() * f.transpose() + dense_noise(&noise);
            covariance.propagate(&step, &noise);
            let error = difference(&covariance.to_matrix(), &dense, &dense);
            prop_assert!(error < ROUNDING, "{error:e}");
        }
    }

    #[test]
    fn an_update_in_blocks_equals_the_dense_joseph_form(seed: u64) {
        let mut draws = Draws::new(seed);
        update_equals_joseph::<1>(&mut draws)?;
        update_equals_joseph::<2>(&mut draws)?;
        update_equals_joseph::<3>(&mut draws)?;
    }

    #[test]
    fn an_update_is_joseph_for_a_gain_that_is_not_the_best(seed: u64, weight in 0.1..1.9) {
        let mut draws = Draws::new(seed);
        let mut covariance = correlated(&mut draws);
        let seen = measurement::<2>(&mut draws, 0.05);
        let (innovation, mut gain) = covariance.innovation(&seen).unwrap();
        gain.gain.iter_mut().for_each(|block| *block *= weight);
        let (p, h, k) = (covariance.to_matrix(), dense_jacobian(&seen), stacked(&gain.gain));
        let rest = Dense::identity() - k * h;
        let joseph = rest * p * rest.transpose() + k * seen.noise * k.transpose();
        covariance.update(&innovation, &gain);
        let error = difference(&covariance.to_matrix(), &joseph, &p);
        prop_assert!(error < ROUNDING, "{error:e}");
    }
}

#[test]
fn a_measurement_without_meaning_is_refused() {
    let mut draws = Draws::new(1);
    let covariance = correlated(&mut draws);
    let good = measurement::<1>(&mut draws, 0.1);
    let blind = Linearised {
        jacobian: [(VELOCITY, Derivative::Matrix(Matrix3::zeros()))],
        noise: Matrix3::zeros(),
        ..good.clone()
    };
    let lost = Linearised { residual: Vector3::new(f64::NAN, 0.0, 0.0), ..good };
    assert!(covariance.innovation(&blind).is_none());
    assert!(covariance.innovation(&lost).is_none());
}

/// Where the strapdown takes a state that is off by `error`, as an error of where it takes the state itself.
fn carried(state: &FilterState, error: &ErrorVector, before: &Increment, interval_s: f64) -> ErrorVector {
    let imu = sample(0.0, Vector3::new(3.0, -5.0, 2.0), Vector3::new(8.0, -15.0, 20.0));
    let run = |mut state: FilterState| {
        let n = &mut state.navigation;
        let now = n.increment(&imu, interval_s);
        n.propagate(&now, before, interval_s, GRAVITY);
        state
    };
    let mut other = *state;
    other.correct(error);
    let (a, b) = (run(*state), run(other));
    let (n, m) = (a.navigation, b.navigation);
    [
        attitude::log(&(m.attitude * n.attitude.inverse())),
        m.velocity_m_s - n.velocity_m_s,
        m.position_m - n.position_m,
        m.gyro_bias_rad_s - n.gyro_bias_rad_s,
        m.acc_bias_m_s2 - n.acc_bias_m_s2,
        b.contact_m - a.contact_m,
    ]
}

#[test]
fn the_transition_is_the_derivative_of_the_strapdown() {
    let dt = 0.005;
    let navigation = adit_estimation::inertial::strapdown::NavigationState {
        velocity_m_s: Vector3::new(1.0, 2.0, 3.0),
        position_m: Vector3::new(-3.0, 4.0, 1.0),
        gyro_bias_rad_s: Vector3::new(0.01, 0.02, -0.01),
        acc_bias_m_s2: Vector3::new(0.1, -0.1, 0.2),
        ..at_rest(exp(&Vector3::new(0.3, -0.8, 1.4)))
    };
    let state = FilterState { navigation, contact_m: Vector3::new(0.1, 0.0, 0.05) };
    let before = Increment { angle: Vector3::new(3.0, -5.0, 1.5) * dt, velocity: Vector3::z() * 20.0 * dt };
    let imu = sample(0.0, Vector3::new(3.0, -5.0, 2.0), Vector3::new(8.0, -15.0, 20.0));
    let now = navigation.increment(&imu, dt);
    let f = transition(&{ navigation }.propagate(&now, &before, dt, GRAVITY));

    let (turn, gained) = (now.angle.norm(), now.velocity.norm());
    // What the documented transition leaves out, block by block, all of second order in the interval (the factor of
    // one stands for ½ of the leading term and the coning and sculling terms after it); zero everywhere else.
    let neglected = |row: usize, column: usize| match (row, column) {
        (ATTITUDE, GYRO_BIAS) | (VELOCITY, ACC_BIAS) => turn * dt,
        (VELOCITY, GYRO_BIAS) | (POSITION, ATTITUDE) => gained * dt,
        (POSITION, ACC_BIAS) => dt * dt,
        (POSITION, GYRO_BIAS) => gained * dt * dt,
        _ => 0.0,
    };
    let h = 1e-5;
    for index in 0..STATES {
        let mut error: ErrorVector = [Vector3::zeros(); BLOCKS];
        error[index / 3][index % 3] = h;
        let plus = carried(&state, &error, &before, dt);
        error[index / 3][index % 3] = -h;
        let minus = carried(&state, &error, &before, dt);
        for row in 0..BLOCKS {
            let derivative = (plus[row] - minus[row]) / (2.0 * h);
            let documented = f.fixed_view::<3, 1>(3 * row, index);
            // Differences of states of 5 m at 2⁻⁵³ over 2e-5: 5e-11.
            let tolerance = neglected(row, index / 3) + 1e-9;
            let error = (derivative - documented).norm();
            assert!(error < tolerance, "block {row} by state {index}: {error:e} of {tolerance:e}");
        }
    }
}

#[test]
fn the_covariance_stays_symmetric_and_positive_definite_over_a_shift() {
    let mut draws = Draws::new(11);
    let mut covariance = initial_covariance(&mut draws);
    let dt = 0.005;
    for k in 0..100_000_u32 {
        let step = draws.step(dt);
        let process = noise(&mut draws, dt);
        covariance.propagate(&step, &process);
        // A quarter of the time in stance, with what a stance tells.
        if k % 200 >= 150 && k % 2 == 0 {
            let lever = (CONTACT, Derivative::Matrix(draws.matrix()));
            let velocity = (VELOCITY, Derivative::Identity);
            let tilt = (ATTITUDE, Derivative::Matrix(attitude::skew(&draws.vector(0.1))));
            let seen = Linearised {
                residual: draws.vector(0.01),
                jacobian: [tilt, velocity, lever],
                noise: Matrix3::identity() * 1e-4,
            };
            let (innovation, gain) = covariance.innovation(&seen).unwrap();
            covariance.update(&innovation, &gain);
        }
        if k % 100 == 99 {
            let p = covariance.to_matrix();
            assert!(difference(&p, &p.transpose(), &p) < ROUNDING, "step {k}: not symmetric");
            assert!(Cholesky::new(p).is_some(), "step {k}: not positive definite");
        }
    }
}
