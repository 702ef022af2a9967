//! Position from differences of arrival (`TDoA`), in space.
//!
//! ```text
//! d_i = (‖p − p_i‖ + e_i) − (‖p − p_0‖ + e_0),   i = 1 … n
//! ```
//!
//! The reference's error is in every difference, and differences are correlated: `E (e_i − e_0)(e_j − e_0) = σ_i² δ_ij + σ_0²`. That is the same
//! as n + 1 independent arrivals with one unknown more, their common offset b (the distance to the reference with its sign turned):
//!
//! ```text
//! a_i = ‖p − p_i‖ + b + e_i,   a_0 = 0,   a_i = d_i
//! ```
//!
//! and so it is fitted, which keeps the long tails of each arrival, the reference's too, to where they are: `Σ (ν+1)/2 ln(1 + e_i²/σ_i²ν)` and what
//! is known of height and area, by Levenberg–Marquardt on reweighted squares (Lange, Little & Taylor 1989). With ν → ∞ it is the weighted least
//! squares of the correlated differences (tested).
//!
//! It begins where equations linear in p and the distance r to the reference lead ([`closed_form`]),
//!
//! ```text
//! (p_i − p_0)ᵀ q + d_i r = ½ (‖p_i − p_0‖² − d_i²),   q = p − p_0
//! ```
//!
//! solved by least squares for both (Smith & Abel 1987; the first step of Chan & Ho 1994), and for q alone, r then from `‖q‖² = r²` (Schau & Robinson 1987: two
//! places, which as many differences as coordinates cannot tell apart); beside the middle of the anchors; and at the mirror image of the best. How a second minimum counts and how
//! few readings do: as in [`fit`](super::fit).
//!
//! Limits: far outside of the anchors hyperbolas are nearly parallel, and the covariance, linear, says too little.

use super::few;
use super::fit::normal_of;
use super::minima::{Spot, best, tell};
use super::{Height, RangingFix, fit::FitParams};
use crate::radio::AreaPrior;
use adit_core::nalgebra::{Matrix3, Matrix4, Vector3, Vector4};
use alloc::vec::Vec;

/// An anchor and when the signal came there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// East, north, height of the anchor, m.
    pub position_m: Vector3<f64>,
    /// How much farther it is from the tag than the reference is, m; of the reference itself 0.
    pub farther_m: f64,
    /// Standard deviation of the arrival here alone, m: of the difference it is `√(σ_i² + σ_0²)`.
    pub sigma_m: f64,
}

/// Standard deviation of a height of which nothing is known, m.
const ANY_HEIGHT_M: f64 = 1e6;
/// Information of a height that is known, m⁻².
const KNOWN: f64 = 1e12;
/// No anchor is farther from the origin than this, m.
const FARTHEST_M: f64 = 1e9;
/// Nearer to an anchor than this, m, nothing changes any more.
const NEAREST_M: f64 = 0.05;
/// Eigenvalues below this share of the largest are zero: 1 cm in 100 m.
const FLAT: f64 = 1e-8;

/// The fix; the first arrival is the reference. `None` of fewer differences than unknown coordinates where no area is told, and of arrivals that leave the
/// place open.
pub fn fit(arrivals: &[Arrival], area: Option<&AreaPrior>, params: &FitParams) -> Option<RangingFix> {
    let unknowns = if params.height == Height::Free { 3 } else { 2 };
    if arrivals.len() < 2 || (area.is_none() && arrivals.len() <= unknowns) || !usable(arrivals) {
        return None;
    }
    let prior = Prior::new(params.height, area)?;
    let search = |start: Vector3<f64>| {
        let start = if params.height == Height::Free { start } else { start.xy().push(prior.mean_m.z) };
        descend(arrivals, start, &prior, params)
    };
    let count = arrivals.len() as f64;
    let middle = arrivals.iter().map(|one| one.position_m).sum::<Vector3<f64>>() / count;
    let normal = normal_of(arrivals.iter().map(|one| one.position_m), &middle, params.height == Height::Free);
    let spread = arrivals.iter().map(|one| (one.position_m - middle).norm_squared()).sum::<f64>() / count;
    let off = normal * libm::sqrt(spread).max(1.0);
    let closed = closed_form(arrivals, params.height);
    let starts = closed.into_iter().chain([Some(middle + off), Some(middle - off)]);
    let mut spots: [Option<Spot>; 7] = [None; 7];
    for (spot, start) in spots.iter_mut().zip(starts) {
        *spot = start.and_then(search);
    }
    let place = best(&spots)?.position_m;
    spots[6] = search(place - normal * (2.0 * normal.dot(&(place - middle))));
    tell(&spots)
}

fn usable(arrivals: &[Arrival]) -> bool {
    arrivals.iter().all(|one| {
        one.position_m.iter().all(|value| value.abs() < FARTHEST_M)
            && one.farther_m.is_finite()
            && one.sigma_m.is_finite()
            && one.sigma_m > 0.0
    })
}

/// What is known beside the arrivals.
struct Prior {
    mean_m: Vector3<f64>,
    information: Matrix3<f64>,
}

impl Prior {
    fn new(height: Height, area: Option<&AreaPrior>) -> Option<Self> {
        let (mean_m, sigma_m) = match height {
            Height::Free => (0.0, ANY_HEIGHT_M),
            Height::Near { mean_m, sigma_m } => (mean_m, sigma_m),
        };
        let mut prior = Self { mean_m: Vector3::new(0.0, 0.0, mean_m), information: Matrix3::zeros() };
        prior.information[(2, 2)] = (1.0 / (sigma_m * sigma_m)).min(KNOWN);
        if let Some(area) = area {
            prior.mean_m = area.mean_m.push(mean_m);
            prior.information.fixed_view_mut::<2, 2>(0, 0).copy_from(&area.covariance_m2.try_inverse()?);
        }
        Some(prior)
    }
}

/// Up to four places that exact differences would come from.
pub fn closed_form(arrivals: &[Arrival], height: Height) -> [Option<Vector3<f64>>; 4] {
    let Some((reference, others)) = arrivals.split_first() else { return [None; 4] };
    let known = match height {
        Height::Free => None,
        Height::Near { mean_m, .. } => Some(mean_m - reference.position_m.z),
    };
    let mut normal = Matrix4::zeros();
    let mut right = Vector4::zeros();
    for one in others {
        let away = one.position_m - reference.position_m;
        let level = known.map_or(away, |_| away.xy().push(0.0));
        let row = level.push(one.farther_m);
        let square = away.norm_squared() - one.farther_m * one.farther_m;
        normal += row * row.transpose();
        right += row * (0.5 * square - known.map_or(0.0, |up| away.z * up));
    }
    if !normal.iter().chain(&right).all(|value| value.is_finite()) {
        return [None; 4];
    }
    let place = |level: Vector3<f64>| {
        let q = known.map_or(level, |up| level.xy().push(up));
        let finite = q.iter().all(|value| value.is_finite());
        finite.then_some(reference.position_m + q)
    };
    // For place and distance together; what no equation tells is zero, and what the distance then lacks lies across.
    let eigen = normal.symmetric_eigen();
    let cut = FLAT * eigen.eigenvalues.max();
    let mut both = Vector4::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > cut {
            both += vector * (vector.dot(&right) / value);
        }
    }
    let (level, up) = (both.xyz(), known.unwrap_or(0.0));
    let left = both.w * both.w - level.norm_squared() - up * up;
    let mut places = normal.fixed_view::<3, 3>(0, 0).into_owned();
    if known.is_some() {
        places[(2, 2)] = -1.0;
    }
    let eigen = places.symmetric_eigen();
    // Where the height is known it has no equation, and level across is the next least.
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let across = order[usize::from(known.is_some())];
    let flat = eigen.eigenvalues[across] <= FLAT * eigen.eigenvalues.max();
    let normal_axis: Vector3<f64> = eigen.eigenvectors.column(across).into_owned();
    if flat {
        let off = normal_axis * libm::sqrt(left.max(0.0));
        return [place(level + off), place(level - off), None, None];
    }
    // For the place alone, by the distance r: q = a − b r.
    let (mut a, mut b) = (Vector3::zeros(), Vector3::zeros());
    let by_distance: Vector3<f64> = normal.fixed_view::<3, 1>(0, 3).into_owned();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > FLAT * eigen.eigenvalues.max() {
            a += vector * (vector.dot(&right.xyz()) / value);
            b += vector * (vector.dot(&by_distance) / value);
        }
    }
    let [one, other] = roots(b.norm_squared() - 1.0, -2.0 * a.dot(&b), a.norm_squared() + up * up);
    let at = |r: Option<f64>| place(a - b * r.filter(|r| *r >= 0.0)?);
    [place(level), at(one), at(other), None]
}

/// Roots of `a x² + b x + c`; where errors leave none, the place where it is nearest to zero.
fn roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    if a.abs() < 1e-12 {
        return [(b != 0.0).then(|| -c / b), None];
    }
    let half = -0.5 * b / a;
    let root = libm::sqrt((half * half - c / a).max(0.0));
    [Some(half - root), Some(half + root)]
}

struct Normal {
    matrix: Matrix4<f64>,
    /// `Σ g gᵀ`, unweighted.
    information: Matrix4<f64>,
    right: Vector4<f64>,
    cost: f64,
}

fn normal_at(arrivals: &[Arrival], at: &Vector4<f64>, prior: &Prior, dof: f64) -> Normal {
    let place = at.xyz();
    let pull = prior.information * (prior.mean_m - place);
    let mut normal = Normal {
        matrix: prior.information.fixed_resize(0.0),
        information: Matrix4::zeros(),
        right: pull.push(0.0),
        cost: 0.5 * pull.dot(&(prior.mean_m - place)),
    };
    for Arrival { position_m, farther_m, sigma_m } in arrivals {
        let away = place - position_m;
        let distance = away.norm().max(NEAREST_M);
        let gradient = (away / distance).push(1.0) / *sigma_m;
        let error = (distance + at.w - farther_m) / sigma_m;
        let weight = (dof + 1.0) / (dof + error * error);
        let square = gradient * gradient.transpose();
        normal.information += square;
        normal.matrix += square * weight;
        normal.right -= gradient * (weight * error);
        normal.cost += 0.5 * (dof + 1.0) * libm::log1p(error * error / dof);
    }
    normal
}

/// The minimum next to a start.
fn descend(arrivals: &[Arrival], start: Vector3<f64>, prior: &Prior, params: &FitParams) -> Option<Spot> {
    let offset = median(arrivals.iter().map(|one| one.farther_m - (start - one.position_m).norm()))?;
    let mut at = start.push(offset);
    let mut here = normal_at(arrivals, &at, prior, params.dof);
    let mut damping = 1e-3;
    for _ in 0..params.iterations {
        let mut stretched = here.matrix;
        for k in 0..4 {
            stretched[(k, k)] *= 1.0 + damping;
        }
        let step = stretched.cholesky()?.solve(&here.right);
        let there = normal_at(arrivals, &(at + step), prior, params.dof);
        // A cost that is not a number is no progress.
        if there.cost <= here.cost {
            at += step;
            here = there;
            damping *= 0.1;
            if step.xyz().norm() < params.small_step_m {
                break;
            }
        } else {
            damping = (damping * 10.0).max(0.1);
            if damping > 1e6 {
                break;
            }
        }
    }
    let prior = prior.information.fixed_resize(0.0);
    let covariance = few::covariance(&here.information, &prior, arrivals.len(), params.dof)?;
    let finite = at.iter().chain([&here.cost]).all(|value| value.is_finite());
    finite.then(|| Spot {
        position_m: at.xyz(),
        covariance_m2: covariance.fixed_view::<3, 3>(0, 0).into_owned(),
        cost: here.cost,
    })
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
