//! One method on one run.

use super::conduct::Stamps;
use super::ranges::RangeRecord;
use crate::config;
use crate::judged_ranges::JudgedRanges;
use crate::method::{self, with_settings};
use crate::scenario_file::Contender;
use crate::verbs::trials::{self, Trial};
use adit_core::solution::Solution;
use adit_core::trajectory::Trajectory;
use adit_estimation::methods::{MethodError, MethodReport, MethodSettings, Nis};
use adit_estimation::radio::RadioSite;
use adit_evaluation::compare::{
    RunErrors, RunOptions, RunOutcome, loop_error, run_errors, run_errors_at_truth, run_motion,
};
use adit_evaluation::evaluate::trajectory;
use adit_observation::Observation;
use anyhow::{Context, Result, bail};
use std::sync::Arc;
use std::time::Instant;

/// What came of it.
#[derive(Clone)]
pub struct Entered {
    /// Errors, NIS, time; none where the method gave up on the way.
    pub outcome: Option<RunOutcome>,
    /// Odd things that the method met.
    pub warnings: Vec<String>,
    /// What became of its ranges.
    pub ranges: RangeRecord,
}

/// Runs a contender over a trial and judges it; its path comes along where it has one.
///
/// Settings that cannot be used are an error; a method that cannot go on with this run has failed it, with a warning.
pub fn enter(
    trial: &Trial,
    contender: &Contender,
    site: Option<&Arc<RadioSite>>,
    (stamps, options): (Stamps, &RunOptions),
) -> Result<(Entered, Option<Trajectory>)> {
    let place = || format!("{}: {}", contender.name, trial.name);
    let driven =
        with_settings!(contender.method, S => drive::<S>(trial, contender, site)).with_context(place)?;
    let driven = match driven {
        Ok(driven) => driven,
        Err(error) => return Ok((Entered::failed(format!("{}: {error}", place())), None)),
    };
    let (errors, path) = match judge(trial, &driven.solutions, stamps, options) {
        Ok(judged) => judged,
        // A truth that is a list of places asks for 95 % of it.
        Err(error) if stamps != Stamps::Solutions => {
            return Ok((Entered::failed(format!("{}: {error}", place())), None));
        }
        Err(error) => return Err(error).with_context(place),
    };
    let nis = driven.nis.map(|Nis { dimension, count, sum }| (dimension, count, sum));
    let outcome = RunOutcome { errors, nis, time_per_step_ns: driven.time_per_step_ns };
    let warnings = driven.warnings.iter().map(|warning| format!("{}: {warning}", contender.name)).collect();
    Ok((Entered { outcome: Some(outcome), warnings, ranges: RangeRecord::default() }, path))
}

impl Entered {
    /// A run that the method failed.
    fn failed(why: String) -> Self {
        Self { outcome: None, warnings: vec![why], ranges: RangeRecord::default() }
    }
}

/// Errors of the solutions, and their path laid over the truth where they have one.
fn judge(
    trial: &Trial,
    solutions: &[Solution],
    stamps: Stamps,
    options: &RunOptions,
) -> Result<(RunErrors, Option<Trajectory>)> {
    let (truth, errors) = match stamps {
        Stamps::Solutions => (trial.path()?, run_errors(solutions, &trial.truth, options)?),
        Stamps::Truth => {
            let truth = trial.path()?;
            let errors = run_errors_at_truth(solutions, &truth, trial.marked.as_deref(), options)?;
            (truth, errors)
        }
        Stamps::End => return Ok((loop_error(solutions)?, Some(trajectory(solutions)?))),
    };
    if !options.positions {
        return Ok((errors, None));
    }
    let motion = run_motion(solutions, &truth, options)?;
    Ok((errors, Some(motion.trajectory(&trajectory(solutions)?)?)))
}

struct Driven {
    solutions: Vec<Solution>,
    nis: Option<Nis>,
    warnings: Vec<String>,
    time_per_step_ns: f64,
}

fn drive<S: MethodSettings>(
    trial: &Trial,
    contender: &Contender,
    site: Option<&Arc<RadioSite>>,
) -> Result<Result<Driven, MethodError>> {
    let mut settings: S =
        config::overlay_table(&method::knowing::<S>(trial.sidecar.as_ref()), contender.config.clone())?;
    if let Some(radio) = site {
        settings = settings.at_site(radio);
    }
    let heard = contender.only.as_ref().map(|only| {
        let wanted = trial.observations.iter().filter(|o| only.contains(&o.kind()));
        wanted.cloned().collect::<Vec<Observation>>()
    });
    let observations = heard.as_deref().unwrap_or(&trial.observations);
    let judged = contender.nlos.as_ref().map(|model| JudgedRanges::of(model, observations));
    let observations = judged.as_deref().unwrap_or(observations);
    // Of a log without an inertial sensor, whatever it has.
    let inertial = observations.iter().filter(|o| matches!(o, Observation::Imu(_))).count();
    let samples = if inertial > 0 { inertial } else { observations.len() };
    if samples == 0 {
        bail!("no observations, expected some");
    }
    let mut method = settings.start()?;
    let mut solutions = Vec::with_capacity(samples);
    let clock = Instant::now();
    if let Err(error) = trials::run(observations, method.as_mut(), |solution| solutions.push(solution)) {
        return Ok(Err(error));
    }
    let elapsed_ns = clock.elapsed().as_secs_f64() * 1e9;
    let report = method.report();
    Ok(Ok(Driven {
        solutions,
        nis: report.nis(),
        warnings: method::warnings(report.warnings()),
        time_per_step_ns: elapsed_ns / samples as f64,
    }))
}
