//! `adit eval`: an estimate against the truth.

use crate::args::EvalArgs;
use crate::output;
use crate::progress;
use adit_core::solution::Solution;
use adit_core::trajectory::Trajectory;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::ape::{carries_attitude, carries_position};
use adit_evaluation::plot::{attitude_figure, evaluation_figure};
use adit_evaluation::{EvaluationError, EvaluationOptions, WithoutPosition, evaluate, evaluate_attitude};
use adit_observation::solution_csv::SolutionReader;
use adit_observation::truth::{self, Truth};
use adit_observation::tum;
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::fmt::{Display, Write};
use std::path::Path;

/// Scores the estimate and shows the figures.
pub fn run(args: &EvalArgs) -> Result<()> {
    let estimate = tum::read(&args.estimate)?;
    let truth = truth::read(&args.truth)?;
    progress::warn(&truth.warnings);
    let solutions = args.covariance.as_deref().map(|path| solutions(path, &estimate)).transpose()?;
    let pair = Pair { estimate, truth, solutions };
    let against = || format!("{} against {}", args.estimate.display(), args.truth.display());
    match pair.without_position().with_context(against)? {
        None => pair.judge_path(args).with_context(against),
        Some(side) => pair.judge_attitude(args, side).with_context(against),
    }
}

/// What is compared.
struct Pair {
    estimate: Trajectory,
    truth: Truth,
    solutions: Option<Vec<Solution>>,
}

impl Pair {
    /// The side that leaves nothing but attitudes to compare.
    fn without_position(&self) -> Result<Option<WithoutPosition>> {
        if !self.truth.has_position {
            return Ok(Some(WithoutPosition::Truth));
        }
        if carries_position(&self.estimate) || !carries_attitude(&self.estimate) {
            return Ok(None);
        }
        if !self.truth.has_attitude {
            bail!("the estimate holds attitudes alone (all its positions are zero) and the truth holds none");
        }
        Ok(Some(WithoutPosition::Estimate))
    }

    fn options(&self, args: &EvalArgs, alignment: Alignment) -> EvaluationOptions {
        EvaluationOptions {
            alignment: args.align.unwrap_or(alignment),
            start_distance_m: args.start_distance,
            attitude: self.truth.has_attitude && carries_attitude(&self.truth.trajectory),
            marked: self.truth.moving.clone().filter(|_| !args.all_rows),
            ..EvaluationOptions::default()
        }
    }

    fn judge_path(&self, args: &EvalArgs) -> Result<()> {
        let options = self.options(args, Alignment::Se2);
        let mut evaluation = evaluate(&self.estimate, &self.truth.trajectory, &options)?;
        if let Some(solutions) = &self.solutions {
            evaluation.judge_covariance(solutions, &options)?;
        }
        show(args, &evaluation.report, |title| evaluation_figure(&evaluation, title))
    }

    fn judge_attitude(&self, args: &EvalArgs, side: WithoutPosition) -> Result<()> {
        let options = self.options(args, Alignment::None);
        let truth = &self.truth.trajectory;
        let mut evaluation = evaluate_attitude(&self.estimate, truth, side, &options)?;
        if let Some(solutions) = &self.solutions {
            evaluation.judge_covariance(solutions, truth, &options)?;
        }
        show(args, &evaluation.report, |title| attitude_figure(&evaluation, title))
    }
}

/// The covariances of an estimate.
fn solutions(path: &Path, estimate: &Trajectory) -> Result<Vec<Solution>> {
    let solutions = SolutionReader::open(path)?.collect::<Result<Vec<Solution>, _>>()?;
    if solutions.len() != estimate.len() {
        let (found, expected) = (solutions.len(), estimate.len());
        bail!(
            "{}: found {found} solutions, expected {expected}, one for each pose of the estimate",
            path.display()
        );
    }
    Ok(solutions)
}

/// Draws and prints what was found.
fn show(
    args: &EvalArgs,
    report: &(impl Serialize + Display),
    figure: impl FnOnce(&str) -> Result<String, EvaluationError>,
) -> Result<()> {
    if let Some(path) = &args.plot {
        let title = format!("{} against {}", name(&args.estimate), name(&args.truth));
        output::write_file(path, &figure(&title)?)?;
    }
    if args.json {
        return output::print(&(serde_json::to_string_pretty(report)? + "\n"));
    }
    let mut table = report.to_string();
    if let Some(path) = &args.plot {
        writeln!(table, "figure      {}", path.display())?;
    }
    output::print(&table)
}

fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
