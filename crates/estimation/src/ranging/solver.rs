//! The solver that settings name, over the ranges of one epoch.

use super::fit::{FitParams, fit};
use super::linear::linear;
use super::{Height, Ranged, RangingFix};
use crate::radio::{AreaPrior, RadioSite};
use crate::settings::{first_unusable, not_negative, positive};
use adit_core::nalgebra::{Matrix2, Vector2};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// How a position is made of ranges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SolverParams {
    /// Which solver.
    pub kind: SolverKind,
    /// Height of the tag in the frame of the anchors, m; absent: about that of the epoch's anchors.
    pub height_m: Option<f64>,
    /// Standard deviation of that height, m; 0 where it is known.
    pub height_sigma_m: f64,
    /// Degrees of freedom of the errors; robust only.
    pub dof: f64,
    /// Tags are expected this far around anchors and roadways, m, one standard deviation; robust only.
    pub margin_m: f64,
    /// An epoch of fewer ranges gives no position.
    pub least_ranges: usize,
}

/// Solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolverKind {
    /// Linear least squares in the plane, at the height told (system S4).
    Linear,
    /// Linear least squares in space; nothing is assumed of the height.
    #[serde(rename = "linear-3d")]
    LinearSpace,
    /// Robust least squares in space.
    #[default]
    Robust,
}

impl Default for SolverParams {
    fn default() -> Self {
        Self {
            kind: SolverKind::Robust,
            height_m: None,
            height_sigma_m: 2.0,
            dof: 4.0,
            margin_m: 20.0,
            least_ranges: 3,
        }
    }
}

impl SolverParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("solver.height_m", self.height_m.is_none_or(f64::is_finite)),
            ("solver.height_sigma_m", not_negative(self.height_sigma_m)),
            ("solver.dof", positive(self.dof)),
            ("solver.margin_m", positive(self.margin_m)),
            ("solver.least_ranges", self.least_ranges > 0),
        ])
    }

    /// What is known of the height of a tag that these ranges are of.
    pub fn height(&self, ranges: &[Ranged]) -> Height {
        let hung_m = || ranges.iter().map(|one| one.position_m.z).sum::<f64>() / ranges.len().max(1) as f64;
        Height::Near { mean_m: self.height_m.unwrap_or_else(hung_m), sigma_m: self.height_sigma_m }
    }
}

/// Solver of a site.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Solver {
    params: SolverParams,
    area: Option<AreaPrior>,
}

impl Solver {
    /// For the people of a site; settings must be usable.
    pub(crate) fn new(params: SolverParams, site: Option<&RadioSite>) -> Self {
        Self { area: site.and_then(|site| area(site, params.margin_m)), params }
    }

    /// A position of these ranges; `None` of too few, or where they tell none.
    pub fn solve(&self, ranges: &[Ranged]) -> Option<RangingFix> {
        self.solve_within(ranges, self.area.as_ref())
    }

    /// The same of somebody who is expected about a place: what else could be is decided by that. Robust only.
    pub fn solve_within(&self, ranges: &[Ranged], area: Option<&AreaPrior>) -> Option<RangingFix> {
        let SolverParams { kind, dof, least_ranges, .. } = self.params;
        if ranges.len() < least_ranges.max(1) {
            return None;
        }
        let height = self.params.height(ranges);
        match kind {
            SolverKind::Linear => linear(ranges, height),
            SolverKind::LinearSpace => linear(ranges, Height::Free),
            SolverKind::Robust => fit(ranges, area, &FitParams { height, dof, ..FitParams::default() }),
        }
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
