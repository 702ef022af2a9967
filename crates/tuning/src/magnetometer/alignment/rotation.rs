//! What both ways to a rotation share.

use crate::robust::{self, BIWEIGHT_CUT};
use adit_core::attitude;
use adit_core::nalgebra::{Cholesky, Const, Matrix3, SMatrix, SVector, Vector3};

/// A rotation found, with what is known about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationFit {
    /// From magnetometer to inertial axes, proper.
    pub rotation: Matrix3<f64>,
    /// σ about each axis, rad.
    pub sd_rad: Vector3<f64>,
    /// What remains, robust σ, rad.
    pub residual_rad: f64,
}

/// The proper rotation nearest to a matrix or to its negative (Schönemann 1966).
pub fn nearest(matrix: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let svd = matrix.svd(true, true);
    let rotation = svd.u? * svd.v_t?;
    let proper = if rotation.determinant() < 0.0 { -rotation } else { rotation };
    proper.iter().all(|v| v.is_finite()).then_some(proper)
}

/// The rotation turned by a small rotation vector on the left.
pub fn turned(rotation: &Matrix3<f64>, step: &Vector3<f64>) -> Matrix3<f64> {
    attitude::exp(step).to_rotation_matrix() * rotation
}

/// One linearised observation: residual and derivatives by N parameters.
pub struct Linear<const N: usize> {
    /// Value minus what the parameters say, 1.
    pub residual: f64,
    /// Its derivatives.
    pub slope: SVector<f64, N>,
}

/// One robust Gauss–Newton step (Tukey's biweight): the step, the covariance of the parameters, the scale of the residuals.
///
/// `prior` is an information added for parameters that the observations may leave open.
pub fn step<const N: usize>(
    observations: &[Linear<N>],
    prior: &SVector<f64, N>,
    offset_from_prior: &SVector<f64, N>,
) -> Option<(SVector<f64, N>, SMatrix<f64, N, N>, f64)> {
    let scale = robust::spread_about(observations.iter().map(|o| o.residual), 0.0)?.max(1e-9);
    let mut information = SMatrix::<f64, N, N>::zeros();
    let mut gradient = SVector::<f64, N>::zeros();
    for Linear { residual, slope } in observations {
        let weight = robust::biweight(residual / (BIWEIGHT_CUT * scale)) / (scale * scale);
        information.ger(weight, slope, slope, 1.0);
        gradient += slope * (weight * residual);
    }
    information += SMatrix::from_diagonal(prior);
    gradient += prior.component_mul(offset_from_prior);
    let factor: Cholesky<f64, Const<N>> = Cholesky::new(information)?;
    Some((-factor.solve(&gradient), factor.inverse(), scale))
}
