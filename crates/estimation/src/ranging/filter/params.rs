//! Settings of the filter.

use super::gate::GateParams;
use crate::methods::NoiseParameter;
use crate::settings::{first_unusable, not_negative, positive};
use serde::{Deserialize, Serialize};

/// Settings of [`RangeFilter`](super::RangeFilter), but for the weighting.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FilterParams {
    /// How people move.
    pub motion: MotionParams,
    /// At what height they are.
    pub height: HeightParams,
    /// How ranges err.
    pub errors: ErrorParams,
    /// Dead reckoning, where there is one.
    pub reckoning: ReckoningParams,
    /// What keeps wrong ranges out.
    pub gate: GateParams,
    /// The beginning.
    pub start: StartParams,
}

/// How people move on the level.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MotionParams {
    /// Standard deviation of the velocity on each level axis, m/s.
    pub speed_m_s: f64,
    /// Time over which a velocity is kept, s.
    pub steady_s: f64,
}

/// Height of the tag.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HeightParams {
    /// Its mean in the frame of the anchors, m; absent: [`Self::below_anchors_m`] below the mean of the anchors that are heard.
    pub height_m: Option<f64>,
    /// Standard deviation about the mean, m; 0 where it is known, kilometres where it is free.
    pub sigma_m: f64,
    /// Standard deviation of its rate, m/s.
    pub climb_m_s: f64,
    /// How far below the anchors tags are where no height is told, m.
    pub below_anchors_m: f64,
}

/// How ranges err: noise, an error of each anchor that passes (people, machines and walls near the path), one of each anchor that stays,
/// and one that all have in common (the antenna of the tag).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ErrorParams {
    /// What is left of the error of a range as noise where it is all taken for one that passes, m.
    pub least_sigma_m: f64,
    /// Error that passes, standard deviation, m.
    pub passing_sigma_m: f64,
    /// Time over which it passes, s.
    pub correlation_s: f64,
    /// Offset of an anchor beside the common one, standard deviation, m.
    pub anchor_offset_sigma_m: f64,
    /// Time over which such an offset changes, s.
    pub offset_s: f64,
    /// Offset that all anchors have in common, standard deviation, m.
    pub common_offset_sigma_m: f64,
}

/// How dead reckoning errs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReckoningParams {
    /// By how much its path may be turned, standard deviation at the start, deg.
    pub heading_sigma_deg: f64,
    /// Random walk of that, deg/√s.
    pub heading_walk_deg_sqrt_s: f64,
    /// By what share its steps may be too long or too short, standard deviation.
    pub scale_sigma: f64,
    /// Error of a step that is of this step alone, share of its length.
    pub way_share: f64,
    /// Who does not walk still shifts about: m/√s.
    pub standing_m_sqrt_s: f64,
}

/// How places by a robust fit become a start, and a new start of a filter that is lost.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StartParams {
    /// Ranges of so long make one fit, s.
    pub window_s: f64,
    /// Fits in a row that have to agree.
    pub agreeing_fits: u32,
    /// Anchors that a fit needs.
    pub least_anchors: usize,
    /// How much better one of two places has to explain the ranges before the other is dropped: difference of the logarithms of their likelihoods.
    pub margin: f64,
    /// Standard deviation of the place at the start beside that of the fit, m.
    pub sigma_m: f64,
}

impl Default for MotionParams {
    fn default() -> Self {
        Self { speed_m_s: 1.4, steady_s: 4.0 }
    }
}

impl Default for HeightParams {
    fn default() -> Self {
        Self { height_m: None, sigma_m: 1.2, climb_m_s: 0.36, below_anchors_m: 1.0 }
    }
}

impl Default for ErrorParams {
    fn default() -> Self {
        Self {
            least_sigma_m: 0.04,
            passing_sigma_m: 0.07,
            correlation_s: 0.7,
            anchor_offset_sigma_m: 0.04,
            offset_s: 3600.0,
            common_offset_sigma_m: 0.3,
        }
    }
}

impl Default for ReckoningParams {
    fn default() -> Self {
        Self {
            heading_sigma_deg: 10.0,
            heading_walk_deg_sqrt_s: 0.3,
            scale_sigma: 0.1,
            way_share: 0.1,
            standing_m_sqrt_s: 0.05,
        }
    }
}

impl Default for StartParams {
    fn default() -> Self {
        Self { window_s: 0.5, agreeing_fits: 3, least_anchors: 3, margin: 10.0, sigma_m: 1.0 }
    }
}

/// A height that is known is known to this, m.
const KNOWN_M: f64 = 1e-3;

impl HeightParams {
    /// Mean where the anchors hang at a mean height, m.
    pub(super) fn mean_m(&self, hung_m: Option<f64>) -> Option<f64> {
        self.height_m.or_else(|| hung_m.map(|hung_m| hung_m - self.below_anchors_m))
    }

    pub(super) fn told_sigma_m(&self) -> f64 {
        self.sigma_m.max(KNOWN_M)
    }
}

impl FilterParams {
    /// What tuning may search.
    pub const NOISE: [NoiseParameter; 9] = [
        NoiseParameter::new("filter.motion.speed_m_s", 0.1, 10.0),
        NoiseParameter::new("filter.motion.steady_s", 0.1, 60.0),
        NoiseParameter::new("filter.height.sigma_m", 0.01, 100.0),
        NoiseParameter::new("filter.height.climb_m_s", 0.01, 10.0),
        NoiseParameter::new("ranges.sigma_m", 0.01, 2.0),
        NoiseParameter::new("filter.errors.passing_sigma_m", 0.001, 2.0),
        NoiseParameter::new("filter.errors.correlation_s", 0.01, 60.0),
        NoiseParameter::new("filter.errors.anchor_offset_sigma_m", 0.001, 2.0),
        NoiseParameter::new("filter.errors.common_offset_sigma_m", 0.001, 2.0),
    ];

    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let Self { motion, height, errors, reckoning, gate, start } = self;
        first_unusable(&[
            ("filter.motion.speed_m_s", positive(motion.speed_m_s)),
            ("filter.motion.steady_s", positive(motion.steady_s)),
            ("filter.height.height_m", height.height_m.is_none_or(f64::is_finite)),
            ("filter.height.sigma_m", not_negative(height.sigma_m)),
            ("filter.height.climb_m_s", positive(height.climb_m_s)),
            ("filter.height.below_anchors_m", height.below_anchors_m.is_finite()),
            ("filter.errors.least_sigma_m", positive(errors.least_sigma_m)),
            ("filter.errors.passing_sigma_m", not_negative(errors.passing_sigma_m)),
            ("filter.errors.correlation_s", positive(errors.correlation_s)),
            ("filter.errors.anchor_offset_sigma_m", not_negative(errors.anchor_offset_sigma_m)),
            ("filter.errors.offset_s", positive(errors.offset_s)),
            ("filter.errors.common_offset_sigma_m", not_negative(errors.common_offset_sigma_m)),
            ("filter.reckoning.heading_sigma_deg", not_negative(reckoning.heading_sigma_deg)),
            ("filter.reckoning.heading_walk_deg_sqrt_s", not_negative(reckoning.heading_walk_deg_sqrt_s)),
            ("filter.reckoning.scale_sigma", not_negative(reckoning.scale_sigma)),
            ("filter.reckoning.way_share", not_negative(reckoning.way_share)),
            ("filter.reckoning.standing_m_sqrt_s", not_negative(reckoning.standing_m_sqrt_s)),
            ("filter.start.window_s", positive(start.window_s)),
            ("filter.start.agreeing_fits", start.agreeing_fits > 0),
            ("filter.start.least_anchors", start.least_anchors > 0),
            ("filter.start.margin", positive(start.margin)),
            ("filter.start.sigma_m", positive(start.sigma_m)),
        ])
        .or_else(|| gate.unusable())
    }
}
