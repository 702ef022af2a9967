//! How much each range counts.
//!
//! e = v/√S, the innovation over its standard deviation.
//!
//! **Equal**: the extended Kalman filter; every range that the gate lets in counts.
//!
//! **Robust**: the innovation's variance becomes S/w(e). Huber (1964): `w = min(1, k/|e|)`. IGG-III (Yang, Song & Xu 2002, eq. 12, in three segments):
//!
//! ```text
//! w = 1                                      |e| ≤ k₀
//!   = k₀/|e| ((k₁ − |e|)/(k₁ − k₀))²    k₀ < |e| ≤ k₁
//!   = 0                                 k₁ < |e|
//! ```
//!
//! Yang et al. put w on the variance of the measurement; here it is on that of the innovation, so that no range moves the state by more than k₀ standard deviations
//! of what it was predicted with, however uncertain the prediction was.
//!
//! **Adaptive**: the variance of the ranges of each anchor follows its innovations (Sage & Husa 1969; Mehra 1972, innovation correlation),
//!
//! ```text
//! r ← (1 − d) r + d (v² − H P Hᵀ),   d = (1 − b)/(1 − b^(k+1)),
//! ```
//!
//! kept between shares of what is told of the ranges, and the prediction is believed less where the innovations of the last ranges are too large all together (Yang, He & Xu 2001, the two-segment factor
//! with the innovations' statistic of Yang & Gao 2006): `P ← P/α, α = min(1, (c/Δ))²`, `Δ² = Σ e²/m` over the last m.

use super::state::SLOTS;
use crate::settings::{first_unusable, positive};
use serde::{Deserialize, Serialize};

/// How much each range counts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Weighting {
    /// By which rule.
    pub kind: WeightingKind,
    /// Huber's k and k₀ of IGG-III: standard deviations up to which a range counts in full.
    pub full: f64,
    /// k₁ of IGG-III: standard deviations from which it does not count.
    pub none: f64,
    /// Adaptive, b: share of the variance that is kept from one range of an anchor to the next.
    pub memory: f64,
    /// Adaptive, m: innovations over which the prediction is judged.
    pub window: u32,
    /// Adaptive, c: root of their mean square from which on the prediction is believed less.
    pub bound: f64,
    /// Adaptive: least variance of the ranges, as a share of what is told of them.
    pub least_share: f64,
    /// Adaptive: largest variance.
    pub most_share: f64,
}

/// Rules of weighting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WeightingKind {
    /// All that the gate lets in count alike.
    Equal,
    /// Less the farther off.
    Huber,
    /// Less the farther off, and not at all in the end.
    #[default]
    Igg3,
    /// All count alike, by variances that follow the innovations.
    Adaptive,
}

impl Default for Weighting {
    fn default() -> Self {
        Self {
            kind: WeightingKind::Igg3,
            full: 1.5,
            none: 5.0,
            memory: 0.95,
            window: 16,
            bound: 1.5,
            least_share: 0.5,
            most_share: 100.0,
        }
    }
}

/// What an adaptive weighting has learnt.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Adaptation {
    /// Variance of the ranges of each slot over what is told of it, and how many made it.
    shares: [(f64, u32); SLOTS],
    /// Sum of e² since the prediction was judged, and how many.
    recent: (f64, u32),
}

impl Weighting {
    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("weighting.full", positive(self.full)),
            ("weighting.none", positive(self.none) && self.none > self.full),
            ("weighting.memory", (0.0..1.0).contains(&self.memory)),
            ("weighting.window", (1..=1000).contains(&self.window)),
            ("weighting.bound", positive(self.bound)),
            ("weighting.least_share", positive(self.least_share) && self.least_share <= 1.0),
            ("weighting.most_share", self.most_share.is_finite() && self.most_share >= 1.0),
        ])
    }

    /// w(e); 0 leaves the range out.
    pub fn weight(&self, e: f64) -> f64 {
        let (e, full, none) = (e.abs(), self.full, self.none);
        match self.kind {
            WeightingKind::Equal | WeightingKind::Adaptive => 1.0,
            WeightingKind::Huber | WeightingKind::Igg3 if e <= full => 1.0,
            WeightingKind::Huber => full / e,
            WeightingKind::Igg3 if e >= none => 0.0,
            WeightingKind::Igg3 => {
                let fall = (none - e) / (none - full);
                full / e * fall * fall
            }
        }
    }

    fn is_adaptive(&self) -> bool {
        self.kind == WeightingKind::Adaptive
    }
}

impl Adaptation {
    /// Factor on the variance of the ranges of a slot.
    pub fn share(&self, slot: usize) -> f64 {
        match self.shares[slot] {
            (share, count) if count > 0 => share,
            _ => 1.0,
        }
    }

    /// A slot has another anchor now.
    pub fn forget(&mut self, slot: usize) {
        self.shares[slot] = (1.0, 0);
    }

    /// Takes what a range of a slot showed of its variance, over what is told of it.
    pub fn learn(&mut self, slot: usize, shown: f64, weighting: &Weighting) {
        let Weighting { memory, least_share, most_share, .. } = *weighting;
        if !weighting.is_adaptive() {
            return;
        }
        let (share, count) = self.shares[slot];
        let share = if count == 0 { 1.0 } else { share };
        let count = count.saturating_add(1);
        let gain = (1.0 - memory) / (1.0 - libm::pow(memory, f64::from(count) + 1.0));
        let next = ((1.0 - gain) * share + gain * shown).max(least_share).min(most_share);
        self.shares[slot] = (next, count);
    }

    /// Takes e²; 1/α where a window of them is too large all together.
    pub fn judge(&mut self, squared: f64, weighting: &Weighting) -> Option<f64> {
        let Weighting { window, bound, .. } = *weighting;
        if !weighting.is_adaptive() {
            return None;
        }
        self.recent.0 += squared;
        self.recent.1 += 1;
        if self.recent.1 < window {
            return None;
        }
        let mean = self.recent.0 / f64::from(self.recent.1);
        self.recent = (0.0, 0);
        (mean > bound * bound).then(|| mean / (bound * bound))
    }
}
