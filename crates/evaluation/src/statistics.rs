//! A series of errors in a few numbers, and as a distribution.
//!
//! `rmse = √(Σe²/n)`, `std = √(Σ(e − mean)²/n)` (population, as numpy and evo), percentiles by linear interpolation
//! between order statistics (type 7 of Hyndman & Fan 1996, numpy's default).

use serde::Serialize;

/// Summary of a series of errors, in the unit of the series (`sse` in its square).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// Root mean square.
    pub rmse: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// 50th percentile.
    pub median: f64,
    /// 90th percentile.
    pub p90: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest.
    pub max: f64,
    /// Smallest.
    pub min: f64,
    /// Standard deviation about the mean.
    pub std: f64,
    /// Sum of squares.
    pub sse: f64,
}

impl Statistics {
    /// Summary of `errors` (finite numbers); `None` when there are none.
    pub fn of(errors: &[f64]) -> Option<Self> {
        let distribution = Distribution::of(errors)?;
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let sse = errors.iter().map(|e| e * e).sum::<f64>();
        let variance = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / count;
        Some(Self {
            rmse: (sse / count).sqrt(),
            mean,
            median: distribution.quantile(0.5),
            p90: distribution.quantile(0.9),
            p95: distribution.quantile(0.95),
            max: distribution.quantile(1.0),
            min: distribution.quantile(0.0),
            std: variance.sqrt(),
            sse,
        })
    }

    /// Name and value of each number, in the order of the fields; the names are those of the JSON.
    pub fn named(&self) -> [(&'static str, f64); 9] {
        [
            ("rmse", self.rmse),
            ("mean", self.mean),
            ("median", self.median),
            ("p90", self.p90),
            ("p95", self.p95),
            ("max", self.max),
            ("min", self.min),
            ("std", self.std),
            ("sse", self.sse),
        ]
    }
}

/// Empirical distribution of a series of errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    sorted: Vec<f64>,
}

impl Distribution {
    /// Distribution of `errors`; `None` when there are none.
    pub fn of(errors: &[f64]) -> Option<Self> {
        let mut sorted = errors.to_vec();
        sorted.sort_by(f64::total_cmp);
        (!sorted.is_empty()).then_some(Self { sorted })
    }

    /// The errors, smallest first; never empty.
    pub fn sorted(&self) -> &[f64] {
        &self.sorted
    }

    /// The error not exceeded by the share `share` (clamped to 0 to 1) of the samples, interpolated.
    pub fn quantile(&self, share: f64) -> f64 {
        let last = self.sorted.len() - 1;
        let place = share.clamp(0.0, 1.0) * last as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 ≤ place ≤ last, NaN gives 0"
        )]
        let below = place as usize;
        let (low, high) = (self.sorted[below], self.sorted[(below + 1).min(last)]);
        low + (high - low) * (place - below as f64).max(0.0)
    }

    /// Share of the samples that are not above `limit`, 0 to 1: the cumulative distribution function.
    pub fn share_below(&self, limit: f64) -> f64 {
        self.sorted.partition_point(|e| *e <= limit) as f64 / self.sorted.len() as f64
    }
}
