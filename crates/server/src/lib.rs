//! From the gateways to positions, alarms and an open API.

pub mod api;
pub mod auth;
mod error;
pub mod export;
pub mod feed;
pub mod journal;
pub mod store;

pub use error::ServerError;
