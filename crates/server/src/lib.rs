//! From the gateways to positions, alarms and an open API.

mod error;

pub use error::ServerError;
