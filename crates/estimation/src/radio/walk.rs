//! A walk over the lattice: where the tag is, from readings that come one after another.
//!
//! A hidden Markov model (Rabiner 1989): the state is the place, it wanders as a random walk of variance `q Δt` in each direction, and each
//! epoch's readings weigh the places by the likelihood of the [map](super::map). Nobody leaves the lattice: at its edge a
//! walk is turned back. Filtered online; over a whole log, forwards and backwards, smoothed. Nothing is assumed of the start.
//!
//! Errors of consecutive readings are alike, for the body that shadows a tag stays where it is for a while: each counts
//! for a share of a reading only ([`WalkParams::share`]). Between floors there is no way: a walk stays on the floors where
//! it was likely.

use super::lattice::Lattice;
use super::map::{PlaceFix, place_fix};
use super::single;
use alloc::vec;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// How people move and how much a reading counts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WalkParams {
    /// Spread of the random walk after one second, m/√s.
    pub wander_m_sqrt_s: f64,
    /// How much of an independent reading each one is, above 0 to 1.
    pub share: f64,
}

impl Default for WalkParams {
    fn default() -> Self {
        Self { wander_m_sqrt_s: 0.5, share: 0.5 }
    }
}

/// Probability that the model is wrong altogether and the tag anywhere, at each epoch: keeps lost walks from staying lost.
const ANYWHERE: f64 = 1e-6;

/// A walk so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Walk {
    lattice: Lattice,
    params: WalkParams,
    /// Probability of each place; sums to one.
    weights: Vec<f64>,
    spread: Spread,
}

impl Walk {
    /// Anywhere on the lattice. Settings out of range are brought into it.
    pub fn new(lattice: Lattice, params: WalkParams) -> Self {
        let even = 1.0 / lattice.len().max(1) as f64;
        let weights = vec![even; lattice.len()];
        let share = if params.share > 0.0 { params.share.min(1.0) } else { 1.0 };
        let wander_m_sqrt_s = params.wander_m_sqrt_s.clamp(0.0, 100.0);
        Self { lattice, params: WalkParams { wander_m_sqrt_s, share }, weights, spread: Spread::default() }
    }

    /// Time passes, s; none where it does not rise.
    pub fn wander(&mut self, interval_s: f64) {
        if interval_s > 0.0 {
            self.spread.prepare(&self.lattice, self.params.wander_m_sqrt_s * libm::sqrt(interval_s.min(1e6)));
            self.spread.forwards(&self.lattice, &mut self.weights);
        }
    }

    /// Readings are heard: the logarithm of their likelihood at every place.
    pub fn hear(&mut self, log_likelihood: &[f64]) {
        weigh(&mut self.weights, log_likelihood, self.params.share);
    }

    /// Where it is now.
    pub fn fix(&self) -> Option<PlaceFix> {
        place_fix(&self.lattice, &self.weights)
    }
}

/// Places at every epoch of a whole log, from what was heard before and after it.
///
/// Each epoch has the time since the one before, s, and the logarithm of the likelihood at every place. Memory: two numbers to a
/// place and epoch.
pub fn smooth(lattice: &Lattice, params: WalkParams, epochs: &[(f64, Vec<f64>)]) -> Vec<Option<PlaceFix>> {
    let mut walk = Walk::new(lattice.clone(), params);
    let mut forwards: Vec<Vec<f32>> = Vec::with_capacity(epochs.len());
    for (interval_s, log_likelihood) in epochs {
        walk.wander(*interval_s);
        walk.hear(log_likelihood);
        forwards.push(walk.weights.iter().map(|w| single(*w)).collect());
    }
    let mut after = vec![1.0; lattice.len()];
    let mut fixes = vec![None; epochs.len()];
    for (index, forward) in forwards.iter().enumerate().rev() {
        let both: Vec<f64> = forward.iter().zip(&after).map(|(f, b)| f64::from(*f) * b).collect();
        fixes[index] = place_fix(lattice, &both);
        let (interval_s, log_likelihood) = &epochs[index];
        weigh(&mut after, log_likelihood, walk.params.share);
        if *interval_s > 0.0 {
            walk.spread.prepare(lattice, walk.params.wander_m_sqrt_s * libm::sqrt(interval_s.min(1e6)));
            walk.spread.backwards(lattice, &mut after);
        }
        let largest = after.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        for weight in &mut after {
            *weight /= largest;
        }
    }
    fixes
}

fn weigh(weights: &mut [f64], log_likelihood: &[f64], share: f64) {
    let best = log_likelihood.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !best.is_finite() {
        return;
    }
    for (weight, log) in weights.iter_mut().zip(log_likelihood) {
        // A likelihood that is no number is none.
        *weight *= if log.is_nan() { 0.0 } else { libm::exp(share * (log - best)) };
    }
    let total: f64 = weights.iter().sum();
    let floor = ANYWHERE / weights.len() as f64;
    // A sum of zero: the readings rule out all that was thought possible.
    let scale = if total > 0.0 { (1.0 - ANYWHERE) / total } else { 0.0 };
    for weight in weights.iter_mut() {
        *weight = *weight * scale + floor;
    }
}

/// The normal kernel of one step, on whole slabs.
#[derive(Debug, Clone, PartialEq, Default)]
struct Spread {
    sigma_m: f64,
    kernel: Vec<f64>,
    /// What of the kernel about each place falls on places.
    kept: Vec<f64>,
    /// Two buffers of all points.
    from: Vec<f64>,
    to: Vec<f64>,
}

impl Spread {
    fn prepare(&mut self, lattice: &Lattice, sigma_m: f64) {
        let (columns, lines, slabs, _) = lattice.slabs();
        if sigma_m.to_bits() == self.sigma_m.to_bits() && self.kept.len() == lattice.len() {
            return;
        }
        self.sigma_m = sigma_m;
        let steps = sigma_m / lattice.step_m();
        let widest = columns.max(lines) as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most the width of the lattice"
        )]
        let reach = libm::ceil(4.0 * steps).min(widest) as usize;
        // What falls on a square of the lattice: differences of the normal distribution, right for narrow kernels too.
        let below = |x: f64| 0.5 * libm::erfc(-x / (steps.max(1e-9) * core::f64::consts::SQRT_2));
        self.kernel = (0..=reach).map(|k| below(k as f64 + 0.5) - below(k as f64 - 0.5)).collect();
        let points = columns * lines * slabs;
        self.from = vec![0.0; points];
        self.to = vec![0.0; points];
        let mut ones = vec![1.0; lattice.len()];
        self.convolve(lattice, &mut ones);
        self.kept = ones;
    }

    /// `p ← K (p / K 1)`: what would leave the lattice stays.
    fn forwards(&mut self, lattice: &Lattice, weights: &mut [f64]) {
        for (weight, kept) in weights.iter_mut().zip(&self.kept) {
            *weight /= kept;
        }
        self.convolve(lattice, weights);
    }

    /// `b ← (K b) / K 1`, the transpose.
    fn backwards(&mut self, lattice: &Lattice, weights: &mut [f64]) {
        self.convolve(lattice, weights);
        for (weight, kept) in weights.iter_mut().zip(&self.kept) {
            *weight /= kept;
        }
    }

    fn convolve(&mut self, lattice: &Lattice, weights: &mut [f64]) {
        let (columns, lines, slabs, places) = lattice.slabs();
        self.from.fill(0.0);
        for (place, weight) in places.iter().zip(weights.iter()) {
            self.from[*place as usize] = *weight;
        }
        let all_lines = lines * slabs;
        for line in 0..all_lines {
            let span = line * columns..(line + 1) * columns;
            blur(&self.from[span.clone()], &mut self.to[span], 1, columns, &self.kernel);
        }
        for slab in 0..slabs {
            let span = slab * lines * columns..(slab + 1) * lines * columns;
            for column in 0..columns {
                blur(
                    &self.to[span.start + column..span.end],
                    &mut self.from[span.start + column..span.end],
                    columns,
                    lines,
                    &self.kernel,
                );
            }
        }
        for (place, weight) in places.iter().zip(weights.iter_mut()) {
            *weight = self.from[*place as usize];
        }
    }
}

/// One line of `count` values, `stride` apart, blurred by a symmetric kernel.
fn blur(from: &[f64], to: &mut [f64], stride: usize, count: usize, kernel: &[f64]) {
    for index in 0..count {
        let mut sum = kernel[0] * from[index * stride];
        for (away, weight) in kernel.iter().enumerate().skip(1) {
            if index >= away {
                sum += weight * from[(index - away) * stride];
            }
            if index + away < count {
                sum += weight * from[(index + away) * stride];
            }
        }
        to[index * stride] = sum;
    }
}
