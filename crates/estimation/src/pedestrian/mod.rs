//! What is true of people on foot.

pub mod heading;
pub mod stance;
pub mod zero_velocity;
