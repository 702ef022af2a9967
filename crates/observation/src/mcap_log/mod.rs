//! Sensor logs as MCAP, one channel per sensor, protobuf messages with their schemas inside.
//!
//! | topic | schema | what |
//! |---|---|---|
//! | `/imu` | `adit.v1.ImuSample` | gyro (rad/s) and accelerometer (m/s²) |
//! | `/acceleration` | `adit.v1.AccelerationSample` | accelerometer without a gyro (m/s²) |
//! | `/magnetic` | `adit.v1.MagneticSample` | magnetometer (µT) |
//! | `/pressure` | `adit.v1.PressureSample` | barometer (Pa) |
//! | `/fix` | `adit.v1.PositionFix` | position from outside (m) |
//! | `/signal` | `adit.v1.SignalStrength` | signal strength of a transmitter (dBm) |
//! | `/range` | `adit.v1.RangeSample` | distance to an anchor (m), how the signal came in, its impulse response |
//! | `/sighting` | `adit.v1.Sighting` | seen by a reader |
//!
//! The schemas stand in `proto/adit/v1/`; a file carries them as a `FileDescriptorSet`, so that Foxglove and any other
//! MCAP tool decodes it. Channels are known by schema name, whatever their topic; others are ignored with a
//! warning. Two topics with the same schema are an error unless one is chosen
//! ([`crate::ReadOptions::topics`]).
//!
//! Time is the `timestamp` inside the message, exact and signed; MCAP's own log time is unsigned and gets 0 for times
//! before the origin.
//!
//! Reading streams: memory is bounded by one chunk ([`LARGEST_RECORD`] packed and unpacked), whatever a damaged file
//! claims. A cut file gives all complete chunks and then an error with record and offset. Writing streams in
//! chunks of 1 MiB, by lz4 or plain.
//!
//! Format: <https://mcap.dev/spec>; the state machine is the `mcap` crate's, without I/O.

mod reader;
mod records;
mod writer;

pub use reader::McapLog;
pub use records::LARGEST_RECORD;
pub use writer::{McapLogWriter, Packing};

/// The first bytes of every MCAP file.
pub(crate) const MAGIC: &[u8] = mcap::MAGIC;
