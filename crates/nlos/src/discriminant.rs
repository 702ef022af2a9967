//! The baseline: Fisher's linear discriminant with equal priors.
//!
//! `log P(c | z) = μ_cᵀ Σ⁻¹ z − ½ μ_cᵀ Σ⁻¹ μ_c + const` (Fisher 1936) with the class means `μ_c` and the covariance `Σ` within the classes, whose correlations are
//! shrunk, `Σ_ij (1 − λ)` for i ≠ j (Schäfer & Strimmer 2005): a few dozen geometries do not tell 30 × 30 numbers apart.

use crate::error::NlosError;
use nalgebra::{DMatrix, DVector};

/// Weights and borders, linear in the scores of the features.
#[derive(Debug, Clone, PartialEq)]
pub struct Discriminant {
    /// Of each class, a weight for each feature.
    pub weights: Vec<Vec<f32>>,
    /// Of each class.
    pub bias: Vec<f32>,
}

/// One row to learn from: scores, index of the class, weight.
pub type Row<'a> = (&'a [f32], usize, f64);

impl Discriminant {
    /// From rows of `features` scores, in `classes` classes that all have a row.
    pub fn learn<'a>(
        rows: impl Iterator<Item = Row<'a>> + Clone,
        features: usize,
        classes: usize,
        shrinkage: f64,
    ) -> Result<Self, NlosError> {
        let mut means = vec![DVector::<f64>::zeros(features); classes];
        let mut sums = vec![0.0; classes];
        let vector = |scores: &[f32]| DVector::from_iterator(features, scores.iter().map(|s| f64::from(*s)));
        for (scores, class, weight) in rows.clone() {
            means[class] += weight * vector(scores);
            sums[class] += weight;
        }
        for (mean, sum) in means.iter_mut().zip(&sums) {
            *mean /= *sum;
        }
        let mut covariance = DMatrix::<f64>::zeros(features, features);
        for (scores, class, weight) in rows {
            let off = vector(scores) - &means[class];
            covariance.ger(weight / sums[class] / classes as f64, &off, &off, 1.0);
        }
        for i in 0..features {
            for j in 0..features {
                covariance[(i, j)] *= if i == j { 1.0 } else { 1.0 - shrinkage };
            }
            // A feature that does not vary within the classes counts as one that does, a little.
            covariance[(i, i)] += 1e-6;
        }
        let factor = covariance.cholesky().ok_or(NlosError::Degenerate)?;
        #[expect(clippy::cast_possible_truncation, reason = "weights of scores within ±3")]
        let told = means.iter().map(|mean| {
            let weights = factor.solve(mean);
            let bias = -0.5 * weights.dot(mean);
            (weights.iter().map(|w| *w as f32).collect::<Vec<f32>>(), bias as f32)
        });
        let (weights, bias): (Vec<_>, Vec<_>) = told.unzip();
        if bias.iter().all(|b| b.is_finite()) { Ok(Self { weights, bias }) } else { Err(NlosError::Degenerate) }
    }

    /// Logarithms of the posterior of each class, up to a constant.
    pub fn logits(&self, scores: &[f32]) -> impl Iterator<Item = f32> {
        self.weights.iter().zip(&self.bias).map(move |(weights, bias)| {
            weights.iter().zip(scores).fold(*bias, |sum, (weight, score)| sum + weight * score)
        })
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    /// Two normal clouds with known means and covariance: the weights are Σ⁻¹ μ.
    #[test]
    fn weights_are_the_inverse_covariance_times_the_means() {
        // The corners of a parallelogram have the covariance [[1, 0.5], [0.5, 1]] about their middle.
        let corners = [[1.5_f32, 1.5], [-1.5, -1.5], [0.5, -0.5], [-0.5, 0.5]].map(|c| c.map(|v| v * 0.8_f32.sqrt() * 1.118_034 / 1.0));
        let variance = corners.iter().map(|c| f64::from(c[0] * c[0])).sum::<f64>() / 4.0;
        let mixed = corners.iter().map(|c| f64::from(c[0] * c[1])).sum::<f64>() / 4.0;
        let rows: Vec<([f32; 2], usize)> = corners
            .iter()
            .flat_map(|c| [([c[0] + 1.0, c[1]], 0), ([c[0] - 1.0, c[1] + 2.0], 1)])
            .collect();
        let shrinkage = 0.25;
        let learnt = Discriminant::learn(rows.iter().map(|(r, c)| (&r[..], *c, 1.0)), 2, 2, shrinkage).unwrap();
        let (a, b) = (variance + 1e-6, mixed * (1.0 - shrinkage));
        let determinant = a * a - b * b;
        for (class, mean) in [[1.0, 0.0], [-1.0, 2.0]].into_iter().enumerate() {
            let expected = [(a * mean[0] - b * mean[1]) / determinant, (a * mean[1] - b * mean[0]) / determinant];
            for (found, expected) in learnt.weights[class].iter().zip(expected) {
                // Single precision.
                assert!((f64::from(*found) - expected).abs() < 1e-5, "{found} {expected}");
            }
            let bias = -0.5 * (expected[0] * mean[0] + expected[1] * mean[1]);
            assert!((f64::from(learnt.bias[class]) - bias).abs() < 1e-5);
        }
    }
}
