//! What is known beside the gyro, as measurement models: bounded velocity, rest, and the magnetic field.

use crate::attitude::state::{
    ATTITUDE, AttitudeState, DELAY, DOWN, FIELD, GYRO_BIAS, HORIZONTAL, OFFSET, VELOCITY,
};
use crate::kalman::{Derivative, Linearised, MeasurementModel};
use adit_core::attitude::skew;
use adit_core::nalgebra::{Matrix3, Vector3};

/// Gyro and accelerometer say nothing of the vertical velocity that the tilt depends on: it is left alone, m/s.
const VERTICAL_SIGMA_M_S: f64 = 100.0;

/// A person's velocity is bounded: `0 = v + noise`, where the noise is the velocity itself.
///
/// A velocity that is correlated over a time `T` weighs, in measurements `Δt` apart, as white noise of the variance
/// `2 σ² T / Δt` (equal spectral density at low frequency).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundedVelocity {
    /// Standard deviation of each horizontal component, m/s.
    pub sigma_m_s: f64,
}

impl MeasurementModel<AttitudeState, 1> for BoundedVelocity {
    fn linearise(&self, state: &AttitudeState) -> Linearised<1> {
        let level = self.sigma_m_s * self.sigma_m_s;
        let up = VERTICAL_SIGMA_M_S * VERTICAL_SIGMA_M_S;
        Linearised {
            residual: -state.velocity_m_s,
            jacobian: [(VELOCITY, Derivative::Identity)],
            noise: Matrix3::from_diagonal(&Vector3::new(level, level, up)),
        }
    }
}

/// A tag at rest does not turn: the gyro reads its bias.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestRate {
    /// Mean reading, rad/s.
    pub rate_rad_s: Vector3<f64>,
    /// Variance of each component, rad²/s².
    pub variance_rad2_s2: f64,
}

impl MeasurementModel<AttitudeState, 1> for RestRate {
    fn linearise(&self, state: &AttitudeState) -> Linearised<1> {
        Linearised {
            residual: self.rate_rad_s - state.gyro_bias_rad_s,
            jacobian: [(GYRO_BIAS, Derivative::Identity)],
            noise: Matrix3::from_diagonal_element(self.variance_rad2_s2),
        }
    }
}

/// Mean of the magnetometer over an interval, turned into ENU with the estimate at each sample:
/// `z = B − φ × B + R δb + δτ R (ω × m)` for errors of attitude, offset and delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanField {
    /// The mean, ENU, µT.
    pub field_ut: Vector3<f64>,
    /// Mean of the rotations.
    pub rotation: Matrix3<f64>,
    /// Mean of the derivatives by the delay, µT/s.
    pub by_delay_ut_s: Vector3<f64>,
    /// Variance of each component, µT².
    pub variance_ut2: f64,
    /// Angle from true to magnetic north, positive to the east, rad.
    pub declination_rad: f64,
}

impl MeasurementModel<AttitudeState, 3> for MeanField {
    fn linearise(&self, state: &AttitudeState) -> Linearised<3> {
        let expected = state.field_ut(self.declination_rad);
        let mut by_field = Matrix3::zeros();
        by_field.set_column(HORIZONTAL, &state.magnetic_north(self.declination_rad));
        by_field.set_column(DOWN, &Vector3::new(0.0, 0.0, -1.0));
        by_field.set_column(DELAY, &self.by_delay_ut_s);
        Linearised {
            residual: self.field_ut - expected,
            jacobian: [
                (ATTITUDE, Derivative::Matrix(skew(&expected))),
                (OFFSET, Derivative::Matrix(self.rotation)),
                (FIELD, Derivative::Matrix(by_field)),
            ],
            noise: Matrix3::from_diagonal_element(self.variance_ut2),
        }
    }
}
