//! What is known of how ranges err, taken off them.
//!
//! ```text
//! r = d + o_a + e
//! ```
//!
//! o: what the antennas and the clock of anchor a add to every range, m. e depends on how the signal came, and an [`ErrorModel`] tells its mean and
//! spread `(m, σ)`: by a curve of what the receiver tells of the signal ([`ErrorCurve`]), else by a polynomial of the range (system S4, Jia et al.
//! 2024, eq. 6–10: [`RangePolynomial`]), else `(0, σ)`.
//!
//! There are three of them: of signals that came straight (L), of those that did not (N), and of those that nobody has judged. With the
//! probability `p` that a signal came straight ([`RangeSample::line_of_sight`]) both hypotheses are blended:
//!
//! ```text
//! m = p m_L + (1 − p) m_N,   σ² = p (σ_L² + (m_L − m)²) + (1 − p) (σ_N² + (m_N − m)²)
//! ```
//!
//! Learnt by `adit_tuning::ranges`. Outside of what was learnt nothing is extrapolated: curves and polynomials go on as at their ends. Units: m.

mod curve;
mod polynomial;

pub use curve::{Diagnostic, ErrorCurve};
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
    /// Of signals that nobody has judged.
    pub unjudged: ErrorModel,
    /// Of signals that came straight; absent: as of those not judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub straight: Option<ErrorModel>,
    /// Of signals that did not; absent: as of those not judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nlos: Option<ErrorModel>,
}

/// How ranges of one kind err once the offset is off.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorModel {
    /// Standard deviation where nothing else is told, m.
    pub sigma_m: f64,
    /// Distance by range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polynomial: Option<RangePolynomial>,
    /// Error by how the signal came in; goes before the polynomial where the device tells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<ErrorCurve>,
}

/// A distance and how far to trust it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectedRange {
    /// The distance, m.
    pub distance_m: f64,
    /// Its standard deviation, m.
    pub sigma_m: f64,
}

impl ErrorModel {
    /// What a range reads too long beside the offset and the standard deviation of that, m; `without_offset` is the range less its offset.
    pub fn expected(&self, range: &RangeSample, without_offset: f64) -> (f64, f64) {
        let by_curve = self.curve.as_ref().and_then(|curve| curve.expected(range));
        by_curve.unwrap_or_else(|| match &self.polynomial {
            Some(polynomial) => (without_offset - polynomial.distance_m(without_offset), polynomial.sigma_m),
            None => (0.0, self.sigma_m),
        })
    }

    /// What it cannot be worked with for, if anything: (name, what is expected).
    pub fn fault(&self) -> Option<(&'static str, &'static str)> {
        if !positive(self.sigma_m) {
            return Some(("sigma_m", "a number of metres above 0"));
        }
        let of_polynomial = self.polynomial.as_ref().and_then(RangePolynomial::fault);
        of_polynomial.or_else(|| self.curve.as_ref()?.fault())
    }
}

impl RangeCorrection {
    /// Offsets alone: every range errs by σ, m.
    pub const fn of_offset(offset_m: f64, sigma_m: f64) -> Self {
        let unjudged = ErrorModel { sigma_m, polynomial: None, curve: None };
        Self { offset_m, anchors: BTreeMap::new(), unjudged, straight: None, nlos: None }
    }

    /// What an anchor's ranges read too long, m.
    pub fn offset_of(&self, anchor: &str) -> f64 {
        self.anchors.get(anchor).copied().unwrap_or(self.offset_m)
    }

    /// What it cannot be worked with for, if anything: (name, what is expected).
    pub fn fault(&self) -> Option<(&'static str, &'static str)> {
        if !self.offset_m.is_finite() || !self.anchors.values().all(|offset| offset.is_finite()) {
            return Some(("offset_m, anchors", "finite numbers"));
        }
        [Some(&self.unjudged), self.straight.as_ref(), self.nlos.as_ref()]
            .into_iter()
            .flatten()
            .find_map(ErrorModel::fault)
    }

    /// The distance that a range stands for.
    pub fn correct(&self, range: &RangeSample) -> CorrectedRange {
        let without_offset = range.range_m - self.offset_of(range.anchor.as_str());
        let told =
            |model: Option<&ErrorModel>| model.unwrap_or(&self.unjudged).expected(range, without_offset);
        let (too_long, sigma_m) = match range.line_of_sight {
            Some(p) => {
                let ((m_l, sigma_l), (m_n, sigma_n)) =
                    (told(self.straight.as_ref()), told(self.nlos.as_ref()));
                let mean = p * m_l + (1.0 - p) * m_n;
                let second = |m: f64, sigma: f64| sigma * sigma + (m - mean) * (m - mean);
                (mean, libm::sqrt(p * second(m_l, sigma_l) + (1.0 - p) * second(m_n, sigma_n)))
            }
            None => told(None),
        };
        CorrectedRange { distance_m: without_offset - too_long, sigma_m }
    }
}
