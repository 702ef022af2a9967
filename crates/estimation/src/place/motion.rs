//! What a stretch of the carrier's way does to the error of a state: `e ← F e + w`, `P ← F P Fᵀ + Q`.
//!
//! F and Q are those of [`super::state`]; they are kept apart from the state because a smoother goes the same way back.

use super::state::{
    BAROMETER, Covariance, DRIFT, EAST, FACTOR, HEADING, HeadingError, IRON, MISSED, NORTH, State, Stretch,
    TURN, UP, Vector,
};
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};

/// Cosine of the angle between a way and a roadway up to which it is a way along it: 45°.
const ALONG: f64 = 0.707;

/// A stretch as a state takes it.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// The displacement on the map, m.
    pub walked_m: Vector3<f64>,
    stretch: &'a Stretch,
    /// Its level part as the covariance takes it, m, and the length, m.
    level: Vector2<f64>,
    length_m: f64,
    /// Derivatives of the place by the direction and by the factor.
    turned: Vector2<f64>,
    stretched: Vector2<f64>,
}

impl<'a> Motion<'a> {
    /// Of a state before the stretch, on a roadway in this direction (unit vector, either sense) if on any: see [`State::walk_along`].
    pub fn new(state: &State, stretch: &'a Stretch, roadway: Option<&Vector2<f64>>) -> Self {
        let walked_m = state.on_map(&stretch.way_m);
        let length_m = walked_m.xy().norm();
        let on_roadway = roadway.map(|direction| (direction, direction.dot(&walked_m.xy())));
        let level = match on_roadway {
            Some((direction, along_m)) if along_m.abs() > ALONG * length_m => {
                direction * libm::copysign(length_m, along_m)
            }
            _ => walked_m.xy(),
        };
        let (turned, stretched) = (Vector2::new(level.y, -level.x), level / state.factor);
        Self { walked_m, stretch, level, length_m, turned, stretched }
    }

    /// By what drift and missed turns turn a state, rad: nothing while a magnetometer holds the heading.
    pub fn turned_rad(&self, state: &State) -> f64 {
        let [drifting, turned_rad] = self.by_drift();
        state.drift_rad * drifting + state.missed * turned_rad
    }

    /// Derivatives of the heading by ρ and s.
    fn by_drift(&self) -> [f64; 2] {
        match self.stretch.heading {
            HeadingError::Gyro { .. } => [self.stretch.drifting, self.stretch.turned_rad],
            HeadingError::Magnetic { .. } => [0.0; 2],
        }
    }

    /// `F e`.
    #[inline]
    pub fn carry(&self, error: &Vector) -> Vector {
        let kept = match self.stretch.heading {
            HeadingError::Gyro { .. } => 1.0,
            HeadingError::Magnetic { kept, .. } => kept,
        };
        let angle = error[TURN] + error[HEADING];
        let mut carried = *error;
        carried[EAST] += self.stretched.x * error[FACTOR] + self.turned.x * angle;
        carried[NORTH] += self.stretched.y * error[FACTOR] + self.turned.y * angle;
        let [drifting, turned_rad] = self.by_drift();
        carried[HEADING] = error[HEADING] * kept + error[DRIFT] * drifting + error[MISSED] * turned_rad;
        carried
    }

    /// `P + Q`.
    pub fn spread(&self, covariance: &mut Covariance) {
        let stretch = self.stretch;
        let mut place = covariance.fixed_view_mut::<2, 2>(EAST, EAST);
        if self.length_m > 0.0 {
            let (along, across) = (self.level / self.length_m, self.turned / self.length_m);
            let white = along * along.transpose() * stretch.along_m2
                + across * across.transpose() * stretch.across_m2;
            place += white;
        }
        place += Matrix2::identity() * stretch.about_m2;
        covariance[(UP, UP)] += stretch.up_m2;
        covariance[(TURN, TURN)] += stretch.turn_rad2;
        covariance[(DRIFT, DRIFT)] += stretch.drift2;
        covariance[(IRON, IRON)] += stretch.iron_rad2;
        covariance[(IRON + 1, IRON + 1)] += stretch.iron_rad2;
        covariance[(FACTOR, FACTOR)] += stretch.factor2;
        covariance[(BAROMETER, BAROMETER)] += stretch.barometer_m2;
        covariance[(HEADING, HEADING)] += match stretch.heading {
            HeadingError::Gyro { walk_rad2 } => walk_rad2,
            HeadingError::Magnetic { variance_rad2, kept } => variance_rad2 * (1.0 - kept * kept),
        };
    }
}
