//! One method on one run.

use crate::config;
use crate::method::{self, with_settings};
use crate::scenario_file::Contender;
use crate::verbs::trials::{Driven, Trial};
use adit_core::trajectory::Trajectory;
use adit_estimation::methods::{MethodError, MethodSettings, Nis};
use adit_evaluation::compare::{RunOptions, RunOutcome, run_errors};
use adit_evaluation::evaluate::trajectory;
use adit_observation::Observation;
use anyhow::{Context, Result, bail};

/// What came of it.
#[derive(Clone)]
pub struct Entered {
    /// Errors, NIS, time; none where the method gave up on the way.
    pub outcome: Option<RunOutcome>,
    /// Odd things that the method met.
    pub warnings: Vec<String>,
}

/// Runs a contender over a trial and judges it; its path comes along where it has one.
///
/// Settings that cannot be used are an error; a method that cannot go on with this run has failed it, with a warning.
pub fn enter(
    trial: &Trial,
    contender: &Contender,
    options: &RunOptions,
) -> Result<(Entered, Option<Trajectory>)> {
    let place = || format!("{}: {}", contender.name, trial.name);
    let driven = with_settings!(contender.method, S => drive::<S>(trial, contender)).with_context(place)?;
    let driven = match driven {
        Ok(driven) => driven,
        Err(error) => {
            let warnings = vec![format!("{}: {error}", place())];
            return Ok((Entered { outcome: None, warnings }, None));
        }
    };
    let errors = run_errors(&driven.solutions, &trial.truth, options).with_context(place)?;
    let path = options.positions.then(|| trajectory(&driven.solutions)).transpose()?;
    let nis = driven.nis.map(|Nis { dimension, count, sum }| (dimension, count, sum));
    let outcome = RunOutcome { errors, nis, time_per_step_ns: driven.time_per_step_ns };
    let warnings = driven.warnings.iter().map(|warning| format!("{}: {warning}", contender.name)).collect();
    Ok((Entered { outcome: Some(outcome), warnings }, path))
}

fn drive<S: MethodSettings>(trial: &Trial, contender: &Contender) -> Result<Result<Driven, MethodError>> {
    let settings: S =
        config::overlay_table(&method::knowing::<S>(trial.sidecar.as_ref()), contender.config.clone())?;
    let samples = trial.observations.iter().filter(|o| matches!(o, Observation::Imu(_))).count();
    if samples == 0 {
        bail!("no inertial samples, expected some");
    }
    let method = settings.start()?;
    Ok(trial.run(method))
}
