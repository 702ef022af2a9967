//! The baseline: what features made by hand tell.

use crate::discriminant::Discriminant;
use crate::error::NlosError;
use crate::examples::Examples;
use crate::features;
use crate::normal_scores::{self, LEVELS, NormalScores};

/// How much correlations are shrunk; chosen on uwb-cir by geometry (`docs/methods/nlos.md`).
pub const SHRINKAGE: f64 = 0.2;

/// Features made normal, and their discriminant.
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// Which of [`features::NAMES`].
    pub used: Vec<usize>,
    /// How each of them is made normal.
    pub normal: Vec<NormalScores>,
    /// Over their scores.
    pub discriminant: Discriminant,
    scores: [f32; LEVELS],
}

impl Baseline {
    /// From its parts.
    pub fn new(used: Vec<usize>, normal: Vec<NormalScores>, discriminant: Discriminant) -> Self {
        Self { used, normal, discriminant, scores: normal_scores::scores() }
    }

    /// From some rows, with the features that most of them tell.
    pub fn learn(examples: &Examples, rows: &[usize], shrinkage: f64) -> Result<Self, NlosError> {
        let weights = examples.weights(rows);
        let value = |feature: usize| rows.iter().map(move |row| examples.rows[*row].features[feature]);
        let told = |feature: &usize| 2 * value(*feature).filter(|v| !v.is_nan()).count() > rows.len();
        let used: Vec<usize> = (0..features::COUNT).filter(told).collect();
        let of = |feature: &usize| NormalScores::learn(value(*feature));
        let normal: Vec<NormalScores> = used.iter().filter_map(of).collect();
        if normal.is_empty() || normal.len() < used.len() {
            return Err(NlosError::NoFeatures);
        }
        let empty = Discriminant { weights: Vec::new(), bias: Vec::new() };
        let mut baseline = Self::new(used, normal, empty);
        let scores: Vec<Vec<f32>> =
            rows.iter().map(|row| baseline.scores(&examples.rows[*row].features)).collect();
        let learnt = rows.iter().zip(&scores).zip(&weights).map(|((row, s), w)| (&s[..], examples.rows[*row].class, *w));
        baseline.discriminant =
            Discriminant::learn(learnt, baseline.used.len(), examples.classes.len(), shrinkage)?;
        Ok(baseline)
    }

    /// The features made normal, in the order of [`Self::used`].
    pub fn scores(&self, features: &[f32; features::COUNT]) -> Vec<f32> {
        let mut scores = vec![0.0; self.used.len()];
        self.write_scores(features, &mut scores);
        scores
    }

    /// The same into place.
    pub fn write_scores(&self, features: &[f32; features::COUNT], into: &mut [f32]) {
        for ((score, feature), normal) in into.iter_mut().zip(&self.used).zip(&self.normal) {
            *score = normal.score(features[*feature], &self.scores);
        }
    }

    /// Logarithms of the posterior of each class, up to a constant.
    pub fn logits(&self, features: &[f32; features::COUNT]) -> Vec<f32> {
        self.discriminant.logits(&self.scores(features)).collect()
    }
}
