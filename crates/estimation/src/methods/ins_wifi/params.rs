//! Settings of both methods.

use crate::methods::NoiseParameter;
use crate::settings::{first_unusable, not_negative, positive};
use adit_observation::{ImuSpecification, Site, StartPose};
use serde::{Deserialize, Serialize};

/// Settings of the reduced and of the full method; the defaults are those of system S0 (Luo & Yang 2015).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct InsWifiParams {
    /// Where the origin of fixes and solutions lies. Needed: a sidecar or the configuration gives it.
    pub site: Option<Site>,
    /// Pose at the first inertial sample. Needed: neither gyro nor accelerometer knows a heading.
    pub start: Option<StartPose>,
    /// Noise of the inertial sensor.
    pub noise: ImuSpecification,
    /// Gyro bias at the start, σ, rad/s.
    pub gyro_bias_sigma_rad_s: f64,
    /// Accelerometer bias at the start, σ, m/s².
    pub acc_bias_sigma_m_s2: f64,
    /// Gyro scale factor error, σ (full method).
    pub gyro_scale_sigma: f64,
    /// Velocity at the start, σ about zero, m/s.
    pub velocity_sigma_m_s: f64,
    /// How well the height of the level is known, σ, m (full method; a height in a fix says more).
    pub level_sigma_m: f64,
    /// A fix whose normalised innovation squared exceeds this pulls no more than one at it, once the position is nearly as well
    /// known as the fix (ten times its standard deviation).
    pub fix_nis_bound: f64,
    /// False: dead reckoning alone, fixes are counted and left.
    pub use_fixes: bool,
    /// Longest interval that is integrated over, s.
    pub gap_s: f64,
    /// Over a longer one: speed, σ, m/s.
    pub gap_speed_m_s: f64,
    /// And rate of turn, σ, rad/s.
    pub gap_turn_rad_s: f64,
}

impl Default for InsWifiParams {
    fn default() -> Self {
        Self {
            site: None,
            start: None,
            noise: ImuSpecification {
                // 0.01 °/√h and 50 µg/√Hz: see docs/methods/reduced-ins-wifi.md.
                angle_random_walk_rad_sqrt_s: 2.909e-6,
                velocity_random_walk_m_s_sqrt_s: 4.903e-4,
                gyro_bias_walk_rad_s_sqrt_s: 0.0,
                acc_bias_walk_m_s2_sqrt_s: 0.0,
            },
            // 0.1 °/h and 1e-4 g.
            gyro_bias_sigma_rad_s: 4.848e-7,
            acc_bias_sigma_m_s2: 9.807e-4,
            gyro_scale_sigma: 1e-4,
            velocity_sigma_m_s: 1e-3,
            level_sigma_m: 0.1,
            // χ² of two degrees of freedom: exceeded by 1 of 3000 good fixes.
            fix_nis_bound: 16.0,
            use_fixes: true,
            gap_s: 0.5,
            gap_speed_m_s: 1.0,
            gap_turn_rad_s: 0.5,
        }
    }
}

/// What tuning may search of both methods.
pub(super) const NOISE: [NoiseParameter; 5] = [
    // From 0.0003 deg/sqrt(h) and 0.1 µg/sqrt(Hz), which no tag has, to the cheapest sensors.
    NoiseParameter::new("noise.angle_random_walk_rad_sqrt_s", 1e-7, 5e-2),
    NoiseParameter::new("noise.velocity_random_walk_m_s_sqrt_s", 1e-6, 1e-1),
    // From 0.002 deg/h and 1 µg to a cheap sensor's in the cold.
    NoiseParameter::new("gyro_bias_sigma_rad_s", 1e-8, 0.1),
    NoiseParameter::new("acc_bias_sigma_m_s2", 1e-5, 1.0),
    // At rest, and told from a walker's stride.
    NoiseParameter::new("velocity_sigma_m_s", 1e-4, 1.0),
];

/// What tuning may search of the full method beside that.
pub(super) const FULL_NOISE: [NoiseParameter; 2] =
    [NoiseParameter::new("gyro_scale_sigma", 1e-6, 3e-2), NoiseParameter::new("level_sigma_m", 1e-3, 3.0)];

impl InsWifiParams {
    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("site", self.site.is_some_and(|site| site.point().is_some())),
            ("start", self.start.is_some_and(|start| start.is_usable())),
            ("noise.angle_random_walk_rad_sqrt_s", not_negative(self.noise.angle_random_walk_rad_sqrt_s)),
            (
                "noise.velocity_random_walk_m_s_sqrt_s",
                not_negative(self.noise.velocity_random_walk_m_s_sqrt_s),
            ),
            ("noise.gyro_bias_walk_rad_s_sqrt_s", not_negative(self.noise.gyro_bias_walk_rad_s_sqrt_s)),
            ("noise.acc_bias_walk_m_s2_sqrt_s", not_negative(self.noise.acc_bias_walk_m_s2_sqrt_s)),
            ("gyro_bias_sigma_rad_s", not_negative(self.gyro_bias_sigma_rad_s)),
            ("acc_bias_sigma_m_s2", not_negative(self.acc_bias_sigma_m_s2)),
            ("gyro_scale_sigma", not_negative(self.gyro_scale_sigma)),
            ("velocity_sigma_m_s", not_negative(self.velocity_sigma_m_s)),
            ("level_sigma_m", positive(self.level_sigma_m)),
            ("fix_nis_bound", positive(self.fix_nis_bound)),
            ("gap_s", positive(self.gap_s)),
            ("gap_speed_m_s", not_negative(self.gap_speed_m_s)),
            ("gap_turn_rad_s", not_negative(self.gap_turn_rad_s)),
        ])
    }
}
