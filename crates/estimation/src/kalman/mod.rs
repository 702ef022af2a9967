//! What every filter shares: measurement models and innovations.
//!
//! A sensor is one implementation of a measurement model: it compares what was measured with what the state predicts,
//! and says how the difference depends on the error state ([`Linearised`]). The filter never changes for a new sensor.

pub mod blocks;
pub mod dense;

use adit_core::nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Derivative of a residual by one 3-vector of the error state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Derivative {
    /// The identity: the residual is that error itself. A third of all products of an update are spared by knowing it.
    Identity,
    /// Any 3×3 matrix.
    Matrix(Matrix3<f64>),
}

impl Derivative {
    /// `m Hᵀ`.
    #[inline]
    pub fn right_transposed(&self, m: &Matrix3<f64>) -> Matrix3<f64> {
        match self {
            Self::Identity => *m,
            Self::Matrix(h) => m * h.transpose(),
        }
    }

    /// `H m`.
    #[inline]
    pub fn left(&self, m: &Matrix3<f64>) -> Matrix3<f64> {
        match self {
            Self::Identity => *m,
            Self::Matrix(h) => h * m,
        }
    }

    /// `H` itself.
    pub fn matrix(&self) -> Matrix3<f64> {
        match self {
            Self::Identity => Matrix3::identity(),
            Self::Matrix(h) => *h,
        }
    }
}

/// A three-dimensional measurement, linearised at the present state: `residual ≈ Σ jacobian δx + noise`.
///
/// `N` is the number of 3-vectors of the error state that the measurement depends on.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised<const N: usize> {
    /// Measured minus predicted.
    pub residual: Vector3<f64>,
    /// Derivative of the residual by each block of the error state that it depends on: (index of the block, 3×3).
    pub jacobian: [(usize, Derivative); N],
    /// Covariance of the measurement noise, 3×3.
    pub noise: Matrix3<f64>,
}

/// What a sensor, or a thing known of people, says of a state: one implementation each.
///
/// `N` is the number of 3-vectors of the error state that it depends on.
pub trait MeasurementModel<State, const N: usize> {
    /// Compares what was measured with what `state` predicts.
    fn linearise(&self, state: &State) -> Linearised<N>;
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
