//! Settings of `pdr`: one default for every walker and every place of the tag.

use crate::attitude::AttitudeParams;
use crate::methods::NoiseParameter;
use crate::pedestrian::step_length::StepLength;
use crate::pedestrian::steps::StepParams;
use crate::radio::RadioSite;
use crate::radio::locator::LocatorParams;
use crate::radio::scan::ScanParams;
use crate::settings::{first_unusable, not_negative, positive};
use adit_observation::StartPose;
use alloc::sync::Arc;
use serde::{Deserialize, Serialize};

/// How the direction of the walk follows from the attitude of the tag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// The body's x axis points forward: the sidecar of the log declares how the tag is mounted.
    Mounted,
    /// The tag is held somehow, but held the same: what is between its x axis and forward is unknown and constant; fixes tell.
    #[default]
    Held,
    /// As `held`, and forward lies along the axis in which the specific force varies the most; backward is not told from it.
    PrincipalAxis,
}

/// Settings of [`super::Pdr`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PdrParams {
    /// The attitude estimator.
    pub attitude: AttitudeParams,
    /// The step detector.
    pub steps: StepParams,
    /// Length of a step.
    pub length: StepLength,
    /// Forward from attitude.
    pub direction: Direction,
    /// Pose at the first sample, where somebody knows it.
    pub start: Option<StartPose>,
    /// Random errors.
    pub noise: PdrNoise,
    /// What is made of position fixes.
    pub fixes: FixParams,
    /// How fixes are made of signal strengths.
    pub radio: PdrRadio,
    /// The radio of the site.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
}

/// How fixes are made of signal strengths, where something is known of the radio of the site.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PdrRadio {
    /// False: signal strengths are left.
    pub used: bool,
    /// How signals are gathered.
    pub scan: ScanParams,
    /// How positions are made of them.
    pub locator: LocatorParams,
    /// Way over which errors of positions are alike (down to 1/e), at least, m.
    pub correlation_m: f64,
    /// The same as a multiple of their own standard deviation, where that is more.
    pub correlation_sigmas: f64,
    /// Time over which they are alike, s.
    pub correlation_s: f64,
}

/// Random errors of a walk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PdrNoise {
    /// Length of one step, standard deviation, as a share of it.
    pub step_share: f64,
    /// The same of a step that was not seen.
    pub unseen_share: f64,
    /// Factor between the model of the length and the person, standard deviation about 1 at the start.
    pub factor_sigma: f64,
    /// Its random walk, per √m walked.
    pub factor_walk_sqrt_m: f64,
    /// Direction of one step, standard deviation, rad.
    pub step_direction_rad: f64,
    /// Direction of a mounted tag against forward, standard deviation at the start, rad.
    pub mounting_rad: f64,
    /// Random walk of that direction (the tag slips, the hand turns), rad/√m walked.
    pub direction_walk_rad_sqrt_m: f64,
    /// Time over which the heading of a magnetometer is off in the same way, s.
    pub magnetic_time_s: f64,
    /// Who does not walk still shifts about: m/√s.
    pub standing_m_sqrt_s: f64,
    /// Speed over a gap in the log, standard deviation, m/s.
    pub gap_speed_m_s: f64,
    /// Direction of one principal axis, standard deviation, rad.
    pub principal_axis_rad: f64,
}

/// What is made of position fixes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FixParams {
    /// False: dead reckoning alone, fixes are counted and left.
    pub used: bool,
    /// A fix whose normalised innovation squared exceeds this pulls no more than one at it, once the position is nearly as well
    /// known as the fix.
    pub nis_bound: f64,
    /// Time after the last fix for which a position counts as held by it, s.
    pub hold_s: f64,
}

impl Default for PdrParams {
    fn default() -> Self {
        Self {
            // A correction costs as much as forty samples, and a step lasts half a second.
            attitude: AttitudeParams { interval_s: 0.2, ..AttitudeParams::default() },
            steps: StepParams::default(),
            length: StepLength::default(),
            direction: Direction::default(),
            start: None,
            noise: PdrNoise::default(),
            fixes: FixParams::default(),
            radio: PdrRadio::default(),
            site: None,
        }
    }
}

impl Default for PdrNoise {
    fn default() -> Self {
        Self {
            step_share: 0.08,
            unseen_share: 0.5,
            factor_sigma: 0.12,
            factor_walk_sqrt_m: 0.003,
            step_direction_rad: 0.07,
            mounting_rad: 0.17,
            direction_walk_rad_sqrt_m: 0.005,
            magnetic_time_s: 30.0,
            standing_m_sqrt_s: 0.05,
            gap_speed_m_s: 1.0,
            principal_axis_rad: 0.5,
        }
    }
}

impl Default for PdrRadio {
    fn default() -> Self {
        Self {
            used: true,
            // Three seconds of packets, or the scans that there are in them: the filter itself averages what is longer ago.
            scan: ScanParams { averaged: 6, longest_s: 3.0, ..ScanParams::default() },
            locator: LocatorParams::default(),
            // Shadowing is alike over some metres. The rest belongs to the place: an error ends where other transmitters are near,
            // and that is about as far as it is large.
            correlation_m: 3.0,
            correlation_sigmas: 1.0,
            correlation_s: 120.0,
        }
    }
}

impl Default for FixParams {
    fn default() -> Self {
        // χ² of two degrees of freedom: exceeded by 1 of 3000 good fixes.
        Self { used: true, nis_bound: 16.0, hold_s: 30.0 }
    }
}

/// What tuning may search.
pub(super) const NOISE: [NoiseParameter; 15] = [
    // Of a drill on level ground, and of somebody who stumbles.
    NoiseParameter::new("noise.step_share", 1e-2, 0.5),
    NoiseParameter::new("noise.unseen_share", 5e-2, 1.0),
    NoiseParameter::new("noise.factor_sigma", 1e-2, 0.5),
    NoiseParameter::new("noise.factor_walk_sqrt_m", 1e-5, 0.1),
    NoiseParameter::new("noise.step_direction_rad", 5e-3, 1.0),
    // On a belt, and loose in a pocket.
    NoiseParameter::new("noise.mounting_rad", 1e-2, 1.5),
    NoiseParameter::new("noise.direction_walk_rad_sqrt_m", 1e-5, 0.3),
    NoiseParameter::new("noise.magnetic_time_s", 1.0, 600.0),
    NoiseParameter::new("noise.standing_m_sqrt_s", 1e-3, 0.5),
    NoiseParameter::new("noise.principal_axis_rad", 5e-2, 1.5),
    // What of the attitude decides about the heading.
    NoiseParameter::new("attitude.velocity_m_s", 5e-2, 3.0),
    NoiseParameter::new("attitude.field_anomaly_ut", 0.1, 20.0),
    NoiseParameter::new("attitude.field_anomaly_time_s", 0.3, 60.0),
    NoiseParameter::new("attitude.noise.gyro_bias_walk_rad_s_sqrt_s", 1e-7, 1e-2),
    NoiseParameter::new("attitude.initial.gyro_bias_rad_s", 1e-4, 0.2),
];

impl PdrParams {
    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let noise = &self.noise;
        let own = first_unusable(&[
            ("start", self.start.is_none_or(|start| start.is_usable())),
            ("noise.step_share", not_negative(noise.step_share)),
            ("noise.unseen_share", not_negative(noise.unseen_share)),
            ("noise.factor_sigma", not_negative(noise.factor_sigma) && noise.factor_sigma <= 0.5),
            ("noise.factor_walk_sqrt_m", not_negative(noise.factor_walk_sqrt_m)),
            ("noise.step_direction_rad", not_negative(noise.step_direction_rad)),
            ("noise.mounting_rad", not_negative(noise.mounting_rad)),
            ("noise.direction_walk_rad_sqrt_m", not_negative(noise.direction_walk_rad_sqrt_m)),
            ("noise.magnetic_time_s", positive(noise.magnetic_time_s)),
            ("noise.standing_m_sqrt_s", not_negative(noise.standing_m_sqrt_s)),
            ("noise.gap_speed_m_s", not_negative(noise.gap_speed_m_s)),
            ("noise.principal_axis_rad", positive(noise.principal_axis_rad)),
            ("fixes.nis_bound", positive(self.fixes.nis_bound)),
            ("fixes.hold_s", not_negative(self.fixes.hold_s)),
            ("radio.correlation_m", positive(self.radio.correlation_m)),
            ("radio.correlation_sigmas", not_negative(self.radio.correlation_sigmas)),
            ("radio.correlation_s", positive(self.radio.correlation_s)),
        ]);
        own.or_else(|| self.attitude.unusable())
            .or_else(|| self.steps.unusable())
            .or_else(|| self.length.unusable())
    }
}
