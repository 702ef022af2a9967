//! The motion of `kind = "tumble"`: a tag turned and moved by hand, in degrees.

use adit_simulation::{Swing, Tumble};
use serde::Deserialize;

/// The table `[tumble]`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TumbleEntry {
    rest_s: f64,
    moving_s: f64,
    ramp_s: Option<f64>,
    #[serde(default)]
    yaw: Turn,
    #[serde(default)]
    pitch: Turn,
    #[serde(default)]
    roll: Turn,
    #[serde(default)]
    east: Shift,
    #[serde(default)]
    north: Shift,
    #[serde(default)]
    up: Shift,
}

/// One angle over time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Turn {
    start_deg: f64,
    rate_deg_s: f64,
    swing_deg: f64,
    frequency_hz: f64,
    phase_deg: f64,
}

/// One coordinate over time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Shift {
    rate_m_s: f64,
    swing_m: f64,
    frequency_hz: f64,
    phase_deg: f64,
}

impl Turn {
    fn swing(&self) -> Swing {
        Swing {
            start: self.start_deg.to_radians(),
            rate: self.rate_deg_s.to_radians(),
            amplitude: self.swing_deg.to_radians(),
            frequency_hz: self.frequency_hz,
            phase_rad: self.phase_deg.to_radians(),
        }
    }
}

impl Shift {
    fn swing(&self) -> Swing {
        Swing {
            start: 0.0,
            rate: self.rate_m_s,
            amplitude: self.swing_m,
            frequency_hz: self.frequency_hz,
            phase_rad: self.phase_deg.to_radians(),
        }
    }
}

impl TumbleEntry {
    /// The motion.
    pub fn tumble(&self) -> Tumble {
        let still = Tumble::still(self.rest_s, self.moving_s);
        Tumble {
            ramp_s: self.ramp_s.unwrap_or(still.ramp_s),
            yaw: self.yaw.swing(),
            pitch: self.pitch.swing(),
            roll: self.roll.swing(),
            position: [self.east, self.north, self.up].map(|axis| axis.swing()),
            ..still
        }
    }
}
