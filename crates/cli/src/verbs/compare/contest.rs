//! One method on one run.

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
use adit_evaluation::compare::{RunOptions, RunOutcome, run_errors};
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
    options: &RunOptions,
) -> Result<(Entered, Option<Trajectory>)> {
    let place = || format!("{}: {}", contender.name, trial.name);
    let driven =
        with_settings!(contender.method, S => drive::<S>(trial, contender, site)).with_context(place)?;
    let driven = match driven {
        Ok(driven) => driven,
        Err(error) => {
            let warnings = vec![format!("{}: {error}", place())];
            return Ok((Entered { outcome: None, warnings, ranges: RangeRecord::default() }, None));
        }
    };
    let errors = run_errors(&driven.solutions, &trial.truth, options).with_context(place)?;
    let path = options.positions.then(|| trajectory(&driven.solutions)).transpose()?;
    let nis = driven.nis.map(|Nis { dimension, count, sum }| (dimension, count, sum));
    let outcome = RunOutcome { errors, nis, time_per_step_ns: driven.time_per_step_ns };
    let warnings = driven.warnings.iter().map(|warning| format!("{}: {warning}", contender.name)).collect();
    Ok((Entered { outcome: Some(outcome), warnings, ranges: RangeRecord::default() }, path))
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
    let judged = contender.nlos.as_ref().map(|model| JudgedRanges::of(model, &trial.observations));
    let observations = judged.as_deref().unwrap_or(&trial.observations);
    let samples = observations.iter().filter(|o| matches!(o, Observation::Imu(_))).count();
    if samples == 0 {
        bail!("no inertial samples, expected some");
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
