//! Covariance of a small error state of any size, kept as one matrix.
//!
//! The transition is given as a function `x ↦ Φ x`: a navigation error model has few terms, and written out they cost a
//! fraction of a product of matrices (10 states: 32 multiplications in place of 100). Sizes are fixed, nothing is allocated.

use adit_core::nalgebra::{SMatrix, SVector};

/// What an update did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectedUpdate<const N: usize, const M: usize> {
    /// What the measurement says of the error state.
    pub correction: SVector<f64, N>,
    /// Covariance of the innovation, before any widening.
    pub covariance: SMatrix<f64, M, M>,
    /// Normalised innovation squared: χ² with `M` degrees of freedom when the filter is consistent.
    pub nis: f64,
}

/// `P ← Φ P Φᵀ`, symmetric to the last bit.
#[inline]
pub fn propagate<const N: usize>(
    covariance: &mut SMatrix<f64, N, N>,
    transition: impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
) {
    for _ in 0..2 {
        for mut column in covariance.column_iter_mut() {
            let carried = transition(&column.clone_owned());
            column.copy_from(&carried);
        }
        covariance.transpose_mut();
    }
    symmetrise(covariance);
}

/// Kalman update with a measurement of the states `measured` themselves: `residual = x[measured] + noise`.
///
/// Where the normalised innovation squared exceeds `bound` the noise grows until it does not (Huber's weight): an outlier
/// pulls no more than a value at the bound. `None` when the covariance of the innovation has no Cholesky factor.
pub fn update_selected<const N: usize, const M: usize>(
    covariance: &mut SMatrix<f64, N, N>,
    measured: [usize; M],
    residual: &SVector<f64, M>,
    noise: &SMatrix<f64, M, M>,
    bound: f64,
) -> Option<SelectedUpdate<N, M>> {
    let seen = SMatrix::<f64, N, M>::from_fn(|row, column| covariance[(row, measured[column])]);
    let predicted = SMatrix::<f64, M, M>::from_fn(|row, column| seen[(measured[row], column)]);
    let innovation = predicted + noise;
    let nis = residual.dot(&innovation.cholesky()?.solve(residual));
    let widened = if nis > bound { innovation * (nis / bound) } else { innovation };
    // K = P Hᵀ S⁻¹, and P ← P − K S Kᵀ with K S = P Hᵀ.
    let gain = widened.cholesky()?.solve(&seen.transpose()).transpose();
    *covariance -= gain * seen.transpose();
    symmetrise(covariance);
    Some(SelectedUpdate { correction: gain * residual, covariance: innovation, nis })
}

/// Rounding leaves the halves a bit apart, and what is apart grows.
#[inline]
fn symmetrise<const N: usize>(matrix: &mut SMatrix<f64, N, N>) {
    for column in 0..N {
        for row in 0..column {
            let mean = 0.5 * (matrix[(row, column)] + matrix[(column, row)]);
            matrix[(row, column)] = mean;
            matrix[(column, row)] = mean;
        }
    }
}
