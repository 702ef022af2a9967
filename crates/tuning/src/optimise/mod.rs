//! Optimisers: the parameters within bounds at which a cost is least, by trial alone.
//!
//! | name | method | module |
//! |---|---|---|
//! | `bat` | bat algorithm (Yang 2010) | [`bat`] |
//! | `sca` | sine cosine algorithm (Mirjalili 2016) | [`sine_cosine`] |
//! | `scaba` | both in each generation, as in system S1 (Lu, Zhao & Xu) | [`sine_cosine_bat`] |
//! | `cmaes` | covariance matrix adaptation with restarts, of the crate `genoxide` | [`covariance_matrix`] |
//!
//! All are asked the same way: a [`Task`] says where to look, with what budget and seed; a [`Search`] evaluates whole generations in
//! parallel (rayon), counts, remembers, and ends when the budget is spent. What it remembers, a [`Record`], is all there is to
//! resume a search: every method is deterministic, so it is run again with the values that are known already, and goes on where they end.
//!
//! ```
//! use adit_tuning::optimise::{Method, Search, Task};
//! let task = Task { bounds: vec![[-5.0, 5.0]; 3], agents: 20, evaluations: 2000, seed: 1 };
//! let cost = |x: &[f64]| x.iter().map(|v| (v - 1.0).powi(2)).sum::<f64>();
//! let found = Search::new(Method::CovarianceMatrix, task, &cost)?.run();
//! assert!(found.cost < 1e-6);
//! # Ok::<(), adit_tuning::TuningError>(())
//! ```
//!
//! Noise parameters differ by powers of ten: give their logarithms as the parameters.

pub mod bat;
pub mod covariance_matrix;
mod search;
pub mod sine_cosine;
pub mod sine_cosine_bat;
mod swarm;

pub use search::{Found, Progress, Record, Search, Trace};

use serde::{Deserialize, Serialize};

/// Where to look and for how long.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Least and largest value of each parameter.
    pub bounds: Vec<[f64; 2]>,
    /// Agents of a generation, 4 at the least; CMA-ES doubles them at each restart.
    pub agents: usize,
    /// Evaluations of the cost in all.
    pub evaluations: usize,
    /// Of every random draw.
    pub seed: u64,
}

/// The methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Method {
    /// Bat algorithm.
    #[serde(rename = "bat")]
    Bat,
    /// Sine cosine algorithm.
    #[serde(rename = "sca")]
    SineCosine,
    /// Both, as in S1.
    #[serde(rename = "scaba")]
    SineCosineBat,
    /// CMA-ES with restarts.
    #[serde(rename = "cmaes")]
    CovarianceMatrix,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Bat, Self::SineCosine, Self::SineCosineBat, Self::CovarianceMatrix];

    /// As on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bat => "bat",
            Self::SineCosine => "sca",
            Self::SineCosineBat => "scaba",
            Self::CovarianceMatrix => "cmaes",
        }
    }

    /// From its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }

    /// The method with its usual settings.
    pub fn optimiser(self) -> Box<dyn Optimiser> {
        match self {
            Self::Bat => Box::new(bat::Bat::default()),
            Self::SineCosine => Box::new(sine_cosine::SineCosine::default()),
            Self::SineCosineBat => Box::new(sine_cosine_bat::SineCosineBat::default()),
            Self::CovarianceMatrix => Box::new(covariance_matrix::CovarianceMatrix::default()),
        }
    }
}

/// A way to look for the least cost.
///
/// It draws all its random numbers from [`Task::seed`] and does nothing that depends on anything but the costs it is told: a search is resumed by
/// running it again.
pub trait Optimiser {
    /// Asks for generation after generation until [`Trace::evaluate`] says that it is over.
    fn minimise(&self, search: &mut dyn Trace);
}
