//! Truth: a tag that is turned and moved by hand, or worn on a waist, in closed form.
//!
//! # Model
//! Attitude `R = Rz(ψ) Ry(θ) Rx(φ)`, each angle (and each coordinate of the position) a [`Swing`] of one phase time `s`:
//!
//! `x(s) = start + rate s + amplitude (sin(2π f s + phase) − sin(phase))`
//!
//! The tag lies still for [`Tumble::rest_s`], `s` then gathers speed over [`Tumble::ramp_s`] to one second per second, and loses
//! it in the same way before the rest at the end: `ṡ` is the septic step of [`crate::foot_motion`], so that the
//! position is C⁴ and every derivative exact. What tumbles evenly in `s` covers directions evenly in time but for the ramps.
//!
//! # Frames and units
//! Navigation ENU, origin at the sensor at rest; sensor axes x forward, y left, z up where the angles are 0. m, s, rad.
//!
//! # Limits
//! A hand trembles and a hip jerks with each step; here both glide. The lever between hand and tag is what the position
//! says, it does not follow the rotation.

use crate::error::{SimulationError, check_within};
use crate::jet::{Jet, JetVector};
use crate::motion::{Angles, Motion, MotionState};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use serde::{Deserialize, Serialize};

/// One angle (rad) or coordinate (m), as a function of the phase time; `U` is rad or m.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Swing {
    /// Value at rest, U.
    pub start: f64,
    /// Steady change, U/s.
    pub rate: f64,
    /// Amplitude of the oscillation, U.
    pub amplitude: f64,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Its phase at rest, rad.
    pub phase_rad: f64,
}

impl Swing {
    fn at(&self, s: Jet) -> Jet {
        let (sin, _) = (s * (TAU * self.frequency_hz) + Jet::constant(self.phase_rad)).sin_cos();
        Jet::constant(self.start - self.amplitude * libm::sin(self.phase_rad))
            + s * self.rate
            + sin * self.amplitude
    }

    fn check(&self, name: &'static str, largest: f64, expected: &'static str) -> Result<(), SimulationError> {
        for found in [self.start, self.rate, self.amplitude] {
            check_within(name, found, -largest, largest, expected)?;
        }
        check_within("frequency_hz", self.frequency_hz, 0.0, 20.0, "0 to 20 Hz")?;
        check_within("phase_rad", self.phase_rad, -TAU, TAU, "-2π to 2π rad")
    }
}

/// A tag that is turned and moved, from rest to rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tumble {
    /// Rest before and again after the motion, s.
    pub rest_s: f64,
    /// Time from rest to rest, s.
    pub moving_s: f64,
    /// Time to gather speed, and again to lose it, s; at most half of the motion.
    pub ramp_s: f64,
    /// Rotation about the vertical, anticlockwise from east, rad.
    pub yaw: Swing,
    /// Rotation about y after the yaw, nose down positive, rad.
    pub pitch: Swing,
    /// Rotation about x after both, left side up positive, rad.
    pub roll: Swing,
    /// Position, east, north, up, m.
    pub position: [Swing; 3],
}

impl Tumble {
    /// At rest, level, facing east: `rest_s` before and after `moving_s` of nothing yet.
    pub fn still(rest_s: f64, moving_s: f64) -> Self {
        let still = Swing::default();
        Self {
            rest_s,
            moving_s,
            ramp_s: (0.25 * moving_s).min(2.0),
            yaw: still,
            pitch: still,
            roll: still,
            position: [still; 3],
        }
    }

    /// The calibration tumble: rolls over and over (100°/s) while its nose goes once down and once up, and it turns slowly
    /// about the vertical (12°/s): within a minute the field comes from every side of the tag.
    pub fn over_the_sphere(moving_s: f64) -> Self {
        let degree = PI / 180.0;
        Self {
            yaw: Swing { rate: 12.0 * degree, ..Swing::default() },
            pitch: Swing { amplitude: FRAC_PI_2, frequency_hz: 1.0 / moving_s, ..Swing::default() },
            roll: Swing { rate: 100.0 * degree, ..Swing::default() },
            ..Self::still(2.0, moving_s)
        }
    }

    /// What a hurried user does instead: turns the level tag around the vertical a few times, and hardly tilts it (10°).
    pub fn level_turns(moving_s: f64) -> Self {
        let tilt = Swing { amplitude: PI / 18.0, frequency_hz: 0.2, ..Swing::default() };
        Self {
            yaw: Swing { rate: 0.9, ..Swing::default() },
            pitch: tilt,
            roll: Swing { phase_rad: 1.0, frequency_hz: 0.13, ..tilt },
            ..Self::still(2.0, moving_s)
        }
    }

    /// A tag on the waist of someone who walks around on the spot: hips sway and tilt with each stride (0.9 Hz), the
    /// heading swings and wanders.
    pub fn waist(moving_s: f64) -> Self {
        let sway = |amplitude, frequency_hz, phase_rad| Swing {
            amplitude,
            frequency_hz,
            phase_rad,
            ..Swing::default()
        };
        Self {
            yaw: Swing { rate: 0.15, ..sway(0.12, 0.9, 0.0) },
            pitch: sway(0.06, 1.8, 0.4),
            roll: sway(0.07, 0.9, 1.1),
            position: [sway(0.02, 0.9, 0.7), sway(0.03, 0.9, 0.0), sway(0.025, 1.8, 0.2)],
            ..Self::still(3.0, moving_s)
        }
    }

    /// Times, angles and rates are those of a tag in a hand.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("rest_s", self.rest_s, 0.0, 1e6, "0 to 1e6 s")?;
        check_within("moving_s", self.moving_s, 0.0, 1e6, "0 to 1e6 s")?;
        check_within("ramp_s", self.ramp_s, 1e-3, 0.5 * self.moving_s, "0.001 s to half of moving_s")?;
        for (name, angle) in [("yaw", &self.yaw), ("pitch", &self.pitch), ("roll", &self.roll)] {
            angle.check(name, 100.0, "-100 to 100 rad and rad/s")?;
        }
        self.position.iter().try_for_each(|axis| axis.check("position", 1e4, "-10000 to 10000 m and m/s"))
    }

    /// The phase time; its slope is 0 at rest and 1 between the ramps.
    fn phase(&self, time_s: f64) -> Jet {
        let since = time_s - self.rest_s;
        let left = self.moving_s - since;
        let end = self.moving_s - self.ramp_s;
        if since <= 0.0 {
            Jet::constant(0.0)
        } else if left <= 0.0 {
            Jet::constant(end)
        } else if since < self.ramp_s {
            ramp(since, self.ramp_s)
        } else if left < self.ramp_s {
            let mirrored = ramp(left, self.ramp_s);
            Jet { value: end - mirrored.value, first: mirrored.first, second: -mirrored.second }
        } else {
            Jet::linear(since - 0.5 * self.ramp_s, 1.0)
        }
    }
}

/// Integral of the septic step from 0 to `time_s`, with that step and its slope.
fn ramp(time_s: f64, ramp_s: f64) -> Jet {
    let x = time_s / ramp_s;
    let y = 1.0 - x;
    let (x2, x4) = (x * x, x * x * x * x);
    Jet {
        value: ramp_s * x4 * x * (7.0 + x * (-14.0 + x * (10.0 - 2.5 * x))),
        first: x4 * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x))),
        second: 140.0 * x2 * x * y * y * y / ramp_s,
    }
}

impl Motion for Tumble {
    fn at(&self, time_s: f64) -> MotionState {
        let s = self.phase(time_s);
        let angles = Angles { yaw: self.yaw.at(s), pitch: self.pitch.at(s), roll: self.roll.at(s) };
        let [east, north, up] = self.position.map(|axis| axis.at(s));
        let position = JetVector([east, north, up]);
        MotionState {
            position_m: position.value(),
            velocity_m_s: position.first(),
            acceleration_m_s2: position.second(),
            attitude: angles.attitude(),
            angular_rate_rad_s: angles.rate_rad_s(),
            stance: s.first == 0.0,
        }
    }

    fn duration_s(&self) -> f64 {
        2.0 * self.rest_s + self.moving_s
    }
}
