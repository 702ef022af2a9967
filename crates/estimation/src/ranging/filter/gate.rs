//! A gate that cannot lock itself out.
//!
//! A plain χ² gate refuses what is more than k standard deviations off. Once the filter is surely wrong (a tag was carried where no range is heard, the start was told
//! wrongly, the noise is set too small) it refuses every right range, and nothing will ever put it right.
//!
//! With two anchors on one wall it is enough to begin on the wrong side of them: their ranges fit the mirror image for ever, and those of all others are refused for ever.
//!
//! Here refusals are counted, two up for a range that is refused, one down for one that is taken: one wrong anchor of three leaves the count where it is. After `watch_after` refusals
//! robust fits of what is heard are made, as at the start; so many in a row that agree with each other decide: where they are elsewhere the filter goes there (*recovered*), where they
//! are with the filter it is right and the count stays. While no fits agree and the count is above `relax_after` the gate widens with every further refusal, `k (1 + (n − n₁)/n₁)`;
//! a range that comes in so is taken with the place in doubt by as much as it is off (*relaxed*).

use crate::settings::{first_unusable, positive};
use serde::{Deserialize, Serialize};

/// Settings of the gate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GateParams {
    /// What becomes of ranges that are far off.
    pub kind: GateKind,
    /// k: standard deviations of the innovation from which a range is refused.
    pub bound: f64,
    /// n₀: refusals after which fits are made.
    pub watch_after: u32,
    /// n₁: refusals after which the gate widens.
    pub relax_after: u32,
}

/// Kinds of gates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GateKind {
    /// All ranges come in.
    Open,
    /// χ² alone: the gate that locks itself out, to compare with.
    Plain,
    /// χ² with a way back.
    #[default]
    Recovering,
}

impl Default for GateParams {
    fn default() -> Self {
        Self { kind: GateKind::Recovering, bound: 5.0, watch_after: 8, relax_after: 24 }
    }
}

impl GateParams {
    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("filter.gate.bound", positive(self.bound)),
            ("filter.gate.watch_after", self.watch_after > 0),
            ("filter.gate.relax_after", self.relax_after > 0),
        ])
    }
}

/// What the gate makes of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Taken,
    /// Beyond the bound, within the widened one.
    Relaxed,
    Refused,
}

/// Refusals of late.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(super) struct Gate {
    /// Two for each refusal, less one for each range taken.
    halves: u32,
}

impl Gate {
    /// Judges an innovation of e standard deviations that a weighting counts with `weight`.
    pub fn judge(&mut self, e: f64, weight: f64, params: &GateParams) -> Verdict {
        let inside = e.abs() <= params.bound && weight > 0.0;
        match params.kind {
            GateKind::Open => return if weight > 0.0 { Verdict::Taken } else { Verdict::Refused },
            GateKind::Plain => return if inside { Verdict::Taken } else { Verdict::Refused },
            GateKind::Recovering if inside => {
                self.halves = self.halves.saturating_sub(1);
                return Verdict::Taken;
            }
            GateKind::Recovering => {}
        }
        self.halves = self.halves.saturating_add(2);
        let beyond = 0.5 * f64::from(self.halves) - f64::from(params.relax_after);
        let widened = params.bound * (1.0 + beyond / f64::from(params.relax_after));
        if beyond > 0.0 && e.abs() <= widened { Verdict::Relaxed } else { Verdict::Refused }
    }

    /// Whether so many were refused that the filter may be lost.
    pub fn doubts(self, params: &GateParams) -> bool {
        params.kind == GateKind::Recovering && self.halves > params.watch_after.saturating_mul(2)
    }

    /// Fits say that the filter is right: it is watched on, and nothing is relaxed for now.
    pub fn calm(&mut self, params: &GateParams) {
        self.halves = self.halves.min(params.watch_after.saturating_mul(2).saturating_add(1));
    }

    /// As new.
    pub fn reset(&mut self) {
        self.halves = 0;
    }
}
