//! How one foot moves through one stride: the numbers, and presets.
//!
//! A stride of one foot lasts from one flat stance to the next. It is first still for
//! [`Gait::still_share`] of its time and then moves; all windows of the moving part are shares of that part.
//!
//! Foot axes: x towards the toe, y left, z up; positive pitch is heel up. Lengths m, times s, angles rad.

use crate::error::SimulationError;
use adit_core::attitude::Attitude;
use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// Shape and timing of one person's stride at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gait {
    /// Distance from one stance to the next of the same foot, m.
    pub stride_m: f64,
    /// Time from one stance to the next, s.
    pub stride_s: f64,
    /// Share of the stride for which the foot rests flat.
    pub still_share: f64,
    /// Slow lifting of the heel before the push, rad.
    pub early_heel_off_rad: f64,
    /// Heel-off: further pitch up to toe-off, rad.
    pub heel_off_rad: f64,
    /// Toe-up pitch at which the heel strikes, rad.
    pub heel_strike_rad: f64,
    /// Lift of the pivot (ball, then heel) over the straight line at mid-swing, m.
    pub clearance_m: f64,
    /// Sideways swing of the foot around the standing leg, m to the outside.
    pub circumduction_m: f64,
    /// Roll of the foot in swing, rad.
    pub swing_roll_rad: f64,
    /// Yaw of the foot in swing, rad.
    pub swing_yaw_rad: f64,
    /// Amplitude of the shock that rings after heel strike, m.
    pub shock_m: f64,
    /// Angle by which the foot rocks about the ball (pitch and roll) during stance, rad; 0 = truly still.
    pub stance_rock_rad: f64,
    /// Coefficient of variation from stride to stride of length, time, angles and shock.
    pub variation: f64,
}

impl Gait {
    /// Brisk level walk, 1.3 m/s.
    pub const fn walk() -> Self {
        Self {
            stride_m: 1.42,
            stride_s: 1.1,
            still_share: 0.16,
            early_heel_off_rad: 10.0 * DEGREE,
            heel_off_rad: 56.0 * DEGREE,
            heel_strike_rad: 20.0 * DEGREE,
            clearance_m: 0.065,
            circumduction_m: 0.03,
            swing_roll_rad: 9.0 * DEGREE,
            swing_yaw_rad: 6.0 * DEGREE,
            shock_m: 0.0002,
            stance_rock_rad: 0.0,
            variation: 0.03,
        }
    }

    /// The same walk with a foot that rocks in stance as recorded feet do (15 °/s, 2 cm/s), see [`crate::foot_motion`].
    pub const fn restless_walk() -> Self {
        Self { stance_rock_rad: 0.8 * DEGREE, ..Self::walk() }
    }

    /// Careful walk, 0.7 m/s.
    pub const fn slow() -> Self {
        Self {
            stride_m: 1.05,
            stride_s: 1.5,
            still_share: 0.24,
            early_heel_off_rad: 8.0 * DEGREE,
            heel_off_rad: 46.0 * DEGREE,
            heel_strike_rad: 15.0 * DEGREE,
            shock_m: 0.0002,
            ..Self::walk()
        }
    }

    /// Run, 2.2 m/s: hardly any stance, and the foot never quite still in it.
    pub const fn run() -> Self {
        Self {
            stride_m: 1.62,
            stride_s: 0.74,
            still_share: 0.08,
            early_heel_off_rad: 8.0 * DEGREE,
            heel_off_rad: 62.0 * DEGREE,
            heel_strike_rad: 14.0 * DEGREE,
            clearance_m: 0.12,
            circumduction_m: 0.04,
            swing_roll_rad: 12.0 * DEGREE,
            swing_yaw_rad: 8.0 * DEGREE,
            shock_m: 0.0005,
            stance_rock_rad: 0.6 * DEGREE,
            variation: 0.04,
        }
    }

    /// On stairs: short strides, flat landing, high clearance.
    pub const fn stairs() -> Self {
        Self {
            stride_m: 0.58,
            stride_s: 1.25,
            still_share: 0.28,
            early_heel_off_rad: 5.0 * DEGREE,
            heel_off_rad: 35.0 * DEGREE,
            heel_strike_rad: 4.0 * DEGREE,
            clearance_m: 0.09,
            shock_m: 0.0002,
            ..Self::walk()
        }
    }

    /// Mean speed, m/s.
    pub fn speed_m_s(&self) -> f64 {
        self.stride_m / self.stride_s
    }

    /// Steps (of both feet) per minute.
    pub fn cadence_per_minute(&self) -> f64 {
        120.0 / self.stride_s
    }

    /// The values are those of a foot: finite, positive where a stride needs it, shares inside (0, 1).
    pub fn check(&self) -> Result<(), SimulationError> {
        let out_of_range = |name, found, expected| Err(SimulationError::Parameter { name, found, expected });
        let within = |v: f64, low: f64, high: f64| (low..=high).contains(&v);
        if !within(self.stride_m, 0.05, 5.0) {
            return out_of_range("stride_m", self.stride_m, "0.05 to 5 m");
        }
        if !within(self.stride_s, 0.2, 10.0) {
            return out_of_range("stride_s", self.stride_s, "0.2 to 10 s");
        }
        if !within(self.still_share, 0.01, 0.9) {
            return out_of_range("still_share", self.still_share, "0.01 to 0.9");
        }
        if !within(self.variation, 0.0, 0.2) {
            return out_of_range("variation", self.variation, "0 to 0.2");
        }
        let angles = [
            ("early_heel_off_rad", self.early_heel_off_rad),
            ("heel_off_rad", self.heel_off_rad),
            ("heel_strike_rad", self.heel_strike_rad),
            ("swing_roll_rad", self.swing_roll_rad),
            ("swing_yaw_rad", self.swing_yaw_rad),
            ("stance_rock_rad", self.stance_rock_rad),
        ];
        if let Some(&(name, found)) = angles.iter().find(|(_, v)| !within(v.abs(), 0.0, 1.4)) {
            return out_of_range(name, found, "-1.4 to 1.4 rad");
        }
        let lengths = [
            ("clearance_m", self.clearance_m),
            ("circumduction_m", self.circumduction_m),
            ("shock_m", self.shock_m),
        ];
        if let Some(&(name, found)) = lengths.iter().find(|(_, v)| !within(v.abs(), 0.0, 1.0)) {
            return out_of_range(name, found, "-1 to 1 m");
        }
        Ok(())
    }
}

/// Where the sensor sits on the foot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Foot {
    /// From the sensor to the ball of the foot, about which the heel rises; foot axes, m.
    pub ball_m: Vector3<f64>,
    /// From the sensor to the heel, on which the foot lands; foot axes, m.
    pub heel_m: Vector3<f64>,
    /// Sensor axes into foot axes.
    pub mounting: Attitude,
}

impl Foot {
    /// Sensor on the instep of a shoe of size 43, its axes those of the foot.
    pub fn instep() -> Self {
        Self {
            ball_m: Vector3::new(0.09, 0.0, -0.08),
            heel_m: Vector3::new(-0.13, 0.0, -0.08),
            mounting: Attitude::identity(),
        }
    }
}
