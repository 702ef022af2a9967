//! The error-quaternion filter against numerical derivatives, its constraint, and the plain 4-parameter update.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix3, Quaternion, SMatrix, SVector, Vector3, Vector4};
use adit_estimation::inertial::covariance::{ACC_BIAS, CONTACT, GYRO_BIAS, POSITION, VELOCITY};
use adit_estimation::inertial::error_quaternion::{
    ErrorQuaternionFilter, FIRST, HARD_IRON, STATES, StartSigma, xi_body, xi_navigation,
};
use adit_estimation::inertial::filter::{FilterState, SensorNoise};
use adit_estimation::inertial::reference_attitude::{ReferenceAttitude, reference_attitude};
use adit_estimation::inertial::strapdown::{Increment, NavigationState};
use adit_estimation::kalman::MeasurementModel;
use adit_observation::ImuSample;
use proptest::prelude::*;
use support::sample;

const G: f64 = 9.80665;
const DT_S: f64 = 0.005;
const CORRELATION_S: f64 = 100.0;
const NO_NOISE: SensorNoise = SensorNoise {
    angle_random_walk_rad_sqrt_s: 0.0,
    rate_share_sqrt_s: 0.0,
    velocity_random_walk_m_s_sqrt_s: 0.0,
    force_share_sqrt_s: 0.0,
    gyro_bias_walk_rad_s_sqrt_s: 0.0,
    acc_bias_walk_m_s2_sqrt_s: 0.0,
    gyro_range_rad_s: 1e9,
    clipped_rate_rad_sqrt_s: 0.0,
};
const SIGMA: StartSigma = StartSigma {
    attitude_rad: Vector3::new(0.03, 0.05, 0.2),
    drift_rad_s: 0.002,
    velocity_m_s: 0.1,
    position_m: 0.3,
    acc_bias_m_s2: 0.2,
    contact_m: 0.1,
    hard_iron_ut: 0.3,
};

fn vector(range: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-range..range).prop_map(Vector3::from)
}

prop_compose! {
    /// A foot somewhere, moving somehow.
    fn states()(
        turn in vector(3.0), velocity in vector(3.0), position in vector(50.0), drift in vector(0.01), bias in vector(0.3),
        contact in vector(0.2),
    ) -> FilterState {
        FilterState {
            navigation: NavigationState {
                attitude: attitude::exp(&turn),
                velocity_m_s: velocity,
                position_m: position,
                gyro_bias_rad_s: drift,
                acc_bias_m_s2: bias,
            },
            contact_m: contact,
        }
    }
}

fn wxyz(q: &Attitude) -> Vector4<f64> {
    Vector4::new(q.w, q.i, q.j, q.k)
}

/// All that is estimated as one vector, in the order of the error state.
fn flat(state: &FilterState, iron: &Vector3<f64>) -> SVector<f64, STATES> {
    let n = &state.navigation;
    let mut x = SVector::<f64, STATES>::zeros();
    x.fixed_rows_mut::<4>(0).copy_from(&wxyz(&n.attitude));
    x.fixed_rows_mut::<3>(FIRST[GYRO_BIAS]).copy_from(&n.gyro_bias_rad_s);
    x.fixed_rows_mut::<3>(FIRST[VELOCITY]).copy_from(&n.velocity_m_s);
    x.fixed_rows_mut::<3>(FIRST[POSITION]).copy_from(&n.position_m);
    x.fixed_rows_mut::<3>(FIRST[ACC_BIAS]).copy_from(&n.acc_bias_m_s2);
    x.fixed_rows_mut::<3>(FIRST[CONTACT]).copy_from(&state.contact_m);
    x.fixed_rows_mut::<3>(FIRST[HARD_IRON]).copy_from(iron);
    x
}

/// The state moved by a small error that keeps the quaternion at length 1: (rotation in n, drift, velocity, …).
fn moved(state: &FilterState, error: &SVector<f64, 21>) -> FilterState {
    let part = |first: usize| error.fixed_rows::<3>(first).into_owned();
    let mut s = *state;
    s.navigation.attitude = attitude::turn_navigation(&state.navigation.attitude, &part(0));
    s.navigation.gyro_bias_rad_s += part(3);
    s.navigation.velocity_m_s += part(6);
    s.navigation.position_m += part(9);
    s.navigation.acc_bias_m_s2 += part(12);
    s.contact_m += part(15);
    s
}

/// From these 21 to the 22 of the error state.
fn spread(q: &Attitude) -> SMatrix<f64, STATES, 21> {
    let mut t = SMatrix::<f64, STATES, 21>::zeros();
    t.fixed_view_mut::<4, 3>(0, 0).copy_from(&(xi_navigation(q) * 0.5));
    t.fixed_view_mut::<18, 18>(4, 3).fill_with_identity();
    t
}

/// One interval of the true equations, drift decay included, without the filter.
fn stepped(state: &FilterState, rest_drift: &Vector3<f64>, imu: &ImuSample) -> FilterState {
    let mut s = *state;
    let increment = s.navigation.increment(imu, DT_S);
    s.navigation.propagate(&increment, &Increment::default(), DT_S, G);
    let kept = (-DT_S / CORRELATION_S).exp();
    s.navigation.gyro_bias_rad_s = rest_drift + (state.navigation.gyro_bias_rad_s - rest_drift) * kept;
    s
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// The covariance carried by the filter is `J P Jᵀ` with `J` from central differences of the strapdown itself.
    #[test]
    fn the_transition_is_the_derivative_of_the_strapdown(
        state in states(), rate in vector(8.0), force in vector(30.0)
    ) {
        let imu = sample(DT_S, rate, force);
        let mut filter = ErrorQuaternionFilter::new(state, &SIGMA, G);
        let rest_drift = state.navigation.gyro_bias_rad_s;
        let before = filter.covariance;
        filter.predict(&imu, DT_S, &NO_NOISE, CORRELATION_S, true);

        let step = 1e-5;
        let mut jacobian = SMatrix::<f64, STATES, 21>::zeros();
        for column in 0..21 {
            let error = SVector::<f64, 21>::ith(column, step);
            let iron = error.fixed_rows::<3>(18).into_owned();
            let ahead = flat(&stepped(&moved(&state, &error), &rest_drift, &imu), &iron);
            let behind = flat(&stepped(&moved(&state, &-error), &rest_drift, &imu), &-iron);
            jacobian.set_column(column, &((ahead - behind) / (2.0 * step)));
        }
        // P = T Π Tᵀ with Π over the 21; its pseudo-inverse on the tangent gives Π back.
        let spread = spread(&state.navigation.attitude);
        let mut gather = SMatrix::<f64, 21, STATES>::zeros();
        gather.fixed_view_mut::<3, 4>(0, 0).copy_from(&(xi_navigation(&state.navigation.attitude).transpose() * 2.0));
        gather.fixed_view_mut::<18, 18>(3, 4).fill_with_identity();
        let reduced = gather * before * gather.transpose();
        prop_assert!((spread * reduced * spread.transpose() - before).amax() < 1e-15);

        let expected = jacobian * reduced * jacobian.transpose();
        // Left out is what is of third order in the interval: ⅙ dt (|ω| dt)² of a bias, with |ω| dt ≤ 0.07, and the like for
        // drift and quaternion; and J_r to third order, (|ω| dt)³/24 dt σ_ε. With σ_b = 0.2 m/s² and σ_v = 0.1 m/s that is
        // below 1e-7; central differences add 1e-10.
        let tolerance = 1e-7;
        let error = (filter.covariance - expected).amax();
        prop_assert!(error < tolerance, "{error:e}");
    }

    /// `P (q̂, 0, …) = 0` and `|q̂| = 1`, after a start, predictions and updates.
    #[test]
    fn nothing_is_uncertain_along_the_quaternion(state in states(), rate in vector(8.0), offset in -0.5..0.5) {
        let mut filter = ErrorQuaternionFilter::new(state, &SIGMA, G);
        let noise = SensorNoise::default();
        for k in 0..50 {
            let imu = sample(DT_S * f64::from(k + 1), rate, Vector3::new(1.0, -2.0, G));
            filter.predict(&imu, DT_S, &noise, CORRELATION_S, true);
            if k % 10 == 0 {
                let q = filter.state.navigation.attitude;
                let reference = ReferenceAttitude {
                    attitude: reference_attitude(&q, Some(&imu.specific_force_m_s2), Some(offset)),
                    gravity_m_s2: G,
                    tilt_sigma_rad: Some(0.05),
                    heading_sigma_rad: Some(0.05), heading_by_iron: Vector3::zeros(),
                };
                prop_assert!(filter.update(&reference, f64::INFINITY).unwrap().accepted);
            }
        }
        let q = filter.state.navigation.attitude;
        prop_assert!((q.into_inner().norm() - 1.0).abs() < 1e-14);
        let along = filter.covariance.fixed_columns::<4>(0) * wxyz(&q);
        // Rounding of 50 predictions of covariances of order 1.
        prop_assert!(along.amax() < 1e-13, "{:e}", along.amax());
        let smallest = filter.covariance.symmetric_eigenvalues().min();
        prop_assert!(smallest > -1e-12, "{smallest:e}");
    }

    /// The update by three components in the tangent is the 4-parameter update with the pseudo-inverse of `S`.
    #[test]
    fn the_update_is_that_of_four_parameters(state in states(), turn in vector(0.1), sign in prop::bool::ANY) {
        let mut filter = ErrorQuaternionFilter::new(state, &SIGMA, G);
        let q = state.navigation.attitude;
        let measured = attitude::turn_navigation(&q, &turn);
        let flipped = if sign { Attitude::new_unchecked(-measured.into_inner()) } else { measured };
        // All three angles, and no bias in them: the z row sees none, so heading alone is compared, then the tilt with a
        // bias that is known.
        let sigma = StartSigma { acc_bias_m_s2: 0.0, ..SIGMA };
        let mut known = ErrorQuaternionFilter::new(state, &sigma, G);
        let reference = ReferenceAttitude {
            attitude: flipped, gravity_m_s2: G, tilt_sigma_rad: Some(0.02), heading_sigma_rad: Some(0.03), heading_by_iron: Vector3::zeros(),
        };
        let p = known.covariance;
        known.update(&reference, f64::INFINITY).unwrap();
        filter.update(&reference, f64::INFINITY).unwrap();

        // z = q(ε) − q(ω), H = [I 0], R = ¼ Ξ_L diag(σ²) Ξ_Lᵀ, all of rank 3.
        let xi = xi_navigation(&q);
        let r = xi * Matrix3::from_diagonal(&Vector3::new(4e-4, 4e-4, 9e-4)) * xi.transpose() * 0.25;
        let s = p.fixed_view::<4, 4>(0, 0) + r;
        let s_pinv = s.pseudo_inverse(1e-12).unwrap();
        let gain = p.fixed_columns::<4>(0) * s_pinv;
        let z = wxyz(&measured) / wxyz(&measured).dot(&wxyz(&q)) - wxyz(&q);
        let x = flat(&state, &Vector3::zeros()) + gain * z;
        let q = Attitude::new_normalize(Quaternion::new(x[0], x[1], x[2], x[3]));
        let carried = xi_navigation(&q) * xi.transpose();
        let mut t = SMatrix::<f64, STATES, STATES>::identity();
        t.fixed_view_mut::<4, 4>(0, 0).copy_from(&carried);
        let expected = t * (p - gain * p.fixed_rows::<4>(0)) * t.transpose();

        let found = &known.state.navigation.attitude;
        prop_assert!(found.angle_to(&q) < 1e-12, "{:e}", found.angle_to(&q));
        prop_assert!((known.covariance - expected).amax() < 1e-12);
        // An accelerometer that may have a bias is believed less.
        prop_assert!(filter.tilt_sigma_rad() > known.tilt_sigma_rad());
    }

    /// `q(ε)`: level by the specific force, turned clockwise by the offset, whatever the tilt before.
    #[test]
    fn the_reference_is_level_and_has_the_heading(turn in vector(3.0), tilt in vector(0.2), offset in -3.0..3.0) {
        let truth = attitude::exp(&turn);
        let force = truth.inverse() * Vector3::new(0.0, 0.0, G);
        let estimate = attitude::turn_navigation(&truth, &Vector3::new(tilt.x, tilt.y, 0.0));
        let reference = reference_attitude(&estimate, Some(&force), Some(offset));
        prop_assert!((reference * force - Vector3::new(0.0, 0.0, G)).amax() < 1e-12);
        let turned = attitude::log(&(reference * reference_attitude(&estimate, Some(&force), None).inverse()));
        prop_assert!((turned - Vector3::new(0.0, 0.0, -offset)).amax() < 1e-9, "{turned}");
    }

    /// The derivatives of the reference by attitude and accelerometer bias are those of central differences.
    #[test]
    fn the_jacobian_of_the_reference_is_numerical(state in states()) {
        let q = state.navigation.attitude;
        let observed = |state: &FilterState| {
            let n = &state.navigation;
            // What the accelerometer would read in that state, levelled with the estimate that the filter has.
            let reading = n.attitude.inverse() * Vector3::new(0.0, 0.0, G) + n.acc_bias_m_s2;
            let heading = attitude::log(&(n.attitude * q.inverse())).z;

            let reference = ReferenceAttitude {
                attitude: reference_attitude(&q, Some(&reading), Some(-heading)),
                gravity_m_s2: G, tilt_sigma_rad: Some(1.0), heading_sigma_rad: Some(1.0), heading_by_iron: Vector3::zeros(),
            };
            let mut at = *state;
            at.navigation.attitude = q;
            reference.linearise(&at)
        };
        let level = FilterState {
            navigation: NavigationState { acc_bias_m_s2: Vector3::zeros(), ..state.navigation }, ..state
        };
        let analytic = observed(&level).jacobian;
        let step = 1e-5;
        for axis in 0..3 {
            let small = Vector3::ith(axis, step);
            for (block, derivative) in analytic.iter().filter(|(block, _)| *block != HARD_IRON) {
                let shifted = |by: Vector3<f64>| {
                    let mut s = level;
                    if *block == ACC_BIAS {
                        s.navigation.acc_bias_m_s2 += by;
                    } else {
                        s.navigation.attitude = attitude::turn_navigation(&q, &by);
                    }
                    observed(&s).residual
                };
                let numerical = (shifted(small) - shifted(-small)) / (2.0 * step);
                let error = numerical - derivative.matrix().column(axis);
                // Second differences of order step².
                prop_assert!(error.amax() < 1e-8, "block {block} axis {axis}: {error}");
            }
        }
    }
}

#[test]
fn a_certain_reference_is_taken_over_whole_however_far_it_is() {
    for turn_deg in [1.0, 30.0, 90.0, 150.0_f64] {
        let turn = Vector3::new(0.36, -0.48, 0.8) * turn_deg.to_radians();
        let estimate = FilterState {
            navigation: support::at_rest(attitude::exp(&Vector3::new(0.4, 1.0, -0.3))),
            contact_m: Vector3::zeros(),
        };
        let truth = attitude::turn_navigation(&estimate.navigation.attitude, &turn);
        let unsure = StartSigma { attitude_rad: Vector3::repeat(1.0), acc_bias_m_s2: 0.0, ..SIGMA };
        let mut filter = ErrorQuaternionFilter::new(estimate, &unsure, G);
        let reference = ReferenceAttitude {
            attitude: truth,
            gravity_m_s2: G,
            tilt_sigma_rad: Some(1e-6),
            heading_sigma_rad: Some(1e-6),
            heading_by_iron: Vector3::zeros(),
        };
        filter.update(&reference, f64::INFINITY).unwrap();
        let left = filter.state.navigation.attitude.angle_to(&truth);
        // The prior keeps a share of 1e-12.
        assert!(left < 1e-10, "{turn_deg}: {left:e}");
    }
}

#[test]
fn gravity_tells_nothing_of_the_heading() {
    // A foot at rest for a minute with a tilt and a bias that nothing tells apart: both are corrected again and again.
    let mut draws = support::Draws::new(5);
    let mut state = FilterState {
        navigation: support::at_rest(attitude::exp(&Vector3::new(0.5, -0.3, 2.0))),
        contact_m: Vector3::zeros(),
    };
    let up = state.navigation.attitude.inverse() * Vector3::new(0.0, 0.0, G);
    state.navigation.attitude =
        attitude::turn_navigation(&state.navigation.attitude, &Vector3::new(0.03, -0.04, 0.0));
    let sigma = StartSigma { attitude_rad: Vector3::new(0.04, 0.04, 0.08), acc_bias_m_s2: 0.3, ..SIGMA };
    let mut filter = ErrorQuaternionFilter::new(state, &sigma, G);
    let before = filter.heading_variance();
    let noise =
        SensorNoise { velocity_random_walk_m_s_sqrt_s: 2e-3, acc_bias_walk_m_s2_sqrt_s: 2e-4, ..NO_NOISE };
    for k in 0..6_000 {
        let imu = sample(DT_S * f64::from(k + 1), Vector3::zeros(), up + draws.vector(0.03));
        filter.predict(&imu, DT_S, &noise, CORRELATION_S, false);
        if k % 10 == 0 {
            let navigation = &filter.state.navigation;
            let force = imu.specific_force_m_s2 - navigation.acc_bias_m_s2;
            let tilt = ReferenceAttitude {
                attitude: reference_attitude(&navigation.attitude, Some(&force), None),
                gravity_m_s2: G,
                tilt_sigma_rad: Some(0.02),
                heading_sigma_rad: None,
                heading_by_iron: Vector3::zeros(),
            };
            filter.update(&tilt, f64::INFINITY).unwrap();
        }
    }
    // Rounding, and nothing else.
    let kept = filter.heading_variance() / before;
    assert!((kept - 1.0).abs() < 1e-6, "{kept}");
}

#[test]
fn the_kinematics_are_those_of_the_paper() {
    // q̇ = ½ Ω(ω) q = ½ Ξ(q) ω: both forms of eq. 5, and their agreement with the rotation itself.
    let q = attitude::exp(&Vector3::new(0.3, -1.1, 0.7));
    let rate = Vector3::new(0.4, -0.2, 0.9);
    let omega = adit_core::nalgebra::Matrix4::new(
        0.0, -rate.x, -rate.y, -rate.z, //
        rate.x, 0.0, rate.z, -rate.y, //
        rate.y, -rate.z, 0.0, rate.x, //
        rate.z, rate.y, -rate.x, 0.0,
    );
    let from_omega = omega * wxyz(&q) * 0.5;
    let from_xi = xi_body(&q) * rate * 0.5;
    assert!((from_omega - from_xi).amax() < 1e-16);
    let h = 1e-6;
    let turned = |t: f64| wxyz(&attitude::turn_body(&q, &(rate * t)));
    assert!(((turned(h) - turned(-h)) / (2.0 * h) - from_xi).amax() < 1e-9);
}

#[test]
fn the_drift_forgets_as_a_gauss_markov_process_does() {
    let drift = Vector3::new(0.01, 0.0, 0.0);
    let mut state = FilterState {
        navigation: NavigationState {
            attitude: Attitude::identity(),
            velocity_m_s: Vector3::zeros(),
            position_m: Vector3::zeros(),
            gyro_bias_rad_s: drift,
            acc_bias_m_s2: Vector3::zeros(),
        },
        contact_m: Vector3::zeros(),
    };
    let noise = SensorNoise { gyro_bias_walk_rad_s_sqrt_s: 1e-3, ..NO_NOISE };
    let mut filter = ErrorQuaternionFilter::new(state, &SIGMA, G);
    // What is estimated beside the drift at rest.
    state = filter.state;
    state.navigation.gyro_bias_rad_s += Vector3::new(0.0, 0.004, 0.0);
    filter.state = state;
    for k in 0..40_000 {
        filter.predict(
            &sample(DT_S * f64::from(k + 1), drift, Vector3::new(0.0, 0.0, G)),
            DT_S,
            &noise,
            50.0,
            true,
        );
    }
    // 200 s are four correlation times: e⁻⁴ of the drift is left, and the variance is q² τ/2 (1 − e⁻⁸) + e⁻⁸ σ².
    let left = filter.state.navigation.gyro_bias_rad_s - drift;
    assert!((left.y / (0.004 * (-4.0_f64).exp()) - 1.0).abs() < 1e-9, "{left}");
    let expected = 1e-6 * 25.0 * (1.0 - (-8.0_f64).exp()) + (-8.0_f64).exp() * 4e-6;
    let variance = filter.covariance[(FIRST[GYRO_BIAS], FIRST[GYRO_BIAS])];
    assert!((variance / expected - 1.0).abs() < 1e-9, "{variance:e} {expected:e}");
}
