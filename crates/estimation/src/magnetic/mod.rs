//! The magnetic field as a compass: levelled heading, and when not to believe it.

pub mod gate;
pub mod heading;
