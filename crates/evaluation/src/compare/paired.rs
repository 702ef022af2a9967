//! The difference between two methods on the same runs.
//!
//! With one number `aᵢ`, `bᵢ` of each of n runs that both came to the end of, `dᵢ = aᵢ − bᵢ`: mean `d̄`, `s² = Σ(dᵢ − d̄)²/(n − 1)`, and
//! `d̄ ± t(0.975, n − 1) s/√n` holds the mean difference with 95 % (Student 1908, the paired t). It takes the runs for independent and the mean of their
//! differences for normal: seeds are the first; walks by one person through one room less so, and few runs with heavy tails not the second.

use super::PROBABILITY;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Mean difference of a figure over the runs of both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairedDifference {
    /// Runs that both came to the end of.
    pub runs: usize,
    /// Mean of the one minus the other.
    pub mean: f64,
    /// Lower end of its 95 % interval; none of a single run.
    pub lower: Option<f64>,
    /// Upper end.
    pub upper: Option<f64>,
}

impl PairedDifference {
    /// Of the numbers of two methods, run by run; `None` where they have no run in common.
    pub fn of(one: &[Option<f64>], other: &[Option<f64>]) -> Option<Self> {
        let both = one.iter().zip(other).filter_map(|(a, b)| Some((*a)? - (*b)?));
        let differences: Vec<f64> = both.collect();
        let runs = differences.len();
        if runs == 0 {
            return None;
        }
        let mean = differences.iter().sum::<f64>() / runs as f64;
        let half = half_width(&differences, mean);
        Some(Self { runs, mean, lower: half.map(|half| mean - half), upper: half.map(|half| mean + half) })
    }

    /// Whether the interval leaves zero out.
    pub fn is_certain(&self) -> bool {
        self.lower.zip(self.upper).is_some_and(|(lower, upper)| lower > 0.0 || upper < 0.0)
    }
}

fn half_width(differences: &[f64], mean: f64) -> Option<f64> {
    let freedom = (differences.len() as f64) - 1.0;
    // No freedom, no distribution.
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
    let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / freedom;
    let quantile = student.inverse_cdf(0.5 + 0.5 * PROBABILITY);
    Some(quantile * (variance / differences.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn known(values: &[f64]) -> Vec<Option<f64>> {
        values.iter().copied().map(Some).collect()
    }

    /// `scipy.stats.ttest_rel(a, b).confidence_interval(0.95)`; see `tests/reference/paired.py`.
    #[test]
    fn intervals_are_those_of_scipy() {
        let a = known(&[0.31, 0.28, 0.44, 0.39, 0.25, 0.36, 0.41]);
        let b = known(&[0.35, 0.27, 0.52, 0.47, 0.29, 0.33, 0.55]);
        let found = PairedDifference::of(&a, &b).unwrap();
        assert_eq!(found.runs, 7);
        // The quantile is found to 1e-9 and better; scipy prints 17 digits.
        assert!((found.mean - SCIPY[0]).abs() < 1e-12, "{found:?}");
        assert!((found.lower.unwrap() - SCIPY[1]).abs() < 1e-9, "{found:?}");
        assert!((found.upper.unwrap() - SCIPY[2]).abs() < 1e-9, "{found:?}");
        assert!(!found.is_certain());
    }

    const SCIPY: [f64; 3] = [-0.048_571_428_571_428_58, -0.102_081_720_403_130_52, 0.004_938_863_260_273_367];

    #[test]
    fn only_runs_of_both_count() {
        let (a, b) = ([Some(1.0), None, Some(3.0), Some(2.0)], [Some(0.5), Some(9.0), None, Some(1.0)]);
        let found = PairedDifference::of(&a, &b).unwrap();
        assert_eq!((found.runs, found.mean), (2, 0.75));
        // Differences 0.5 and 1: 0.75 ± 12.706 · 0.25.
        assert!((found.upper.unwrap() - (0.75 + 12.706_204_736 * 0.25)).abs() < 1e-8, "{found:?}");
        let single = PairedDifference::of(&a[..1], &b[..1]).unwrap();
        assert_eq!((single.runs, single.lower, single.is_certain()), (1, None, false));
        assert_eq!(PairedDifference::of(&a[1..2], &b[1..2]), None);
    }
}
