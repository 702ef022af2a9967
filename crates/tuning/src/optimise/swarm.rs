//! What the swarms share: agents within bounds, their costs, and the best of all.

use super::Task;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Random numbers of one method: the seed's, in a stream of its own.
pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// From 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        // The upper 53 bits of a word.
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From −1 to below 1.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}

/// Agents, what they cost, and the best place that any has been at.
pub struct Swarm {
    pub points: Vec<Vec<f64>>,
    pub costs: Vec<f64>,
    pub best: Vec<f64>,
    pub best_cost: f64,
}

impl Swarm {
    /// Evenly at random within the bounds.
    pub fn places(task: &Task, dice: &mut Dice) -> Vec<Vec<f64>> {
        let point = |dice: &mut Dice| {
            task.bounds.iter().map(|[low, high]| low + (high - low) * dice.unit()).collect::<Vec<f64>>()
        };
        (0..task.agents).map(|_| point(dice)).collect()
    }

    pub fn new(points: Vec<Vec<f64>>, costs: Vec<f64>) -> Self {
        let mut swarm = Self {
            best: points.first().cloned().unwrap_or_default(),
            best_cost: f64::INFINITY,
            points,
            costs,
        };
        let (points, costs) = (swarm.points.clone(), swarm.costs.clone());
        swarm.look(&points, &costs);
        swarm
    }

    /// Remembers the best of a generation.
    pub fn look(&mut self, points: &[Vec<f64>], costs: &[f64]) {
        for (point, cost) in points.iter().zip(costs) {
            if *cost < self.best_cost {
                self.best_cost = *cost;
                self.best.clone_from(point);
            }
        }
    }
}

/// A value brought back within its bounds.
pub fn clamp(value: f64, [low, high]: [f64; 2]) -> f64 {
    // A NaN of a runaway velocity ends at the lower bound.
    if value > low { value.min(high) } else { low }
}
