//! Settings of the step detectors: one default for every walker and every place of the tag.

use crate::settings::{first_unusable, not_negative, positive};
use serde::{Deserialize, Serialize};

/// Which detector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detector {
    /// Bumps in rhythm: adit's own.
    Gait,
    /// Zero crossings: system S1.
    ZeroCrossing,
}

/// Settings of [`super::StepDetector`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StepParams {
    /// Detector.
    pub detector: Detector,
    /// A gap longer than this ends a walk, s.
    pub gap_s: f64,
    /// Full width of the smoothing while nobody walks, s.
    pub smoothing_s: f64,
    /// The same on a walk, as a share of the time of a step: at 1 the second harmonic vanishes.
    pub smoothing_share: f64,
    /// A rise or fall smaller than this is no bump, m/s².
    pub hysteresis_m_s2: f64,
    /// Least time between two steps, s.
    pub shortest_s: f64,
    /// Greatest time between two steps, s.
    pub longest_s: f64,
    /// Height of the bumps that begin a walk, m/s².
    pub least_bump_m_s2: f64,
    /// Deviation of the time of a step from that of the same foot's step before, as a share, at the beginning of a walk.
    pub irregularity: f64,
    /// Ratio of the times of neighbouring steps there: a limp.
    pub limp: f64,
    /// Ratio of the heights of bumps of the same foot there.
    pub foot_ratio: f64,
    /// Ratio of the heights of any two bumps there: a tag in one pocket hears one foot the louder.
    pub largest_ratio: f64,
    /// On a walk a bump lower than this share of the mean is weak: a step only if the walk goes on.
    pub weak_share: f64,
    /// A bump earlier than this share of the time of a step belongs to the step before.
    pub early: f64,
    /// A bump later than this leaves room for a step that was not seen.
    pub late: f64,
    /// Steps that a walk may stay weak or silent before it is over.
    pub patience: f64,
    /// Height of the bump that begins the first step, as a share of the mean.
    pub first_share: f64,
    /// Height of the bump of the last step beside the standing foot, as a share of the mean.
    pub last_share: f64,
    /// Settings of the zero crossings.
    pub zero_crossing: ZeroCrossingParams,
}

/// Settings of [`super::zero_crossing::ZeroCrossing`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ZeroCrossingParams {
    /// Corner of the low-pass, Hz.
    pub low_pass_hz: f64,
    /// Time constant of the mean that is taken for gravity, s.
    pub gravity_time_s: f64,
    /// Height that must be reached between two crossings, m/s².
    pub threshold_m_s2: f64,
    /// Least time between two steps, s.
    pub shortest_s: f64,
}

impl Default for StepParams {
    fn default() -> Self {
        Self {
            detector: Detector::Gait,
            gap_s: 0.5,
            smoothing_s: 0.48,
            smoothing_share: 0.9,
            hysteresis_m_s2: 0.07,
            shortest_s: 0.27,
            longest_s: 1.2,
            least_bump_m_s2: 0.6,
            irregularity: 0.3,
            limp: 1.8,
            foot_ratio: 3.0,
            largest_ratio: 6.0,
            weak_share: 0.2,
            early: 0.5,
            late: 1.65,
            patience: 4.5,
            first_share: 0.05,
            last_share: 0.1,
            zero_crossing: ZeroCrossingParams::default(),
        }
    }
}

impl Default for ZeroCrossingParams {
    fn default() -> Self {
        Self { low_pass_hz: 3.0, gravity_time_s: 1.0, threshold_m_s2: 0.5, shortest_s: 0.25 }
    }
}

impl StepParams {
    /// Width of the smoothing on a walk with this time of a step (`None`: nobody walks), s.
    pub(super) fn width_s(&self, period_s: Option<f64>) -> f64 {
        period_s.map_or(self.smoothing_s, |period_s| self.smoothing_share * period_s)
    }

    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        let ratio = |value: f64| value.is_finite() && value >= 1.0;
        let crossing = &self.zero_crossing;
        first_unusable(&[
            ("steps.gap_s", positive(self.gap_s) && self.gap_s <= 10.0),
            ("steps.smoothing_s", positive(self.smoothing_s)),
            ("steps.smoothing_share", positive(self.smoothing_share)),
            ("steps.hysteresis_m_s2", positive(self.hysteresis_m_s2)),
            ("steps.shortest_s", positive(self.shortest_s)),
            ("steps.longest_s", self.longest_s > self.shortest_s && self.longest_s <= 5.0),
            ("steps.least_bump_m_s2", not_negative(self.least_bump_m_s2)),
            ("steps.irregularity", not_negative(self.irregularity)),
            ("steps.limp", ratio(self.limp)),
            ("steps.foot_ratio", ratio(self.foot_ratio)),
            ("steps.largest_ratio", ratio(self.largest_ratio)),
            ("steps.weak_share", not_negative(self.weak_share)),
            ("steps.early", not_negative(self.early) && self.early < 1.0),
            ("steps.late", ratio(self.late)),
            ("steps.patience", (1.0..=20.0).contains(&self.patience)),
            ("steps.first_share", not_negative(self.first_share)),
            ("steps.last_share", not_negative(self.last_share)),
            ("steps.zero_crossing.low_pass_hz", (0.1..=10.0).contains(&crossing.low_pass_hz)),
            ("steps.zero_crossing.gravity_time_s", positive(crossing.gravity_time_s)),
            ("steps.zero_crossing.threshold_m_s2", not_negative(crossing.threshold_m_s2)),
            ("steps.zero_crossing.shortest_s", positive(crossing.shortest_s)),
        ])
    }
}
