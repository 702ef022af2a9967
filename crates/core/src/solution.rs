//! What a method answers: where, how fast, which way, and how sure.

use crate::attitude::Attitude;
use crate::time::Time;
use nalgebra::{Matrix2, Matrix3, SMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// Covariance of `[position (m), velocity (m/s), attitude (rotation vector in n, rad)]`.
pub type SolutionCovariance = SMatrix<f64, 9, 9>;

/// How far a solution can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quality {
    /// Held by position fixes: the error does not grow with the distance walked.
    Fixed,
    /// Dead reckoning from the last fix or from the start: the error grows, and the covariance says how.
    DeadReckoning,
    /// The method knows that it has lost the walker.
    Lost,
}

/// Integrity risk of [`Solution::protection_level_m`]: the share of moments at which the true position may lie outside.
pub const INTEGRITY_RISK: f64 = 1e-3;
/// The protection level over the 95 % radius. A normal error would need 1.5; errors of radio and of steps have longer tails: chosen, not proved
/// (docs/methods/fused.md).
const PROTECTION: f64 = 3.0;

/// State of one walker at one time, in the navigation frame (ENU, z up) of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// Time of validity.
    pub time: Time,
    /// Position (east, north, up), m.
    pub position_m: Vector3<f64>,
    /// Velocity (east, north, up), m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Body-to-navigation rotation.
    pub attitude: Attitude,
    /// Covariance of position, velocity and attitude error, in this order.
    pub covariance: SolutionCovariance,
    /// How far to trust it.
    pub quality: Quality,
}

impl Solution {
    /// Covariance of the position, m².
    pub fn position_covariance(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Radius of the horizontal circle that holds the true position with 95 % probability, m: [`radius_95_m`].
    pub fn radius_95_m(&self) -> f64 {
        radius_95_m(&self.covariance.fixed_view::<2, 2>(0, 0).into_owned())
    }

    /// Protection level, m: radius of the horizontal circle outside which the true position lies with no more probability than [`INTEGRITY_RISK`].
    pub fn protection_level_m(&self) -> f64 {
        PROTECTION * self.radius_95_m()
    }
}

/// Radius of the circle that holds a normal error of this covariance (m²) with 95 % probability, m.
///
/// Exact for the line-like (1.9600 σ) and the circular (2.4477 σ) Gaussian; in between, where there is no closed
/// form, a polynomial in the squared ratio of the axes that is nowhere more than 0.1 % off the exact radius (fitted
/// to, and tested against, the numerical integral in `tests/reference/radius_95.py`).
/// NaN when the covariance is: a filter that has lost itself must not look certain.
pub fn radius_95_m(covariance_m2: &Matrix2<f64>) -> f64 {
    let (a, b, c) = (covariance_m2[(0, 0)], covariance_m2[(0, 1)], covariance_m2[(1, 1)]);
    let mean = 0.5 * (a + c);
    let half_gap = libm::hypot(0.5 * (a - c), b);
    let major = no_less_than_zero(mean + half_gap);
    if major == 0.0 {
        return 0.0;
    }
    let ratio = no_less_than_zero(mean - half_gap) / major;
    libm::sqrt(major) * (1.96 + ratio * (0.2113 + ratio * (0.4142 - ratio * 0.1378)))
}

/// A rounding error below zero is zero; NaN, which `f64::max` would swallow, stays NaN.
fn no_less_than_zero(variance: f64) -> f64 {
    if variance < 0.0 { 0.0 } else { variance }
}
