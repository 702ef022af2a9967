//! Where the walk lies on the map: the first fixes against the way walked, while neither place nor direction is known.
//!
//! The filter is linear about its direction; one that may be anything within half a turn is beyond it. So the first fixes are
//! held against the dead-reckoned way as a whole. Of fixes `f_i` and places `d_i` of the way, the rotation and shift with
//! the least squares (Umeyama 1991, in the plane and without scale) come from running sums alone:
//!
//! ```text
//! ψ = arg Σ (d_i − d̄)* (f_i − f̄),   var ψ = σ² / Σ |d_i − d̄|²,   var f̄ = σ² / n
//! ```
//!
//! with east and north as the parts of a complex number and σ² the mean variance of the fixes. The search is over when
//! ψ is known to [`FOUND_RAD`]: the walker has gone some three times the error of a fix.

use super::walker::{EAST, FACTOR, HEADING, NORTH, OFFSET, STATES, Walker};
use adit_core::nalgebra::{Matrix2, SMatrix, Vector2};
use adit_observation::PositionFix;
use serde::{Deserialize, Serialize};

/// Standard deviation of the direction with which the filter takes over, rad.
pub const FOUND_RAD: f64 = 0.3;
/// Nothing is known of a direction: standard deviation of the uniform distribution over a turn, rad.
pub const UNKNOWN_RAD: f64 = 1.8138;

/// Running sums.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Search {
    count: f64,
    mean_way: Vector2<f64>,
    mean_fix: Vector2<f64>,
    /// Real and imaginary part of the sum of products.
    dot: f64,
    cross: f64,
    spread: f64,
    variance_sum: f64,
}

impl Search {
    /// A fix, and where the way was at its time, m.
    pub fn observe(&mut self, fix: &PositionFix, way_m: &Vector2<f64>) {
        self.count += 1.0;
        let (way, target) = (way_m - self.mean_way, fix.level_m - self.mean_fix);
        self.mean_way += way / self.count;
        self.mean_fix += target / self.count;
        let rest = fix.level_m - self.mean_fix;
        self.dot += way.dot(&rest);
        self.cross += way.x * rest.y - way.y * rest.x;
        self.spread += way.dot(&(way_m - self.mean_way));
        self.variance_sum += 0.5 * fix.covariance_m2.trace();
    }

    /// True before the first fix.
    pub fn is_empty(&self) -> bool {
        self.count < 1.0
    }

    /// Variance of the direction, rad².
    fn direction_variance(&self) -> f64 {
        let none = UNKNOWN_RAD * UNKNOWN_RAD;
        if self.spread > 0.0 { (self.variance_sum / self.count / self.spread).min(none) } else { none }
    }

    /// True when the direction is known well enough for the filter.
    pub fn is_over(&self) -> bool {
        self.direction_variance() < FOUND_RAD * FOUND_RAD
    }

    /// The walker of the way as he stands on the map; `direction_rad2` is what is known of the direction without the fixes.
    pub fn place(&self, way: &Walker) -> Walker {
        // Counter-clockwise in the plane of east and north; headings run clockwise.
        let turn = libm::atan2(self.cross, self.dot);
        let (sin, cos) = libm::sincos(turn);
        let rotation = Matrix2::new(cos, -sin, sin, cos);
        let lever = rotation * (way.position_m - self.mean_way);
        let mut placed = way.clone();
        placed.position_m = self.mean_fix + lever;
        placed.offset_rad -= turn;

        let kept = way.covariance[(FACTOR, FACTOR)];
        let (direction, mean) = (self.direction_variance(), self.variance_sum / (self.count * self.count));
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
