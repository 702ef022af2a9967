//! Settings of `uwb-ls`.

use crate::radio::RadioSite;
use crate::ranging::epochs::EpochParams;
use crate::settings::{first_unusable, not_negative, positive};
use alloc::string::String;
use alloc::sync::Arc;
use serde::{Deserialize, Serialize};

/// Settings of [`UwbLs`](super::UwbLs).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UwbLsParams {
    /// Only the ranges of this tag, where one carrier wears several; else of all of them.
    pub tag: Option<String>,
    /// How ranges are gathered.
    pub epochs: EpochParams,
    /// How positions are made of them.
    pub solver: SolverParams,
    /// The anchors of the site.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
}

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
    /// Standard deviation of a range where the device does not tell, m.
    pub sigma_m: f64,
    /// What every range reads too long, m, beside the offset of its anchor.
    pub offset_m: f64,
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
            sigma_m: 0.15,
            offset_m: 0.0,
            dof: 4.0,
            margin_m: 20.0,
            least_ranges: 3,
        }
    }
}

impl UwbLsParams {
    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let solver = &self.solver;
        let own = first_unusable(&[
            ("solver.height_m", solver.height_m.is_none_or(f64::is_finite)),
            ("solver.height_sigma_m", not_negative(solver.height_sigma_m)),
            ("solver.sigma_m", positive(solver.sigma_m)),
            ("solver.offset_m", solver.offset_m.is_finite()),
            ("solver.dof", positive(solver.dof)),
            ("solver.margin_m", positive(solver.margin_m)),
            ("solver.least_ranges", solver.least_ranges > 0),
        ]);
        self.epochs.unusable().or(own)
    }
}
