//! A part of the way of a carrier, and what becomes uncertain on it.

use adit_core::nalgebra::Vector3;

/// Part of a way of the carrier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The way in the carrier's frame (level two axes, up), m.
    pub way_m: Vector3<f64>,
    /// What the heading's drift counts by: s, or m walked.
    pub drifting: f64,
    /// By how much the carrier turned, rad clockwise.
    pub turned_rad: f64,
    /// White error along the way, m²: of this stretch alone.
    pub along_m2: f64,
    /// White error across it, m².
    pub across_m2: f64,
    /// White error upwards, m².
    pub up_m2: f64,
    /// Whoever stands shifts about: on each level axis, m².
    pub about_m2: f64,
    /// How the heading's error goes on.
    pub heading: HeadingError,
    /// Random walk of the turn, rad².
    pub turn_rad2: f64,
    /// Random walk of the drift, (rad for each unit of `drifting`)².
    pub drift2: f64,
    /// Random walk of what goes with the tag, rad².
    pub iron_rad2: f64,
    /// Random walk of the factor.
    pub factor2: f64,
    /// Random walk of the barometer's offset, m².
    pub barometer_m2: f64,
}

impl Stretch {
    /// No way and no time, in which the barometer's offset jumps by a step of this variance, m².
    pub fn jump(barometer_m2: f64) -> Self {
        Self {
            way_m: Vector3::zeros(),
            drifting: 0.0,
            turned_rad: 0.0,
            along_m2: 0.0,
            across_m2: 0.0,
            up_m2: 0.0,
            about_m2: 0.0,
            heading: HeadingError::Gyro { walk_rad2: 0.0 },
            turn_rad2: 0.0,
            drift2: 0.0,
            iron_rad2: 0.0,
            factor2: 0.0,
            barometer_m2,
        }
    }

    /// The same way walked back: random walks and what a magnetometer errs are the same in both directions of time.
    #[must_use]
    pub fn back(self) -> Self {
        Self { way_m: -self.way_m, drifting: -self.drifting, turned_rad: -self.turned_rad, ..self }
    }
}

/// How the error of a carrier's heading goes on over a stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeadingError {
    /// The gyro holds it: it drifts, and walks by this much, rad².
    Gyro {
        /// Random walk, rad².
        walk_rad2: f64,
    },
    /// A magnetometer holds it: an error of this variance, of which this share is left from before.
    Magnetic {
        /// Variance of the heading, rad².
        variance_rad2: f64,
        /// Share that is left.
        kept: f64,
    },
}
