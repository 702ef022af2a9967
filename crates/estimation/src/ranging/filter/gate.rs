//! A gate that cannot lock itself out.
//!
//! A plain χ² gate refuses what is more than k standard deviations off. Once the filter is surely wrong (a tag was carried where no range is heard, the start was told
//! wrongly, the noise is set too small) it refuses every right range, and nothing will ever put it right.
//!
//! Here refusals are counted: one up for a range that is refused, two down for one that is taken, so that up to two wrong anchors of three in turn leave the count at rest. Above `relax_after` the gate widens with every
//! further refusal, `k (1 + (n − n₀)/n₀)`; a range that comes in so is taken with the place in doubt by as much as it is off (*relaxed*).
//! Meanwhile robust fits of what is heard are made as at the start; when so many in a row agree with each other, and not with the filter,
//! it goes there (*recovered*).

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
    /// n₀: refusals after which the gate widens.
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
        Self { kind: GateKind::Recovering, bound: 5.0, relax_after: 12 }
    }
}

impl GateParams {
    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("filter.gate.bound", positive(self.bound)),
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
    count: u32,
}

impl Gate {
    /// Judges an innovation of e standard deviations that a weighting counts with `weight`.
    pub fn judge(&mut self, e: f64, weight: f64, params: &GateParams) -> Verdict {
        let inside = e.abs() <= params.bound && weight > 0.0;
        match params.kind {
            GateKind::Open => return if weight > 0.0 { Verdict::Taken } else { Verdict::Refused },
            GateKind::Plain => return if inside { Verdict::Taken } else { Verdict::Refused },
            GateKind::Recovering if inside => {
                self.count = self.count.saturating_sub(2);
                return Verdict::Taken;
            }
            GateKind::Recovering => {}
        }
        self.count = self.count.saturating_add(1);
        let beyond = self.count.saturating_sub(params.relax_after);
        let widened = params.bound * (1.0 + f64::from(beyond) / f64::from(params.relax_after));
        if beyond > 0 && e.abs() <= widened { Verdict::Relaxed } else { Verdict::Refused }
    }

    /// Whether so many were refused that the filter may be lost.
    pub fn doubts(&self, params: &GateParams) -> bool {
        params.kind == GateKind::Recovering && self.count > params.relax_after
    }

    /// As new.
    pub fn reset(&mut self) {
        self.count = 0;
    }
}
