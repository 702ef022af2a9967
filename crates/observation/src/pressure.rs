//! Air pressure.

use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// One reading of a barometer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PressureSample {
    /// Time of the reading.
    pub time: Time,
    /// Absolute pressure, Pa.
    pub pressure_pa: f64,
}
