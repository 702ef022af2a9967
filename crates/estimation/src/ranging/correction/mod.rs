//! What is known of how ranges err, taken off them.
//!
//! ```text
//! r = d + o_a + e
//! ```
//!
//! o: what the antennas and the clock of anchor a add to every range, m. e depends on how the signal came. Of one that came straight it is noise of
//! [`RangeCorrection::sigma_m`]; of one that did not, the range is too long by `r − f(r)`, f a [`RangePolynomial`] (system S4, Jia et al. 2024, eq. 6–10).
//!
//! Which of both is told by the probability `p` that a signal came straight ([`RangeSample::line_of_sight`]), and both hypotheses are blended by it:
//!
//! ```text
//! m = (1 − p) m_N,   σ² = p σ_L² + (1 − p) σ_N² + p (1 − p) m_N²
//! ```
//!
//! Where nobody has judged the signal nothing is taken off, and σ is that of both kinds in the shares that were learnt.
//! Learnt by `adit_tuning::ranges`. Units: m.

mod polynomial;

pub use polynomial::RangePolynomial;

use crate::settings::positive;
use adit_observation::RangeSample;
use alloc::collections::BTreeMap;
use alloc::string::String;
use serde::{Deserialize, Serialize};

/// How ranges err.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangeCorrection {
    /// What every range reads too long, m, of anchors that are not in [`Self::anchors`].
    #[serde(default)]
    pub offset_m: f64,
    /// What the ranges of an anchor read too long, m, all told.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub anchors: BTreeMap<String, f64>,
    /// Standard deviation of a range that came straight, m.
    pub sigma_m: f64,
    /// Of ranges that did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nlos: Option<NlosCorrection>,
}

/// How ranges err whose signal did not come straight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NlosCorrection {
    /// The distance behind a range from which the offset was taken off.
    pub polynomial: RangePolynomial,
    /// Standard deviation about it, m.
    pub sigma_m: f64,
    /// Their share where it was learnt, 0 to 1.
    pub share: f64,
}

/// A distance and how far to trust it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectedRange {
    /// The distance, m.
    pub distance_m: f64,
    /// Its standard deviation, m.
    pub sigma_m: f64,
}

impl RangeCorrection {
    /// What an anchor's ranges read too long, m.
    pub fn offset_of(&self, anchor: &str) -> f64 {
        self.anchors.get(anchor).copied().unwrap_or(self.offset_m)
    }

    /// What it cannot be worked with for, if anything: (name, what is expected).
    pub fn fault(&self) -> Option<(&'static str, &'static str)> {
        let finite = self.offset_m.is_finite() && self.anchors.values().all(|offset| offset.is_finite());
        let of_nlos = || {
            let nlos = self.nlos.as_ref()?;
            let own = [
                ("nlos.sigma_m", positive(nlos.sigma_m), "a number of metres above 0"),
                ("nlos.share", (0.0..=1.0).contains(&nlos.share), "0 to 1"),
            ];
            let first = own.into_iter().find(|(_, usable, _)| !usable);
            first.map(|(name, _, expected)| (name, expected)).or_else(|| nlos.polynomial.fault())
        };
        match (finite, positive(self.sigma_m)) {
            (false, _) => Some(("offset_m, anchors", "finite numbers")),
            (_, false) => Some(("sigma_m", "a number of metres above 0")),
            _ => of_nlos(),
        }
    }

    /// The distance that a range stands for.
    pub fn correct(&self, range: &RangeSample) -> CorrectedRange {
        let without_offset = range.range_m - self.offset_of(range.anchor.as_str());
        let straight = self.sigma_m * self.sigma_m;
        let Some(nlos) = &self.nlos else {
            return CorrectedRange { distance_m: without_offset, sigma_m: self.sigma_m };
        };
        let too_long = without_offset - nlos.polynomial.distance_m(without_offset);
        let (p, taken_off) = match range.line_of_sight {
            Some(p) => (p, (1.0 - p) * too_long),
            None => (1.0 - nlos.share, 0.0),
        };
        // Second moment of the error about what is taken off.
        let [by_straight, by_nlos] = [taken_off, too_long - taken_off].map(|off| off * off);
        let variance = p * (straight + by_straight) + (1.0 - p) * (nlos.sigma_m * nlos.sigma_m + by_nlos);
        CorrectedRange { distance_m: without_offset - taken_off, sigma_m: libm::sqrt(variance) }
    }
}
