//! What every filter shares: measurement models and innovations.
//!
//! A sensor is one implementation of a measurement model: it compares what was measured with what the state predicts,
//! and says how the difference depends on the error state ([`Linearised`]). The filter never changes for a new sensor.

use adit_core::nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// A three-dimensional measurement, linearised at the present state: `residual ≈ Σ jacobian δx + noise`.
///
/// `N` is the number of 3-vectors of the error state that the measurement depends on.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised<const N: usize> {
    /// Measured minus predicted.
    pub residual: Vector3<f64>,
    /// Derivative of the residual by each block of the error state: (index of the block, 3×3).
    pub jacobian: [(usize, Matrix3<f64>); N],
    /// Covariance of the measurement noise, 3×3.
    pub noise: Matrix3<f64>,
}

/// What became of one measurement; rejected ones are reported like accepted ones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Innovation {
    /// Measured minus predicted.
    pub value: Vector3<f64>,
    /// Its predicted covariance `S = H P Hᵀ + R`.
    pub covariance: Matrix3<f64>,
    /// Normalised innovation squared `vᵀ S⁻¹ v`: χ² with three degrees of freedom when the filter is consistent.
    pub nis: f64,
    /// False when the gate kept the measurement out.
    pub accepted: bool,
}
