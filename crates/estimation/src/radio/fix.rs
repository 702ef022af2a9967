//! A position by radio and how sure it is.

use super::line::moments;
use adit_core::nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

/// A position by radio.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RadioFix {
    /// East, north, m.
    pub position_m: Vector2<f64>,
    /// Covariance of its error, m².
    pub covariance_m2: Matrix2<f64>,
}

/// Where a tag may be before anything is heard: a mean place and how far people are from it.
///
/// It keeps a fix on its side of a row of transmitters, and near the mine when few are heard.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AreaPrior {
    /// Centre, m.
    pub mean_m: Vector2<f64>,
    /// Spread, m².
    pub covariance_m2: Matrix2<f64>,
}

impl AreaPrior {
    /// Mean and spread of places where people are, widened by `margin_m` in every direction; `None` of no places.
    pub fn of(places_m: &[Vector2<f64>], margin_m: f64) -> Option<Self> {
        let (mean_m, scatter) = moments(places_m.iter().map(|place| (*place, 1.0)))?;
        Some(Self { mean_m, covariance_m2: scatter + Matrix2::identity() * (margin_m * margin_m) })
    }
}

impl RadioFix {
    /// Radius of the circle that holds the true position with 95 % probability if errors are normal, m.
    pub fn radius_95_m(&self) -> f64 {
        adit_core::solution::radius_95_m(&self.covariance_m2)
    }
}
