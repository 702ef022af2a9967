//! The sine cosine algorithm (Mirjalili 2016, eq. 3.1–3.4), as in system S1, eq. 16.
//!
//! ```text
//! x ← x + φ1 sin φ2 |φ3 P − x|   if φ4 < 0.5,   else with cos φ2
//! φ1 = a − t a / T,   φ2 even in 0…2π,   φ3 in 0…2,   φ4 in 0…1, all drawn anew for each coordinate;   P the best place so far
//! ```
//!
//! t counts generations from 0, T is as many as the budget has. An agent moves only where it costs less (the papers are silent; `OriginalSCA` of mealpy does the
//! same). Who leaves the bounds stays at them.
//!
//! **`φ3 P` draws towards zero, not only towards P**: the algorithm is at its best where the answer is the origin of the coordinates. Give parameters so
//! that zero is a good guess, as logarithms of factors are.

use super::swarm::{Dice, Swarm, clamp};
use super::{Optimiser, Task, Trace};

/// The sine cosine algorithm's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SineCosine {
    /// Amplitude a at the start.
    pub amplitude: f64,
}

impl Default for SineCosine {
    fn default() -> Self {
        Self { amplitude: 2.0 }
    }
}

/// Stream of its random numbers.
const STREAM: u64 = 2;

impl SineCosine {
    /// Where each agent tries next; `share` of the generations is past.
    pub(super) fn swing(self, swarm: &Swarm, task: &Task, share: f64, dice: &mut Dice) -> Vec<Vec<f64>> {
        let amplitude = self.amplitude * (1.0 - share).max(0.0);
        let swung = |((x, best), bound): ((&f64, &f64), &[f64; 2]), dice: &mut Dice| {
            let (sin, cos) = (std::f64::consts::TAU * dice.unit()).sin_cos();
            let away = (2.0 * dice.unit() * best - x).abs();
            let wave = if dice.unit() < 0.5 { sin } else { cos };
            clamp(x + amplitude * wave * away, *bound)
        };
        let agent = |point: &Vec<f64>| {
            point.iter().zip(&swarm.best).zip(&task.bounds).map(|one| swung(one, dice)).collect()
        };
        swarm.points.iter().map(agent).collect()
    }
}

impl Optimiser for SineCosine {
    fn minimise(&self, search: &mut dyn Trace) {
        let task = search.task().clone();
        let mut dice = Dice::new(task.seed, STREAM);
        let points = Swarm::places(&task, &mut dice);
        let Some(costs) = search.evaluate(&points) else { return };
        let mut swarm = Swarm::new(points, costs);
        let generations = (task.evaluations / task.agents).saturating_sub(1).max(1) as f64;
        for generation in 0_u32.. {
            let tried = self.swing(&swarm, &task, f64::from(generation) / generations, &mut dice);
            let Some(costs) = search.evaluate(&tried) else { return };
            swarm.look(&tried, &costs);
            for (agent, (point, cost)) in tried.into_iter().zip(costs).enumerate() {
                if cost < swarm.costs[agent] {
                    swarm.points[agent] = point;
                    swarm.costs[agent] = cost;
                }
            }
        }
    }
}
