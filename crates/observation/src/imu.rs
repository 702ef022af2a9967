//! Inertial and magnetic observations.

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// One reading of a three-axis gyro and a three-axis accelerometer, body frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ImuSample {
    /// Time of the reading: the end of the interval over which the sensor averaged.
    pub time: Time,
    /// Angular rate of the body against inertial space, rad/s.
    pub angular_rate_rad_s: Vector3<f64>,
    /// Specific force, m/s² (at rest it points up and has the length of gravity).
    pub specific_force_m_s2: Vector3<f64>,
}

impl ImuSample {
    /// Faster turns no sensor, rad/s (gyros end at 70), and none is shaken harder, m/s² (shock sensors end at some 1e5).
    pub const LIMITS: (f64, f64) = (1e3, 1e5);

    /// Whether every component is a finite number that an inertial sensor could give.
    #[inline]
    pub fn is_reading(&self) -> bool {
        let (rate, force) = Self::LIMITS;
        // NaN and infinities are not within either.
        self.angular_rate_rad_s.iter().all(|v| v.abs() <= rate)
            && self.specific_force_m_s2.iter().all(|v| v.abs() <= force)
    }
}

/// One reading of a three-axis accelerometer that has no gyro beside it, body frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AccelerationSample {
    /// Time of the reading: the end of the interval over which the sensor averaged.
    pub time: Time,
    /// Specific force, m/s² (at rest it points up and has the length of gravity).
    pub specific_force_m_s2: Vector3<f64>,
}

impl AccelerationSample {
    /// Whether every component is a finite number that an accelerometer could give.
    #[inline]
    pub fn is_reading(&self) -> bool {
        self.specific_force_m_s2.iter().all(|v| v.abs() <= ImuSample::LIMITS.1)
    }
}

/// One reading of a three-axis magnetometer, body frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MagneticSample {
    /// Time of the reading.
    pub time: Time,
    /// Magnetic flux density, µT.
    pub field_ut: Vector3<f64>,
}

impl MagneticSample {
    /// Beyond this no magnetometer reads, µT: 10 mT.
    pub const LIMIT_UT: f64 = 1e4;

    /// Whether every component is a finite number that a magnetometer could give.
    #[inline]
    pub fn is_reading(&self) -> bool {
        self.field_ut.iter().all(|v| v.abs() <= Self::LIMIT_UT)
    }
}

/// Noise of an IMU in the terms of a data sheet; one-sided amplitude spectral densities.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImuSpecification {
    /// Angle random walk, rad/√s (1 °/√h = 2.909e-4 rad/√s).
    pub angle_random_walk_rad_sqrt_s: f64,
    /// Velocity random walk, (m/s)/√s (1 mg/√Hz = 9.807e-3).
    pub velocity_random_walk_m_s_sqrt_s: f64,
    /// Gyro bias random walk, (rad/s)/√s.
    pub gyro_bias_walk_rad_s_sqrt_s: f64,
    /// Accelerometer bias random walk, (m/s²)/√s.
    pub acc_bias_walk_m_s2_sqrt_s: f64,
}
