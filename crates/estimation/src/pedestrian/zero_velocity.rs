//! What a foot in stance tells the filter.
//!
//! # Zero velocity at the point of contact
//! A foot in stance is not still: it rolls from heel to toe, and a runner's never stops rolling. What rests on the
//! ground is the point of contact. With the lever `r` from it to the sensor (body frame), the sensor moves with
//!
//! ```text
//! v = C_b^n (ω × r) + n,     cov n = σ² I + ρ² (|ω|² I − ω ωᵀ)
//! ```
//!
//! `r` is estimated with the rest of the state; what remains of it, different for heel and toe, is an isotropic lever
//! of standard deviation `ρ`, which makes the noise grow with the turning rate, across its axis only. With `r = 0` and
//! `ρ = 0` this is the ZUPT of S2 (Kang 2023, eq. 10–13).

use crate::inertial::covariance::{ACC_BIAS, ATTITUDE, CONTACT, GYRO_BIAS, VELOCITY};
use crate::inertial::filter::FilterState;
use crate::kalman::{Derivative, Linearised, MeasurementModel};
use adit_core::attitude::skew;
use adit_core::nalgebra::{Matrix3, Vector3};

/// Zero velocity at the point of contact.
#[derive(Debug, Clone, Copy)]
pub struct ContactVelocity {
    /// Measured angular rate, rad/s, body.
    pub angular_rate_rad_s: Vector3<f64>,
    /// Standard deviation of the velocity of the contact itself, m/s.
    pub sigma_m_s: f64,
    /// Standard deviation of the lever around its estimate, m.
    pub lever_sigma_m: f64,
}

impl MeasurementModel<FilterState, 3> for ContactVelocity {
    #[inline]
    fn linearise(&self, state: &FilterState) -> Linearised<3> {
        let rotation = state.navigation.attitude.to_rotation_matrix().into_inner();
        let rate = self.angular_rate_rad_s - state.navigation.gyro_bias_rad_s;
        let expected = rotation * rate.cross(&state.contact_m);
        let rate_level = rotation * rate;
        let lever_variance = self.lever_sigma_m * self.lever_sigma_m;
        let across = Matrix3::identity() * rate_level.norm_squared() - rate_level * rate_level.transpose();
        Linearised {
            residual: expected - state.navigation.velocity_m_s,
            jacobian: [
                (ATTITUDE, Derivative::Matrix(skew(&expected))),
                (VELOCITY, Derivative::Identity),
                (CONTACT, Derivative::Matrix(rotation * skew(&-rate))),
            ],
            noise: Matrix3::identity() * (self.sigma_m_s * self.sigma_m_s) + across * lever_variance,
        }
    }
}

/// Zero angular rate: at rest the gyro reads its bias.
#[derive(Debug, Clone, Copy)]
pub struct ZeroRate {
    /// Measured angular rate, rad/s, body.
    pub angular_rate_rad_s: Vector3<f64>,
    /// Standard deviation of the rate of a foot called still, rad/s.
    pub sigma_rad_s: f64,
}

impl MeasurementModel<FilterState, 1> for ZeroRate {
    #[inline]
    fn linearise(&self, state: &FilterState) -> Linearised<1> {
        Linearised {
            residual: self.angular_rate_rad_s - state.navigation.gyro_bias_rad_s,
            jacobian: [(GYRO_BIAS, Derivative::Identity)],
            noise: Matrix3::identity() * (self.sigma_rad_s * self.sigma_rad_s),
        }
    }
}

/// Gravity at rest: the specific force points up and has its length (tilt update).
#[derive(Debug, Clone, Copy)]
pub struct RestGravity {
    /// Measured specific force, m/s², body.
    pub specific_force_m_s2: Vector3<f64>,
    /// Standard deviation, m/s²: sway, and scale errors of the accelerometer.
    pub sigma_m_s2: f64,
    /// Gravity at the site, m/s².
    pub gravity_m_s2: f64,
}

impl MeasurementModel<FilterState, 2> for RestGravity {
    #[inline]
    fn linearise(&self, state: &FilterState) -> Linearised<2> {
        let rotation = state.navigation.attitude.to_rotation_matrix().into_inner();
        let force = rotation * (self.specific_force_m_s2 - state.navigation.acc_bias_m_s2);
        Linearised {
            residual: Vector3::new(0.0, 0.0, self.gravity_m_s2) - force,
            jacobian: [
                (ATTITUDE, Derivative::Matrix(skew(&-force))),
                (ACC_BIAS, Derivative::Matrix(-rotation)),
            ],
            noise: Matrix3::identity() * (self.sigma_m_s2 * self.sigma_m_s2),
        }
    }
}
