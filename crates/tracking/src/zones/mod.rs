//! Zones, who is in them, and how many.

mod live;
mod watch;

pub use live::LiveZone;
pub(crate) use watch::{Counts, LevelIndex, Levels, Shape, Watch};
