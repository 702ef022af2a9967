//! Distance as a polynomial of the range (system S4, Jia et al. 2024, eq. 6–10).
//!
//! ```text
//! ε = Σ (d_i − f(r_i))²  →  least,   f(r) = a0 + a1 r + … + ak r^k
//! ```
//!
//! The paper solves normal equations of sums of powers up to `r^2k` (eq. 10; its first element `m + 1` should be `m`, and the vector of unknowns lacks a0),
//! of hundreds of metres to the 2k: at 100 m and k = 5 no digit is left. Here the ranges are first
//! put on −1…1 and Chebyshev polynomials of them are fitted; the result is written in powers of r. Equal in exact arithmetic.
//!
//! With few [degrees of freedom](PolynomialParams::dof) errors have Student's long tails: squares are reweighted (Lange, Little & Taylor 1989).

use crate::error::TuningError;
use adit_core::nalgebra::{DMatrix, DVector};
use adit_estimation::ranging::correction::RangePolynomial;

/// How to fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolynomialParams {
    /// k.
    pub degree: usize,
    /// Degrees of freedom of the errors; infinite for least squares as in the paper.
    pub dof: f64,
}

/// A range and the distance that it measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangePair {
    /// The range as measured, m.
    pub measured_m: f64,
    /// The distance, m.
    pub true_m: f64,
}

/// Powers beyond this wriggle.
pub const MOST: usize = 9;
/// Directions of the normal matrix with less than this of its greatest eigenvalue are left at zero.
const SMALL: f64 = 1e-12;
/// No range is better than this, m.
const LEAST_M: f64 = 1e-3;
/// Reweightings settle in a few.
const REWEIGHTINGS: usize = 50;

/// Fits f, its standard deviation being that of all pairs, long tails too; degrees beyond [`MOST`] are taken for it. The error of too few pairs, or of pairs that are not finite.
pub fn fit(pairs: &[RangePair], params: &PolynomialParams) -> Result<RangePolynomial, TuningError> {
    let degree = params.degree.min(MOST);
    if pairs.len() < degree + 2 {
        let (found, expected) = (pairs.len(), degree + 2);
        return Err(TuningError::TooFewReadings { sensor: "ranges with a known distance", found, expected });
    }
    let mut values = pairs.iter().flat_map(|pair| [pair.measured_m, pair.true_m]);
    if let Some(found) = values.find(|value| !value.is_finite()) {
        return Err(TuningError::Range { found });
    }
    let measured = || pairs.iter().map(|pair| pair.measured_m);
    let learnt_m = [measured().fold(f64::INFINITY, f64::min), measured().fold(f64::NEG_INFINITY, f64::max)];
    let middle = 0.5 * (learnt_m[0] + learnt_m[1]);
    let half = (0.5 * (learnt_m[1] - learnt_m[0])).max(1e-3);
    let design = DMatrix::from_fn(pairs.len(), degree + 1, |row, k| {
        chebyshev(k, (pairs[row].measured_m - middle) / half)
    });
    // Errors of the range, not distances: what the design cannot tell stays zero, and so does the correction.
    let too_long =
        DVector::from_iterator(pairs.len(), pairs.iter().map(|pair| pair.measured_m - pair.true_m));
    let mut weights = DVector::from_element(pairs.len(), 1.0);
    let mut solved = weighted(&design, &too_long, &weights);
    if params.dof.is_finite() {
        for _ in 0..REWEIGHTINGS {
            let residuals = &too_long - &design * &solved;
            let squares = residuals.map(|residual| residual * residual);
            // EM of the scale of Student's t (Lange, Little & Taylor 1989).
            let scale = (squares.dot(&weights) / pairs.len() as f64).max(1e-12);
            let renewed = squares.map(|square| (params.dof + 1.0) / (params.dof + square / scale));
            let next = weighted(&design, &too_long, &renewed);
            let change = (&next - &solved).amax();
            (weights, solved) = (renewed, next);
            if change < 1e-9 {
                break;
            }
        }
    }
    let residuals = &too_long - &design * &solved;
    let sigma_m = (residuals.norm_squared() / (pairs.len() - degree - 1) as f64).sqrt();
    let mut coefficients: Vec<f64> = in_powers(solved.as_slice(), middle, half).iter().map(|a| -a).collect();
    match coefficients.get_mut(1) {
        Some(slope) => *slope += 1.0,
        None => coefficients.push(1.0),
    }
    Ok(RangePolynomial { coefficients, learnt_m, sigma_m: sigma_m.max(LEAST_M) })
}

/// Weighted least squares by the eigenvalues of the normal matrix.
fn weighted(design: &DMatrix<f64>, right: &DVector<f64>, weights: &DVector<f64>) -> DVector<f64> {
    let mut weighted = design.clone();
    for (mut row, weight) in weighted.row_iter_mut().zip(weights.iter()) {
        row *= *weight;
    }
    let eigen = weighted.tr_mul(design).symmetric_eigen();
    let cut = SMALL * eigen.eigenvalues.amax();
    let mut along = eigen.eigenvectors.tr_mul(&weighted.tr_mul(right));
    for (value, eigenvalue) in along.iter_mut().zip(eigen.eigenvalues.iter()) {
        *value = if *eigenvalue > cut { *value / eigenvalue } else { 0.0 };
    }
    eigen.eigenvectors * along
}

/// `T_k(u)`, by its recursion.
fn chebyshev(k: usize, u: f64) -> f64 {
    (0..k).fold((1.0, u), |(here, next), _| (next, 2.0 * u * next - here)).0
}

/// `Σ c_k T_k((r − middle) / half)` as coefficients of powers of r.
fn in_powers(coefficients: &[f64], middle: f64, half: f64) -> Vec<f64> {
    let width = coefficients.len();
    // u as a polynomial of r.
    let times_u = |of: &[f64]| {
        let mut product = vec![0.0; width];
        for (k, a) in of.iter().enumerate() {
            product[k] -= a * middle / half;
            if let Some(above) = product.get_mut(k + 1) {
                *above += a / half;
            }
        }
        product
    };
    let mut here = vec![0.0; width];
    here[0] = 1.0;
    let mut next = times_u(&here);
    let mut sum = vec![0.0; width];
    for c in coefficients {
        for (sum, value) in sum.iter_mut().zip(&here) {
            *sum += c * value;
        }
        let after: Vec<f64> = times_u(&next).iter().zip(&here).map(|(a, b)| 2.0 * a - b).collect();
        here = std::mem::replace(&mut next, after);
    }
    sum
}
