//! Prints how `marg-ins` does on the simulated walks of system S3 over many seeds, as Markdown.
//!
//! `cargo build --release -p adit-cli && cargo run --release -p adit-cli --example marg_walks -- target/release/adit`; called by
//! `ci/results.sh`.

#[path = "../tests/common/marg_seeds.rs"]
mod marg_seeds;

use anyhow::{Result, bail};
use marg_seeds::{S3_FILTER, SeedRun, judge, scenario, settings, simulate, track};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

const SEEDS: u64 = 20;
/// Length of the walk, m.
const WALK_M: f64 = 80.0;

/// Walks with the scenario of each.
const WALKS: [(&str, &str); 5] = [
    ("undisturbed", "s3.toml"),
    ("a car passes, 30 µT", "s3-steel.toml"),
    ("a car stops beside the walker", "s3-steel-stop.toml"),
    ("a car keeps beside the walker", "s3-steel-beside.toml"),
    ("a car is there at the start", "s3-steel-start.toml"),
];
/// Settings with their names: what the filter knows, and whether it has the gate.
const SETTINGS: [(&str, bool, &str); 4] = [
    ("`marg-ins`, the sensor's data sheet", true, S3_FILTER),
    ("no gate, as the paper, the data sheet", false, S3_FILTER),
    ("`marg-ins`, the defaults", true, DECLINATION),
    ("no gate, as the paper, the defaults", false, DECLINATION),
];
/// What a sidecar says of the site: World Magnetic Model at the court.
const SITE: &str = "[heading.reference]\nnorm_ut = 55.281\ndip_rad = 1.10631\n";
const DECLINATION: &str = "declination_rad = -0.18518\n";

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit] = arguments.as_slice() else { bail!("usage: marg_walks ADIT") };
    println!(
        "| walk | filter | largest error, of {WALK_M:.0} m: mean / worst of {SEEDS} seeds | mean error | return error | heading error, largest: mean / worst | heading within 2 σ |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|");
    for (walk, file) in WALKS {
        let runs: Vec<[SeedRun; SETTINGS.len()]> =
            (0..SEEDS).into_par_iter().map(|seed| run(adit, file, seed)).collect::<Result<_>>()?;
        for (index, (name, ..)) in SETTINGS.iter().enumerate() {
            let runs: Vec<&SeedRun> = runs.iter().map(|runs| &runs[index]).collect();
            println!("| {walk} | {name} | {} |", figures(&runs));
        }
    }
    // Only a reference from elsewhere can tell at once that the start is disturbed.
    let [.., (walk, file)] = WALKS;
    let told = settings(&format!("{S3_FILTER}\n{SITE}"), true)?;
    let runs: Vec<SeedRun> = (0..SEEDS)
        .into_par_iter()
        .map(|seed| {
            let folder = simulate(adit, &scenario(file), seed)?;
            let (solutions, truth) = track(folder.path(), &told)?;
            judge(&solutions, &truth)
        })
        .collect::<Result<_>>()?;
    let runs: Vec<&SeedRun> = runs.iter().collect();
    println!("| {walk} | `marg-ins`, the data sheet and the field of the site | {} |", figures(&runs));
    Ok(())
}

/// One seed of a walk, tracked with all settings.
fn run(adit: &Path, file: &str, seed: u64) -> Result<[SeedRun; SETTINGS.len()]> {
    let folder = simulate(adit, &scenario(file), seed)?;
    let judged = SETTINGS.map(|(_, gated, text)| {
        let (solutions, truth) = track(folder.path(), &settings(text, gated)?)?;
        judge(&solutions, &truth)
    });
    let [a, b, c, d] = judged;
    Ok([a?, b?, c?, d?])
}

fn figures(runs: &[&SeedRun]) -> String {
    let mean = |of: &dyn Fn(&SeedRun) -> f64| runs.iter().map(|run| of(run)).sum::<f64>() / runs.len() as f64;
    let worst = |of: &dyn Fn(&SeedRun) -> f64| runs.iter().map(|run| of(run)).fold(0.0, f64::max);
    let share = |of: &dyn Fn(&SeedRun) -> f64| {
        format!("{:.2} / {:.2} %", 100.0 * mean(of) / WALK_M, 100.0 * worst(of) / WALK_M)
    };
    format!(
        "{} | {} | {} | {:.1} / {:.1}° | {:.0} %",
        share(&|run| run.largest_m),
        share(&|run| run.mean_m),
        share(&|run| run.return_m),
        mean(&|run| run.heading_deg),
        worst(&|run| run.heading_deg),
        100.0 * mean(&|run| run.heading_within),
    )
}
