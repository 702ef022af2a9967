//! Settings of `foot-ins`: one default for everybody, every value documented with its unit.

use crate::inertial::filter::SensorNoise;
use crate::pedestrian::stance::StanceParams;
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

/// Zero velocity of the foot in stance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ZeroVelocityParams {
    /// Standard deviation at rest, m/s.
    pub sigma_m_s: f64,
    /// Standard deviation per square root of the stance statistic, m/s.
    pub statistic_sigma_m_s: f64,
    /// Standard deviation of the lever to the point of contact around its estimate, m.
    pub lever_sigma_m: f64,
    /// Time between updates, s: motion of the foot is correlated over about this time.
    pub interval_s: f64,
    /// Time between updates of a foot that has been at rest for `rest_s`, s: nothing new is learned sooner.
    pub rest_interval_s: f64,
    /// Greatest normalised innovation squared (3 degrees of freedom) that is believed.
    pub gate_nis: f64,
    /// Time without an accepted update after which the gate opens, s: the gate cannot lock itself out.
    pub patience_s: f64,
    /// Stance statistic below which a stance is credible: a second one that is refused opens the gate.
    pub credible_statistic: f64,
    /// Time from the first refused credible stance to the one that opens the gate, s: longer than a stance.
    pub second_stance_s: f64,
    /// Stance statistic below which a foot is at rest, not only in stance.
    pub rest_statistic: f64,
    /// Time at rest after which the gate opens, s.
    pub rest_s: f64,
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

impl FootInsParams {
    /// These settings with the noise at rest of a particular sensor.
    #[must_use]
    pub fn with_specification(mut self, specification: &ImuSpecification) -> Self {
        self.noise.angle_random_walk_rad_sqrt_s = specification.angle_random_walk_rad_sqrt_s;
        self.noise.velocity_random_walk_m_s_sqrt_s = specification.velocity_random_walk_m_s_sqrt_s;
        self.noise.gyro_bias_walk_rad_s_sqrt_s = specification.gyro_bias_walk_rad_s_sqrt_s;
        self.noise.acc_bias_walk_m_s2_sqrt_s = specification.acc_bias_walk_m_s2_sqrt_s;
        self
    }

    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        let (z, n, i, s) = (&self.zero_velocity, &self.noise, &self.initial, &self.stance);
        let checks = [
            ("gravity_m_s2", positive(self.gravity_m_s2)),
            ("alignment_s", not_negative(self.alignment_s)),
            ("declination_rad", self.declination_rad.is_finite()),
            ("gap_s", positive(self.gap_s)),
            ("lost_after_s", positive(self.lost_after_s)),
            ("stance.window_s", not_negative(s.window_s)),
            ("stance.acc_scale_m_s2", positive(s.acc_scale_m_s2)),
            ("stance.gyro_scale_rad_s", positive(s.gyro_scale_rad_s)),
            ("stance.threshold", positive(s.threshold)),
            ("stance.reach_s", not_negative(s.reach_s)),
            ("stance.look_ahead_s", not_negative(s.look_ahead_s)),
            ("stance.gain", positive(s.gain)),
            ("stance.floor", positive(s.floor)),
            ("stance.ceiling", positive(s.ceiling)),
            ("noise.angle_random_walk_rad_sqrt_s", not_negative(n.angle_random_walk_rad_sqrt_s)),
            ("noise.rate_share_sqrt_s", not_negative(n.rate_share_sqrt_s)),
            ("noise.velocity_random_walk_m_s_sqrt_s", not_negative(n.velocity_random_walk_m_s_sqrt_s)),
            ("noise.force_share_sqrt_s", not_negative(n.force_share_sqrt_s)),
            ("noise.gyro_bias_walk_rad_s_sqrt_s", not_negative(n.gyro_bias_walk_rad_s_sqrt_s)),
            ("noise.acc_bias_walk_m_s2_sqrt_s", not_negative(n.acc_bias_walk_m_s2_sqrt_s)),
            ("noise.gyro_range_rad_s", positive(n.gyro_range_rad_s)),
            ("noise.clipped_rate_rad_sqrt_s", not_negative(n.clipped_rate_rad_sqrt_s)),
            ("initial.tilt_rad", positive(i.tilt_rad)),
            ("initial.heading_rad", positive(i.heading_rad)),
            ("initial.velocity_m_s", positive(i.velocity_m_s)),
            ("initial.position_m", positive(i.position_m)),
            ("initial.gyro_bias_rad_s", not_negative(i.gyro_bias_rad_s)),
            ("initial.acc_bias_m_s2", not_negative(i.acc_bias_m_s2)),
            ("initial.contact_m", not_negative(i.contact_m)),
            ("zero_velocity.sigma_m_s", positive(z.sigma_m_s)),
            ("zero_velocity.statistic_sigma_m_s", not_negative(z.statistic_sigma_m_s)),
            ("zero_velocity.lever_sigma_m", not_negative(z.lever_sigma_m)),
            ("zero_velocity.interval_s", not_negative(z.interval_s)),
            ("zero_velocity.rest_interval_s", not_negative(z.rest_interval_s)),
            ("zero_velocity.gate_nis", positive(z.gate_nis)),
            ("zero_velocity.patience_s", not_negative(z.patience_s)),
            ("zero_velocity.credible_statistic", not_negative(z.credible_statistic)),
            ("zero_velocity.second_stance_s", not_negative(z.second_stance_s)),
            ("zero_velocity.rest_statistic", not_negative(z.rest_statistic)),
            ("zero_velocity.rest_s", not_negative(z.rest_s)),
            ("zero_rate.statistic", not_negative(self.zero_rate.statistic)),
            ("zero_rate.interval_s", not_negative(self.zero_rate.interval_s)),
            ("zero_rate.sigma_rad_s", positive(self.zero_rate.sigma_rad_s)),
            ("zero_rate.rate_share", not_negative(self.zero_rate.rate_share)),
            ("rest_gravity.statistic", not_negative(self.rest_gravity.statistic)),
            ("rest_gravity.interval_s", not_negative(self.rest_gravity.interval_s)),
            ("rest_gravity.sigma_m_s2", positive(self.rest_gravity.sigma_m_s2)),
        ];
        checks.iter().find(|(_, usable)| !usable).map(|(name, _)| *name)
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

impl Default for SensorNoise {
    /// Found on recorded and simulated walks together (`docs/log.md`): larger than any data sheet, since the foot's
    /// own motion, not the sensor at rest, sets the errors.
    fn default() -> Self {
        Self {
            angle_random_walk_rad_sqrt_s: 6e-3,
            rate_share_sqrt_s: 3e-4,
            velocity_random_walk_m_s_sqrt_s: 7.5e-3,
            force_share_sqrt_s: 1.5e-3,
            gyro_bias_walk_rad_s_sqrt_s: 1e-5,
            acc_bias_walk_m_s2_sqrt_s: 1.6e-4,
            // ±500 °/s, the commonest full scale of foot-worn gyros.
            gyro_range_rad_s: 8.7266,
            clipped_rate_rad_sqrt_s: 1.8,
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

impl Default for ZeroVelocityParams {
    fn default() -> Self {
        Self {
            sigma_m_s: 0.1,
            statistic_sigma_m_s: 0.016,
            lever_sigma_m: 0.15,
            interval_s: 0.01,
            rest_interval_s: 0.02,
            gate_nis: 5.0,
            patience_s: 4.0,
            credible_statistic: 20.0,
            second_stance_s: 0.6,
            rest_statistic: 2.0,
            rest_s: 0.3,
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
