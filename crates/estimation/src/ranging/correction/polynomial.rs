//! The distance behind a range that came through or round something, as a polynomial of the range (system S4, Jia et al. 2024, eq. 6–10).

use crate::settings::positive;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// `f(d) = a0 + a1 d + … + ak d^k`, of measured d, m, within what it was learnt from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangePolynomial {
    /// `a0`, `a1`, … `ak`; the i-th in `m^(1 − i)`.
    pub coefficients: Vec<f64>,
    /// Shortest and longest measured range that it was learnt from, m.
    pub learnt_m: [f64; 2],
    /// Standard deviation of the distance about it, m.
    pub sigma_m: f64,
}

impl RangePolynomial {
    /// The distance, m. Outside of what was learnt, the error at the nearest end is taken off: powers say nothing there.
    pub fn distance_m(&self, measured_m: f64) -> f64 {
        let [shortest, longest] = self.learnt_m;
        let inside = measured_m.max(shortest).min(longest);
        let value = self.coefficients.iter().rev().fold(0.0, |sum, a| sum * inside + a);
        measured_m + (value - inside)
    }

    /// What keeps it from being one, if anything: (name, what is expected).
    pub fn fault(&self) -> Option<(&'static str, &'static str)> {
        let [shortest, longest] = self.learnt_m;
        if self.coefficients.is_empty() || !self.coefficients.iter().all(|a| a.is_finite()) {
            return Some(("coefficients", "one finite number or more"));
        }
        let span = shortest.is_finite() && longest.is_finite() && shortest <= longest;
        if !span {
            return Some(("learnt_m", "the shortest and the longest range, m"));
        }
        (!positive(self.sigma_m)).then_some(("sigma_m", "a number of metres above 0"))
    }
}
