//! What gateways send: batches of packets of tags, as protobuf (`proto/adit/v1/batch.proto`). Bytes in, observations out; no I/O.
//!
//! A [`Batch`] is read without its packets, which stay bytes until somebody asks ([`PacketReader`]), so that whoever only has to
//! store and hand on does no more. Readings at even times travel as counts, each less the one before: a second of six axes at
//! 100 Hz is 1.2 kB instead of 7.4 (test `runs_are_a_fifth_of_single_readings`).
//!
//! ```
//! use adit_observation::wire::{Batch, Packet, PacketReader, Resolution};
//! # use adit_observation::{DeviceId, ImuSample, Observation};
//! # use adit_core::{nalgebra::Vector3, time::Time};
//! # let sample = |i: i64| Observation::Imu(ImuSample {
//! #     time: Time::from_nanos(i * 10_000_000), angular_rate_rad_s: Vector3::zeros(), specific_force_m_s2: Vector3::new(0.0, 0.0, 9.81) });
//! # let observations = (0..100).map(sample).collect();
//! let tag = DeviceId::new("T-17").unwrap();
//! let packet = Packet { tag, number: 1, battery: Some(0.8), distress: false, observations };
//! let batch = Batch::new(0x5eed, 1).with_packet(&packet, &Resolution::default());
//! let read = Batch::read(batch.to_bytes()).unwrap();
//! let same = PacketReader::default().read(&read.packets[0]).unwrap();
//! assert_eq!(same.observations.len(), 100);
//! ```

mod batch;
mod packet;
mod runs;

pub use batch::{Batch, DeviceStatus};
pub use packet::{MOST_OBSERVATIONS, Packet, PacketReader};
#[cfg(test)]
mod tests;

pub use runs::Resolution;

use crate::protobuf::BadMessage;
use thiserror::Error;

/// A batch or packet that is none, with what was found in it and what was expected.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{what}: found {found}, expected {expected}")]
pub struct WireError {
    /// Which field.
    pub what: String,
    /// What stands there.
    pub found: String,
    /// What should.
    pub expected: String,
}

impl WireError {
    fn new(what: &str, found: impl std::fmt::Display, expected: &str) -> Self {
        Self { what: what.to_owned(), found: found.to_string(), expected: expected.to_owned() }
    }

    fn of(bad: BadMessage, message: &str) -> Self {
        let (what, found, expected) = bad.told(message);
        Self { what, found, expected }
    }
}
