//! The modern reference: CMA-ES (Hansen & Ostermeier 2001; parameters of Hansen's tutorial of 2016), of the crate `genoxide`, restarted with twice the
//! agents each time it has converged (IPOP, Auger & Hansen 2005) until the budget is spent.
//!
//! It begins, and begins again, at a place drawn evenly within the bounds. The crate does its own arithmetic, the same bits on every platform.

use super::{Optimiser, Trace};
use genoxide::algorithm::cmaes::Restarts;
use genoxide::algorithm::{Algorithm, Cmaes};
use genoxide::genome::Real;
use genoxide::{Fitness, Result};

/// Its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CovarianceMatrix {
    /// First standard deviation, as a share of the width of the bounds.
    pub step: f64,
}

impl Default for CovarianceMatrix {
    fn default() -> Self {
        Self { step: 0.3 }
    }
}

impl CovarianceMatrix {
    fn follow(self, search: &mut dyn Trace) -> Result<()> {
        let task = search.task();
        let genes = Real::new(task.bounds.iter().map(|[low, high]| *low..=*high))?;
        let mut strategy = Cmaes::builder(genes)
            .minimize()
            .seed(task.seed)
            .population_size(task.agents)
            .initial_step(self.step)
            .restarts(Restarts::Ipop)
            .build()?;
        loop {
            let points: Vec<Vec<f64>> = strategy.ask().iter().map(|point| point.to_vec()).collect();
            let Some(costs) = search.evaluate(&points) else { return Ok(()) };
            let costs: Vec<Fitness> = costs.into_iter().map(Fitness::new).collect();
            strategy.tell(&costs)?;
        }
    }
}

impl Optimiser for CovarianceMatrix {
    fn minimise(&self, search: &mut dyn Trace) {
        // The crate refuses only settings and bounds that no search is begun with, and costs that were not asked for.
        let _ = self.follow(search);
    }
}
