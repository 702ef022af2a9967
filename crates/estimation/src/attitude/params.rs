//! Settings of the attitude estimator: one default for every wearer and every motion.

use adit_observation::ImuSpecification;
use serde::{Deserialize, Serialize};

/// Settings of [`super::AttitudeFilter`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AttitudeParams {
    /// Gravity at the site, m/s².
    pub gravity_m_s2: f64,
    /// Angle from true to magnetic north, positive to the east, rad.
    pub declination_rad: f64,
    /// Time between corrections, s.
    pub interval_s: f64,
    /// Longest gap between samples that is integrated over, s.
    pub gap_s: f64,
    /// Velocity of the wearer: standard deviation of each component, m/s.
    pub velocity_m_s: f64,
    /// Time over which the velocity of the wearer is correlated, s.
    pub velocity_time_s: f64,
    /// Difference of the field at the place of the moment from the field of the site, standard deviation, µT.
    pub field_anomaly_ut: f64,
    /// Time over which that difference is correlated for a wearer on the move, s.
    pub field_anomaly_time_s: f64,
    /// Normalised innovation squared (3 degrees of freedom) from which on a measurement loses weight.
    pub innovation_bound: f64,
    /// Random errors of the sensors.
    pub noise: AttitudeNoise,
    /// Uncertainty at the start.
    pub initial: AttitudeInitialSigma,
    /// What counts as rest, and how well it holds.
    pub rest: RestParams,
    /// What counts as a disturbed field.
    pub disturbance: DisturbanceParams,
}

/// Random errors of the sensors, and how their slow errors walk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AttitudeNoise {
    /// Angle random walk, rad/√s.
    pub angle_random_walk_rad_sqrt_s: f64,
    /// Error of the rate as a share of it that changes with the motion (cross-axis, nonlinearity, sampling).
    pub rate_share: f64,
    /// Time over which that error is correlated, s.
    pub rate_share_time_s: f64,
    /// Gyro bias random walk, (rad/s)/√s; much more than at rest, since vibration and acceleration shift the bias.
    pub gyro_bias_walk_rad_s_sqrt_s: f64,
    /// Velocity random walk, (m/s)/√s.
    pub velocity_random_walk_m_s_sqrt_s: f64,
    /// Accelerometer bias random walk, (m/s²)/√s.
    pub acc_bias_walk_m_s2_sqrt_s: f64,
    /// Noise of one magnetometer sample, µT.
    pub field_ut: f64,
    /// Random walk of the offset that the body adds to the field, µT/√s.
    pub offset_walk_ut_sqrt_s: f64,
    /// Random walk of the field of the site, µT/√s.
    pub field_walk_ut_sqrt_s: f64,
}

/// Standard deviations at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AttitudeInitialSigma {
    /// Roll and pitch, rad.
    pub tilt_rad: f64,
    /// Heading without a magnetometer, rad: small, since the frame is defined by it.
    pub heading_rad: f64,
    /// Gyro bias, rad/s.
    pub gyro_bias_rad_s: f64,
    /// Gyro scale factor, a share.
    pub gyro_scale: f64,
    /// Accelerometer bias, m/s².
    pub acc_bias_m_s2: f64,
    /// Magnetometer offset that calibration left, µT.
    pub offset_ut: f64,
    /// Delay of the magnetometer against the gyro, s.
    pub delay_s: f64,
}

/// What counts as rest, and how well it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RestParams {
    /// Spread of the rate within an interval, rad/s.
    pub rate_spread_rad_s: f64,
    /// Largest mean rate that can be a bias, rad/s.
    pub largest_bias_rad_s: f64,
    /// Spread of the specific force within an interval and change from one to the next, m/s².
    pub force_spread_m_s2: f64,
    /// Time for which all of these must hold, s.
    pub after_s: f64,
    /// Standard deviation of the mean rate of an interval at rest, rad/s.
    pub rate_sigma_rad_s: f64,
    /// Standard deviation of the velocity at rest, m/s.
    pub velocity_sigma_m_s: f64,
}

/// What counts as a disturbed field.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DisturbanceParams {
    /// Deviation of the norm that is borne, as a share of it.
    pub norm_share: f64,
    /// Deviation of the dip that is borne, rad.
    pub dip_rad: f64,
    /// Time constant with which a past disturbance is forgotten, s.
    pub memory_s: f64,
    /// Weight lost by a deviation that is just borne: the variance grows by this factor times the deviation squared.
    pub doubt: f64,
    /// A disturbed field that stays the same for this long while the tag turns is a new offset or a new site, s.
    pub adopt_after_s: f64,
    /// How much it may vary meanwhile, µT.
    pub adopt_spread_ut: f64,
    /// Rate from which on the tag turns, rad/s.
    pub turning_rad_s: f64,
}

impl Default for AttitudeParams {
    fn default() -> Self {
        Self {
            gravity_m_s2: 9.81,
            declination_rad: 0.0,
            interval_s: 0.1,
            gap_s: 0.5,
            velocity_m_s: 0.5,
            velocity_time_s: 0.8,
            field_anomaly_ut: 1.2,
            field_anomaly_time_s: 3.0,
            innovation_bound: 16.0,
            noise: AttitudeNoise::default(),
            initial: AttitudeInitialSigma::default(),
            rest: RestParams::default(),
            disturbance: DisturbanceParams::default(),
        }
    }
}

impl Default for AttitudeNoise {
    fn default() -> Self {
        Self {
            angle_random_walk_rad_sqrt_s: 2e-4,
            rate_share: 0.01,
            rate_share_time_s: 0.1,
            gyro_bias_walk_rad_s_sqrt_s: 3e-4,
            velocity_random_walk_m_s_sqrt_s: 0.01,
            acc_bias_walk_m_s2_sqrt_s: 1e-4,
            field_ut: 1.0,
            offset_walk_ut_sqrt_s: 0.01,
            field_walk_ut_sqrt_s: 0.05,
        }
    }
}

impl Default for AttitudeInitialSigma {
    fn default() -> Self {
        Self {
            tilt_rad: 0.1,
            heading_rad: 0.01,
            gyro_bias_rad_s: 0.05,
            gyro_scale: 0.003,
            acc_bias_m_s2: 0.03,
            offset_ut: 1.0,
            delay_s: 0.01,
        }
    }
}

impl Default for RestParams {
    fn default() -> Self {
        Self {
            rate_spread_rad_s: 0.04,
            largest_bias_rad_s: 0.06,
            force_spread_m_s2: 0.3,
            after_s: 0.5,
            rate_sigma_rad_s: 0.001,
            velocity_sigma_m_s: 0.005,
        }
    }
}

impl Default for DisturbanceParams {
    fn default() -> Self {
        Self {
            norm_share: 0.1,
            dip_rad: 0.17,
            memory_s: 3.0,
            doubt: 16.0,
            adopt_after_s: 10.0,
            adopt_spread_ut: 6.0,
            turning_rad_s: 0.35,
        }
    }
}

impl AttitudeParams {
    /// With the noise that a data sheet or a calibration gives for the inertial sensor, as lower bounds: motion adds to it.
    #[must_use]
    pub fn with_specification(mut self, noise: &ImuSpecification) -> Self {
        let n = &mut self.noise;
        n.angle_random_walk_rad_sqrt_s =
            n.angle_random_walk_rad_sqrt_s.max(noise.angle_random_walk_rad_sqrt_s);
        n.velocity_random_walk_m_s_sqrt_s =
            n.velocity_random_walk_m_s_sqrt_s.max(noise.velocity_random_walk_m_s_sqrt_s);
        n.gyro_bias_walk_rad_s_sqrt_s = n.gyro_bias_walk_rad_s_sqrt_s.max(noise.gyro_bias_walk_rad_s_sqrt_s);
        n.acc_bias_walk_m_s2_sqrt_s = n.acc_bias_walk_m_s2_sqrt_s.max(noise.acc_bias_walk_m_s2_sqrt_s);
        self
    }

    /// Name of the first setting that cannot be used.
    pub fn unusable(&self) -> Option<&'static str> {
        let (n, i, r, d) = (&self.noise, &self.initial, &self.rest, &self.disturbance);
        let positive = [
            ("gravity_m_s2", self.gravity_m_s2),
            ("interval_s", self.interval_s),
            ("gap_s", self.gap_s),
            ("velocity_m_s", self.velocity_m_s),
            ("velocity_time_s", self.velocity_time_s),
            ("field_anomaly_ut", self.field_anomaly_ut),
            ("field_anomaly_time_s", self.field_anomaly_time_s),
            ("innovation_bound", self.innovation_bound),
            ("noise.field_ut", n.field_ut),
            ("initial.tilt_rad", i.tilt_rad),
            ("rest.rate_sigma_rad_s", r.rate_sigma_rad_s),
            ("rest.velocity_sigma_m_s", r.velocity_sigma_m_s),
            ("disturbance.norm_share", d.norm_share),
            ("disturbance.dip_rad", d.dip_rad),
            ("disturbance.memory_s", d.memory_s),
            ("disturbance.adopt_after_s", d.adopt_after_s),
            ("disturbance.adopt_spread_ut", d.adopt_spread_ut),
        ];
        let not_negative = [
            ("noise.angle_random_walk_rad_sqrt_s", n.angle_random_walk_rad_sqrt_s),
            ("noise.rate_share", n.rate_share),
            ("noise.rate_share_time_s", n.rate_share_time_s),
            ("noise.gyro_bias_walk_rad_s_sqrt_s", n.gyro_bias_walk_rad_s_sqrt_s),
            ("noise.velocity_random_walk_m_s_sqrt_s", n.velocity_random_walk_m_s_sqrt_s),
            ("noise.acc_bias_walk_m_s2_sqrt_s", n.acc_bias_walk_m_s2_sqrt_s),
            ("noise.offset_walk_ut_sqrt_s", n.offset_walk_ut_sqrt_s),
            ("noise.field_walk_ut_sqrt_s", n.field_walk_ut_sqrt_s),
            ("initial.heading_rad", i.heading_rad),
            ("initial.gyro_bias_rad_s", i.gyro_bias_rad_s),
            ("initial.gyro_scale", i.gyro_scale),
            ("initial.acc_bias_m_s2", i.acc_bias_m_s2),
            ("initial.offset_ut", i.offset_ut),
            ("initial.delay_s", i.delay_s),
            ("rest.rate_spread_rad_s", r.rate_spread_rad_s),
            ("rest.largest_bias_rad_s", r.largest_bias_rad_s),
            ("rest.force_spread_m_s2", r.force_spread_m_s2),
            ("rest.after_s", r.after_s),
            ("disturbance.doubt", d.doubt),
            ("disturbance.turning_rad_s", d.turning_rad_s),
        ];
        let bad = |floor: f64| move |(_, value): &&(&'static str, f64)| !value.is_finite() || *value < floor;
        let declination = [("declination_rad", self.declination_rad.abs())];
        positive
            .iter()
            .find(bad(f64::MIN_POSITIVE))
            .or_else(|| not_negative.iter().find(bad(0.0)))
            .or_else(|| declination.iter().find(bad(0.0)))
            .map(|(name, _)| *name)
    }
}
