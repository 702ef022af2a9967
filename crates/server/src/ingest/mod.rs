//! What comes in: batches of gateways by MQTT and HTTP, positions from outside, commands.
//!
//! Everything goes through one [`Door`], which checks it, has the journal store it, and says so. What is not stored is not
//! acknowledged: its sender keeps it and sends it again. Whoever comes while [`Door`] is behind waits, and is told to come again
//! after [`PATIENCE`].

mod door;
pub mod mqtt;

pub use door::{
    CommandError, Door, DoorError, JsonBatch, LARGEST_BATCH, PATIENCE, PositionReport, Receipt, Source,
    UNKNOWN_RADIUS_M,
};
