//! From the gateways to positions, alarms and an open API.

mod error;
pub mod ingest;
pub mod journal;
pub mod pipeline;
pub mod export;
pub mod store;

pub use error::ServerError;
