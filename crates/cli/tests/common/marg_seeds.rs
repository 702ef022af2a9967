//! Simulated walks with a magnetometer over many seeds: how far off path and heading are, and whether the heading knows.
//!
//! Used by the test `marg_walks` and by the examples `marg_walks` and `marg_figure`, which make table and picture of the docs.

use adit_core::attitude;
use adit_core::solution::Solution;
use adit_core::trajectory::Trajectory;
use adit_estimation::methods::MethodSettings;
use adit_estimation::methods::marg_ins::{GateKind, MargInsParams};
use adit_observation::{open, tum};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;

/// One walk, tracked.
pub struct SeedRun {
    /// Horizontal errors over the walk, m: largest, mean over time, and at the end, where the walk began.
    pub largest_m: f64,
    pub mean_m: f64,
    pub return_m: f64,
    /// Largest error of the heading, deg.
    pub heading_deg: f64,
    /// Share of the time at which the heading is within two of its standard deviations.
    pub heading_within: f64,
}

/// A scenario of the repository.
pub fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name)
}

/// Settings from TOML text, with the magnetic gate or without it.
pub fn settings(text: &str, gated: bool) -> Result<MargInsParams> {
    let settings: MargInsParams = toml::from_str(text)?;
    let magnetic_gate = if gated { GateKind::Disturbance } else { GateKind::None };
    Ok(MargInsParams { magnetic_gate, ..settings })
}

/// The settings of `scenarios/s3-filter.toml`.
pub const S3_FILTER: &str = include_str!("../../../../scenarios/s3-filter.toml");

/// Simulates a scenario with the program; returns the folder with `log.mcap` and `truth.tum`.
pub fn simulate(adit: &Path, scenario: &Path, seed: u64) -> Result<tempfile::TempDir> {
    let folder = tempfile::tempdir()?;
    let seed = seed.to_string();
    let output = Command::new(adit)
        .arg("simulate")
        .arg(scenario)
        .args(["--seed", &seed, "-o"])
        .arg(folder.path())
        .output()
        .with_context(|| adit.display().to_string())?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(folder)
}

/// Tracks a simulated log in this process: its solutions, with the truth of each.
pub fn track(folder: &Path, settings: &MargInsParams) -> Result<(Vec<Solution>, Trajectory)> {
    let mut method = settings.clone().start()?;
    let mut solutions = Vec::new();
    for observation in open(folder.join("log.mcap"))? {
        let mut due = method.observe(&observation?)?;
        while let Some(solution) = due {
            solutions.push(solution);
            due = method.next_due()?;
        }
    }
    while let Some(solution) = method.finish_next()? {
        solutions.push(solution);
    }
    let truth = tum::read(folder.join("truth.tum"))?;
    ensure!(truth.len() == solutions.len(), "{} poses of truth, {} solutions", truth.len(), solutions.len());
    Ok((solutions, truth))
}

/// Signed error of the heading of each solution, estimate minus truth, deg.
pub fn heading_errors_deg(solutions: &[Solution], truth: &Trajectory) -> Vec<f64> {
    let error = |(s, t): (&Solution, &adit_core::trajectory::Pose)| {
        -attitude::log(&(s.attitude * t.attitude.inverse())).z.to_degrees()
    };
    solutions.iter().zip(truth.poses()).map(error).collect()
}

/// Judges a run: positions matched at the first sample, headings not at all.
pub fn judge(solutions: &[Solution], truth: &Trajectory) -> Result<SeedRun> {
    let origin = truth.poses().first().context("a walk has samples")?.position_m;
    let errors: Vec<f64> = solutions
        .iter()
        .zip(truth.poses())
        .map(|(s, t)| (s.position_m - (t.position_m - origin)).xy().norm())
        .collect();
    let headings = heading_errors_deg(solutions, truth);
    let within = solutions
        .iter()
        .zip(&headings)
        .filter(|(s, error)| error.abs() <= 2.0 * s.covariance[(8, 8)].sqrt().to_degrees());
    let count = errors.len() as f64;
    Ok(SeedRun {
        largest_m: errors.iter().copied().fold(0.0, f64::max),
        mean_m: errors.iter().sum::<f64>() / count,
        return_m: errors.last().copied().unwrap_or_default(),
        heading_deg: headings.iter().map(|error| error.abs()).fold(0.0, f64::max),
        heading_within: within.count() as f64 / count,
    })
}
