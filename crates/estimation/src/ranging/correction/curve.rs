//! Expected error of a range as a curve of how its signal came in.

use adit_observation::{RangeSample, Reception};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// What a curve is of. Powers in dBm, ratios in dB.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Diagnostic {
    /// The range itself, m.
    Range,
    /// Power of the whole signal, dBm.
    RxPower,
    /// Power of the first path, dBm.
    FirstPathPower,
    /// Whole signal over first path, dB.
    PowerGap,
    /// What the whole signal has more than free space would leave at the range, dB and a constant of the radio.
    PowerExcess,
    /// Largest of the three amplitudes from the first path on over the first of them, dB.
    Rise,
    /// The largest of them over the standard deviation of the noise, dB.
    SignalToNoise,
    /// Preamble symbols accumulated.
    PreambleCount,
}

/// Nearer than this, m, free space is not asked.
const NEAREST_M: f64 = 0.5;

impl Diagnostic {
    /// All of them, the plainest first.
    pub const ALL: [Self; 8] = [
        Self::Range,
        Self::RxPower,
        Self::FirstPathPower,
        Self::PowerGap,
        Self::PowerExcess,
        Self::Rise,
        Self::SignalToNoise,
        Self::PreambleCount,
    ];

    /// Its value of a range; `None` where the device does not tell.
    pub fn of(self, range: &RangeSample) -> Option<f64> {
        let reception = range.reception.as_deref();
        let rx = || Some(f64::from(reception?.rx_power_dbm?));
        let first = || Some(f64::from(reception?.first_path_power_dbm?));
        let value = match self {
            Self::Range => Some(range.range_m),
            Self::RxPower => rx(),
            Self::FirstPathPower => first(),
            Self::PowerGap => Some(rx()? - first()?),
            Self::PowerExcess => Some(rx()? + 20.0 * libm::log10(range.range_m.max(NEAREST_M))),
            Self::Rise => reception.and_then(rise_db),
            Self::SignalToNoise => reception.and_then(signal_to_noise_db),
            Self::PreambleCount => Some(f64::from(reception?.preamble_count?)),
        };
        value.filter(|value| value.is_finite())
    }

    /// As written in files and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Range => "range",
            Self::RxPower => "rx-power",
            Self::FirstPathPower => "first-path-power",
            Self::PowerGap => "power-gap",
            Self::PowerExcess => "power-excess",
            Self::Rise => "rise",
            Self::SignalToNoise => "signal-to-noise",
            Self::PreambleCount => "preamble-count",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Range => "m",
            Self::RxPower | Self::FirstPathPower => "dBm",
            Self::PowerGap | Self::PowerExcess | Self::Rise | Self::SignalToNoise => "dB",
            Self::PreambleCount => "symbols",
        }
    }
}

fn largest(reception: &Reception) -> Option<f32> {
    reception.first_path_amplitudes?.into_iter().reduce(f32::max)
}

fn ratio_db(over: f32, under: f32) -> Option<f64> {
    (over > 0.0 && under > 0.0).then(|| 20.0 * libm::log10(f64::from(over) / f64::from(under)))
}

fn rise_db(reception: &Reception) -> Option<f64> {
    let [first, ..] = reception.first_path_amplitudes?;
    ratio_db(largest(reception)?, first)
}

fn signal_to_noise_db(reception: &Reception) -> Option<f64> {
    ratio_db(largest(reception)?, reception.noise_std?)
}

/// Expected error and its spread between knots, straight from one to the next; beyond the ends as there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorCurve {
    /// What it is of.
    pub of: Diagnostic,
    /// Rising knots, in its unit.
    pub at: Vec<f64>,
    /// What a range reads too long there, m.
    pub too_long_m: Vec<f64>,
    /// Standard deviation about it, m.
    pub sigma_m: Vec<f64>,
}

impl ErrorCurve {
    /// What a range reads too long and the standard deviation of that, m; `None` where the device does not tell what the curve is of.
    pub fn expected(&self, range: &RangeSample) -> Option<(f64, f64)> {
        self.at_value(self.of.of(range)?)
    }

    /// The same of a value of what the curve is of.
    pub fn at_value(&self, value: f64) -> Option<(f64, f64)> {
        let (mut low, mut share) = (0, 0.0);
        for (k, pair) in self.at.windows(2).enumerate() {
            if value > pair[0] {
                (low, share) = (k, ((value - pair[0]) / (pair[1] - pair[0])).min(1.0));
            }
        }
        let between = |values: &[f64]| {
            let here = *values.get(low)?;
            Some(here + share * (values.get(low + 1).unwrap_or(&here) - here))
        };
        Some((between(&self.too_long_m)?, between(&self.sigma_m)?))
    }

    /// What keeps it from being one, if anything: (name, what is expected).
    pub fn fault(&self) -> Option<(&'static str, &'static str)> {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if self.at.is_empty() || !finite(&self.at) || !self.at.is_sorted_by(|a, b| a < b) {
            return Some(("at", "rising knots, one or more"));
        }
        if self.too_long_m.len() != self.at.len() || !finite(&self.too_long_m) {
            return Some(("too_long_m", "a finite number for each knot"));
        }
        let spreads = self.sigma_m.iter().all(|sigma| sigma.is_finite() && *sigma > 0.0);
        let whole = self.sigma_m.len() == self.at.len() && spreads;
        (!whole).then_some(("sigma_m", "a number above 0 for each knot"))
    }
}
