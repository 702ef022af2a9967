//! From the gateways to positions, alarms and an open API.

pub mod auth;
mod error;
pub mod journal;

pub use error::ServerError;
