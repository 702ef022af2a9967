//! SCABA, the optimiser of system S1 (Lu, Zhao & Xu, steps 1 to 10): bats that fly, then swing.
//!
//! Every generation is first one of the [bat algorithm](super::bat) with its local search (steps 4 to 6), then one of the
//! [sine cosine algorithm](super::sine_cosine) begun at every bat (step 7). All places, those flown to and those swung to, are ranked and
//! the best kept (step 8): as many as there are agents; the paper does not say how many. A generation costs twice the evaluations of either, so with the
//! same budget there are half as many.

use super::bat::{Bat, Colony};
use super::sine_cosine::SineCosine;
use super::swarm::{Dice, Swarm};
use super::{Optimiser, Trace};

/// Settings of both halves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SineCosineBat {
    /// Of the bats.
    pub bat: Bat,
    /// Of the swing.
    pub sine_cosine: SineCosine,
}

/// Stream of its random numbers.
const STREAM: u64 = 3;

impl Optimiser for SineCosineBat {
    fn minimise(&self, search: &mut dyn Trace) {
        let task = search.task().clone();
        let mut dice = Dice::new(task.seed, STREAM);
        let points = Swarm::places(&task, &mut dice);
        let Some(costs) = search.evaluate(&points) else { return };
        let mut swarm = Swarm::new(points, costs);
        let mut colony = Colony::new(self.bat, &task);
        let generations = ((task.evaluations - task.agents) / (2 * task.agents)).max(1) as f64;
        for generation in 0_u32.. {
            let flown = colony.fly(&swarm, &task, &mut dice);
            let Some(costs) = search.evaluate(&flown) else { return };
            colony.settle(&mut swarm, flown, &costs, &mut dice);

            let share = f64::from(generation) / generations;
            let swung = self.sine_cosine.swing(&swarm, &task, share, &mut dice);
            let Some(costs) = search.evaluate(&swung) else { return };
            swarm.look(&swung, &costs);
            keep_best(&mut swarm, swung, costs);
        }
    }
}

/// The best of the agents and of the newcomers, as many as there are agents.
fn keep_best(swarm: &mut Swarm, points: Vec<Vec<f64>>, costs: Vec<f64>) {
    let agents = swarm.points.len();
    let all = swarm.points.drain(..).chain(points);
    let mut ranked: Vec<(f64, Vec<f64>)> = swarm.costs.drain(..).chain(costs).zip(all).collect();
    // Stable: of equals the elder stays.
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.truncate(agents);
    (swarm.costs, swarm.points) = ranked.into_iter().unzip();
}
