//! How long a step is.
//!
//! | model | length |
//! |---|---|
//! | [`StepLength::Weinberg`] | `k · (a_max − a_min)^¼` (Weinberg 2002, *Using the ADXL202 in pedometer and personal navigation applications*, AN-602) |
//! | [`StepLength::FrequencyHeight`] | `0.7 + 0.371 (H − 1.75) + 0.227 (f − 1.79) H / 1.75` for a body height `H` and `f` steps/s (Chen, Pei & Chen 2011, *A smart phone based PDR solution for indoor navigation*) |
//! | [`StepLength::Constant`] | always the same |
//!
//! No model knows the person: what remains is a factor of some per cent to twenty, which fixes calibrate
//! ([`crate::methods::pdr`]). `a_max − a_min` is that of the norm as [`super::steps`] smooths it, over the time of a step; `k` of
//! other smoothings differs.

use super::steps::Step;
use crate::settings::positive;
use serde::{Deserialize, Serialize};

/// Model of the length of a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum StepLength {
    /// Fourth root of the swing of the specific force.
    Weinberg {
        /// `k`, m/(m/s²)^¼.
        k: f64,
    },
    /// Cadence and body height.
    FrequencyHeight {
        /// Body height, m.
        height_m: f64,
    },
    /// The same for every step.
    Constant {
        /// Length, m.
        length_m: f64,
    },
}

impl Default for StepLength {
    /// `k` of ten walkers with a tag on the lower back, over legs of ten metres (docs/methods/pdr.md).
    fn default() -> Self {
        Self::Weinberg { k: 0.49 }
    }
}

impl StepLength {
    /// Length of a step, m; between 0 and [`LONGEST_M`].
    pub fn length_m(&self, step: &Step) -> f64 {
        let length_m = match *self {
            Self::Weinberg { k } => k * libm::sqrt(libm::sqrt(step.swing_m_s2)),
            Self::FrequencyHeight { height_m } => {
                let frequency_hz = 1.0 / step.period_s;
                0.7 + 0.371 * (height_m - 1.75) + 0.227 * (frequency_hz - 1.79) * height_m / 1.75
            }
            Self::Constant { length_m } => length_m,
        };
        if length_m.is_finite() { length_m.clamp(0.0, LONGEST_M) } else { 0.0 }
    }

    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        match *self {
            Self::Weinberg { k } => (!positive(k)).then_some("length.weinberg.k"),
            Self::FrequencyHeight { height_m } => {
                (!(0.5..=2.5).contains(&height_m)).then_some("length.frequency-height.height_m")
            }
            Self::Constant { length_m } => {
                (!(positive(length_m) && length_m <= LONGEST_M)).then_some("length.constant.length_m")
            }
        }
    }
}

/// No step of a person is longer, m: that of a sprinter at full speed is 2.5 m.
pub const LONGEST_M: f64 = 3.0;
