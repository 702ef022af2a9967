//! From the gateways to positions, alarms and an open API.

pub mod api;
pub mod auth;
mod clock;
mod console;
mod error;
pub mod export;
pub mod feed;
pub mod ingest;
pub mod journal;
mod lock;
pub mod pipeline;
mod plan_changes;
mod run;
mod seldom;
mod server;
pub mod store;
mod writer;

pub use clock::{Clock, FASTEST, Pace, now};
pub use error::ServerError;
pub use plan_changes::{AnchorChange, PlanChanges, PlanDesk, with_changes};
pub use run::{Parts, Settings, start};
pub use server::{Server, Serving};
