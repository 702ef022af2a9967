//! When the velocity of a standing foot is asked for, and when the answer is believed.
//!
//! A foot lifted slowly and evenly looks still to every detector; the filter knows that it moves and refuses (a gate on
//! the normalised innovation). The gate cannot lock itself out: it opens when a second credible stance in a row is
//! refused, after real rest, or after some time without an accepted update.

use crate::kalman::Innovation;
use crate::pedestrian::stance::Stance;
use crate::settings::{first_unusable, not_negative, positive};
use serde::{Deserialize, Serialize};

/// Stands for "never"; finite, so that a snapshot survives every format.
pub const LONG_AGO_S: f64 = 1e9;
/// Slack on the time between updates, so that jitter of the stamps does not skip one, s.
pub const SLACK_S: f64 = 0.001;

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

/// Memory of the zero-velocity updates of one foot.
#[expect(clippy::struct_field_names, reason = "all four are times, with their unit")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StanceUpdates {
    /// Time since the last update that was tried, and since the last that was accepted, s.
    since_update_s: f64,
    since_accepted_s: f64,
    /// Time since the first credible stance that the gate refused, none since the last accepted one, s.
    since_refused_s: Option<f64>,
    /// Time at rest, s.
    at_rest_s: f64,
}

impl Default for StanceUpdates {
    fn default() -> Self {
        Self { since_update_s: LONG_AGO_S, since_accepted_s: 0.0, since_refused_s: None, at_rest_s: 0.0 }
    }
}

impl StanceUpdates {
    /// Time goes on.
    #[inline]
    pub fn advance(&mut self, interval_s: f64) {
        self.since_update_s += interval_s;
        self.since_accepted_s += interval_s;
        self.since_refused_s = self.since_refused_s.map(|since| since + interval_s);
    }

    /// Takes the stance of a sample, `interval_s` after the one before.
    #[inline]
    pub fn observe(&mut self, stance: &Stance, interval_s: f64, z: &ZeroVelocityParams) {
        self.at_rest_s = if stance.statistic < z.rest_statistic { self.at_rest_s + interval_s } else { 0.0 };
    }

    /// True when the foot has been at rest for a while.
    #[inline]
    pub fn is_resting(&self, z: &ZeroVelocityParams) -> bool {
        self.at_rest_s >= z.rest_s
    }

    /// Time since the last accepted update, s.
    pub fn since_accepted_s(&self) -> f64 {
        self.since_accepted_s
    }

    /// Nothing is known over a gap: the gate opens.
    pub fn cross_gap(&mut self) {
        self.since_accepted_s = LONG_AGO_S;
        self.at_rest_s = 0.0;
    }

    /// The gate of the update that is due now, infinite when it is open; `None` when none is due.
    ///
    /// A foot at rest for a while says nothing new and is asked less often.
    #[inline]
    pub fn due(&mut self, stance: &Stance, z: &ZeroVelocityParams) -> Option<f64> {
        let resting = self.is_resting(z);
        if self.since_update_s < if resting { z.rest_interval_s } else { z.interval_s } - SLACK_S {
            return None;
        }
        self.since_update_s = 0.0;
        // Two stances in a row that the state denies: the state is wrong, not the foot.
        let credible = stance.statistic < z.credible_statistic;
        let second_refused = credible && self.since_refused_s.is_some_and(|since| since > z.second_stance_s);
        let gate_open = second_refused || resting || self.since_accepted_s > z.patience_s;
        Some(if gate_open { f64::INFINITY } else { z.gate_nis })
    }

    /// Hears what became of the update.
    #[inline]
    pub fn note(&mut self, innovation: &Innovation, stance: &Stance, z: &ZeroVelocityParams) {
        if innovation.accepted {
            self.since_accepted_s = 0.0;
            self.since_refused_s = None;
        } else if stance.statistic < z.credible_statistic {
            self.since_refused_s.get_or_insert(0.0);
        }
    }
}

impl ZeroVelocityParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("zero_velocity.sigma_m_s", positive(self.sigma_m_s)),
            ("zero_velocity.statistic_sigma_m_s", not_negative(self.statistic_sigma_m_s)),
            ("zero_velocity.lever_sigma_m", not_negative(self.lever_sigma_m)),
            ("zero_velocity.interval_s", not_negative(self.interval_s)),
            ("zero_velocity.rest_interval_s", not_negative(self.rest_interval_s)),
            ("zero_velocity.gate_nis", positive(self.gate_nis)),
            ("zero_velocity.patience_s", not_negative(self.patience_s)),
            ("zero_velocity.credible_statistic", not_negative(self.credible_statistic)),
            ("zero_velocity.second_stance_s", not_negative(self.second_stance_s)),
            ("zero_velocity.rest_statistic", not_negative(self.rest_statistic)),
            ("zero_velocity.rest_s", not_negative(self.rest_s)),
        ])
    }

    /// The less still the foot, the less is its velocity known: variance grows with the statistic.
    #[inline]
    pub fn sigma_m_s(&self, stance: &Stance) -> f64 {
        let rolling = self.statistic_sigma_m_s * self.statistic_sigma_m_s * stance.statistic;
        libm::sqrt(self.sigma_m_s * self.sigma_m_s + rolling)
    }
}
