//! Where somebody is, by dead reckoning of any kind and whatever else is at hand: hypotheses, each an error-state filter.

pub mod bank;
mod moments;
mod motion;
pub mod params;
pub mod roadways;
pub mod smoother;
pub mod state;
mod stretch;
pub mod trail;
