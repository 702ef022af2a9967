//! What a round came to.

use crate::journal::Position;
use adit_core::time::Time;
use adit_tracking::{Event, Fix};

/// What a round came to, for viewers and for the store: all of it happened after everything of the round before.
#[derive(Debug, Clone, Default)]
pub struct RoundOutcome {
    /// The last entry of the journal in it; `None` when the disk took none.
    pub position: Option<Position>,
    /// When it arrived.
    pub arrived: Time,
    /// Where tags are, of those that the tracking took.
    pub fixes: Vec<TrackedFix>,
    /// What happened.
    pub events: Vec<Event>,
}

/// Where a tag is, and who wears it.
#[derive(Debug, Clone)]
pub struct TrackedFix {
    /// Where it is.
    pub fix: Fix,
    /// Id of the person who wears it.
    pub person: Option<String>,
    /// The zone that they entered last, of those they are in.
    pub zone: Option<String>,
}

impl RoundOutcome {
    /// Nothing came of it.
    pub fn is_empty(&self) -> bool {
        self.fixes.is_empty() && self.events.is_empty()
    }
}
