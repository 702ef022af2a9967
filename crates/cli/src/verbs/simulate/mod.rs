//! `adit simulate`: a scenario in, logs with their truth out.

mod everybody;
mod person;

pub use person::Simulated;

use crate::args::SimulateArgs;
use crate::output;
use crate::progress::{Progress, Unit};
use crate::scenario_file::Scenario;
use adit_core::time::Interval;
use anyhow::{Result, bail};
use person::{Counts, Disturbance};
use std::path::Path;

/// Simulates and says what was made.
pub fn run(args: &SimulateArgs) -> Result<()> {
    let scenario = Scenario::read(&args.scenario)?;
    let seed = args.seed.unwrap_or(scenario.seed);
    if scenario.has_everybody() {
        return everybody::run(args, &scenario, seed);
    }
    if args.people.is_some() {
        bail!("{}: --people is for scenarios of kind = \"mine\"", args.scenario.display());
    }
    let made = simulate(&scenario, seed, &args.out)?;
    output::print(&told(&made))
}

/// Simulates a scenario of one person, or of one tag.
pub fn simulate(scenario: &Scenario, seed: u64, folder: &Path) -> Result<Simulated> {
    let run = scenario.generate(seed)?;
    person::write(run, folder, Interval::ZERO, &Progress::new("simulating", Unit::Samples, None))
}

/// What was made of one log.
fn told(made: &Simulated) -> String {
    let Simulated { log, truth, sidecar, ranges_truth, counts, worst, duration_s } = made;
    let samples = format!("{}: {} samples over {duration_s:.1} s", log.display(), counts.inertial);
    let kinds = beside(counts, worst).into_iter().map(|line| format!("  with {line}"));
    let known = sidecar.iter().map(|path| format!("{}: what is known beside the log", path.display()));
    let links = ranges_truth.iter().map(|path| format!("{}: the truth of the ranges", path.display()));
    let truth = format!("{}: the truth", truth.display());
    let lines = [samples].into_iter().chain(kinds).chain(known).chain(links).chain([truth]);
    lines.map(|line| line + "\n").collect()
}

/// What there is beside inertial samples.
fn beside(counts: &Counts, worst: &Disturbance) -> Vec<String> {
    let Disturbance { norm_ut, time_s } = *worst;
    let magnetic = match (counts.magnetic, norm_ut > 0.0) {
        (0, _) => None,
        (count, false) => Some(format!("{count} magnetic samples of an undisturbed field")),
        (count, true) => {
            Some(format!("{count} magnetic samples, disturbed by at most {norm_ut:.1} µT at {time_s:.1} s"))
        }
    };
    let counted = |count: u64, what: &str| (count > 0).then(|| format!("{count} {what}"));
    let blocked = 100.0 * counts.blocked as f64 / counts.ranges.max(1) as f64;
    let kinds = [
        magnetic,
        counted(counts.pressures, "air pressures"),
        counted(counts.fixes, "position fixes"),
        counted(counts.signals, "signal strengths"),
        counted(counts.ranges, &format!("ranges, {blocked:.0} % of them past an obstacle")),
        counted(counts.sightings, "sightings at portals"),
    ];
    kinds.into_iter().flatten().collect()
}
