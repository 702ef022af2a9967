//! Straight lines for many transmitters, fitted together: robust, pooled, with censored values.
//!
//! ```text
//! y = a_i + b_i x + γᵀ s + e,   e ~ Student t_ν(σ),   (a_i, b_i) ~ N((a, b), diag(τ_a², τ_b²))
//! ```
//!
//! x and the shared covariates s are known; the lines of all transmitters are drawn to a common one, the more the less each was heard
//! (partial pooling; Gelman & Hill 2007, ch. 12). Expectation–maximisation: weights `(ν+1)/(ν+e²/σ²)` for the long tails
//! (Lange, Little & Taylor 1989), and for a **censored** value, of which only `y < c` is known, its mean below c (Tobin 1958):
//!
//! ```text
//! E[y | y < c] = m − σ λ,   Var = σ² (1 − λ (λ + z)),   z = (c − m) / σ,   λ = φ(z) / Φ(z)
//! ```
//!
//! A transmitter may also be missed for no reason of level, with probability ε: a censored value counts with the probability
//! that it was the level.

use adit_core::nalgebra::{Matrix2, Vector2};
use serde::Serialize;

/// A value of one transmitter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// Which transmitter.
    pub group: usize,
    /// What the line runs over.
    pub x: f64,
    /// Shared covariates.
    pub shared: [f64; 2],
    /// What was read.
    pub value: Value,
}

/// What was read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// This.
    Read(f64),
    /// Nothing: it lies below this.
    Below(f64),
}

/// What is believed before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PooledParams {
    /// Degrees of freedom ν of the errors.
    pub dof: f64,
    /// The common line before any data.
    pub line: [f64; 2],
    /// How sure that is: standard deviations of a and b. Weighs as one transmitter more.
    pub line_sigma: [f64; 2],
    /// Bounds of the slopes.
    pub slopes: [f64; 2],
    /// Probability ε that a strong transmitter is missed.
    pub missed: f64,
}

/// Lines of all transmitters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PooledLines {
    /// a and b of each transmitter; the common line of one never heard.
    pub lines: Vec<[f64; 2]>,
    /// The common line.
    pub common: [f64; 2],
    /// How the transmitters differ: `τ_a`, `τ_b`.
    pub between: [f64; 2],
    /// Shared coefficients γ.
    pub shared: [f64; 2],
    /// Scale σ of the errors.
    pub sigma: f64,
    /// Logarithm of the likelihood of what was read.
    pub log_likelihood: f64,
    /// Values read.
    pub read: usize,
}

const ROUNDS: usize = 60;
/// σ does not fall below, in the unit of the readings.
const LEAST_SIGMA: f64 = 0.05;

/// One value as the round sees it: expected value, weight, variance beyond its square.
struct Seen {
    y: f64,
    weight: f64,
    variance: f64,
}

/// Fits the lines of `groups` transmitters; `None` of fewer than three values.
pub fn fit(records: &[Record], groups: usize, params: &PooledParams) -> Option<PooledLines> {
    let values =
        || records.iter().filter_map(|r| if let Value::Read(y) = r.value { Some((r, y)) } else { None });
    let read = values().count();
    if read < 3 {
        return None;
    }
    let mut now = PooledLines {
        lines: vec![params.line; groups],
        common: params.line,
        between: params.line_sigma,
        shared: [0.0; 2],
        sigma: 1.0,
        log_likelihood: f64::NEG_INFINITY,
        read,
    };
    // A first scale: the middle of the errors about the line before any data, its level free.
    let offsets = values().map(|(r, y)| y - now.mean(r)).collect();
    let level = crate::robust::median(offsets)?;
    now.common[0] += level;
    now.lines.iter_mut().for_each(|line| line[0] += level);
    now.sigma = crate::robust::spread_about(values().map(|(r, y)| y - now.mean(r)), 0.0)?.max(1.0);
    for _ in 0..ROUNDS {
        now.fit_lines(records, params);
        now.fit_shared(records, params);
        now.fit_common(records, params);
        now.fit_sigma(records, params);
    }
    let dof = params.dof;
    let normaliser = -0.5 * (dof * std::f64::consts::PI).ln() + ln_gamma_ratio(dof);
    now.log_likelihood = values()
        .map(|(r, y)| {
            let e = (y - now.mean(r)) / now.sigma;
            normaliser - now.sigma.ln() - 0.5 * (dof + 1.0) * (e * e / dof).ln_1p()
        })
        .sum();
    Some(now)
}

/// ln Γ((ν+1)/2) − ln Γ(ν/2).
fn ln_gamma_ratio(dof: f64) -> f64 {
    libm::lgamma(0.5 * (dof + 1.0)) - libm::lgamma(0.5 * dof)
}

impl PooledLines {
    /// What a record should read.
    pub fn mean(&self, record: &Record) -> f64 {
        let [a, b] = self.lines.get(record.group).copied().unwrap_or(self.common);
        a + b * record.x + self.beyond(record)
    }

    fn beyond(&self, record: &Record) -> f64 {
        self.shared[0] * record.shared[0] + self.shared[1] * record.shared[1]
    }

    fn see(&self, record: &Record, params: &PooledParams) -> Seen {
        let mean = self.mean(record);
        match record.value {
            Value::Read(y) => {
                let e = (y - mean) / self.sigma;
                Seen { y, weight: (params.dof + 1.0) / (params.dof + e * e), variance: 0.0 }
            }
            Value::Below(limit) => {
                let z = (limit - mean) / self.sigma;
                let (below, hazard) = lower_tail(z);
                let by_level =
                    (1.0 - params.missed) * below / (params.missed + (1.0 - params.missed) * below);
                let variance = self.sigma * self.sigma * (1.0 - hazard * (hazard + z)).max(0.0);
                Seen { y: mean - self.sigma * hazard, weight: by_level, variance }
            }
        }
    }

    fn fit_lines(&mut self, records: &[Record], params: &PooledParams) {
        let prior = Matrix2::from_diagonal(&Vector2::from(self.between.map(|tau| 1.0 / (tau * tau))));
        let pull = prior * Vector2::from(self.common);
        let variance = self.sigma * self.sigma;
        let mut sums = vec![(prior, pull); self.lines.len()];
        for record in records {
            let seen = self.see(record, params);
            let h = Vector2::new(1.0, record.x);
            if let Some((normal, right)) = sums.get_mut(record.group) {
                *normal += h * h.transpose() * (seen.weight / variance);
                *right += h * ((seen.y - self.beyond(record)) * seen.weight / variance);
            }
        }
        for (line, (normal, right)) in self.lines.iter_mut().zip(sums) {
            if let Some(factor) = normal.cholesky() {
                let solved = factor.solve(&right);
                *line = [solved.x, solved.y.clamp(params.slopes[0], params.slopes[1])];
            }
        }
    }

    fn fit_shared(&mut self, records: &[Record], params: &PooledParams) {
        // A weak prior at zero keeps a covariate that never varies at zero.
        let mut normal = Matrix2::identity() * 1e-6;
        let mut right = Vector2::zeros();
        for record in records {
            let seen = self.see(record, params);
            let h = Vector2::from(record.shared);
            normal += h * h.transpose() * seen.weight;
            right += h * ((seen.y - self.mean(record) + self.beyond(record)) * seen.weight);
        }
        if let Some(factor) = normal.cholesky() {
            self.shared = factor.solve(&right).into();
        }
    }

    fn fit_common(&mut self, records: &[Record], params: &PooledParams) {
        let mut heard = vec![false; self.lines.len()];
        for record in records.iter().filter(|record| matches!(record.value, Value::Read(_))) {
            if let Some(heard) = heard.get_mut(record.group) {
                *heard = true;
            }
        }
        let lines: Vec<[f64; 2]> =
            self.lines.iter().zip(&heard).filter(|(_, heard)| **heard).map(|(line, _)| *line).collect();
        let count = lines.len() as f64;
        for axis in 0..2 {
            let tau = self.between[axis] * self.between[axis];
            let before = params.line_sigma[axis] * params.line_sigma[axis];
            let sum: f64 = lines.iter().map(|line| line[axis]).sum();
            let common = (sum / tau + params.line[axis] / before) / (count / tau + 1.0 / before);
            let squares: f64 = lines.iter().map(|line| (line[axis] - common).powi(2)).sum();
            self.common[axis] = common;
            // As if one transmitter more had been seen, that differs by a tenth of what was thought possible.
            let least = before * 0.01;
            self.between[axis] = ((squares + least) / (count + 1.0)).max(least * 0.01).sqrt();
        }
        for (line, heard) in self.lines.iter_mut().zip(heard) {
            if !heard {
                *line = self.common;
            }
        }
    }

    fn fit_sigma(&mut self, records: &[Record], params: &PooledParams) {
        let (mut squares, mut count) = (0.0, 0.0);
        for record in records {
            let seen = self.see(record, params);
            squares += seen.weight * ((seen.y - self.mean(record)).powi(2) + seen.variance);
            // A value read counts whole whatever its weight: that is the step of the t distribution's scale.
            count += if matches!(record.value, Value::Read(_)) { 1.0 } else { seen.weight };
        }
        if count > 0.0 {
            self.sigma = (squares / count).sqrt().max(LEAST_SIGMA);
        }
    }
}

/// Φ(z) and φ(z)/Φ(z), also far down.
fn lower_tail(z: f64) -> (f64, f64) {
    if z < -25.0 {
        // Mills' ratio; the probability itself is below 1e-130.
        return (0.0, -z - 1.0 / z);
    }
    let below = 0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2);
    let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
    (below, density / below)
}
