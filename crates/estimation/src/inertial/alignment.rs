//! Alignment at rest: roll and pitch from gravity, heading from the magnetometer where there is one.
//!
//! S2 (Kang 2023, eq. 2–4): at rest the accelerometer reads gravity alone, which levels the sensor whatever way up it
//! is mounted; the levelled magnetic field gives the heading, plus declination. Without a magnetometer the body's x
//! axis is taken as north: the frame is then turned by an unknown angle, constant over the log.

use crate::magnetic::heading::{LevelField, tilt_compensated};
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_observation::{ImuSample, MagneticSample};
use serde::{Deserialize, Serialize};

/// Deviation of the specific force, m/s², and rate, rad/s, above which a body is not at rest.
///
/// A foot that bears weight sways by less than 0.5 m/s² and 0.3 rad/s; a step reaches 20 times that.
const REST_FORCE_M_S2: f64 = 1.0;
const REST_RATE_RAD_S: f64 = 0.5;
/// Spread of the rate, rad/s, below which a body is so quiet that the mean rate is the bias of the gyro: a standing
/// person sways by more, a tag that lies or a foot that is planted firmly by less.
const QUIET_RATE_RAD_S: f64 = 0.007;
/// Largest mean rate that can be a bias (3 °/s), rad/s.
const LARGEST_BIAS_RAD_S: f64 = 0.052;

/// Running means of the samples at the start of a log.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RestAlignment {
    samples: u32,
    force_sum: Vector3<f64>,
    force_squared_sum: f64,
    rate_sum: Vector3<f64>,
    rate_squared_sum: f64,
    fields: u32,
    field_sum: Vector3<f64>,
}

/// Outcome of an alignment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aligned {
    /// Body to local level.
    pub attitude: Attitude,
    /// Length of the mean specific force, m/s².
    pub force_m_s2: f64,
    /// Mean rate of a quiet rest, which is the gyro's bias, rad/s; zero when the rest was not quiet.
    pub gyro_bias_rad_s: Vector3<f64>,
    /// True when the body was at rest.
    pub at_rest: bool,
    /// The magnetic field that gave the heading; `None` without a magnetometer, where x counts as north.
    pub field: Option<LevelField>,
}

impl RestAlignment {
    /// Takes one IMU sample.
    pub fn observe_imu(&mut self, imu: &ImuSample) {
        self.samples += 1;
        self.force_sum += imu.specific_force_m_s2;
        self.force_squared_sum += imu.specific_force_m_s2.norm_squared();
        self.rate_sum += imu.angular_rate_rad_s;
        self.rate_squared_sum += imu.angular_rate_rad_s.norm_squared();
    }

    /// Takes one magnetometer sample.
    pub fn observe_magnetic(&mut self, magnetic: &MagneticSample) {
        self.fields += 1;
        self.field_sum += magnetic.field_ut;
    }

    /// Mean specific force of what was seen, m/s².
    pub fn mean_force_m_s2(&self) -> Vector3<f64> {
        self.force_sum / f64::from(self.samples.max(1))
    }

    /// Attitude from what was seen; `None` without a usable specific force.
    ///
    /// `declination_rad` is the angle from true to magnetic north, positive to the east.
    pub fn align(&self, declination_rad: f64) -> Option<Aligned> {
        let count = f64::from(self.samples.max(1));
        let force = self.mean_force_m_s2();
        let variance = (self.force_squared_sum / count - force.norm_squared()).max(0.0);
        let deviation = libm::sqrt(variance);
        let rate = libm::sqrt(self.rate_squared_sum / count);
        let mean_rate = self.rate_sum / count;
        let rate_spread = libm::sqrt((self.rate_squared_sum / count - mean_rate.norm_squared()).max(0.0));
        let quiet = rate_spread < QUIET_RATE_RAD_S && mean_rate.amax() < LARGEST_BIAS_RAD_S;

        let mean_field = self.field_sum / f64::from(self.fields.max(1));
        let compass = tilt_compensated(&force, &mean_field, declination_rad);
        Some(Aligned {
            attitude: match &compass {
                Some(compass) => compass.attitude,
                None => attitude::level(&force, 0.0)?,
            },
            force_m_s2: libm::sqrt(force.norm_squared()),
            gyro_bias_rad_s: if quiet { mean_rate } else { Vector3::zeros() },
            at_rest: deviation < REST_FORCE_M_S2 && rate < REST_RATE_RAD_S,
            field: compass.map(|compass| compass.field),
        })
    }
}
