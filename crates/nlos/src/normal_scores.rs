//! A feature made normal: its rank among the training data as the quantile of a standard normal distribution.
//!
//! `z(v) = Φ⁻¹(F(v))` with the empirical distribution `F`, held as its values at 64 levels and interpolated between them (van der Waerden 1952).
//! A discriminant is linear in `z`; skewed features, outliers and units do not matter. Beyond the outermost levels `z` stays at ±2.42; a feature that is
//! not told counts as the middle, 0.

use statrs::distribution::{ContinuousCDF, Normal};

/// Levels.
pub const LEVELS: usize = 64;

/// How one feature is made normal.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalScores {
    /// Its values at the levels `(i + ½)/64`, not falling.
    pub values: [f32; LEVELS],
}

/// The scores at the levels.
pub fn scores() -> [f32; LEVELS] {
    let normal = Normal::standard();
    #[expect(clippy::cast_possible_truncation, reason = "a score within ±3")]
    std::array::from_fn(|i| normal.inverse_cdf((i as f64 + 0.5) / LEVELS as f64) as f32)
}

impl NormalScores {
    /// Of values; `None` where none is told.
    pub fn learn(values: impl Iterator<Item = f32>) -> Option<Self> {
        let mut told: Vec<f32> = values.filter(|value| !value.is_nan()).collect();
        told.sort_by(f32::total_cmp);
        let at = |level: usize| told.get((2 * level + 1) * told.len() / (2 * LEVELS)).copied();
        at(0)?;
        Some(Self { values: std::array::from_fn(|level| at(level).unwrap_or_default()) })
    }

    /// The score of a value, given [`scores`].
    pub fn score(&self, value: f32, scores: &[f32; LEVELS]) -> f32 {
        if value.is_nan() {
            return 0.0;
        }
        let below = self.values.partition_point(|v| *v < value);
        let up_to = self.values.partition_point(|v| *v <= value);
        if up_to > below {
            return 0.5 * (scores[below] + scores[up_to - 1]);
        }
        match below {
            0 => scores[0],
            LEVELS => scores[LEVELS - 1],
            _ => {
                let (low, high) = (self.values[below - 1], self.values[below]);
                let share = if low.is_finite() { (value - low) / (high - low) } else { 1.0 };
                scores[below - 1] + share * (scores[below] - scores[below - 1])
            }
        }
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "tests: these are exact")]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn scores_of_the_training_data_are_standard_normal_whatever_its_law() {
        let values = (0..10_000_i16).map(|k| (f32::from(k) / 1000.0).exp());
        let learnt = NormalScores::learn(values.clone()).unwrap();
        let scores = scores();
        let z: Vec<f64> = values.map(|v| f64::from(learnt.score(v, &scores))).collect();
        let mean = z.iter().sum::<f64>() / z.len() as f64;
        let variance = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
        // The tails beyond the outermost of 64 levels are cut off: they hold 2 % of the variance.
        assert!(mean.abs() < 1e-3 && (variance - 0.98).abs() < 0.02, "{mean} {variance}");
        assert!(z.is_sorted());
    }

    #[test]
    fn what_is_not_told_is_the_middle_and_ties_share_their_score() {
        let scores = scores();
        let half = NormalScores::learn([1.0, 2.0, f32::NAN].into_iter()).unwrap();
        assert_eq!(half.score(f32::NAN, &scores), 0.0);
        // Half of the data is 1: the mean of the scores of the lower 32 levels' ends.
        assert_eq!(half.score(1.0, &scores), 0.5 * (scores[0] + scores[31]));
        assert_eq!(half.score(-f32::INFINITY, &scores), scores[0]);
        assert_eq!(half.score(f32::INFINITY, &scores), scores[63]);
        assert!(NormalScores::learn([f32::NAN].into_iter()).is_none());
    }
}
