//! An [`ErrorCurve`] by least absolute errors.
//!
//! ```text
//! Σ w_i √(e_i² + ε²) + λ Σ (b_{k−1} − 2 b_k + b_{k+1})²  →  least,   e_i = y_i − Σ h_k(x_i) b_k
//! ```
//!
//! h: hats about the knots, which stand at quantiles; b: the curve there. Least absolute errors fit medians (Koenker & Bassett 1978), here smooth near zero and by
//! reweighted squares; the second differences are those of P-splines (Eilers & Marx 1996).

use super::folds::{Row, Rows};
use super::offsets::Offsets;
use crate::robust::quantile;
use adit_core::nalgebra::{DMatrix, DVector};
use adit_estimation::ranging::correction::{Diagnostic, ErrorCurve};

/// Knots at most.
const KNOTS: usize = 8;
/// Links for each knot at least.
const LINKS: usize = 6;
/// Shares of the values below the outermost knots.
const ENDS: [f64; 2] = [0.01, 0.99];
/// ε: errors below are those of the radio itself, m.
const SMOOTH_M: f64 = 0.02;
/// λ for each unit of weight and knot, 1/m.
const STIFFNESS: f64 = 1.0;
/// Reweightings settle in a few tens.
const REWEIGHTINGS: usize = 60;
/// Links whose worth of the common spread each knot's is drawn to.
const PRIOR_LINKS: f64 = 3.0;

/// As many as the links carry.
pub(super) fn knots_for(rows: &Rows<'_>) -> usize {
    let mut links: Vec<usize> = rows.rows.iter().map(|row| row.link).collect();
    links.dedup();
    (links.len() / LINKS).clamp(2, KNOTS)
}

/// The curve with no spread yet; `None` where nothing tells what it is of.
pub(super) fn fit(rows: &Rows<'_>, offsets: &Offsets, of: Diagnostic, knots: usize) -> Option<ErrorCurve> {
    let points = rows.rows.iter().filter_map(|row| {
        let range = &row.known.range;
        let too_long = row.known.too_long_m() - offsets.of(range.anchor.as_str());
        Some((of.of(range)?, too_long, row.weight))
    });
    let points: Vec<(f64, f64, f64)> = points.collect();
    let mut values: Vec<f64> = points.iter().map(|(x, ..)| *x).collect();
    let shares = (0..knots).map(|k| {
        let along = if knots > 1 { k as f64 / (knots - 1) as f64 } else { 0.5 };
        ENDS[0] + along * (ENDS[1] - ENDS[0])
    });
    let mut at: Vec<f64> = shares.filter_map(|share| quantile(&mut values, share)).collect();
    at.dedup();
    if at.is_empty() {
        return None;
    }
    let count = at.len();
    let total: f64 = points.iter().map(|(.., weight)| weight).sum();
    let mut stiff = DMatrix::zeros(count, count);
    for k in 1..count.saturating_sub(1) {
        let mut bend = DVector::zeros(count);
        (bend[k - 1], bend[k], bend[k + 1]) = (1.0, -2.0, 1.0);
        stiff += &bend * bend.transpose() * (STIFFNESS * total / count as f64);
    }
    let hats: Vec<(usize, f64)> = points.iter().map(|(x, ..)| hat(&at, *x)).collect();
    let mut curve = DVector::zeros(count);
    for _ in 0..REWEIGHTINGS {
        let (mut normal, mut right) = (stiff.clone(), DVector::zeros(count));
        for ((k, share), (_, y, weight)) in hats.iter().zip(&points) {
            let sides = [(*k, 1.0 - share), ((k + 1).min(count - 1), *share)];
            let error = y - sides.iter().map(|(k, part)| part * curve[*k]).sum::<f64>();
            let weight = weight / error.hypot(SMOOTH_M);
            for (i, a) in sides {
                right[i] += weight * a * y;
                for (j, b) in sides {
                    normal[(i, j)] += weight * a * b;
                }
            }
        }
        for k in 0..count {
            // A knot that nothing stands by.
            normal[(k, k)] += 1e-9 * total;
        }
        let next = normal.cholesky()?.solve(&right);
        let change = (&next - &curve).amax();
        curve = next;
        if change < 1e-5 {
            break;
        }
    }
    let sigma_m = vec![1.0; count];
    Some(ErrorCurve { of, at, too_long_m: curve.as_slice().to_vec(), sigma_m })
}

/// The knot before a value and the share of the way to the next.
fn hat(at: &[f64], value: f64) -> (usize, f64) {
    let after = at.partition_point(|knot| *knot <= value);
    match (after.checked_sub(1), at.get(after)) {
        (Some(before), Some(next)) => (before, (value - at[before]) / (next - at[before])),
        (Some(before), None) => (before, 0.0),
        (None, _) => (0, 0.0),
    }
}

/// Spread at each knot: of the ranges held out near it, drawn to that of all.
pub(super) fn spread(curve: &mut ErrorCurve, residuals: &[(Row<'_>, f64)], of_all_m: f64) {
    let links = residuals.iter().map(|(row, _)| row.link).max().map_or(1.0, |last| last as f64 + 1.0);
    let total: f64 = residuals.iter().map(|(row, _)| row.weight).sum();
    let prior = PRIOR_LINKS * total / links;
    let count = curve.at.len();
    let mut sums = vec![[prior * of_all_m * of_all_m, prior]; count];
    for (row, residual) in residuals {
        let Some(value) = curve.of.of(&row.known.range) else { continue };
        let (k, share) = hat(&curve.at, value);
        for (k, part) in [(k, 1.0 - share), ((k + 1).min(count - 1), share)] {
            sums[k][0] += part * row.weight * residual * residual;
            sums[k][1] += part * row.weight;
        }
    }
    curve.sigma_m = sums.into_iter().map(|[square, weight]| (square / weight).sqrt().max(1e-3)).collect();
}
