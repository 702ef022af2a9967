//! Air pressure in a mine, and barometers.
//!
//! `p(place, t) = p_column(z) + p_weather(t) + p_ventilation(place) + p_doors(place, t)`
//!
//! | term | what |
//! |---|---|
//! | column | hydrostatic, temperature falling evenly with height: the lowest layer of the standard atmosphere (ISO 2533:1975), continued below the datum |
//! | weather | slow and the same everywhere: a seeded sum of five sinusoids of 3 h to 60 h |
//! | ventilation | what drives the air: steps across closed doors, falling off along the roadways between them ([`Ventilation`]) |
//! | doors | while somebody passes a door, the pressures on its two sides approach one another |
//!
//! [`MineAir`] is the truth, [`BarometerModel`] what a sensor makes of it, [`Barometer`] the stream of readings. Frame: mine grid; Pa, m, s, K.
//!
//! **Limits.** No wind pressure at the portals, no piston effect of vehicles and cages, no humidity; air moves linearly.

mod air;
mod barometer;
mod doors;
mod ventilation;

pub use air::{AirColumn, AirSpec, MineAir};
pub use barometer::{Barometer, BarometerModel, PressureTruth};
pub use doors::Passage;
pub use ventilation::Ventilation;
