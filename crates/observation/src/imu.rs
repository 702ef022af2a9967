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

/// One reading of a three-axis magnetometer, body frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MagneticSample {
    /// Time of the reading.
    pub time: Time,
    /// Magnetic flux density, µT.
    pub field_ut: Vector3<f64>,
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
