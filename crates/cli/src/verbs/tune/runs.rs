//! Logs with their truth, and how far off a method is on them with given values of its parameters.

use super::objective::{FAILED, Objective};
use super::parameters::Parameters;
use crate::args::TuneArgs;
use crate::config;
use crate::interrupt;
use crate::method::{self, MethodName, with_settings};
use crate::progress::{Progress, Unit};
use crate::radio_site;
use crate::verbs::trials::{Trial, Trials};
use adit_core::solution::Solution;
use adit_core::trajectory::{Pose, Trajectory};
use adit_estimation::methods::{MethodSettings, RadioUse};
use adit_evaluation::alignment::{Alignment, align_attitudes};
use adit_evaluation::ape::attitude_error;
use adit_evaluation::association::{Association, associate};
use adit_evaluation::compare::{Moments, path_errors_m};
use adit_evaluation::marks::Judged;
use adit_observation::sidecar::Sidecar;
use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

/// Share of the moments judged with the settings as they are that must be judged with others too: who says less is not better.
const SHARE_KEPT: f64 = 0.95;

/// What is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Judgement {
    /// Horizontal position; squared m².
    Position,
    /// The whole angle; squared deg².
    Attitude,
}

impl Judgement {
    /// What is judged, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Position => "horizontal position error",
            Self::Attitude => "attitude error",
        }
    }

    /// Unit of the error.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Position => "m",
            Self::Attitude => "deg",
        }
    }
}

/// How runs are judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// What.
    pub what: Judgement,
    /// What is forgiven.
    pub alignment: Alignment,
    /// From when on, s.
    pub from_s: f64,
}

impl Rules {
    /// Those of a command line.
    pub fn of(args: &TuneArgs) -> Self {
        let (what, usual) = match args.method {
            // In the frame of the site as they come.
            method if method.radio() == RadioUse::Needed => (Judgement::Position, Alignment::None),
            method if method.estimates_path() => (Judgement::Position, Alignment::Se2),
            _ => (Judgement::Attitude, Alignment::None),
        };
        Self { what, alignment: args.align.unwrap_or(usual), from_s: args.from }
    }
}

/// The runs, in memory.
pub struct Runs {
    all: Vec<Run>,
    rules: Rules,
    drive: fn(&Trial, toml::Table) -> Result<Trajectory>,
}

struct Run {
    trial: Trial,
    /// The settings as they are.
    settings: toml::Table,
    /// The truth by which it is judged.
    truth: Trajectory,
    /// Moments that are judged with the settings as they are.
    moments: usize,
}

/// Of a run with one set of values.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Errors {
    mean_square: f64,
    moments: usize,
}

impl Runs {
    /// Reads logs and truths; the runs keep their order.
    pub fn read(args: &TuneArgs, paths: &[PathBuf], config: &toml::Table) -> Result<Self> {
        let rules = Rules::of(args);
        let trials = Trials::recorded(paths)?;
        let radio = radio_site::read(args.mine.as_deref(), &args.radio)?;
        let progress = Progress::new("reading", Unit::Samples, Some(trials.len() as u64));
        let done = AtomicU64::new(0);
        let read = |index: usize| -> Result<Run> {
            interrupt::check()?;
            let mut trial = trials.get(index)?;
            trial.radio.clone_from(&radio);
            let run = Run::new(args.method, trial, config, &rules)?;
            progress.at(done.fetch_add(1, Ordering::Relaxed) + 1);
            Ok(run)
        };
        let all = (0..trials.len()).into_par_iter().map(read).collect::<Result<Vec<_>>>()?;
        Ok(Self::new(args.method, all, rules))
    }

    /// Runs that are in memory already.
    pub fn of(method: MethodName, trials: Vec<Trial>, config: &toml::Table, rules: Rules) -> Result<Self> {
        let runs = trials.into_iter().map(|trial| Run::new(method, trial, config, &rules));
        Ok(Self::new(method, runs.collect::<Result<_>>()?, rules))
    }

    fn new(method: MethodName, all: Vec<Run>, rules: Rules) -> Self {
        Self { all, rules, drive: with_settings!(method, S => drive::<S>) }
    }

    /// Whether everything is judged, as it is.
    pub fn judges_all_as_it_is(&self) -> bool {
        self.rules.alignment == Alignment::None && self.rules.from_s <= 0.0
    }

    /// Something of each: of its log, its settings as they are and its truth.
    pub fn map<T: Send>(
        &self,
        of: impl Fn(&Trial, &toml::Table, &Trajectory) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        self.all.par_iter().map(|run| of(&run.trial, &run.settings, &run.truth)).collect()
    }

    /// Names of the logs.
    pub fn logs(&self) -> Vec<String> {
        self.all.iter().map(|run| run.trial.name.clone()).collect()
    }

    /// Settings of each as they are.
    pub fn settings(&self) -> Vec<toml::Table> {
        self.all.iter().map(|run| run.settings.clone()).collect()
    }

    /// Judges the settings as they are: mean squared error of each run, or why there is none. What others say is held against it.
    pub fn judge_as_they_are(&mut self) -> Vec<Result<f64>> {
        let judged: Vec<Result<Errors>> =
            self.all.par_iter().map(|run| self.errors(run, run.settings.clone())).collect();
        let keep = |(run, errors): (&mut Run, Result<Errors>)| {
            let Errors { mean_square, moments } = errors?;
            run.moments = moments;
            Ok(mean_square)
        };
        self.all.iter_mut().zip(judged).map(keep).collect()
    }

    /// Judges values of the parameters: mean squared error of each run, or why there is none.
    pub fn judge(&self, parameters: &Parameters, values: &[f64]) -> Vec<Result<f64>> {
        let judged = |run: &Run| -> Result<f64> {
            interrupt::check()?;
            let mut settings = run.settings.clone();
            parameters.put(&mut settings, values);
            let Errors { mean_square, moments } = self.errors(run, settings)?;
            if (moments as f64) < SHARE_KEPT * run.moments as f64 {
                bail!(
                    "{}: {moments} moments can be judged, expected {} or nearly so",
                    run.trial.name,
                    run.moments
                );
            }
            Ok(mean_square)
        };
        self.all.par_iter().map(judged).collect()
    }

    fn errors(&self, run: &Run, settings: toml::Table) -> Result<Errors> {
        let place = || run.trial.name.clone();
        let estimate = (self.drive)(&run.trial, settings).with_context(place)?;
        let errors = match self.rules.what {
            Judgement::Position => self.rules.of_positions(&estimate, &run.truth),
            Judgement::Attitude => self.rules.of_attitudes(&estimate, &run.truth),
        };
        let errors = errors.with_context(place)?;
        if !errors.mean_square.is_finite() {
            bail!("{}: the error is not a finite number", run.trial.name);
        }
        Ok(errors)
    }
}

impl Run {
    fn new(method: MethodName, mut trial: Trial, config: &toml::Table, rules: &Rules) -> Result<Self> {
        let known = match rules.what {
            Judgement::Position => trial.has_position,
            Judgement::Attitude => trial.has_attitude,
        };
        if !known {
            let what = rules.what.words();
            bail!("{}: its truth does not tell the {what} by which {} is judged", trial.name, method.name());
        }
        let settings = with_settings!(method, S => settings::<S>(trial.sidecar.as_ref(), config))
            .with_context(|| trial.name.clone())?;
        let truth = match rules.what {
            Judgement::Position => trial.path()?,
            Judgement::Attitude => rules.of_marked(&trial)?,
        };
        // One truth is enough.
        (trial.truth, trial.marked) = (Vec::new(), None);
        Ok(Self { trial, settings, truth, moments: 0 })
    }
}

impl Rules {
    /// The truth of attitudes: what it marks, from when on somebody judges.
    fn of_marked(&self, trial: &Trial) -> Result<Trajectory> {
        let whole = trial.path()?;
        let first = whole.poses().first().map(|pose| pose.time);
        let marked = Judged::of(&whole, trial.marked.as_deref())?.truth;
        let late = |pose: &&Pose| first.is_some_and(|first| (pose.time - first).seconds() >= self.from_s);
        Ok(Trajectory::new(marked.poses().iter().filter(late).copied().collect())?)
    }

    fn of_positions(&self, estimate: &Trajectory, truth: &Trajectory) -> Result<Errors> {
        let moments = Moments { from_s: self.from_s, ..Moments::default() };
        Ok(Errors::of(path_errors_m(estimate, truth, self.alignment, moments)?.into_iter()))
    }

    fn of_attitudes(&self, estimate: &Trajectory, truth: &Trajectory) -> Result<Errors> {
        let pairs = associate(estimate, truth, &Association::default())?.pairs;
        let turn = align_attitudes(&pairs, self.alignment)?;
        let total_deg = pairs
            .iter()
            .map(|(estimate, truth)| attitude_error(&(turn * estimate.attitude), &truth.attitude))
            .map(|error| error.total_rad.to_degrees());
        Ok(Errors::of(total_deg))
    }
}

impl Errors {
    fn of(errors: impl Iterator<Item = f64>) -> Self {
        let (mut sum, mut moments) = (0.0, 0);
        for error in errors {
            sum += error * error;
            moments += 1;
        }
        Self { mean_square: sum / moments as f64, moments }
    }
}

/// Settings of a method on one run: its defaults, what the sidecar knows, what the configuration says.
fn settings<S: MethodSettings>(sidecar: Option<&Sidecar>, config: &toml::Table) -> Result<toml::Table> {
    let settings: S = config::overlay_table(&method::knowing::<S>(sidecar), config.clone())?;
    toml::Table::try_from(settings).context("settings cannot be written as TOML")
}

fn drive<S: MethodSettings>(trial: &Trial, settings: toml::Table) -> Result<Trajectory> {
    let mut settings: S = settings.try_into()?;
    if let Some(radio) = &trial.radio {
        settings = settings.at_site(radio);
    }
    // Poses alone: solutions with their covariances would take ten times the memory, and as much time.
    let mut poses = Vec::new();
    trial.run(settings.start()?.as_mut(), |Solution { time, position_m, attitude, .. }| {
        poses.push(Pose { time, position_m, attitude });
    })?;
    Ok(Trajectory::new(poses)?)
}

/// The mean over the runs of their mean squared errors, each method run over its whole logs.
pub struct WholeLogs<'a> {
    /// The runs.
    pub runs: &'a Runs,
    /// The parameters.
    pub parameters: &'a Parameters,
}

impl Objective for WholeLogs<'_> {
    fn cost(&self, values: &[f64]) -> f64 {
        let errors = self.runs.judge(self.parameters, values);
        mean_cost(&errors.into_iter().map(Result::ok).collect::<Vec<_>>())
    }
}

/// Mean over the runs; one that failed costs [`FAILED`], and none costs more.
pub fn mean_cost(errors: &[Option<f64>]) -> f64 {
    let costs = errors.iter().map(|error| error.map_or(FAILED, |error| error.min(FAILED)));
    costs.sum::<f64>() / errors.len() as f64
}
