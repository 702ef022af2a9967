//! Position of a walker by steps, and what is not known of him: the filter.
//!
//! State: position p (east, north), angle ψ from the tag's heading to forward, error η of the tag's heading, factor κ of the
//! step length. A step of model length l in the measured heading θ:
//!
//! ```text
//! p ← p + κ l (sin α, cos α),   α = θ + ψ + η
//! δp ← δp + l (sin α, cos α) δκ + κ l (cos α, −sin α) (δψ + δη)
//! noise: κ l σ_s along, κ l σ_α across;  κ, ψ: random walks over the way;  η: that of the attitude estimator
//! ```
//!
//! `η` is a Gauss–Markov process with the heading variance that the attitude estimator tells while a magnetometer holds it, and
//! grows with that variance while the gyro alone does. A position fix is a measurement of p; by the correlations that walking
//! makes it corrects ψ, η and κ: that is how the step length calibrates itself.

use super::params::PdrNoise;
use crate::kalman::dense::{SelectedUpdate, propagate, update_selected};
use adit_core::nalgebra::{Matrix2, SMatrix, SVector, Vector1, Vector2};
use adit_observation::PositionFix;
use core::f64::consts::PI;
use serde::{Deserialize, Serialize};

/// States of the error.
pub const STATES: usize = 5;
/// East.
pub const EAST: usize = 0;
/// North.
pub const NORTH: usize = 1;
/// Angle from the tag's heading to forward.
pub const OFFSET: usize = 2;
/// Error of the tag's heading.
pub const HEADING: usize = 3;
/// Factor of the step length.
pub const FACTOR: usize = 4;
/// The factor stays a factor.
const FACTORS: (f64, f64) = (0.3, 3.0);
/// A prediction this many times less sure than a fix does not judge it.
const UNSURE: f64 = 10.0;

/// A walk between two times: a whole step, or the part of one up to a fix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Length by the model, m.
    pub length_m: f64,
    /// Its standard deviation, as a share; of a whole step.
    pub share_sigma: f64,
    /// Heading of the tag, rad.
    pub heading_rad: f64,
    /// Standard deviation of the direction of a whole step, rad.
    pub direction_rad: f64,
    /// Part of a step that this is, 0 to 1.
    pub part: f64,
}

/// State and covariance of one walker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Walker {
    /// Position (east, north), m.
    pub position_m: Vector2<f64>,
    /// ψ + η, rad.
    pub offset_rad: f64,
    /// κ.
    pub factor: f64,
    /// The way so far as the tag's heading and the model's lengths tell it: ψ, η and κ turn and stretch it, m.
    pub way_m: Vector2<f64>,
    /// Covariance of the error (truth minus estimate).
    pub covariance: SMatrix<f64, STATES, STATES>,
    /// Variance of the attitude's heading that η stands for, rad²; `None` before the first.
    heading_variance: Option<f64>,
}

impl Walker {
    /// At the origin, forward as the tag's heading is.
    pub fn new(noise: &PdrNoise, offset_sigma_rad: f64) -> Self {
        let sigmas = SVector::from([0.0, 0.0, offset_sigma_rad, 0.0, noise.factor_sigma]);
        Self {
            position_m: Vector2::zeros(),
            offset_rad: 0.0,
            factor: 1.0,
            way_m: Vector2::zeros(),
            covariance: SMatrix::from_diagonal(&sigmas.component_mul(&sigmas)),
            heading_variance: None,
        }
    }

    /// Moves along a stretch; gives the displacement, m.
    pub fn walk(&mut self, noise: &PdrNoise, stretch: &Stretch) -> Vector2<f64> {
        let length_m = stretch.length_m * stretch.part;
        let (sin, cos) = libm::sincos(stretch.heading_rad + self.offset_rad);
        let (along, across) = (Vector2::new(sin, cos), Vector2::new(cos, -sin));
        let walked_m = self.factor * length_m;
        self.position_m += along * walked_m;
        let (sin, cos) = libm::sincos(stretch.heading_rad);
        self.way_m += Vector2::new(sin, cos) * length_m;
        propagate(&mut self.covariance, |error| {
            let turn = error[OFFSET] + error[HEADING];
            let gained = along * (length_m * error[FACTOR]) + across * (walked_m * turn);
            let mut carried = *error;
            carried[EAST] += gained.x;
            carried[NORTH] += gained.y;
            carried
        });
        // The parts of a step share its errors: their variances are to add up to those of the whole.
        let whole_m = self.factor * stretch.length_m;
        let (long_m, wide_m) = (whole_m * stretch.share_sigma, whole_m * stretch.direction_rad);
        let white = along * along.transpose() * (long_m * long_m * stretch.part)
            + across * across.transpose() * (wide_m * wide_m * stretch.part);
        self.spread(&white);
        let walk = |sigma: f64| sigma * sigma * walked_m;
        self.covariance[(FACTOR, FACTOR)] += walk(noise.factor_walk_sqrt_m);
        self.covariance[(OFFSET, OFFSET)] += walk(noise.direction_walk_rad_sqrt_m);
        along * walked_m
    }

    /// Takes over the heading variance of the attitude estimator, `elapsed_s` after the last time.
    pub fn follow(&mut self, noise: &PdrNoise, variance_rad2: f64, magnetic: bool, elapsed_s: f64) {
        let Some(before) = self.heading_variance.replace(variance_rad2) else {
            self.covariance[(HEADING, HEADING)] += variance_rad2;
            return;
        };
        if magnetic {
            let kept = libm::exp(-elapsed_s / noise.magnetic_time_s);
            for state in 0..STATES {
                self.covariance[(HEADING, state)] *= kept;
                self.covariance[(state, HEADING)] *= kept;
            }
            self.covariance[(HEADING, HEADING)] += variance_rad2 * (1.0 - kept * kept);
        } else {
            self.covariance[(HEADING, HEADING)] += (variance_rad2 - before).max(0.0);
        }
    }

    /// Adds to the covariance of the position, m².
    pub fn spread(&mut self, covariance_m2: &Matrix2<f64>) {
        let mut block = self.covariance.fixed_view_mut::<2, 2>(EAST, EAST);
        block += covariance_m2;
    }

    /// Adds to the standard deviation of the offset, rad.
    pub fn doubt_offset(&mut self, sigma_rad: f64) {
        self.covariance[(OFFSET, OFFSET)] += sigma_rad * sigma_rad;
    }

    /// The offset is known by definition, but for this standard deviation, rad.
    pub fn settle_offset(&mut self, sigma_rad: f64) {
        self.covariance.row_mut(OFFSET).fill(0.0);
        self.covariance.column_mut(OFFSET).fill(0.0);
        self.covariance[(OFFSET, OFFSET)] = sigma_rad * sigma_rad;
    }

    /// The first fix on the map is all that is known of the position of when `way_m` was the way.
    pub fn place(&mut self, fix: &PositionFix, way_m: &Vector2<f64>) {
        self.position_m = fix.level_m + self.since(way_m);
        for axis in [EAST, NORTH] {
            self.covariance.row_mut(axis).fill(0.0);
            self.covariance.column_mut(axis).fill(0.0);
        }
        self.spread(&fix.covariance_m2);
    }

    /// Variance of the direction, rad².
    pub fn direction_variance(&self) -> f64 {
        let p = &self.covariance;
        p[(OFFSET, OFFSET)] + 2.0 * p[(OFFSET, HEADING)] + p[(HEADING, HEADING)]
    }

    /// How far away the walker was when `way_m` was his way, east and north, m.
    pub fn since(&self, way_m: &Vector2<f64>) -> Vector2<f64> {
        let back = self.way_m - way_m;
        let (sin, cos) = libm::sincos(self.offset_rad);
        Vector2::new(cos * back.x + sin * back.y, cos * back.y - sin * back.x) * self.factor
    }

    /// Compares a fix with the position of when `way_m` was the way. `None` when it cannot be used; else whether it was bounded comes
    /// from the NIS.
    ///
    /// The position then is that of now less what was walked since, `κ R(ψ + η) Δw`: the errors of κ, ψ and η are in it.
    pub fn correct(
        &mut self,
        fix: &PositionFix,
        way_m: &Vector2<f64>,
        nis_bound: f64,
    ) -> Option<SelectedUpdate<STATES, 2>> {
        let since = self.since(way_m);
        let (stretched, turned) = (since / self.factor, Vector2::new(since.y, -since.x));
        let carry = |covariance: &mut SMatrix<f64, STATES, STATES>, sign: f64| {
            propagate(covariance, |error| {
                let walked = stretched * error[FACTOR] + turned * (error[OFFSET] + error[HEADING]);
                let mut carried = *error;
                carried[EAST] += sign * walked.x;
                carried[NORTH] += sign * walked.y;
                carried
            });
        };
        let before = self.covariance;
        if since != Vector2::zeros() {
            carry(&mut self.covariance, -1.0);
        }
        let predicted_m2 = self.covariance[(EAST, EAST)] + self.covariance[(NORTH, NORTH)];
        // Who is ten times less sure than the fix cannot call it an outlier.
        let sure = predicted_m2 < UNSURE * UNSURE * fix.covariance_m2.trace();
        let bound = if sure { nis_bound } else { f64::INFINITY };
        let residual = fix.level_m - (self.position_m - since);
        let update =
            update_selected(&mut self.covariance, [EAST, NORTH], &residual, &fix.covariance_m2, bound);
        let Some(update) = update else {
            self.covariance = before;
            return None;
        };
        self.position_m -= since;
        self.feed_back(&update.correction);
        self.position_m += self.since(way_m);
        if since != Vector2::zeros() {
            carry(&mut self.covariance, 1.0);
        }
        Some(update)
    }

    /// The walk goes along an axis: `axis_rad` clockwise from north, forward or backward, against the tag's heading.
    pub fn align_axis(&mut self, heading_rad: f64, axis_rad: f64, sigma_rad: f64) {
        let off = axis_rad - heading_rad - self.offset_rad;
        let residual = off - PI * libm::round(off / PI);
        // The sum of two states is measured: for the update it takes the place of one of them.
        let sum = |x: &SVector<f64, STATES>, sign: f64| {
            let mut y = *x;
            y[OFFSET] += sign * x[HEADING];
            y
        };
        propagate(&mut self.covariance, |error| sum(error, 1.0));
        let noise = Vector1::new(sigma_rad * sigma_rad);
        let update =
            update_selected(&mut self.covariance, [OFFSET], &Vector1::new(residual), &noise, f64::INFINITY);
        propagate(&mut self.covariance, |error| sum(error, -1.0));
        if let Some(update) = update {
            self.feed_back(&sum(&update.correction, -1.0));
        }
    }

    /// No number has been lost.
    pub fn is_finite(&self) -> bool {
        self.position_m.iter().chain(self.covariance.iter()).all(|v| v.is_finite())
    }

    fn feed_back(&mut self, correction: &SVector<f64, STATES>) {
        self.position_m += Vector2::new(correction[EAST], correction[NORTH]);
        self.offset_rad += correction[OFFSET] + correction[HEADING];
        self.factor = (self.factor + correction[FACTOR]).clamp(FACTORS.0, FACTORS.1);
    }
}
