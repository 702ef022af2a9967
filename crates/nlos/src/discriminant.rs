//! The baseline: Fisher's linear discriminant with equal priors.
//!
//! `ln P(yes | z)/P(no | z) = (μ₁ − μ₂)ᵀ Σ⁻¹ (z − ½ (μ₁ + μ₂))` (Fisher 1936) with the means `μ` of either answer and the covariance `Σ` within them, whose correlations are
//! shrunk, `Σ_ij (1 − λ)` for i ≠ j (Schäfer & Strimmer 2005): a few dozen geometries do not tell 30 × 30 numbers apart.

use crate::error::NlosError;
use nalgebra::{DMatrix, DVector};

/// Weights and border of one question, linear in the scores of the features.
#[derive(Debug, Clone, PartialEq)]
pub struct Discriminant {
    /// A weight for each feature.
    pub weights: Vec<f32>,
    /// What is added.
    pub bias: f32,
}

/// One row to learn from: scores, answer (`false` is yes), weight.
pub type Row<'a> = (&'a [f32], bool, f64);

impl Discriminant {
    /// From rows of `features` scores, some of either answer.
    pub fn learn<'a>(
        rows: impl Iterator<Item = Row<'a>> + Clone,
        features: usize,
        shrinkage: f64,
    ) -> Result<Self, NlosError> {
        let mut means = [DVector::<f64>::zeros(features), DVector::<f64>::zeros(features)];
        let mut sums = [0.0; 2];
        let vector = |scores: &[f32]| DVector::from_iterator(features, scores.iter().map(|s| f64::from(*s)));
        for (scores, answer, weight) in rows.clone() {
            means[usize::from(answer)] += weight * vector(scores);
            sums[usize::from(answer)] += weight;
        }
        for (mean, sum) in means.iter_mut().zip(&sums) {
            *mean /= *sum;
        }
        let mut covariance = DMatrix::<f64>::zeros(features, features);
        for (scores, answer, weight) in rows {
            let off = vector(scores) - &means[usize::from(answer)];
            covariance.ger(0.5 * weight / sums[usize::from(answer)], &off, &off, 1.0);
        }
        for i in 0..features {
            for j in 0..features {
                covariance[(i, j)] *= if i == j { 1.0 } else { 1.0 - shrinkage };
            }
            // A feature that does not vary within the classes counts as one that does, a little.
            covariance[(i, i)] += 1e-6;
        }
        let factor = covariance.cholesky().ok_or(NlosError::Degenerate)?;
        let [yes, no] = &means;
        let weights = factor.solve(&(yes - no));
        let bias = -0.5 * weights.dot(&(yes + no));
        if !bias.is_finite() {
            return Err(NlosError::Degenerate);
        }
        #[expect(clippy::cast_possible_truncation, reason = "weights of scores within ±3")]
        let learnt = Self { weights: weights.iter().map(|w| *w as f32).collect(), bias: bias as f32 };
        Ok(learnt)
    }

    /// `ln P(yes)/P(no)`.
    pub fn logit(&self, scores: &[f32]) -> f32 {
        self.weights.iter().zip(scores).fold(self.bias, |sum, (weight, score)| sum + weight * score)
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    /// Two clouds with known means and covariance: the weights are Σ⁻¹ (μ₁ − μ₂), the border lies in the middle.
    #[test]
    fn weights_are_the_inverse_covariance_times_the_difference_of_the_means() {
        let corners = [[1.5_f32, 1.5], [-1.5, -1.5], [0.5, -0.5], [-0.5, 0.5]];
        // Their covariance: 5/4 on the diagonal, 1 beside it.
        let rows: Vec<([f32; 2], bool)> = corners
            .iter()
            .flat_map(|c| [([c[0] + 1.0, c[1]], false), ([c[0] - 1.0, c[1] + 2.0], true)])
            .collect();
        let shrinkage = 0.25;
        let learnt = Discriminant::learn(rows.iter().map(|(r, c)| (&r[..], *c, 1.0)), 2, shrinkage).unwrap();
        let (a, b) = (1.25 + 1e-6, 1.0 - shrinkage);
        let determinant = a * a - b * b;
        let difference = [2.0, -2.0];
        let expected = [
            (a * difference[0] - b * difference[1]) / determinant,
            (a * difference[1] - b * difference[0]) / determinant,
        ];
        for (found, expected) in learnt.weights.iter().zip(expected) {
            // Single precision.
            assert!((f64::from(*found) - expected).abs() < 1e-5, "{found} {expected}");
        }
        assert!(learnt.logit(&[0.0, 1.0]).abs() < 1e-5, "the middle of the means");
        assert!(learnt.logit(&[1.0, 0.0]) > 1.0);
    }
}
