//! Where somebody is, by dead reckoning of any kind and whatever else is at hand: hypotheses, each an error-state filter.

pub mod bank;
mod moments;
pub mod params;
pub mod roadways;
pub mod state;
pub mod trail;
