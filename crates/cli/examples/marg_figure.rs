//! Draws the heading error of `marg-ins` with and without its gate while a steel car stops beside the walker of system S3:
//! `marg_figure ADIT OUT.svg`.
//!
//! Called by `ci/results.sh` for the page of `marg-ins`.

#[path = "../tests/common/marg_seeds.rs"]
#[expect(dead_code, reason = "the table uses the rest")]
mod marg_seeds;

use adit_core::solution::Solution;
use adit_evaluation::plot::{TimeCurve, time_figure};
use anyhow::{Context, Result, bail};
use marg_seeds::{S3_FILTER, heading_errors_deg, scenario, settings, simulate, track};
use std::path::PathBuf;

/// What is drawn, s.
const SHOWN: std::ops::Range<f64> = 60.0..260.0;
const SEED: u64 = 1;

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, out] = arguments.as_slice() else { bail!("usage: marg_figure ADIT OUT.svg") };
    let folder = simulate(adit, &scenario("s3-steel-stop.toml"), SEED)?;
    let curve = |label: &str, solutions: &[Solution], values: &[f64]| TimeCurve {
        label: label.to_owned(),
        points: solutions
            .iter()
            .zip(values)
            .map(|(solution, value)| (solution.time.seconds(), *value))
            .filter(|(time_s, _)| SHOWN.contains(time_s))
            .collect(),
    };
    let mut curves = Vec::new();
    for (label, gated) in [("marg-ins", true), ("no gate, as the paper", false)] {
        let (solutions, truth) = track(folder.path(), &settings(S3_FILTER, gated)?)?;
        curves.push(curve(label, &solutions, &heading_errors_deg(&solutions, &truth)));
    }
    let figure = time_figure(&curves, "A steel car stops beside the walker: 30 µT", "heading error, deg")?;
    std::fs::write(out, figure).with_context(|| out.display().to_string())
}
