//! What every closed-form motion gives: the pose of the sensor and its exact derivatives at any time.
//!
//! Frames and units: navigation ENU (x east, y north, z up); sensor axes as mounted; SI units, rad.

use crate::jet::Jet;
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use std::sync::Arc;

/// Pose of the sensor and its exact derivatives at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionState {
    /// Position, ENU, m.
    pub position_m: Vector3<f64>,
    /// Velocity, ENU, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Acceleration, ENU, m/s².
    pub acceleration_m_s2: Vector3<f64>,
    /// Sensor to ENU.
    pub attitude: Attitude,
    /// Angular rate of the sensor against ENU, sensor axes, rad/s.
    pub angular_rate_rad_s: Vector3<f64>,
    /// The sensor's carrier is on firm ground: a foot flat on the floor (and motionless, unless the gait rocks in stance),
    /// or a tag lying still.
    pub stance: bool,
}

/// A pose of the sensor as a function of time.
pub trait Motion {
    /// The state at `time_s` after the start; at rest before 0 and after the end.
    fn at(&self, time_s: f64) -> MotionState;

    /// How long the motion lasts, s.
    fn duration_s(&self) -> f64;
}

impl<M: Motion + ?Sized> Motion for Arc<M> {
    fn at(&self, time_s: f64) -> MotionState {
        (**self).at(time_s)
    }

    fn duration_s(&self) -> f64 {
        (**self).duration_s()
    }
}

/// Attitude as rotations about z, then y, then x.
pub(crate) struct Angles {
    pub yaw: Jet,
    pub pitch: Jet,
    pub roll: Jet,
}

impl Angles {
    pub fn attitude(&self) -> Attitude {
        attitude::exp(&(Vector3::z() * self.yaw.value))
            * attitude::exp(&(Vector3::y() * self.pitch.value))
            * attitude::exp(&(Vector3::x() * self.roll.value))
    }

    /// Angular rate in the turned axes, rad/s (Groves 2013, eq. 2.58, in z-up form):
    /// `ω = (φ̇ − ψ̇ sin θ, θ̇ cos φ + ψ̇ sin φ cos θ, −θ̇ sin φ + ψ̇ cos φ cos θ)`.
    pub fn rate_rad_s(&self) -> Vector3<f64> {
        let (sin_roll, cos_roll) = libm::sincos(self.roll.value);
        let (sin_pitch, cos_pitch) = libm::sincos(self.pitch.value);
        let (yaw, pitch, roll) = (self.yaw.first, self.pitch.first, self.roll.first);
        Vector3::new(
            roll - yaw * sin_pitch,
            pitch * cos_roll + yaw * sin_roll * cos_pitch,
            yaw * cos_roll * cos_pitch - pitch * sin_roll,
        )
    }
}
