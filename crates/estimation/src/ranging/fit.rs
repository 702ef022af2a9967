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
//! Limits: the covariance is that of the expected information, true of many ranges (of 48 the normalised squared error is 3.16 of 3) and bold of few
//! (3.54 with 12). A single range with an area is searched along its circle, slowly: it need not arrive.

use super::linear::linear;
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
/// A place that is not sure to this, m, is none.
const NOT_TOLD_M: f64 = 1e4;
/// Minima whose costs differ by less are equally good.
const EQUAL: f64 = 1e-6;
/// A minimum less probable than this is none.
const UNLIKELY: f64 = 1e-3;
/// So many standard deviations apart, squared, two searches have ended in two minima.
const APART: f64 = 9.0;
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
    let normal = normal_of(ranges, &middle, known_m.is_none());
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
        solve(groups, residuals, (start.xy(), above), &problem)
    };
    let [lower, upper] = match ranges {
        [a, b, c] => three_spheres(&[*a, *b, *c]).map_or([None; 2], |both| both.map(Some)),
        _ => [None; 2],
    };
    let straight = linear(ranges, params.height).map(|fix| fix.position_m);
    let starts = [Some(beside.xy().push(height_m)), straight, lower, upper];
    let mut minima: [Option<Minimum>; 5] = [None; 5];
    for (minimum, start) in minima.iter_mut().zip(starts) {
        *minimum = start.and_then(search);
    }
    let place = |minimum: &Minimum| minimum.position_m.push(height_m + minimum.offset);
    let first = best(&minima)?;
    let off = normal.dot(&(place(&first) - middle));
    minima[4] = search(place(&first) - normal * (2.0 * off));
    let first = best(&minima)?;
    let apart = |one: &Minimum| {
        let away = place(one) - place(&first);
        first.covariance.cholesky().is_some_and(|root| away.dot(&root.solve(&away)) > APART)
    };
    let second = minima.iter().flatten().filter(|one| apart(one));
    let second = second.min_by(|a, b| a.cost.total_cmp(&b.cost)).copied();
    let swapped = second.filter(|other| other.cost - first.cost < EQUAL && other.offset < first.offset);
    let (taken, other) = swapped.map_or((first, second), |lower| (lower, Some(first)));
    let fix = mixture(&taken, other.as_ref(), place);
    let told = fix.covariance_m2.trace() < NOT_TOLD_M * NOT_TOLD_M;
    told.then_some(fix)
}

/// One minimum, and what another adds to its uncertainty.
fn mixture(taken: &Minimum, other: Option<&Minimum>, place: impl Fn(&Minimum) -> Vector3<f64>) -> RangingFix {
    let alone = RangingFix { position_m: place(taken), covariance_m2: taken.covariance, other_m: None };
    let Some(other) = other else { return alone };
    let share = 1.0 / (1.0 + libm::exp((other.cost - taken.cost).max(0.0)));
    if share < UNLIKELY {
        return alone;
    }
    let away = place(other) - place(taken);
    let covariance_m2 =
        taken.covariance * (1.0 - share) + (other.covariance + away * away.transpose()) * share;
    RangingFix { covariance_m2, other_m: Some(place(other)), ..alone }
}

fn best(minima: &[Option<Minimum>]) -> Option<Minimum> {
    minima.iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost)).copied()
}

/// The direction in which anchors differ least, in space (downwards) or in the plane.
fn normal_of(ranges: &[Ranged], middle: &Vector3<f64>, space: bool) -> Vector3<f64> {
    let mut scatter = ranges.iter().fold(Matrix3::zeros(), |scatter, one| {
        let off = one.position_m - middle;
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
