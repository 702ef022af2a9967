//! Strapdown integration in the local level frame.
//!
//! A sample carries the mean rate and mean specific force of its interval (as a sensor with a decimation filter
//! gives them), so that `ω dt` and `f dt` are the exact increments. Rotation inside the interval is taken from this
//! and the previous increment:
//!
//! ```text
//! φ    = Δθ + 1/12 Δθ₋₁ × Δθ                                   coning   (Savage 1998 part 1, eq. 42; Bortz 1971)
//! Δv_b = Δv + 1/2 Δθ × Δv + 1/6 Δθ × (Δθ × Δv)                 rotation (exact to third order at constant rate)
//!      + 1/12 (Δθ₋₁ × Δv + Δv₋₁ × Δθ)                          sculling (Savage 1998 part 2, eq. 19–24)
//! v    ← v + C_b^n Δv_b − g dt        p ← p + (v₋₁ + v)/2 dt        q ← q ∘ exp(φ)
//! ```
//!
//! Frames: body → local level ENU. Earth rotation (7e-5 rad/s) is below the turn-on bias of every sensor this is made
//! for and is absorbed by the gyro bias; transport rate is not modelled: use within a few kilometres of the origin.

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_observation::ImuSample;
use serde::{Deserialize, Serialize};

/// Navigation state that the strapdown integrates and the filter corrects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NavigationState {
    /// Body to local level.
    pub attitude: Attitude,
    /// Velocity, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Position, m.
    pub position_m: Vector3<f64>,
    /// Gyro bias, rad/s, body.
    pub gyro_bias_rad_s: Vector3<f64>,
    /// Accelerometer bias, m/s², body.
    pub acc_bias_m_s2: Vector3<f64>,
}

/// Rotation and velocity gained in one sampling interval, body frame at its beginning, biases removed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Increment {
    /// Integral of the rate, rad.
    pub angle: Vector3<f64>,
    /// Integral of the specific force, m/s.
    pub velocity: Vector3<f64>,
}

/// What one step did, as the linearised error model needs it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// `C_b^n` at the beginning of the interval.
    pub rotation: Matrix3<f64>,
    /// Specific-force increment in n, m/s (gravity not removed).
    pub velocity_gained: Vector3<f64>,
    /// Length of the interval, s.
    pub interval_s: f64,
}

impl NavigationState {
    /// Increments of one sample with the state's biases removed.
    #[inline]
    pub fn increment(&self, imu: &ImuSample, interval_s: f64) -> Increment {
        Increment {
            angle: (imu.angular_rate_rad_s - self.gyro_bias_rad_s) * interval_s,
            velocity: (imu.specific_force_m_s2 - self.acc_bias_m_s2) * interval_s,
        }
    }

    /// Integrates one increment; `before` is the previous one (zero at the start).
    #[inline]
    pub fn propagate(
        &mut self,
        now: &Increment,
        before: &Increment,
        interval_s: f64,
        gravity_m_s2: f64,
    ) -> Step {
        let coning = before.angle.cross(&now.angle) / 12.0;
        let sculling = (before.angle.cross(&now.velocity) + before.velocity.cross(&now.angle)) / 12.0;
        let turned = now.angle.cross(&now.velocity);
        let velocity_body = now.velocity + 0.5 * turned + now.angle.cross(&turned) / 6.0 + sculling;

        let rotation = self.attitude.to_rotation_matrix().into_inner();
        let velocity_gained = rotation * velocity_body;
        let velocity_before = self.velocity_m_s;
        self.velocity_m_s += velocity_gained;
        self.velocity_m_s.z -= gravity_m_s2 * interval_s;
        self.position_m += (velocity_before + self.velocity_m_s) * (0.5 * interval_s);
        self.attitude = attitude::turn_body(&self.attitude, &(now.angle + coning));
        Step { rotation, velocity_gained, interval_s }
    }
}
