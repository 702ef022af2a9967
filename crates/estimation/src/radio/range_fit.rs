//! Position from round-trip ranges: linear least squares, and a robust fit with calibrated offsets.
//!
//! ```text
//! r_i = s_i ‖p − p_i‖ + o_i + e_i,   e_i ~ Student t_ν(σ_i)
//! ```
//!
//! A Wi-Fi round-trip range has an offset for each access point, a metre or two, and reads long behind walls, the more so the farther: offset
//! o and scale s come from a calibration (`adit_tuning::ranges`), as does σ.

use super::gauss_newton::{LANES, Problem, Residuals, solve};
use super::{AreaPrior, RadioFix, trilateration};
use adit_core::nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// How the ranges to one device are off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RangeModel {
    /// What the device adds to every range, m.
    pub offset_m: f64,
    /// Metres read for each metre walked away.
    pub scale: f64,
    /// Standard deviation about that, m.
    pub sigma_m: f64,
}

/// A range to a device whose place is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranged {
    /// East, north, height of the device, m.
    pub position_m: Vector3<f64>,
    /// How its ranges are off.
    pub model: RangeModel,
    /// The range as read, m.
    pub range_m: f64,
}

/// What is taken as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeFitParams {
    /// Height of the tag, m.
    pub height_m: f64,
    /// Degrees of freedom of the errors: few for long tails.
    pub dof: f64,
    /// Iterations at most.
    pub iterations: usize,
    /// Steps shorter than this end the search, m: far below what a fix is sure of.
    pub small_step_m: f64,
}

impl Default for RangeFitParams {
    fn default() -> Self {
        Self { height_m: 0.0, dof: 4.0, iterations: 30, small_step_m: 0.02 }
    }
}

impl Ranged {
    /// Level distance that this range tells, m.
    pub fn level_range_m(&self, height_m: f64) -> f64 {
        let slant = ((self.range_m - self.model.offset_m) / self.model.scale).max(0.0);
        let drop = self.position_m.z - height_m;
        libm::sqrt((slant * slant - drop * drop).max(0.0))
    }
}

/// The robust fit, the better of two: begun at the linear solution and at the middle of the devices. `None` of fewer than three
/// ranges without a prior, or none at all.
pub fn range_fit(ranges: &[Ranged], prior: Option<&AreaPrior>, params: &RangeFitParams) -> Option<RadioFix> {
    if ranges.is_empty() || (prior.is_none() && ranges.len() < 3) {
        return None;
    }
    let problem = Problem {
        dof: params.dof,
        offset_sigma: 0.0,
        small_offset: f64::INFINITY,
        prior,
        iterations: params.iterations,
        small_step_m: params.small_step_m,
    };
    let residuals = |group: usize, position: &Vector2<f64>, _: f64| {
        let mut all = Residuals::default();
        for (k, Ranged { position_m, model, range_m }) in
            ranges.iter().skip(LANES * group).take(LANES).enumerate()
        {
            let away = position - position_m.xy();
            let drop = position_m.z - params.height_m;
            let distance = libm::sqrt(away.norm_squared() + drop * drop).max(0.05);
            let gradient = away * (model.scale / (distance * model.sigma_m));
            all.value[k] = (model.scale * distance + model.offset_m - range_m) / model.sigma_m;
            (all.east[k], all.north[k]) = (gradient.x, gradient.y);
        }
        all
    };
    let middle = ranges.iter().map(|one| one.position_m.xy()).sum::<Vector2<f64>>() / ranges.len() as f64;
    let linear = trilateration::linear_ranges(ranges, params.height_m).map(|fix| fix.position_m);
    let starts = [Some(middle), linear];
    let groups = ranges.len().div_ceil(LANES);
    let minima =
        starts.into_iter().flatten().filter_map(|start| solve(groups, residuals, (start, 0.0), &problem));
    let best = minima.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    Some(RadioFix { position_m: best.position_m, covariance_m2: best.level_covariance_m2() })
}
