//! Observations as protobuf messages and back: what MCAP files and packets of gateways have in common.

mod messages;
mod radio_messages;
pub(crate) mod schema;

pub(crate) use messages::{BadMessage, Messages, device, time, timestamp};
