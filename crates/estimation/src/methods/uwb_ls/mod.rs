//! `uwb-ls`: positions by ranges alone, one epoch at a time.
//!
//! ```text
//! ranges → epochs (ranging::epochs) → a position each (ranging::fit, ranging::linear) → solutions
//! ```
//!
//! One solution for each epoch, at the mean time of its ranges, with its covariance; nothing is assumed of how people move, and none is filtered: the
//! least that every other UWB method has to better. Takes ranges of UWB and of radios that are not told; needs no sensors of the tag.
//! Frame: that of the anchors. Where their height is not told, that of the tag is taken for that of the epoch's anchors within
//! [`SolverParams::height_sigma_m`](crate::ranging::solver::SolverParams::height_sigma_m).
//! Limits: those of [`crate::ranging`]; a range around a corner moves the fix as far as geometry lets it when few others disagree.

mod params;

pub use params::UwbLsParams;

use crate::methods::somewhere::somewhere;
use crate::methods::{
    Estimates, Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, RadioUse,
};
use crate::radio::RadioSite;
use crate::ranging::Ranged;
use crate::ranging::epochs::Epoch;
use crate::ranging::listener::{RangeListener, RangesHeard};
use crate::ranging::solver::Solver;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "uwb-ls";

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UwbLsReport {
    /// What was heard.
    #[serde(flatten)]
    pub heard: RangesHeard,
    /// Epochs that gave a position.
    pub fixes: u64,
    /// Of these, positions that have another beside them which the ranges allow too.
    pub ambiguous_fixes: u64,
    /// Radius of 95 % of the positions, mean, m.
    pub mean_radius_95_m: f64,
    /// Warnings.
    pub warnings: Vec<MethodWarning>,
}

/// One tag, streaming.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UwbLs {
    listener: RangeListener,
    solver: Solver,
    /// Time of the last solution: another tag's epoch may have an earlier middle.
    told: Option<Time>,
    radius_sum_m: f64,
    report: UwbLsReport,
}

impl UwbLs {
    /// A tag that has measured nothing.
    pub fn new(params: UwbLsParams) -> Result<Self, MethodError> {
        if let Some(name) = params.solver.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        let UwbLsParams { ranges, solver, site } = params;
        Ok(Self {
            listener: RangeListener::new(NAME, site.as_deref(), ranges)?,
            solver: Solver::new(solver, site.as_deref()),
            told: None,
            radius_sum_m: 0.0,
            report: UwbLsReport::default(),
        })
    }

    fn tell(&mut self, epoch: &Epoch) -> Option<Solution> {
        self.report.heard.clone_from(self.listener.heard());
        let time = epoch.time();
        let links = epoch.ranges.iter().filter_map(|range| self.listener.link(range));
        let ranges: Vec<Ranged> = links.map(|link| link.ranged).collect();
        let fix = self.solver.solve(&ranges)?;
        if self.told.is_some_and(|told| time <= told) {
            return None;
        }
        self.told = Some(time);
        self.report.fixes += 1;
        self.report.ambiguous_fixes += u64::from(fix.other_m.is_some());
        let solution = somewhere(time, fix.position_m, &fix.covariance_m2);
        self.radius_sum_m += solution.radius_95_m();
        self.report.mean_radius_95_m = self.radius_sum_m / self.report.fixes as f64;
        Some(solution)
    }
}

impl Method for UwbLs {
    type Report = UwbLsReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        self.listener.observe(observation);
        self.next_due()
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(epoch) = self.listener.pop() {
            let solution = self.tell(&epoch);
            if solution.is_some() {
                return Ok(solution);
            }
        }
        Ok(None)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(epoch) = self.listener.finish() {
            let solution = self.tell(&epoch);
            if solution.is_some() {
                return Ok(solution);
            }
        }
        self.report.heard.clone_from(self.listener.heard());
        if self.told.is_none() {
            return Err(self.report.heard.no_position());
        }
        if self.report.warnings.is_empty() {
            self.report.warnings.extend(self.report.heard.warning());
        }
        Ok(None)
    }

    fn report(&self) -> &UwbLsReport {
        &self.report
    }
}

impl MethodSettings for UwbLsParams {
    type Report = UwbLsReport;

    const NAME: &'static str = NAME;
    const ESTIMATES: Estimates = Estimates::Position;
    const RADIO: RadioUse = RadioUse::Needed;

    fn knowing(self, _: &Known) -> Self {
        self
    }

    fn at_site(self, radio: &Arc<RadioSite>) -> Self {
        Self { site: Some(Arc::clone(radio)), ..self }
    }

    fn start(self) -> Result<Box<dyn Method<Report = UwbLsReport>>, MethodError> {
        Ok(Box::new(UwbLs::new(self)?))
    }
}

impl MethodReport for UwbLsReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }
}
