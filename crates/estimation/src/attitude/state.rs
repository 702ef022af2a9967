//! What the attitude estimator knows, and the blocks of its error state.
//!
//! | block | error of | unit |
//! |---|---|---|
//! | [`ATTITUDE`] | attitude: rotation vector in ENU, `q_true = exp(φ) ∘ q` | rad |
//! | [`GYRO_BIAS`] | gyro bias, body axes | rad/s |
//! | [`GYRO_SCALE`] | gyro scale factors, body axes | – |
//! | [`VELOCITY`] | velocity, ENU | m/s |
//! | [`ACC_BIAS`] | accelerometer bias, body axes | m/s² |
//! | [`OFFSET`] | magnetometer offset, body axes | µT |
//! | [`FIELD`] | field of the site (horizontal, down) and delay of the magnetometer | µT, µT, s |
//!
//! Every other error is additive: true minus estimated.

use crate::kalman::blocks::BlockVector;
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Number of 3-vectors in the error state.
pub const BLOCKS: usize = 7;
/// Number of states.
pub const STATES: usize = 3 * BLOCKS;

/// Attitude.
pub const ATTITUDE: usize = 0;
/// Gyro bias.
pub const GYRO_BIAS: usize = 1;
/// Gyro scale factors.
pub const GYRO_SCALE: usize = 2;
/// Velocity.
pub const VELOCITY: usize = 3;
/// Accelerometer bias.
pub const ACC_BIAS: usize = 4;
/// Magnetometer offset.
pub const OFFSET: usize = 5;
/// Field of the site, and delay of the magnetometer: [`HORIZONTAL`], [`DOWN`], [`DELAY`].
pub const FIELD: usize = 6;

/// Component of [`FIELD`]: horizontal strength.
pub const HORIZONTAL: usize = 0;
/// Component of [`FIELD`]: downward strength.
pub const DOWN: usize = 1;
/// Component of [`FIELD`]: delay.
pub const DELAY: usize = 2;

/// Longest delay of a magnetometer that is believed, either way, s.
const LONGEST_DELAY_S: f64 = 0.06;

/// Estimate of attitude and of the sensors' errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AttitudeState {
    /// Body to ENU.
    pub attitude: Attitude,
    /// Gyro bias, rad/s.
    pub gyro_bias_rad_s: Vector3<f64>,
    /// Gyro scale factors: the reading is `1 + scale` times the rate.
    pub gyro_scale: Vector3<f64>,
    /// Velocity that the specific force integrates to, ENU, m/s; kept near the velocity of a person.
    pub velocity_m_s: Vector3<f64>,
    /// Accelerometer bias, m/s².
    pub acc_bias_m_s2: Vector3<f64>,
    /// Magnetometer offset, µT.
    pub offset_ut: Vector3<f64>,
    /// Horizontal strength of the field of the site, µT.
    pub horizontal_ut: f64,
    /// Its downward strength, µT.
    pub down_ut: f64,
    /// Angle from the magnetic north of the region to that of the place, positive to the east, rad: zero until a field
    /// that differs from the one at the start has been adopted.
    pub local_declination_rad: f64,
    /// Delay of the magnetometer against the gyro, s.
    pub delay_s: f64,
}

impl Default for AttitudeState {
    fn default() -> Self {
        Self {
            attitude: Attitude::identity(),
            gyro_bias_rad_s: Vector3::zeros(),
            gyro_scale: Vector3::zeros(),
            velocity_m_s: Vector3::zeros(),
            acc_bias_m_s2: Vector3::zeros(),
            offset_ut: Vector3::zeros(),
            horizontal_ut: 0.0,
            down_ut: 0.0,
            local_declination_rad: 0.0,
            delay_s: 0.0,
        }
    }
}

impl AttitudeState {
    /// Rate of the body from a reading of the gyro, rad/s.
    #[inline]
    pub fn rate_rad_s(&self, reading_rad_s: &Vector3<f64>) -> Vector3<f64> {
        reading_rad_s - self.gyro_bias_rad_s - self.gyro_scale.component_mul(reading_rad_s)
    }

    /// Horizontal direction of the field, ENU; `declination_rad` is that of the region, positive to the east.
    #[inline]
    pub fn magnetic_north(&self, declination_rad: f64) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(declination_rad + self.local_declination_rad);
        Vector3::new(sin, cos, 0.0)
    }

    /// Field of the site, ENU, µT.
    #[inline]
    pub fn field_ut(&self, declination_rad: f64) -> Vector3<f64> {
        self.magnetic_north(declination_rad) * self.horizontal_ut - Vector3::z() * self.down_ut
    }

    /// Adds an error state.
    pub fn correct(&mut self, error: &BlockVector<BLOCKS>) {
        self.attitude = attitude::turn_navigation(&self.attitude, &error[ATTITUDE]);
        self.gyro_bias_rad_s += error[GYRO_BIAS];
        self.gyro_scale += error[GYRO_SCALE];
        self.velocity_m_s += error[VELOCITY];
        self.acc_bias_m_s2 += error[ACC_BIAS];
        self.offset_ut += error[OFFSET];
        self.horizontal_ut += error[FIELD][HORIZONTAL];
        self.down_ut += error[FIELD][DOWN];
        self.delay_s = (self.delay_s + error[FIELD][DELAY]).clamp(-LONGEST_DELAY_S, LONGEST_DELAY_S);
    }
}
