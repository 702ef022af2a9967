//! Evacuation: who is safe, who is on the way, who is missing.

mod drill;
mod exits;
mod status;

pub(crate) use drill::Evacuation;
pub(crate) use drill::Mark;
pub(crate) use exits::Exits;
pub use status::{EvacuationStatus, EvacuationSummary, EvacuationView, Evacuee, Way};
