//! From the journal to positions: entries in, in their order; what tags said to their estimators, what comes of it to the
//! tracking, to viewers and to the store.
//!
//! ```text
//! journal ─► round ─┬─► shard 0: followers of its tags ─┐
//!                   └─► shard 1: …                      ├─► back in the order of the journal ─► tracking ─► outcome of the round
//! ```
//!
//! A **round** takes what the journal has written together. Each tag belongs to one shard, by its name; shards work at the same
//! time, and what they find is put in order again. So all that follows is a function of the journal alone, whatever the number of
//! threads, and a server that starts again from its snapshot comes to the state it had.
//!
//! **Time.** The server's clock stamps an entry once, when it is written. A tag's own clock is believed as far as it can be true
//! ([`clock::TagClock`]).

pub mod clock;
mod devices;
mod estimator;
mod follower;
mod hearing;
mod motion;
mod outcome;
mod profile;
mod rounds;
mod shard;
mod snapshot;
#[cfg(test)]
mod tests;

pub use estimator::Settings;
pub use follower::{TagCounts, TagHealth};
pub use hearing::{BIN_S, HearingReport, NisBin, Rate, Source};
pub use outcome::{RoundOutcome, TrackedFix};
pub use profile::{Profile, Profiles, ProfilesError};
pub use rounds::{Asked, Pipeline, PipelineSettings, Started};
pub use snapshot::Snapshots;
