//! From the gateways to positions, alarms and an open API.

pub mod auth;
mod error;

pub use error::ServerError;
