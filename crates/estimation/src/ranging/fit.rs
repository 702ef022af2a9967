//! Robust least squares on ranges, in space.
//!
//! Minimises `Σ (ν+1)/2 ln(1 + e_i²/ν)` of the residuals `e_i = (s_i ‖p − p_i‖ + o_i − r_i) / σ_i`, and what is known of height and
//! area, by Levenberg–Marquardt on reweighted squares (Lange, Little & Taylor 1989), the solver of [`radio`](crate::radio) with the height for its third
//! unknown. ν → ∞ is plain least squares; with ν = 4 a range that is ten standard deviations too long weighs a twentieth of a good one.
//!
//! The cost has several minima: mirror images, and compromises with wrong ranges. The search begins at the linear solution, at the meetings of three
//! spheres, beside the middle of the anchors, and at the mirror image of the best of these in the plane (or wall, or row) of the anchors. Of two
//! minima the other one has the share `w = 1 / (1 + exp(ΔJ))` of the probability; its place δ away adds `w δ δᵀ` to the covariance. Of two
//! equally good ones the lower is taken: anchors hang above people.
//!
//! The covariance is that of the expected information, larger for few ranges (`few.rs`).
//!
//! Limits: a single range with an area is searched along its circle, slowly: it need not arrive.

use super::few;
use super::linear::linear;
use super::minima::{Spot, best, tell};
use super::spheres::three_spheres;
use super::{Height, Ranged, RangingFix};
use crate::radio::AreaPrior;
use crate::radio::gauss_newton::{LANES, Minimum, Problem, Residuals, solve};
use adit_core::nalgebra::{Matrix3, Vector2, Vector3};

/// How to fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitParams {
    /// What is known of the height.
    pub height: Height,
    /// Degrees of freedom ν of the errors: few for long tails.
    pub dof: f64,
    /// Iterations at most, from each start.
    pub iterations: usize,
    /// Steps shorter than this end a search, m.
    pub small_step_m: f64,
}

impl Default for FitParams {
    fn default() -> Self {
        Self { height: Height::Free, dof: 4.0, iterations: 50, small_step_m: 1e-4 }
    }
}

/// Standard deviation of a height of which nothing is known, m.
const ANY_HEIGHT_M: f64 = 1e6;
/// No anchor is farther from the origin than this, m.
const FARTHEST_M: f64 = 1e9;
/// Nearer to an anchor than this, m, nothing changes any more.
const NEAREST_M: f64 = 0.05;

/// The fix; `None` of no ranges, of fewer than there are unknowns where no area is told, or of ranges that leave the place open.
pub fn fit(ranges: &[Ranged], area: Option<&AreaPrior>, params: &FitParams) -> Option<RangingFix> {
    let (known_m, sigma_m, unknowns) = match params.height {
        Height::Free => (None, ANY_HEIGHT_M, 3),
        Height::Near { mean_m, sigma_m } => (Some(mean_m), sigma_m, 2),
    };
    if ranges.is_empty() || (area.is_none() && ranges.len() < unknowns) {
        return None;
    }
    let middle = ranges.iter().map(|one| one.position_m).sum::<Vector3<f64>>() / ranges.len() as f64;
    if !ranges.iter().all(|one| one.position_m.iter().all(|value| value.abs() < FARTHEST_M)) {
        return None;
    }
    let normal = normal_of(ranges.iter().map(|one| one.position_m), &middle, known_m.is_none());
    // Off the plane, where the cost would have a saddle: `Σ d_i² = n ‖p − middle‖² + Σ ‖p_i − middle‖²`.
    let squares = ranges.iter().map(|one| {
        let (distance, _) = one.distance_m();
        distance * distance - (one.position_m - middle).norm_squared()
    });
    let off = libm::sqrt((squares.sum::<f64>() / ranges.len() as f64).max(0.0));
    let beside = middle + normal * off;
    let height_m = known_m.unwrap_or(beside.z);
    let problem = Problem {
        dof: params.dof,
        offset_sigma: sigma_m,
        small_offset: params.small_step_m,
        prior: area,
        iterations: params.iterations,
        small_step_m: params.small_step_m,
    };
    let residuals = |group: usize, level: &Vector2<f64>, above: f64| {
        residuals(ranges.iter().skip(LANES * group).take(LANES), &level.push(height_m + above))
    };
    let groups = ranges.len().div_ceil(LANES);
    let search = |start: Vector3<f64>| {
        let above = if sigma_m > 0.0 { start.z - height_m } else { 0.0 };
        let minimum = solve(groups, residuals, (start.xy(), above), &problem)?;
        let Minimum { position_m, offset, information, prior, cost, .. } = minimum;
        let covariance_m2 = few::covariance(&information, &prior, ranges.len(), params.dof)?;
        Some(Spot { position_m: position_m.push(height_m + offset), covariance_m2, cost })
    };
    let [lower, upper] = match ranges {
        [a, b, c] => three_spheres(&[*a, *b, *c]).map_or([None; 2], |both| both.map(Some)),
        _ => [None; 2],
    };
    let straight = linear(ranges, params.height).map(|fix| fix.position_m);
    let starts = [Some(beside.xy().push(height_m)), straight, lower, upper];
    let mut spots: [Option<Spot>; 5] = [None; 5];
    for (spot, start) in spots.iter_mut().zip(starts) {
        *spot = start.and_then(search);
    }
    let place = best(&spots)?.position_m;
    spots[4] = search(place - normal * (2.0 * normal.dot(&(place - middle))));
    tell(&spots)
}

/// The direction in which anchors differ least, in space (downwards) or in the plane.
pub(super) fn normal_of(
    anchors_m: impl Iterator<Item = Vector3<f64>>,
    middle: &Vector3<f64>,
    space: bool,
) -> Vector3<f64> {
    let mut scatter = anchors_m.fold(Matrix3::zeros(), |scatter, one| {
        let off = one - middle;
        let off = if space { off } else { off.xy().push(0.0) };
        scatter + off * off.transpose()
    });
    if !space {
        scatter[(2, 2)] = 2.0 * scatter.trace() + 1.0;
    }
    let eigen = scatter.symmetric_eigen();
    let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    if normal.z > 0.0 { -normal } else { normal }
}

fn residuals<'a>(group: impl Iterator<Item = &'a Ranged>, place: &Vector3<f64>) -> Residuals {
    let mut all = Residuals::default();
    for (k, Ranged { position_m, model, range_m }) in group.enumerate() {
        let away = place - position_m;
        let distance = away.norm().max(NEAREST_M);
        let gradient = away * (model.scale / (distance * model.sigma_m));
        all.value[k] = (model.scale * distance + model.offset_m - range_m) / model.sigma_m;
        (all.east[k], all.north[k], all.offset[k]) = (gradient.x, gradient.y, gradient.z);
    }
    all
}
