//! Zones, who is in them, and how many.

mod live;

pub use live::LiveZone;
