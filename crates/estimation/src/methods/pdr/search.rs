//! Where the walk lies on the map: the first fixes against the way walked, while neither place nor direction is known.
//!
//! The filter is linear about its direction; one that may be anything within half a turn is beyond it. So the first fixes are
//! held against the dead-reckoned way as a whole. Of fixes `f_i` and places `d_i` of the way, the rotation and shift with
//! the least squares (Umeyama 1991, in the plane and without scale) come from running sums alone:
//!
//! ```text
//! ψ = arg (k + Σ w_i (d_i − d̄)* (f_i − f̄)),   1 / var ψ = k + Σ w_i |d_i − d̄|²,   1 / var f̄ = Σ w_i
//! ```
//!
//! with east and north as the parts of a complex number, w one over the variance of a fix, and k one over the variance of what is known of the
//! direction without fixes: that of a magnetometer on a tag whose mounting is declared, else nothing (the product of two von Mises distributions; Mardia & Jupp
//! 2000, §3.5.4). The search is over when ψ is known to [`FOUND_RAD`]: the walker has gone some three times the error of a fix.

use super::walker::{EAST, FACTOR, HEADING, NORTH, OFFSET, STATES, Walker};
use adit_core::nalgebra::{Matrix2, SMatrix, Vector2};
use adit_observation::PositionFix;
use serde::{Deserialize, Serialize};

/// Standard deviation of the direction with which the filter takes over, rad.
pub const FOUND_RAD: f64 = 0.3;
/// Nothing is known of a direction: standard deviation of the uniform distribution over a turn, rad.
pub const UNKNOWN_RAD: f64 = 1.8138;

/// Running sums, weighted by one over the variance of each fix.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Search {
    weight: f64,
    mean_way: Vector2<f64>,
    mean_fix: Vector2<f64>,
    /// Real and imaginary part of the sum of products.
    dot: f64,
    cross: f64,
    spread: f64,
    /// The direction that the walk was taken to have has proved wrong.
    direction_is_lost: bool,
}

/// Where somebody stands on the map, by fixes against the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// By how much the way is turned, rad clockwise.
    pub turn_rad: f64,
    /// Where its end is, m.
    pub position_m: Vector2<f64>,
    /// From the mean of the fixes to there, m.
    pub lever_m: Vector2<f64>,
    /// Variance of the turn, rad².
    pub direction_rad2: f64,
    /// Variance of the mean of the fixes on each axis, m².
    pub mean_m2: f64,
}

impl Search {
    /// A search that is to find the direction anew.
    pub fn anew() -> Self {
        Self { direction_is_lost: true, ..Self::default() }
    }

    /// A fix, and where the way was at its time, m.
    pub fn observe(&mut self, fix: &PositionFix, way_m: &Vector2<f64>) {
        let weight = 2.0 / fix.covariance_m2.trace();
        self.weight += weight;
        let (way, target) = (way_m - self.mean_way, fix.level_m - self.mean_fix);
        self.mean_way += way * (weight / self.weight);
        self.mean_fix += target * (weight / self.weight);
        let rest = fix.level_m - self.mean_fix;
        self.dot += weight * way.dot(&rest);
        self.cross += weight * (way.x * rest.y - way.y * rest.x);
        self.spread += weight * way.dot(&(way_m - self.mean_way));
    }

    /// True before the first fix.
    pub fn is_empty(&self) -> bool {
        self.weight <= 0.0
    }

    /// What is known of the direction without the fixes: one over its variance, rad⁻².
    fn known(&self, direction_rad2: f64) -> f64 {
        // As good as nothing where it may be any.
        let known = !self.direction_is_lost && direction_rad2 < UNKNOWN_RAD;
        if known { 1.0 / direction_rad2.max(f64::MIN_POSITIVE) } else { 0.0 }
    }

    /// Variance of the direction, rad².
    fn direction_variance(&self, direction_rad2: f64) -> f64 {
        let none = UNKNOWN_RAD * UNKNOWN_RAD;
        let information = self.spread + self.known(direction_rad2);
        if information > 0.0 { (1.0 / information).min(none) } else { none }
    }

    /// True when the direction is known well enough for the filter; `direction_rad2` is its variance without the fixes.
    pub fn is_over(&self, direction_rad2: f64) -> bool {
        self.direction_variance(direction_rad2) < FOUND_RAD * FOUND_RAD
    }

    /// What the fixes tell of somebody who is at `way_m` now; `direction_rad2` is the variance of the direction without the fixes.
    pub fn found(&self, way_m: &Vector2<f64>, direction_rad2: f64) -> Found {
        // Counter-clockwise in the plane of east and north; headings run clockwise.
        let turn = libm::atan2(self.cross, self.dot + self.known(direction_rad2));
        let (sin, cos) = libm::sincos(turn);
        let lever_m = Matrix2::new(cos, -sin, sin, cos) * (way_m - self.mean_way);
        Found {
            turn_rad: -turn,
            position_m: self.mean_fix + lever_m,
            lever_m,
            direction_rad2: self.direction_variance(direction_rad2),
            mean_m2: 1.0 / self.weight,
        }
    }

    /// The walker of the way as he stands on the map; `direction_rad2` is the variance of the direction without the fixes.
    pub fn place(&self, way: &Walker, direction_rad2: f64) -> Walker {
        let Found { turn_rad, position_m, lever_m: lever, direction_rad2: direction, mean_m2: mean } =
            self.found(&way.position_m, direction_rad2);
        let mut placed = way.clone();
        placed.position_m = position_m;
        placed.offset_rad += turn_rad;

        let kept = way.covariance[(FACTOR, FACTOR)];
        let across = Vector2::new(lever.y, -lever.x);
        let along = lever / way.factor;
        let position = Matrix2::identity() * mean
            + across * across.transpose() * direction
            + along * along.transpose() * kept;
        let mut covariance = SMatrix::<f64, STATES, STATES>::zeros();
        covariance.fixed_view_mut::<2, 2>(EAST, EAST).copy_from(&position);
        covariance[(OFFSET, OFFSET)] = direction;
        covariance[(FACTOR, FACTOR)] = kept;
        for (state, axis) in [EAST, NORTH].into_iter().enumerate() {
            for (other, value) in [(OFFSET, across[state] * direction), (FACTOR, along[state] * kept)] {
                covariance[(axis, other)] = value;
                covariance[(other, axis)] = value;
            }
        }
        // The error of the heading so far is part of the direction that was found.
        covariance[(HEADING, HEADING)] = 0.0;
        placed.covariance = covariance;
        placed
    }
}
