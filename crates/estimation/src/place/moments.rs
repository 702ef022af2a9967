//! Moments of a state where it is no Kalman update that changes them: cut off at a wall, joined with another, faced another way.

use super::state::{
    BAROMETER, CLOCK, COMMON, DRIFT, EAST, FACTOR, HEADING, HEARING, IRON, MISSED, State, TURN, Vector,
    symmetrise,
};
use adit_core::nalgebra::Vector3;
use core::f64::consts::FRAC_1_SQRT_2;

/// Standard deviations up to which the tail of the normal distribution has digits.
const FAR: f64 = 30.0;
/// √2π.
const SQRT_TAU: f64 = 2.506_628_274_631_000_5;
impl State {
    /// The position lies less than `limit_m` from a point in a direction (unit vector). Mean and covariance become those of what is left of the normal distribution
    /// (Simon & Simon 2010, for one bound): `μ − σλ`, `σ² (1 − λ(λ − β))`, `λ = φ(β)/Φ(−β)`, β how many σ the mean lies beyond. Gives β and `ln Φ(−β)`. Nothing is corrected
    /// where β exceeds `most`; `None` when nothing is known of the position.
    pub fn keep_within(
        &mut self,
        (point_m, direction): (&Vector3<f64>, &Vector3<f64>),
        limit_m: f64,
        most: f64,
    ) -> Option<(f64, f64)> {
        let cross = self.covariance.fixed_columns::<3>(EAST) * direction;
        let variance = direction.dot(&cross.fixed_rows::<3>(EAST));
        let sigma = libm::sqrt(variance);
        let beyond = (direction.dot(&(self.position_m - point_m)) - limit_m) / sigma;
        if !beyond.is_finite() {
            return None;
        }
        let within = 0.5 * libm::erfc(beyond * FRAC_1_SQRT_2);
        if beyond > most.min(FAR) {
            return Some((beyond, libm::log(within.max(f64::MIN_POSITIVE))));
        }
        let ratio = libm::exp(-0.5 * beyond * beyond) / (SQRT_TAU * within);
        let lost = (ratio * (ratio - beyond)).clamp(0.0, 1.0);
        self.covariance -= cross * cross.transpose() * (lost / variance);
        symmetrise(&mut self.covariance);
        self.feed_back(&(cross * (-ratio / sigma)));
        Some((beyond, libm::log(within)))
    }

    /// The two moments of a mixture of this state and another, which has this share of it.
    pub fn join(&mut self, other: &Self, share: f64) {
        let p = &self.covariance;
        let turned = libm::remainder(other.turn_rad - self.turn_rad, core::f64::consts::TAU);
        // Only the sum of the two angles is known apart: each has the part of it that it would have by its variance.
        let of_turn =
            turned * (p[(TURN, TURN)] + p[(TURN, HEADING)]) / self.direction_rad2().max(f64::MIN_POSITIVE);
        let apart_m = other.position_m - self.position_m;
        let mut apart = Vector::zeros();
        apart.fixed_rows_mut::<3>(EAST).copy_from(&apart_m);
        apart[TURN] = of_turn;
        apart[HEADING] = turned - of_turn;
        apart[DRIFT] = other.drift_rad - self.drift_rad;
        apart[FACTOR] = other.factor - self.factor;
        apart[BAROMETER] = other.barometer_m - self.barometer_m;
        apart[COMMON] = other.common_m - self.common_m;
        apart[CLOCK] = other.clock_s - self.clock_s;
        apart[HEARING] = other.hearing_db - self.hearing_db;
        apart.fixed_rows_mut::<2>(IRON).copy_from(&(other.iron_rad - self.iron_rad));
        apart[MISSED] = other.missed - self.missed;
        self.covariance = self.covariance * (1.0 - share)
            + other.covariance * share
            + apart * apart.transpose() * (share * (1.0 - share));
        symmetrise(&mut self.covariance);
        self.feed_back(&(apart * share));
    }

    /// The way is turned by this more, known by this, rad; the position stays as little known as it is. For angles that no linearisation bears.
    pub fn face(&mut self, turn_rad: f64, sigma_rad: f64) {
        self.turn_rad += turn_rad;
        self.forget(TURN, sigma_rad * sigma_rad);
        self.forget(HEADING, 0.0);
    }
}
