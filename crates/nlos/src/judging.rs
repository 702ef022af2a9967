//! Judged on groups that were held out: how well what is learnt of one place serves at another.

use crate::baseline::Baseline;
use crate::calibration;
use crate::error::NlosError;
use crate::examples::Examples;
use crate::measures::Measures;
use rayon::prelude::*;

/// What is learnt of some rows and asked of others.
pub trait Learner: Sync {
    /// Learns of the rows `learn` and gives the logits of the rows `ask`.
    fn logits(&self, examples: &Examples, learn: &[usize], ask: &[usize], fold: u64) -> Result<Vec<Vec<f32>>, NlosError>;
}

/// The discriminant.
#[derive(Debug, Clone, Copy)]
pub struct BaselineLearner {
    /// Of the correlations.
    pub shrinkage: f64,
}

impl Learner for BaselineLearner {
    fn logits(&self, examples: &Examples, learn: &[usize], ask: &[usize], _: u64) -> Result<Vec<Vec<f32>>, NlosError> {
        let baseline = Baseline::learn(examples, learn, self.shrinkage)?;
        Ok(ask.iter().map(|row| baseline.logits(&examples.rows[*row].features)).collect())
    }
}

/// Judgements of every row by what was learnt without its group.
#[derive(Debug, Clone)]
pub struct HeldOut {
    /// Of every judged row its number.
    pub rows: Vec<usize>,
    /// Its logits.
    pub logits: Vec<Vec<f32>>,
}

impl HeldOut {
    /// Fold by fold; `also` are rows to learn from that are never held out.
    pub fn of(
        learner: &impl Learner,
        examples: &Examples,
        folds: &[Vec<usize>],
        also: &[usize],
    ) -> Result<Self, NlosError> {
        let judged: Vec<(Vec<usize>, Vec<Vec<f32>>)> = folds
            .par_iter()
            .enumerate()
            .map(|(fold, held)| {
                let everything = folds.iter().flatten();
                let others: Vec<usize> = everything.copied().filter(|group| !held.contains(group)).collect();
                let of = |groups: &[usize]| -> Vec<usize> {
                    (0..examples.rows.len()).filter(|row| groups.contains(&examples.rows[*row].group)).collect()
                };
                let mut learn = of(&others);
                learn.extend(also);
                let ask = of(held);
                let logits = learner.logits(examples, &learn, &ask, fold as u64)?;
                Ok((ask, logits))
            })
            .collect::<Result<_, NlosError>>()?;
        let (rows, logits): (Vec<_>, Vec<_>) = judged.into_iter().unzip();
        Ok(Self { rows: rows.concat(), logits: logits.concat() })
    }

    /// The temperature that makes them hold.
    pub fn temperature(&self, examples: &Examples) -> f32 {
        let weights = examples.weights(&self.rows);
        let judged = self.rows.iter().zip(&self.logits).zip(weights);
        let judged: Vec<_> =
            judged.map(|((row, logits), w)| (examples.rows[*row].class, logits.clone(), w)).collect();
        calibration::temperature(&judged)
    }

    /// How good they are at this temperature.
    pub fn measures(&self, examples: &Examples, temperature: f32) -> Measures {
        let mut probabilities = self.logits.clone();
        for logits in &mut probabilities {
            calibration::softmax(logits, temperature);
        }
        let judged = self.rows.iter().zip(&probabilities);
        Measures::of(&examples.class_names(), judged.map(|(row, p)| (examples.rows[*row].class, &p[..])))
    }
}
