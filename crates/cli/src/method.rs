//! The methods by name: the one place where the command line meets the estimation crate.

use crate::config;
use adit_core::solution::Solution;
use adit_estimation::methods::foot_ins::{
    self, FixedLag, FootIns, FootInsParams, FootInsReport, FootInsWarning,
};
use adit_observation::Observation;
use adit_observation::sidecar::{Location, Sidecar};
use anyhow::{Context, Result};
use clap::ValueEnum;
use std::path::Path;

/// How to position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Inertial sensor on the foot: zero velocity whenever the foot stands; no infrastructure
    FootIns,
}

/// A method with its parameters, ready to start.
#[derive(Debug, Clone)]
pub enum Settings {
    /// [`Method::FootIns`].
    FootIns(FootInsParams),
}

/// What a method says about its run.
#[derive(Debug, Clone)]
pub struct MethodReport {
    /// Share of the inertial samples at which the foot stood, 0 to 1.
    pub share_at_rest: Option<f64>,
    /// Odd things that the method met.
    pub warnings: Vec<String>,
    /// All it has to say, for the JSON report.
    pub details: serde_json::Value,
}

/// A method at work, one observation at a time.
pub trait Tracker {
    /// Takes the next observation; a solution may be late and carries its own time.
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>>;

    /// A further solution that the observations so far make due.
    fn next_due(&mut self) -> Result<Option<Solution>>;

    /// Solutions still owed after the last observation, one by one.
    fn finish_next(&mut self) -> Result<Option<Solution>>;

    /// What it says about its run.
    fn report(&self) -> Result<MethodReport>;
}

impl Method {
    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FootIns => "foot-ins",
        }
    }

    /// Its parameters: the defaults, over them what a sidecar knows of the sensor, over these what a TOML file says.
    pub fn settings(self, sidecar: Option<&Sidecar>, config: Option<&Path>) -> Result<Settings> {
        match self {
            Self::FootIns => {
                let known = sidecar.map_or_else(FootInsParams::default, foot_ins_params);
                let params =
                    config.map_or_else(|| Ok(known.clone()), |path| config::overlay(&known, path))?;
                Ok(Settings::FootIns(params))
            }
        }
    }

    /// What a sidecar says that does not suit the method.
    pub fn objection(self, sidecar: &Sidecar) -> Option<String> {
        match (self, sidecar.mounting.location) {
            (Self::FootIns, None | Some(Location::Foot)) => None,
            (Self::FootIns, Some(other)) => {
                let place = format!("{other:?}").to_lowercase();
                Some(format!("the sidecar puts the sensor at \"{place}\", foot-ins expects it on the foot"))
            }
        }
    }
}

fn foot_ins_params(sidecar: &Sidecar) -> FootInsParams {
    let mut params = FootInsParams::default();
    if let Some(noise) = &sidecar.noise {
        params = params.with_specification(noise);
    }
    if let Some(declination_deg) = sidecar.frame.magnetic_declination_deg {
        params.declination_rad = declination_deg.to_radians();
    }
    params
}

impl Settings {
    /// Starts the method, streaming; with a lag in seconds its solutions are smoothed over that time.
    pub fn start(&self, lag_s: Option<f64>) -> Result<Box<dyn Tracker>> {
        match (self, lag_s) {
            (Self::FootIns(params), None) => Ok(Box::new(FootIns::new(params.clone())?)),
            (Self::FootIns(params), Some(lag_s)) => Ok(Box::new(FixedLag::new(params.clone(), lag_s)?)),
        }
    }

    /// Runs the method over the whole log and smooths it; `progress` hears of the work done, up to twice the samples.
    pub fn smooth(
        &self,
        log: &[Observation],
        progress: &mut dyn FnMut(usize),
    ) -> Result<(Vec<Solution>, MethodReport)> {
        match self {
            Self::FootIns(params) => {
                let (solutions, report) = foot_ins::smooth(params.clone(), log, progress)?;
                Ok((solutions, foot_ins_report(&report)?))
            }
        }
    }
}

impl Tracker for FootIns {
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>> {
        Ok(Self::observe(self, observation)?)
    }

    fn next_due(&mut self) -> Result<Option<Solution>> {
        Ok(Self::next_due(self)?)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>> {
        Ok(Self::finish_next(self)?)
    }

    fn report(&self) -> Result<MethodReport> {
        foot_ins_report(Self::report(self))
    }
}

impl Tracker for FixedLag {
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>> {
        Ok(Self::observe(self, observation)?)
    }

    fn next_due(&mut self) -> Result<Option<Solution>> {
        Ok(Self::next_due(self))
    }

    fn finish_next(&mut self) -> Result<Option<Solution>> {
        Ok(Self::finish_next(self)?)
    }

    fn report(&self) -> Result<MethodReport> {
        foot_ins_report(Self::report(self))
    }
}

fn foot_ins_report(report: &FootInsReport) -> Result<MethodReport> {
    let mut details = serde_json::to_value(report).context("the report of foot-ins cannot be written")?;
    details["mean_nis"] = report.mean_nis().into();
    Ok(MethodReport {
        share_at_rest: (report.samples > 0).then(|| report.still_samples as f64 / report.samples as f64),
        warnings: foot_ins_warnings(&report.warnings),
        details,
    })
}

/// One line for each kind of warning: the log itself has told of every gap already.
fn foot_ins_warnings(warnings: &[FootInsWarning]) -> Vec<String> {
    let is_gap = |warning: &&FootInsWarning| matches!(warning, FootInsWarning::Gap { .. });
    let gaps = warnings.iter().filter(is_gap).count();
    let others = warnings.iter().filter(|warning| !is_gap(warning)).map(FootInsWarning::text);
    let first_gap = warnings.iter().find(is_gap).map(|first| match gaps {
        1 => first.text(),
        _ => format!("{} ({gaps} gaps, this is the first)", first.text()),
    });
    others.chain(first_gap).collect()
}
