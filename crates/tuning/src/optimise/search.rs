//! The one door to the cost: evaluates generations, counts, remembers, resumes.

use super::{Method, Optimiser, Task};
use crate::error::TuningError;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Fewest agents of a generation.
const FEWEST_AGENTS: usize = 4;
/// Most agents and parameters.
const MOST: usize = 1 << 20;

/// What an optimiser sees of a search.
pub trait Trace {
    /// The task.
    fn task(&self) -> &Task;

    /// Costs of a generation, each point within the bounds. `None` when the search is over: the budget is spent, or it was stopped; what could
    /// still be evaluated of the generation then counts for the result.
    fn evaluate(&mut self, points: &[Vec<f64>]) -> Option<Vec<f64>>;

    /// Evaluations left.
    fn left(&self) -> usize;
}

/// Everything that a search has learnt; with it a search goes on, to the same end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// The method.
    pub method: Method,
    /// The task.
    pub task: Task,
    /// Costs in order of evaluation, as the bits of their numbers: text would round them.
    #[serde(with = "bits")]
    pub costs: Vec<f64>,
}

/// How far a search has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress<'a> {
    /// What is known, to be kept for resuming.
    pub record: &'a Record,
    /// The least cost so far.
    pub cost: f64,
    /// Where.
    pub point: &'a [f64],
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// The least cost; infinite where every cost was no number.
    pub cost: f64,
    /// Where.
    pub point: Vec<f64>,
    /// Evaluations.
    pub evaluations: usize,
    /// Evaluations and least cost at each improvement: the curve of convergence.
    pub improvements: Vec<(usize, f64)>,
    /// What was learnt.
    pub record: Record,
}

/// Told how far a search has come, it says whether to go on.
type Watch<'a> = &'a mut dyn FnMut(Progress<'_>) -> ControlFlow<()>;

/// A search with one method.
pub struct Search<'a> {
    record: Record,
    /// How many of the record's costs have been told again to the method.
    told: usize,
    cost: &'a (dyn Fn(&[f64]) -> f64 + Sync),
    watch: Option<Watch<'a>>,
    best: (f64, Vec<f64>),
    improvements: Vec<(usize, f64)>,
    stopped: bool,
}

impl<'a> Search<'a> {
    /// A new search. The cost may be called from several threads; NaN counts as infinite.
    pub fn new(
        method: Method,
        task: Task,
        cost: &'a (dyn Fn(&[f64]) -> f64 + Sync),
    ) -> Result<Self, TuningError> {
        Self::resume(Record { method, task, costs: Vec::new() }, cost)
    }

    /// A search from where a record ends. Its budget may be larger than it was for a method that does not plan with it
    /// (`bat`, `cmaes`); the others take the record's.
    pub fn resume(record: Record, cost: &'a (dyn Fn(&[f64]) -> f64 + Sync)) -> Result<Self, TuningError> {
        let Task { bounds, agents, evaluations, .. } = &record.task;
        let refuse = |what, found: String, expected: &str| {
            Err(TuningError::Search { what, found, expected: expected.to_owned() })
        };
        if bounds.is_empty() {
            return refuse("bounds of a search", "none".to_owned(), "one parameter or more");
        }
        if bounds.len() > MOST {
            return refuse("bounds of a search", bounds.len().to_string(), "1048576 at the most");
        }
        let wide = |[low, high]: &[f64; 2]| low < high && (high - low).is_finite();
        if let Some([low, high]) = bounds.iter().find(|bound| !wide(bound)) {
            return refuse("bounds of a search", format!("{low} to {high}"), "finite and rising");
        }
        if !(FEWEST_AGENTS..=MOST).contains(agents) {
            return refuse("agents of a search", agents.to_string(), "4 to 1048576");
        }
        if evaluations < agents {
            return refuse("evaluations of a search", evaluations.to_string(), "a whole generation or more");
        }
        if record.costs.len() > *evaluations {
            return refuse(
                "costs of a record",
                record.costs.len().to_string(),
                "no more than its evaluations",
            );
        }
        let middle = bounds.iter().map(|[low, high]| 0.5 * (low + high)).collect();
        Ok(Self {
            record,
            told: 0,
            cost,
            watch: None,
            best: (f64::INFINITY, middle),
            improvements: Vec::new(),
            stopped: false,
        })
    }

    /// Has someone watch: called after each generation that was evaluated anew; breaking off ends the search.
    #[must_use]
    pub fn watched_by(mut self, watch: &'a mut dyn FnMut(Progress<'_>) -> ControlFlow<()>) -> Self {
        self.watch = Some(watch);
        self
    }

    /// Searches to the end.
    pub fn run(self) -> Found {
        let optimiser = self.record.method.optimiser();
        self.run_with(optimiser.as_ref())
    }

    /// The same with other settings than the usual ones of the method, or with a method of one's own. A record does not hold them: it is resumed with the same.
    pub fn run_with(mut self, optimiser: &dyn Optimiser) -> Found {
        optimiser.minimise(&mut self);
        let Self { record, best: (cost, point), improvements, told, .. } = self;
        Found { cost, point, evaluations: told, improvements, record }
    }

    fn remember(&mut self, cost: f64, point: &[f64]) {
        self.told += 1;
        if cost < self.best.0 {
            self.best = (cost, point.to_vec());
            self.improvements.push((self.told, cost));
        }
    }
}

impl Trace for Search<'_> {
    fn task(&self) -> &Task {
        &self.record.task
    }

    fn left(&self) -> usize {
        if self.stopped { 0 } else { self.record.task.evaluations.saturating_sub(self.told) }
    }

    fn evaluate(&mut self, points: &[Vec<f64>]) -> Option<Vec<f64>> {
        let count = points.len().min(self.left());
        let known = self.record.costs.len().saturating_sub(self.told).min(count);
        let mut costs = self.record.costs[self.told..self.told + known].to_vec();
        let number = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        let cost = self.cost;
        let new: Vec<f64> = points[known..count].par_iter().map(|point| number(cost(point))).collect();
        self.record.costs.extend(&new);
        costs.extend(&new);
        for (cost, point) in costs.iter().zip(points) {
            self.remember(*cost, point);
        }
        if !new.is_empty()
            && let Some(watch) = &mut self.watch
        {
            let progress = Progress { record: &self.record, cost: self.best.0, point: &self.best.1 };
            self.stopped = watch(progress).is_break();
        }
        (count == points.len() && !self.stopped).then_some(costs)
    }
}

/// Numbers as their bits.
mod bits {
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(costs: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(costs.iter().map(|cost| cost.to_bits()))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
        Ok(Vec::<u64>::deserialize(deserializer)?.into_iter().map(f64::from_bits).collect())
    }
}
