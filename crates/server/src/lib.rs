//! From the gateways to positions, alarms and an open API.

mod error;
pub mod journal;

pub use error::ServerError;
