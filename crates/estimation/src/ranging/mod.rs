//! Position of a tag from one epoch of ranges to anchors, as UWB measures them.
//!
//! ```text
//! r_i = s_i ‖p − p_i‖ + o_i + e_i
//! ```
//!
//! | solver | errors | module |
//! |---|---|---|
//! | trilateration: both places where three spheres meet | none | [`spheres`] |
//! | linear least squares on differences of squares (system S4, Jia et al. 2024, eq. 1–5) | small, and none wrong | [`linear`] |
//! | robust least squares | Student's t: long tails | [`fit`] |
//! | the same on differences of arrival | Student's t at each anchor | [`tdoa`] |
//!
//! Offset o, scale s and standard deviation σ of each anchor are a [`RangeModel`]. The [`Height`] of the tag is free, known, or known within a
//! standard deviation. How well anchors lie for a place tells [`dilution`]; [`epochs`] gathers
//! the ranges of a log, [`listener`] those to the anchors of a site, corrected ([`correction`]); [`solver`] is the solver that settings name.
//!
//! Frame: that of the anchors, z up, m. Nothing here filters: each epoch stands for itself.
//! Limits: anchors in one plane, or in one row, leave mirror images. Every [`RangingFix`] holds the more likely place, and in its covariance how
//! far and how likely the other one is.

pub mod correction;
pub mod dilution;
pub mod epochs;
mod few;
pub mod filter;
pub mod fit;
pub mod linear;
pub mod listener;
mod minima;
pub mod solver;
pub mod spheres;
pub mod tdoa;

pub use crate::radio::range_fit::{RangeModel, Ranged};

use adit_core::nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// What is known of the height of a tag.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Height {
    /// Nothing: it is estimated.
    Free,
    /// Normal about a mean.
    Near {
        /// Mean, m.
        mean_m: f64,
        /// Standard deviation, m; 0 where it is known.
        sigma_m: f64,
    },
}

/// A place by ranges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RangingFix {
    /// East, north, height, m.
    pub position_m: Vector3<f64>,
    /// Second moment of its error, m².
    pub covariance_m2: Matrix3<f64>,
    /// Another place that the ranges allow, m: the mirror image in the plane of the anchors, mostly.
    pub other_m: Option<Vector3<f64>>,
}

impl Ranged {
    /// Distance in space that this range tells and its standard deviation, m.
    pub fn distance_m(&self) -> (f64, f64) {
        let RangeModel { offset_m, scale, sigma_m } = self.model;
        (((self.range_m - offset_m) / scale).max(0.0), sigma_m / scale)
    }
}
