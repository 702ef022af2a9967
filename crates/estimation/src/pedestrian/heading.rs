//! Heuristic drift elimination: people walk roadways in straight legs.
//!
//! Borenstein & Ojeda (2010, *Heuristic drift elimination for personnel tracking systems*): while a stride goes on in
//! the direction of the ones before, the small deviation is taken as drift of the heading, not as a turn of the walker.
//! A real turn exceeds the limit and is left alone. On a wide curve the heuristic pulls the path straight, which is why
//! it is off by default.

use crate::inertial::covariance::ATTITUDE;
use crate::inertial::filter::FilterState;
use crate::kalman::{Derivative, Linearised, MeasurementModel};
use adit_core::attitude::angle_difference;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// Strides that make a leg.
const LEG: usize = 4;
/// Deviation beyond which a stride is a turn, rad (5°).
const TURN_RAD: f64 = 0.087;
/// How far people sway about the direction of a leg, per stride, rad (3°).
const SWAY_RAD: f64 = 0.052;
/// Shorter displacements between stances have no direction, m.
const SHORTEST_STRIDE_M: f64 = 0.4;
/// A stance ends when no update has come for this long, s.
const SWING_S: f64 = 0.2;

/// Directions of the last strides.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StraightLegs {
    last_update: Option<Time>,
    stance_m: Option<Vector3<f64>>,
    directions_rad: [f64; LEG],
    strides: usize,
}

impl StraightLegs {
    /// Takes the position at a zero-velocity update; at the first of a stance that goes on straight, returns the
    /// heading measurement.
    pub fn observe(&mut self, time: Time, position_m: &Vector3<f64>) -> Option<StraightHeading> {
        let began = self.last_update.is_none_or(|last| (time - last).seconds() > SWING_S);
        self.last_update = Some(time);
        if !began {
            return None;
        }
        let stride = position_m - self.stance_m.replace(*position_m)?;
        if stride.xy().norm_squared() < SHORTEST_STRIDE_M * SHORTEST_STRIDE_M {
            self.strides = 0;
            return None;
        }
        let direction = libm::atan2(stride.y, stride.x);
        let deviation = self.deviation(direction);
        self.directions_rad[self.strides % LEG] = direction;
        self.strides += 1;
        let deviation = deviation?;
        if deviation.abs() > TURN_RAD {
            self.strides = 0;
            return None;
        }
        Some(StraightHeading { deviation_rad: deviation })
    }

    /// Direction relative to the mean of a full leg; `None` before there is one.
    fn deviation(&self, direction: f64) -> Option<f64> {
        if self.strides < LEG {
            return None;
        }
        let reference = self.directions_rad[0];
        let mean_offset =
            self.directions_rad.iter().map(|d| angle_difference(*d, reference)).sum::<f64>() / LEG as f64;
        Some(angle_difference(direction, reference + mean_offset))
    }
}

/// A stride that goes on straight: its deviation from the leg is drift of the heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightHeading {
    /// Direction of the stride minus direction of the leg, counter-clockwise, rad.
    pub deviation_rad: f64,
}

impl MeasurementModel<FilterState, 1> for StraightHeading {
    fn linearise(&self, _state: &FilterState) -> Linearised<1> {
        Linearised {
            residual: Vector3::new(0.0, 0.0, -self.deviation_rad),
            jacobian: [(ATTITUDE, Derivative::Matrix(Matrix3::from_diagonal(&Vector3::z())))],
            noise: Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, SWAY_RAD * SWAY_RAD)),
        }
    }
}
