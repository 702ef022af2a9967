//! The baseline: what features made by hand tell.

use crate::calibration::Logits;
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
    /// Over their scores, one for each question.
    pub discriminants: Vec<Discriminant>,
    scores: [f32; LEVELS],
}

impl Baseline {
    /// From its parts.
    pub fn new(used: Vec<usize>, normal: Vec<NormalScores>, discriminants: Vec<Discriminant>) -> Self {
        Self { used, normal, discriminants, scores: normal_scores::scores() }
    }

    /// From some rows, with the features that most of them tell.
    pub fn learn(examples: &Examples, rows: &[usize], shrinkage: f64) -> Result<Self, NlosError> {
        let value = |feature: usize| rows.iter().map(move |row| examples.rows[*row].features[feature]);
        let told = |feature: &usize| 2 * value(*feature).filter(|v| !v.is_nan()).count() > rows.len();
        let used: Vec<usize> = (0..features::COUNT).filter(told).collect();
        let of = |feature: &usize| NormalScores::learn(value(*feature));
        let normal: Vec<NormalScores> = used.iter().filter_map(of).collect();
        if normal.is_empty() || normal.len() < used.len() {
            return Err(NlosError::NoFeatures);
        }
        let mut baseline = Self::new(used, normal, Vec::new());
        let scores: Vec<Vec<f32>> =
            rows.iter().map(|row| baseline.scores(&examples.rows[*row].features)).collect();
        for question in 0..examples.task.questions() {
            let weights = examples.weights(rows, question);
            let learnt = rows.iter().zip(&scores).zip(&weights).filter_map(|((row, scores), weight)| {
                Some((&scores[..], examples.rows[*row].answer(question)?, *weight))
            });
            baseline.discriminants.push(Discriminant::learn(learnt, baseline.used.len(), shrinkage)?);
        }
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

    /// The logit of each question.
    pub fn logits(&self, features: &[f32; features::COUNT]) -> Logits {
        let scores = self.scores(features);
        let mut logits = Logits::default();
        for (logit, discriminant) in logits.iter_mut().zip(&self.discriminants) {
            *logit = discriminant.logit(&scores);
        }
        logits
    }
}
