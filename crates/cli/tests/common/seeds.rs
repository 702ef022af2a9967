//! Simulated walks over many seeds: how far off, and whether the covariance says so.
//!
//! Used by the test `simulated_walks` and by the example of the same name, which prints the figures of the docs.

use adit_core::attitude::{heading, turn_navigation};
use adit_core::nalgebra::{UnitQuaternion, Vector3};
use adit_core::solution::Solution;
use adit_estimation::methods::foot_ins::{FootIns, FootInsParams};
use adit_evaluation::consistency::normalised_squared_error;
use adit_observation::Observation;
use adit_simulation::{FootWalkScenario, ImuErrorModel, TruthState, generate};
use anyhow::{Context, Result};
use rayon::prelude::*;

/// Samples between two looks at the covariance: one second.
const EVERY: usize = 200;
/// The first step is made after this many looks; before it nothing has been estimated.
const STANDING: usize = 8;

/// One simulated walk, tracked.
pub struct SeedRun {
    /// Largest horizontal error, m.
    pub largest_m: f64,
    /// Horizontal error at the end, m.
    pub end_m: f64,
    /// Distance walked, m.
    pub distance_m: f64,
    /// Normalised squared error of the position, once a second from the first step on.
    pub nees: Vec<f64>,
}

/// The settings of `scenarios/s2-filter.toml`.
pub fn s2_filter() -> Result<FootInsParams> {
    Ok(toml::from_str(include_str!("../../../../scenarios/s2-filter.toml"))?)
}

/// Tracks the walk of S2 with a sensor of this kind once for each seed, on all cores; the order is that of the seeds.
pub fn runs(model: &ImuErrorModel, params: &FootInsParams, seeds: u64) -> Result<Vec<SeedRun>> {
    let scenario = FootWalkScenario::demo_walk();
    (0..seeds).into_par_iter().map(|seed| run(&scenario, model, params, seed)).collect()
}

fn run(
    scenario: &FootWalkScenario,
    model: &ImuErrorModel,
    params: &FootInsParams,
    seed: u64,
) -> Result<SeedRun> {
    let simulation = generate(scenario, model, seed)?;
    let (start, distance_m) = (simulation.truth(), simulation.walk().length_m());
    let mut method = FootIns::new(params.clone())?;
    let mut truths: Vec<TruthState> = Vec::new();
    let mut solutions: Vec<Solution> = Vec::new();
    for (sample, truth) in simulation {
        truths.push(truth);
        solutions.extend(method.observe(&Observation::Imu(sample))?);
    }
    while let Some(solution) = method.finish_next()? {
        solutions.push(solution);
    }

    // The frame of the estimate is defined by its first pose: nothing else is matched.
    let first = solutions.first().context("a walk has samples")?;
    let turn = heading(&first.attitude) - heading(&start.attitude);
    let turn = turn_navigation(&UnitQuaternion::identity(), &Vector3::new(0.0, 0.0, turn));
    let matrix = turn.to_rotation_matrix().into_inner();
    let error = |solution: &Solution, truth: &TruthState| {
        truth.position_m - start.position_m - turn * solution.position_m
    };
    let errors: Vec<Vector3<f64>> = solutions.iter().zip(&truths).map(|(s, t)| error(s, t)).collect();
    let nees = errors.iter().zip(&solutions).step_by(EVERY).skip(STANDING).map(|(error, solution)| {
        let covariance = matrix * solution.position_covariance() * matrix.transpose();
        Ok(normalised_squared_error(error, &covariance)?)
    });
    Ok(SeedRun {
        largest_m: errors.iter().map(|e| e.xy().norm()).fold(0.0, f64::max),
        end_m: errors.last().map_or(0.0, |e| e.xy().norm()),
        distance_m,
        nees: nees.collect::<Result<_>>()?,
    })
}
