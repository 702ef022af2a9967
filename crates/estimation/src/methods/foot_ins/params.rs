//! Settings of `foot-ins`: one default for everybody, every value documented with its unit.

use crate::inertial::filter::SensorNoise;
use crate::methods::NoiseParameter;
use crate::methods::foot_input::Site;
use crate::pedestrian::stance::StanceParams;
use crate::pedestrian::stance_updates::ZeroVelocityParams;
use crate::settings::{first_unusable, not_negative, positive};
use adit_core::nalgebra::Vector3;
use adit_observation::ImuSpecification;
use serde::{Deserialize, Serialize};

/// Settings of [`super::FootIns`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FootInsParams {
    /// Gravity at the site, m/s².
    pub gravity_m_s2: f64,
    /// Time at the start of the log over which the sensor is levelled, s.
    pub alignment_s: f64,
    /// Angle from true to magnetic north, positive to the east, rad; used where the log has a magnetometer.
    pub declination_rad: f64,
    /// Longest gap between samples that is integrated over, s; after a longer one the walker counts as lost.
    pub gap_s: f64,
    /// Time without an accepted zero-velocity update after which the walker counts as lost, s.
    pub lost_after_s: f64,
    /// Stance detector.
    pub stance: StanceParams,
    /// Sensor errors.
    pub noise: SensorNoise,
    /// Uncertainty at the start.
    pub initial: InitialSigma,
    /// Zero velocity in stance.
    pub zero_velocity: ZeroVelocityParams,
    /// Zero angular rate in stance.
    pub zero_rate: ZeroRateParams,
    /// Gravity as tilt reference at rest.
    pub rest_gravity: RestGravityParams,
    /// Help for the heading that no inertial sensor observes.
    pub heading_aid: HeadingAid,
}

/// Standard deviations at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InitialSigma {
    /// Roll and pitch, rad.
    pub tilt_rad: f64,
    /// Heading, rad: small, since the frame is defined by it.
    pub heading_rad: f64,
    /// Velocity, m/s.
    pub velocity_m_s: f64,
    /// Position, m: small, since the origin is defined by it.
    pub position_m: f64,
    /// Gyro turn-on bias, rad/s.
    pub gyro_bias_rad_s: f64,
    /// Accelerometer bias, m/s².
    pub acc_bias_m_s2: f64,
    /// Lever from the point of contact to the sensor, m.
    pub contact_m: f64,
}

/// Zero angular rate of the foot in stance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ZeroRateParams {
    /// Stance statistic below which the update is made.
    pub statistic: f64,
    /// Time between updates, s.
    pub interval_s: f64,
    /// Standard deviation at rest, rad/s.
    pub sigma_rad_s: f64,
    /// Standard deviation as a share of the measured rate.
    pub rate_share: f64,
}

/// Tilt update from gravity at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RestGravityParams {
    /// Stance statistic below which the update is made.
    pub statistic: f64,
    /// Time between updates, s.
    pub interval_s: f64,
    /// Standard deviation, m/s².
    pub sigma_m_s2: f64,
}

/// What helps the heading; off by default, since both are guesses about the walker.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum HeadingAid {
    /// None.
    #[default]
    None,
    /// Heuristic drift elimination (Borenstein & Ojeda 2010): strides that go on within a few degrees of the ones
    /// before are taken to be straight. Right in roadways, wrong on wide curves.
    StraightLegs,
}

/// What tuning may search beside [`foot_input::NOISE`](crate::methods::foot_input::NOISE).
pub(super) const NOISE: [NoiseParameter; 3] = [
    // Turn-on bias from a tactical sensor's to a cheap one's in the cold; the sensor on a toe or above the ankle.
    NoiseParameter::new("initial.gyro_bias_rad_s", 1e-6, 0.1),
    NoiseParameter::new("initial.acc_bias_m_s2", 1e-3, 1.0),
    NoiseParameter::new("initial.contact_m", 1e-2, 0.5),
];

impl FootInsParams {
    /// These settings with the noise at rest of a particular sensor.
    #[must_use]
    pub fn with_specification(mut self, specification: &ImuSpecification) -> Self {
        self.noise = self.noise.with_specification(specification);
        self
    }

    /// What the alignment needs to know.
    pub(super) fn site(&self) -> Site {
        Site {
            gravity_m_s2: self.gravity_m_s2,
            alignment_s: self.alignment_s,
            declination_rad: self.declination_rad,
        }
    }

    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let own = [
            ("gravity_m_s2", positive(self.gravity_m_s2)),
            ("alignment_s", not_negative(self.alignment_s)),
            ("declination_rad", self.declination_rad.is_finite()),
            ("gap_s", positive(self.gap_s)),
            ("lost_after_s", positive(self.lost_after_s)),
        ];
        first_unusable(&own)
            .or_else(|| self.stance.unusable())
            .or_else(|| self.noise.unusable())
            .or_else(|| self.initial.unusable())
            .or_else(|| self.zero_velocity.unusable())
            .or_else(|| self.zero_rate.unusable())
            .or_else(|| self.rest_gravity.unusable())
    }
}

impl InitialSigma {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("initial.tilt_rad", positive(self.tilt_rad)),
            ("initial.heading_rad", positive(self.heading_rad)),
            ("initial.velocity_m_s", positive(self.velocity_m_s)),
            ("initial.position_m", positive(self.position_m)),
            ("initial.gyro_bias_rad_s", not_negative(self.gyro_bias_rad_s)),
            ("initial.acc_bias_m_s2", not_negative(self.acc_bias_m_s2)),
            ("initial.contact_m", not_negative(self.contact_m)),
        ])
    }
}

impl ZeroRateParams {
    /// The more a resting gyro reads beside its bias, the less that is worth, for people sway.
    #[inline]
    pub fn sigma_rad_s(&self, rate_rad_s: &Vector3<f64>) -> f64 {
        let sway = self.rate_share * self.rate_share * rate_rad_s.norm_squared();
        libm::sqrt(self.sigma_rad_s * self.sigma_rad_s + sway)
    }

    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("zero_rate.statistic", not_negative(self.statistic)),
            ("zero_rate.interval_s", not_negative(self.interval_s)),
            ("zero_rate.sigma_rad_s", positive(self.sigma_rad_s)),
            ("zero_rate.rate_share", not_negative(self.rate_share)),
        ])
    }
}

impl RestGravityParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("rest_gravity.statistic", not_negative(self.statistic)),
            ("rest_gravity.interval_s", not_negative(self.interval_s)),
            ("rest_gravity.sigma_m_s2", positive(self.sigma_m_s2)),
        ])
    }
}

impl Default for FootInsParams {
    fn default() -> Self {
        Self {
            gravity_m_s2: 9.80665,
            alignment_s: 0.5,
            declination_rad: 0.0,
            gap_s: 0.25,
            lost_after_s: 10.0,
            stance: StanceParams::default(),
            noise: SensorNoise::default(),
            initial: InitialSigma::default(),
            zero_velocity: ZeroVelocityParams::default(),
            zero_rate: ZeroRateParams::default(),
            rest_gravity: RestGravityParams::default(),
            heading_aid: HeadingAid::None,
        }
    }
}

impl Default for InitialSigma {
    fn default() -> Self {
        Self {
            tilt_rad: 0.04,
            heading_rad: 1e-3,
            velocity_m_s: 0.01,
            position_m: 1e-4,
            gyro_bias_rad_s: 2.2e-3,
            acc_bias_m_s2: 0.3,
            contact_m: 0.2,
        }
    }
}

impl Default for ZeroRateParams {
    fn default() -> Self {
        Self { statistic: 0.16, interval_s: 0.01, sigma_rad_s: 5e-4, rate_share: 0.9 }
    }
}

impl Default for RestGravityParams {
    fn default() -> Self {
        Self { statistic: 0.1, interval_s: 0.1, sigma_m_s2: 0.2 }
    }
}
