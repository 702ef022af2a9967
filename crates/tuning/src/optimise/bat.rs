//! The bat algorithm (Yang 2010, *A new metaheuristic bat-inspired algorithm*, eq. 2–6), as in system S1, eq. 13–15.
//!
//! ```text
//! f = f_min + (f_max − f_min) β,   v ← v + (x − x_best) f,   x ← x + v
//! with probability 1 − r instead:  x_new = x_old + ε Ā            Ā mean loudness
//! x_new is taken where rand < A and it is no worse; then A ← α A,  r ← r₀ (1 − e^(−γ t))
//! ```
//!
//! Where the paper is silent:
//!
//! - `x_old` of the local search is the best place found so far, ε Ā is a share of the width of each bound;
//! - **ε** is drawn for each coordinate and has every order of size, `sign(u) |u|^tail` with u even from −1 to 1: at a [`Bat::tail`] of 30 half of the
//!   coordinates move by less than a billionth of the width, a few far. So the search closes in without being told how far it is, and leaves the first
//!   hollow (`docs/methods/optimise.md` has what even draws do instead, and what this costs where the coordinates hang together);
//! - who leaves the bounds stays at them, and loses its velocity along them.
//!
//! The velocity has the sign of Yang and of S1: it leads **away** from the best place. What finds the minimum is the local search.

use super::swarm::{Dice, Swarm, clamp};
use super::{Optimiser, Task, Trace};

/// The bat algorithm's settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bat {
    /// Least and largest frequency.
    pub frequencies: [f64; 2],
    /// Loudness at the start.
    pub loudness: f64,
    /// Its factor at each success, α.
    pub fade: f64,
    /// Pulse rate in the end, r₀.
    pub pulse_rate: f64,
    /// How fast it gets there, γ, for each generation.
    pub pulse_growth: f64,
    /// Power of the local search's draws; 1: even ones.
    pub tail: i32,
}

impl Default for Bat {
    fn default() -> Self {
        Self {
            frequencies: [0.0, 2.0],
            loudness: 1.0,
            fade: 0.9,
            pulse_rate: 0.2,
            pulse_growth: 0.1,
            tail: 30,
        }
    }
}

/// Stream of its random numbers.
const STREAM: u64 = 1;

/// Bats in flight.
pub(super) struct Colony {
    settings: Bat,
    velocities: Vec<Vec<f64>>,
    loudness: Vec<f64>,
    pulse_rates: Vec<f64>,
    generation: f64,
}

impl Colony {
    pub fn new(settings: Bat, task: &Task) -> Self {
        Self {
            settings,
            velocities: vec![vec![0.0; task.bounds.len()]; task.agents],
            loudness: vec![settings.loudness; task.agents],
            pulse_rates: vec![0.0; task.agents],
            generation: 0.0,
        }
    }

    /// Where each bat tries next.
    pub fn fly(&mut self, swarm: &Swarm, task: &Task, dice: &mut Dice) -> Vec<Vec<f64>> {
        self.generation += 1.0;
        let mean_loudness = self.loudness.iter().sum::<f64>() / self.loudness.len().max(1) as f64;
        let [slowest, fastest] = self.settings.frequencies;
        let mut tried = Vec::with_capacity(swarm.points.len());
        for ((point, velocity), pulse_rate) in
            swarm.points.iter().zip(&mut self.velocities).zip(&self.pulse_rates)
        {
            let frequency = slowest + (fastest - slowest) * dice.unit();
            let local = dice.unit() > *pulse_rate;
            let mut next = Vec::with_capacity(point.len());
            for (((x, v), best), bound) in point.iter().zip(velocity).zip(&swarm.best).zip(&task.bounds) {
                *v += (x - best) * frequency;
                let flown = x + *v;
                if flown < bound[0] || flown > bound[1] {
                    *v = 0.0;
                }
                let near = best + self.settings.draw(dice) * mean_loudness * (bound[1] - bound[0]);
                next.push(clamp(if local { near } else { flown }, *bound));
            }
            tried.push(next);
        }
        tried
    }

    /// Takes what was tried where it is loud enough and no worse.
    pub fn settle(&mut self, swarm: &mut Swarm, tried: Vec<Vec<f64>>, costs: &[f64], dice: &mut Dice) {
        swarm.look(&tried, costs);
        let Bat { fade, pulse_rate, pulse_growth, .. } = self.settings;
        for (agent, (point, cost)) in tried.into_iter().zip(costs).enumerate() {
            let loud = dice.unit() < self.loudness[agent];
            if loud && *cost <= swarm.costs[agent] {
                swarm.points[agent] = point;
                swarm.costs[agent] = *cost;
                self.loudness[agent] *= fade;
                self.pulse_rates[agent] = pulse_rate * (1.0 - (-pulse_growth * self.generation).exp());
            }
        }
    }
}

impl Bat {
    /// ε, of any order of size.
    fn draw(&self, dice: &mut Dice) -> f64 {
        let u = dice.signed();
        u.abs().powi(self.tail).copysign(u)
    }
}

impl Optimiser for Bat {
    fn minimise(&self, search: &mut dyn Trace) {
        let task = search.task().clone();
        let mut dice = Dice::new(task.seed, STREAM);
        let points = Swarm::places(&task, &mut dice);
        let Some(costs) = search.evaluate(&points) else { return };
        let mut swarm = Swarm::new(points, costs);
        let mut colony = Colony::new(*self, &task);
        loop {
            let tried = colony.fly(&swarm, &task, &mut dice);
            let Some(costs) = search.evaluate(&tried) else { return };
            colony.settle(&mut swarm, tried, &costs, &mut dice);
        }
    }
}
