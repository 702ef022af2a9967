//! `uwb-ls`: positions by ranges alone, one epoch at a time.
//!
//! ```text
//! ranges → epochs (ranging::epochs) → a position each (ranging::fit, ranging::linear) → solutions
//! ```
//!
//! One solution for each epoch, at the mean time of its ranges, with its covariance; nothing is assumed of how people move, and none is filtered: the
//! least that every other UWB method has to better. Takes ranges of UWB and of radios that are not told; needs no sensors of the tag.
//! Frame: that of the anchors. Where their height is not told, that of the tag is taken for that of the epoch's anchors within
//! [`SolverParams::height_sigma_m`].
//! Limits: those of [`crate::ranging`]; a range around a corner moves the fix as far as geometry lets it when few others disagree.

mod params;

pub use params::{SolverKind, SolverParams, UwbLsParams};

use crate::methods::somewhere::somewhere;
use crate::methods::{
    Estimates, Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, RadioUse,
};
use crate::radio::{AreaPrior, RadioSite, SiteAnchor, first_names};
use crate::ranging::epochs::{Epoch, Epochs};
use crate::ranging::fit::{FitParams, fit};
use crate::ranging::linear::linear;
use crate::ranging::{Height, RangeModel, Ranged, RangingFix};
use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_observation::{DeviceId, Observation, Radio, RangeSample};
use alloc::boxed::Box;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "uwb-ls";
/// Names of unknown anchors kept for the report.
const MOST_NAMES: usize = 100;

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UwbLsReport {
    /// Ranges in the log, of the tag and of UWB.
    pub ranges: u64,
    /// Of these, to anchors that the site does not know.
    pub unknown_ranges: u64,
    /// Those anchors, at most the first hundred.
    pub unknown_anchors: Vec<DeviceId>,
    /// Ranges that came after the report of their epoch: left.
    pub late_ranges: u64,
    /// Ranges of which an epoch had too many: left.
    pub left_out_ranges: u64,
    /// Epochs.
    pub epochs: u64,
    /// Of these, epochs that gave a position.
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
    tag: Option<String>,
    solver: SolverParams,
    /// By id.
    anchors: Vec<SiteAnchor>,
    area: Option<AreaPrior>,
    epochs: Epochs,
    /// Time of the last solution: another tag's epoch may have an earlier middle.
    told: Option<Time>,
    radius_sum_m: f64,
    report: UwbLsReport,
}

impl UwbLs {
    /// A tag that has measured nothing.
    pub fn new(params: UwbLsParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        let UwbLsParams { tag, epochs, solver, site } = params;
        let site = site.filter(|site| !site.anchors.is_empty());
        let site =
            site.ok_or(MethodError::NoRadio { method: NAME, needs: "the places of the anchors (--mine)" })?;
        let mut anchors = site.anchors.clone();
        anchors.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(Self {
            tag,
            area: area(&site, solver.margin_m),
            solver,
            anchors,
            epochs: Epochs::new(epochs),
            told: None,
            radius_sum_m: 0.0,
            report: UwbLsReport::default(),
        })
    }

    fn anchor(&self, id: &str) -> Option<&SiteAnchor> {
        let at = self.anchors.binary_search_by(|anchor| anchor.id.as_str().cmp(id)).ok()?;
        self.anchors.get(at)
    }

    fn take(&mut self, range: &RangeSample) {
        let of_tag = self.tag.is_none() || self.tag.as_deref() == range.tag.as_ref().map(DeviceId::as_str);
        if !of_tag || !matches!(range.radio, Radio::Uwb | Radio::Unknown) {
            return;
        }
        self.report.ranges += 1;
        if self.anchor(range.anchor.as_str()).is_none() {
            self.report.unknown_ranges += 1;
            let unknown = &mut self.report.unknown_anchors;
            if unknown.len() < MOST_NAMES && !unknown.contains(&range.anchor) {
                unknown.push(range.anchor.clone());
            }
            return;
        }
        self.epochs.observe(range);
        self.report.late_ranges = self.epochs.late();
        self.report.left_out_ranges = self.epochs.left_out();
    }

    fn ranged(&self, range: &RangeSample) -> Option<Ranged> {
        let anchor = self.anchor(range.anchor.as_str())?;
        let model = RangeModel {
            offset_m: anchor.range_offset_m + self.solver.offset_m,
            scale: 1.0,
            sigma_m: range.sigma_m.unwrap_or(self.solver.sigma_m),
        };
        Some(Ranged { position_m: anchor.position_m, model, range_m: range.range_m })
    }

    fn solve(&self, epoch: &Epoch) -> Option<RangingFix> {
        let ranges: Vec<Ranged> = epoch.ranges.iter().filter_map(|range| self.ranged(range)).collect();
        let SolverParams { kind, height_m, height_sigma_m, dof, least_ranges, .. } = self.solver;
        if ranges.len() < least_ranges.max(1) {
            return None;
        }
        let hung_m = ranges.iter().map(|one| one.position_m.z).sum::<f64>() / ranges.len() as f64;
        let height = Height::Near { mean_m: height_m.unwrap_or(hung_m), sigma_m: height_sigma_m };
        match kind {
            SolverKind::Linear => linear(&ranges, height),
            SolverKind::LinearSpace => linear(&ranges, Height::Free),
            SolverKind::Robust => {
                fit(&ranges, self.area.as_ref(), &FitParams { height, dof, ..FitParams::default() })
            }
        }
    }

    fn tell(&mut self, epoch: &Epoch) -> Option<Solution> {
        self.report.epochs += 1;
        let time = epoch.time();
        let fix = self.solve(epoch)?;
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

/// Where people are: in the roadways, or among the anchors where there are none.
fn area(site: &RadioSite, margin_m: f64) -> Option<AreaPrior> {
    let known = site.area.map(|area| AreaPrior {
        covariance_m2: area.covariance_m2 + Matrix2::identity() * (margin_m * margin_m),
        ..area
    });
    known.or_else(|| {
        let places: Vec<Vector2<f64>> = site.anchors.iter().map(|anchor| anchor.position_m.xy()).collect();
        AreaPrior::of(&places, margin_m)
    })
}

impl Method for UwbLs {
    type Report = UwbLsReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match observation {
            Observation::Range(range) => self.take(range),
            // What comes by radio may be ahead of the tag's clock.
            other if other.kind().is_wired() => self.epochs.advance(other.time()),
            _ => {}
        }
        self.next_due()
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(epoch) = self.epochs.pop() {
            let solution = self.tell(&epoch);
            if solution.is_some() {
                return Ok(solution);
            }
        }
        Ok(None)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(epoch) = self.epochs.finish() {
            let solution = self.tell(&epoch);
            if solution.is_some() {
                return Ok(solution);
            }
        }
        let UwbLsReport { ranges, unknown_ranges, unknown_anchors, warnings, .. } = &mut self.report;
        let names = first_names(unknown_anchors);
        if self.told.is_none() {
            let names = if names.is_empty() { names } else { alloc::format!(" ({names})") };
            return Err(MethodError::NoRangeFix { ranges: *ranges, unknown: *unknown_ranges, names });
        }
        if warnings.is_empty() && *unknown_ranges > 0 {
            let anchors = unknown_anchors.len();
            warnings.push(MethodWarning::UnknownAnchors { anchors, ranges: *unknown_ranges, names });
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
    fn details(&self) -> impl Serialize {
        self
    }

    fn share_at_rest(&self) -> Option<f64> {
        None
    }

    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }
}
