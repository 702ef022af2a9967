//! What a stance says: Jacobians against differences, noise against its description.

mod support;

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_estimation::inertial::covariance::{BLOCKS, ErrorVector, GYRO_BIAS};
use adit_estimation::inertial::filter::FilterState;
use adit_estimation::inertial::strapdown::NavigationState;
use adit_estimation::kalman::{Linearised, MeasurementModel};
use adit_estimation::pedestrian::zero_velocity::{ContactVelocity, RestGravity, ZeroRate};
use support::Draws;

fn any_state(draws: &mut Draws) -> FilterState {
    let navigation = NavigationState {
        attitude: draws.attitude(),
        velocity_m_s: draws.vector(1.0),
        position_m: draws.vector(10.0),
        gyro_bias_rad_s: draws.vector(0.02),
        acc_bias_m_s2: draws.vector(0.2),
    };
    FilterState { navigation, contact_m: draws.vector(0.1) }
}

/// Derivative of the residual by an error of one block: truth minus estimate, thus against the change of the estimate.
fn numerical<const N: usize>(
    state: &FilterState,
    block: usize,
    linearise: &impl Fn(&FilterState) -> Linearised<N>,
) -> Matrix3<f64> {
    let h = 1e-5;
    let residual_at = |axis: usize, change: f64| {
        let mut error: ErrorVector = [Vector3::zeros(); BLOCKS];
        error[block][axis] = change;
        let mut moved = *state;
        moved.correct(&error);
        linearise(&moved).residual
    };
    let columns: [Vector3<f64>; 3] =
        core::array::from_fn(|axis| (residual_at(axis, -h) - residual_at(axis, h)) / (2.0 * h));
    Matrix3::from_columns(&columns)
}

/// Every block, those that the model leaves out included, except `neglected`.
fn jacobian_is_the_derivative<const N: usize>(
    state: &FilterState,
    neglected: Option<usize>,
    linearise: impl Fn(&FilterState) -> Linearised<N>,
) {
    let model = linearise(state);
    for block in (0..BLOCKS).filter(|block| Some(*block) != neglected) {
        let given = model.jacobian.iter().filter(|(b, _)| *b == block).map(|(_, j)| j.matrix());
        let given = given.fold(Matrix3::zeros(), |sum, j| sum + j);
        let error = (given - numerical(state, block, &linearise)).amax();
        // Residuals of 30 at 2⁻⁵³ over 2e-5: 2e-10; third derivatives of 30 times h²/6: 5e-10.
        assert!(error < 5e-9, "block {block}: {error:e}");
    }
}

#[test]
fn the_contact_velocity_is_linearised_right() {
    let mut draws = Draws::new(1);
    for _ in 0..50 {
        let contact =
            ContactVelocity { angular_rate_rad_s: draws.vector(3.0), sigma_m_s: 0.01, lever_sigma_m: 0.1 };
        jacobian_is_the_derivative(&any_state(&mut draws), Some(GYRO_BIAS), |s| contact.linearise(s));
    }
}

#[test]
fn the_contact_velocity_neglects_no_more_than_the_gyro_bias_at_the_lever() {
    let mut draws = Draws::new(2);
    for _ in 0..50 {
        let state = any_state(&mut draws);
        let contact =
            ContactVelocity { angular_rate_rad_s: draws.vector(3.0), sigma_m_s: 0.01, lever_sigma_m: 0.1 };
        let model = contact.linearise(&state);
        assert!(model.jacobian.iter().all(|(block, _)| *block != GYRO_BIAS));
        let neglected = numerical(&state, GYRO_BIAS, &|s| contact.linearise(s));
        assert!(neglected.amax() < state.contact_m.norm() + 1e-9);
    }
}

#[test]
fn the_zero_rate_is_linearised_right() {
    let mut draws = Draws::new(3);
    for _ in 0..50 {
        let zero_rate = ZeroRate { angular_rate_rad_s: draws.vector(0.1), sigma_rad_s: 0.01 };
        jacobian_is_the_derivative(&any_state(&mut draws), None, |s| zero_rate.linearise(s));
    }
}

#[test]
fn gravity_at_rest_is_linearised_right() {
    let mut draws = Draws::new(4);
    for _ in 0..50 {
        let gravity =
            RestGravity { specific_force_m_s2: draws.vector(10.0), sigma_m_s2: 0.1, gravity_m_s2: 9.80665 };
        jacobian_is_the_derivative(&any_state(&mut draws), None, |s| gravity.linearise(s));
    }
}

#[test]
fn the_true_state_leaves_no_residual() {
    let mut draws = Draws::new(5);
    for _ in 0..50 {
        let mut state = any_state(&mut draws);
        let rate = draws.vector(3.0);
        let attitude = state.navigation.attitude;
        state.navigation.velocity_m_s = attitude * rate.cross(&state.contact_m);
        let angular_rate_rad_s = rate + state.navigation.gyro_bias_rad_s;
        let contact = ContactVelocity { angular_rate_rad_s, sigma_m_s: 0.01, lever_sigma_m: 0.1 };
        assert!(contact.linearise(&state).residual.norm() < 1e-14);

        let up = attitude.inverse_transform_vector(&(Vector3::z() * 9.80665));
        let specific_force_m_s2 = up + state.navigation.acc_bias_m_s2;
        let gravity = RestGravity { specific_force_m_s2, sigma_m_s2: 0.1, gravity_m_s2: 9.80665 };
        assert!(gravity.linearise(&state).residual.norm() < 1e-13);
    }
}

#[test]
fn the_noise_of_the_contact_velocity_grows_only_across_the_axis_of_rotation() {
    let mut draws = Draws::new(6);
    for _ in 0..50 {
        let state = any_state(&mut draws);
        let (sigma, lever) = (0.02, 0.07);
        let angular_rate_rad_s = draws.vector(3.0);
        let contact = ContactVelocity { angular_rate_rad_s, sigma_m_s: sigma, lever_sigma_m: lever };
        let noise = contact.linearise(&state).noise;
        let rate = angular_rate_rad_s - state.navigation.gyro_bias_rad_s;
        let axis = (state.navigation.attitude * rate).normalize();
        let across = axis.cross(&draws.vector(1.0)).normalize();
        let variance = |direction: &Vector3<f64>| direction.dot(&(noise * direction));
        let (along, grown) = (sigma * sigma, sigma * sigma + lever * lever * rate.norm_squared());
        // Rounding of a few products of numbers up to `grown`.
        assert!((variance(&axis) - along).abs() < 1e-14 * grown.max(1.0));
        assert!((variance(&across) - grown).abs() < 1e-14 * grown.max(1.0));
        assert!(axis.dot(&(noise * across)).abs() < 1e-14 * grown.max(1.0));
    }
}
