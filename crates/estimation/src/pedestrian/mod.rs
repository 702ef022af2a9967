//! What is true of people on foot.

pub mod gap;
pub mod heading;
pub mod stance;
pub mod stance_updates;
pub mod step_length;
pub mod steps;
pub mod trail;
pub mod zero_velocity;
