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

impl PressureSample {
    /// What cannot be right, if anything: (name of the quantity, its value, what is expected).
    ///
    /// 1 kPa is the floor of the widest barometers in use (MS5611: 10 to 1200 hPa). Under the ceiling of 200 kPa fit the deepest mines
    /// (4 km below ground: about 140 kPa) and what a person is put under underground: a heading under compressed air, a refuge
    /// chamber, a breathing apparatus.
    pub fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        let possible = (1e3..=2e5).contains(&self.pressure_pa);
        (!possible).then_some((
            "pressure_pa",
            self.pressure_pa,
            "1,000 to 200,000 Pa (1,013.25 hPa are 101,325 Pa)",
        ))
    }
}
