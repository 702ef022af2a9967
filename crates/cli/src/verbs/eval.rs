//! `adit eval`: an estimate against the truth.

use crate::args::EvalArgs;
use crate::output;
use crate::progress;
use adit_core::solution::Solution;
use adit_core::trajectory::Trajectory;
use adit_evaluation::consistency::solution_nees;
use adit_evaluation::plot::evaluation_figure;
use adit_evaluation::{Evaluation, EvaluationOptions, evaluate};
use adit_observation::solution_csv::SolutionReader;
use adit_observation::truth::{self, Truth};
use adit_observation::tum;
use anyhow::{Context, Result, bail};
use std::fmt::Write;
use std::path::Path;

/// Probability for which the bounds of the NEES stand.
const PROBABILITY: f64 = 0.95;

/// Scores the estimate and shows the figures.
pub fn run(args: &EvalArgs) -> Result<()> {
    let estimate = tum::read(&args.estimate)?;
    let truth = truth::read(&args.truth)?;
    progress::warn(&truth.warnings);
    let options = EvaluationOptions {
        alignment: args.align,
        start_distance_m: args.start_distance,
        attitude: truth.has_attitude && adit_evaluation::ape::carries_attitude(&truth.trajectory),
        ..EvaluationOptions::default()
    };
    let evaluation = judge(args, &estimate, &truth, &options)
        .with_context(|| format!("{} against {}", args.estimate.display(), args.truth.display()))?;
    if let Some(path) = &args.plot {
        let title = format!("{} against {}", name(&args.estimate), name(&args.truth));
        output::write_file(path, &evaluation_figure(&evaluation, &title)?)?;
    }
    if args.json {
        return output::print(&(serde_json::to_string_pretty(&evaluation.report)? + "\n"));
    }
    let mut table = evaluation.report.to_string();
    if let Some(path) = &args.plot {
        writeln!(table, "figure      {}", path.display())?;
    }
    output::print(&table)
}

fn judge(
    args: &EvalArgs,
    estimate: &Trajectory,
    truth: &Truth,
    options: &EvaluationOptions,
) -> Result<Evaluation> {
    if !truth.has_position {
        bail!("the truth has no positions, expected columns x_m and y_m");
    }
    let mut evaluation = evaluate(estimate, &truth.trajectory, options)?;
    if let Some(path) = &args.covariance {
        let solutions = SolutionReader::open(path)?.collect::<Result<Vec<Solution>, _>>()?;
        if solutions.len() != estimate.len() {
            let (found, expected) = (solutions.len(), estimate.len());
            bail!(
                "{}: found {found} solutions, expected {expected}, one for each pose of the estimate",
                path.display()
            );
        }
        let (truth, motion) = (&truth.trajectory, &evaluation.motion);
        evaluation.report.nees =
            Some(solution_nees(&solutions, truth, motion, options.attitude, PROBABILITY)?);
    }
    Ok(evaluation)
}

fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
