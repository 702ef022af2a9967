//! The modern reference: CMA-ES (Hansen & Ostermeier 2001), active, of the crate `fcmaes-core`, with restarts of twice the population each time
//! (IPOP, Auger & Hansen 2005) until the budget is spent.
//!
//! It begins with `4 + 3 ln n` agents at the middle of the bounds and steps of 0.3 of their half width; each restart begins at a place drawn evenly.

use super::swarm::{Dice, clamp};
use super::{Optimiser, Trace};
use fcmaes_core::Fitness;
use fcmaes_core::cmaes::{Cmaes, CmaesParams};

/// Its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CovarianceMatrix {
    /// First steps, as a share of half the width of the bounds.
    pub step: f64,
}

impl Default for CovarianceMatrix {
    fn default() -> Self {
        Self { step: 0.3 }
    }
}

/// Stream of its random numbers.
const STREAM: u64 = 4;
/// A cost that no comparison stumbles over.
const HIGHEST: f64 = 1e99;

impl Optimiser for CovarianceMatrix {
    fn minimise(&self, search: &mut dyn Trace) {
        let task = search.task().clone();
        let mut dice = Dice::new(task.seed, STREAM);
        let (lower, upper): (Vec<f64>, Vec<f64>) =
            task.bounds.iter().map(|[low, high]| (*low, *high)).unzip();
        let dimensions = task.bounds.len();
        #[expect(clippy::cast_possible_truncation, reason = "a few agents")]
        let mut agents = (4.0 + 3.0 * (dimensions as f64).ln()).max(4.0) as i32;
        let mut guess: Vec<f64> = task.bounds.iter().map(|[low, high]| 0.5 * (low + high)).collect();
        for run in 0_u32.. {
            let mut fitness = Fitness::bounded(dimensions, 1, &lower, &upper);
            fitness.set_normalize(true);
            let params = CmaesParams {
                popsize: agents,
                max_evaluations: search.left() as u64,
                seed: task.seed,
                runid: i64::from(run),
                ..CmaesParams::default()
            };
            let mut run = Cmaes::new(fitness, &guess, &[self.step], &params);
            loop {
                let mut points = run.ask();
                for point in &mut points {
                    for (value, bound) in point.iter_mut().zip(&task.bounds) {
                        *value = clamp(*value, *bound);
                    }
                }
                let Some(costs) = search.evaluate(&points) else { return };
                let costs: Vec<f64> = costs.into_iter().map(|cost| cost.min(HIGHEST)).collect();
                if run.tell(&costs) != 0 {
                    break;
                }
            }
            agents = agents.saturating_mul(2).min(1 << 20);
            guess = task.bounds.iter().map(|[low, high]| low + (high - low) * dice.unit()).collect();
        }
    }
}
