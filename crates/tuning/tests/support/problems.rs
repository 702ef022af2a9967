//! Functions to search on, the costs that mealpy found on them, and how two sets of runs compare. Also of `examples/optimise_results.rs`.
#![allow(dead_code, reason = "the test and the example use a part each")]
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_tuning::optimise::{Found, Method, Optimiser, Search, Task};
use std::cmp::Ordering;

pub const SEEDS: u64 = 30;
pub const AGENTS: usize = 30;
/// 30 agents × 200 generations and the first places, as mealpy counts: 6030. `DevBA` takes 6250.
pub const EVALUATIONS: usize = AGENTS * 201;
const DIMENSIONS: usize = 8;

pub fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum()
}

pub fn rastrigin(x: &[f64]) -> f64 {
    x.iter().map(|v| 10.0 + v * v - 10.0 * (std::f64::consts::TAU * v).cos()).sum()
}

fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|pair| 100.0 * (pair[1] - pair[0].powi(2)).powi(2) + (1.0 - pair[0]).powi(2)).sum()
}

/// A function, and where its optimum stands, as in `ci/rival/mealpy_optimisers.py`.
#[derive(Clone, Copy)]
pub struct Problem {
    pub name: &'static str,
    pub optimum: &'static str,
    function: fn(&[f64]) -> f64,
    half: f64,
    /// As a share of `half`.
    shift: f64,
}

const fn problem(
    name: &'static str,
    optimum: &'static str,
    function: fn(&[f64]) -> f64,
    half: f64,
    shift: f64,
) -> Problem {
    Problem { name, optimum, function, half, shift }
}

pub const PROBLEMS: [Problem; 5] = [
    problem("sphere", "origin", sphere, 10.0, 0.0),
    problem("sphere", "shifted", sphere, 10.0, 0.3),
    problem("rastrigin", "origin", rastrigin, 5.12, 0.0),
    problem("rastrigin", "shifted", rastrigin, 5.12, 0.3),
    problem("rosenbrock", "ones", rosenbrock, 5.0, 0.0),
];

/// Rastrigin's function turned by a Householder reflection, so that no coordinate can be searched alone.
pub const TURNED: Problem = problem("rastrigin, turned", "shifted", turned_rastrigin, 5.12, 0.3);

fn turned_rastrigin(x: &[f64]) -> f64 {
    let normal: Vec<f64> = (0..x.len()).map(|k| 1.0 + k as f64 / x.len() as f64).collect();
    let square: f64 = normal.iter().map(|v| v * v).sum();
    let along: f64 = normal.iter().zip(x).map(|(v, x)| v * x).sum();
    rastrigin(&x.iter().zip(&normal).map(|(x, v)| x - 2.0 * along / square * v).collect::<Vec<_>>())
}

impl Problem {
    pub fn run(&self, method: Method, seed: u64) -> Found {
        self.run_with(method.optimiser().as_ref(), seed)
    }

    pub fn run_with(&self, optimiser: &dyn Optimiser, seed: u64) -> Found {
        let bounds = vec![[-self.half, self.half]; DIMENSIONS];
        let task = Task { bounds, agents: AGENTS, evaluations: EVALUATIONS, seed };
        let cost =
            |x: &[f64]| (self.function)(&x.iter().map(|v| v - self.shift * self.half).collect::<Vec<_>>());
        // The name is not asked for.
        Search::new(Method::Bat, task, &cost).unwrap().run_with(optimiser)
    }

    /// The least cost of each seed.
    pub fn costs(&self, method: Method) -> Vec<f64> {
        self.costs_with(method.optimiser().as_ref())
    }

    pub fn costs_with(&self, optimiser: &dyn Optimiser) -> Vec<f64> {
        (0..SEEDS).map(|seed| self.run_with(optimiser, seed).cost).collect()
    }

    /// The same of mealpy's `DevBA` or `OriginalSCA`.
    pub fn rival(&self, optimiser: &str) -> Vec<f64> {
        let wanted = format!("{},{},{optimiser},", self.name, self.optimum);
        let costs: Vec<f64> = include_str!("../reference/mealpy.csv")
            .lines()
            .filter(|line| line.starts_with(&wanted))
            .map(|line| line.rsplit(',').next().unwrap().parse().unwrap())
            .collect();
        assert_eq!(costs.len() as u64, SEEDS, "{wanted}");
        costs
    }
}

pub fn mean(costs: &[f64]) -> f64 {
    costs.iter().sum::<f64>() / costs.len() as f64
}

pub fn median(costs: &[f64]) -> f64 {
    let mut sorted = costs.to_vec();
    sorted.sort_by(f64::total_cmp);
    f64::midpoint(sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2])
}

/// Of all pairs of a run of ours and one of theirs, the share in which ours costs less, and how many standard deviations that is above a half
/// if they do not differ (Wilcoxon 1945; Mann & Whitney 1947; without ties, of which there are none). The runs are not paired: a
/// seed means nothing across programs.
pub fn better(ours: &[f64], theirs: &[f64]) -> (f64, f64) {
    let (n, m) = (ours.len() as f64, theirs.len() as f64);
    let win = |our: &f64, their: &f64| match our.total_cmp(their) {
        Ordering::Less => 1.0,
        Ordering::Equal => 0.5,
        Ordering::Greater => 0.0,
    };
    let wins: f64 = ours.iter().map(|our| theirs.iter().map(|their| win(our, their)).sum::<f64>()).sum();
    (wins / (n * m), (wins - 0.5 * n * m) / (n * m * (n + m + 1.0) / 12.0).sqrt())
}
