//! A solution of which the position alone is known.

use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;

/// Speed of somebody of whom nothing is known, standard deviation on each level axis, m/s.
const ANY_SPEED_M_S: f64 = 1.0;
/// Any attitude: standard deviation of the uniform distribution over a turn, rad.
const ANY_ANGLE_RAD: f64 = 1.8138;

/// Position as measured, and what is true of anybody.
pub fn somewhere(time: Time, position_m: Vector3<f64>, covariance_m2: &Matrix3<f64>) -> Solution {
    let mut covariance = SolutionCovariance::zeros();
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(covariance_m2);
    covariance[(3, 3)] = ANY_SPEED_M_S * ANY_SPEED_M_S;
    covariance[(4, 4)] = ANY_SPEED_M_S * ANY_SPEED_M_S;
    let any = Matrix3::identity() * (ANY_ANGLE_RAD * ANY_ANGLE_RAD);
    covariance.fixed_view_mut::<3, 3>(6, 6).copy_from(&any);
    Solution {
        time,
        position_m,
        velocity_m_s: Vector3::zeros(),
        attitude: Attitude::identity(),
        covariance,
        quality: Quality::Fixed,
    }
}
