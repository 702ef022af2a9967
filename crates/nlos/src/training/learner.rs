//! The network as [`crate::judging`] wants it: learnt of some groups, asked of others after each pass.

use super::{Settings, train};
use crate::baseline::{Baseline, SHRINKAGE};
use crate::calibration::Logits;
use crate::error::NlosError;
use crate::examples::Examples;
use crate::judging::Learner;
use crate::network::Scratch;
use std::ops::ControlFlow;

/// The network, with a discriminant of the same rows in it.
pub struct NetworkLearner<'a> {
    /// How it is trained.
    pub settings: &'a Settings,
    /// Each fold draws with one of its own.
    pub seed: u64,
    /// Called after each pass.
    pub after: &'a (dyn Fn() + Sync),
}

impl Learner for NetworkLearner<'_> {
    fn logits(
        &self,
        examples: &Examples,
        learn: &[usize],
        ask: &[usize],
        fold: u64,
    ) -> Result<Vec<Vec<Logits>>, NlosError> {
        let baseline = Baseline::learn(examples, learn, SHRINKAGE)?;
        let questions = examples.task.questions();
        let seed = self.seed.wrapping_mul(1_000_003).wrapping_add(fold + 1);
        let (mut passes, mut scratch) = (Vec::new(), Scratch::default());
        train(examples, learn, &baseline, self.settings, seed, |_, network| {
            let mut asked = |row: &usize| {
                let row = &examples.rows[*row];
                let mut logits = Logits::default();
                let scores = baseline.scores(&row.features);
                network.logits(&scores, row.window.as_deref(), &mut scratch, &mut logits[..questions]);
                logits
            };
            passes.push(ask.iter().map(&mut asked).collect());
            (self.after)();
            ControlFlow::Continue(())
        })?;
        Ok(passes)
    }
}
