//! Evacuation: who is safe, who is on the way, who is missing.

mod status;

pub use status::{EvacuationStatus, EvacuationSummary, EvacuationView, Evacuee, Way};
