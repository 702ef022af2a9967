//! A batch: its number, and packets as bytes.

use super::packet::Packet;
use super::runs::Resolution;
use super::{WireError, packet::share};
use crate::device::DeviceId;
use crate::protobuf::schema::{Timestamp, message};
use crate::protobuf::{self, Messages};
use adit_core::time::Time;
use prost::Message;
use prost::bytes::Bytes;

/// What a gateway sends at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// Drawn at random each time the gateway starts: its sequence numbers begin anew then.
    pub boot: u64,
    /// Number of the batch since then, rising by one from 1.
    pub sequence: u64,
    /// When it was sent, by the gateway's clock.
    pub sent: Option<Time>,
    /// Packets of tags, each as its bytes.
    pub packets: Vec<Bytes>,
    /// How what hangs on the gateway is.
    pub devices: Vec<DeviceStatus>,
}

/// How an anchor, access point or reader is.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceStatus {
    /// Which.
    pub device: DeviceId,
    /// Whether it answers.
    pub up: bool,
    /// Charge of its battery, 0 to 1.
    pub battery: Option<f64>,
}

/// `adit.v1.ObservationBatch`, whose packets stay bytes: on the wire there is no difference.
#[derive(Clone, PartialEq, Message)]
struct Envelope {
    #[prost(fixed64, tag = "1")]
    boot: u64,
    #[prost(uint64, tag = "2")]
    sequence: u64,
    #[prost(message, optional, tag = "3")]
    sent: Option<Timestamp>,
    #[prost(bytes = "bytes", repeated, tag = "4")]
    packets: Vec<Bytes>,
    #[prost(message, repeated, tag = "5")]
    devices: Vec<message::DeviceStatus>,
}

const MESSAGE: &str = "adit.v1.ObservationBatch";

impl Batch {
    /// Without packets.
    pub fn new(boot: u64, sequence: u64) -> Self {
        Self { boot, sequence, sent: None, packets: Vec::new(), devices: Vec::new() }
    }

    /// The same with one more packet; readings at even times become counts of this resolution.
    #[must_use]
    pub fn with_packet(mut self, packet: &Packet, resolution: &Resolution) -> Self {
        self.packets.push(packet.to_bytes(resolution).into());
        self
    }

    /// From its bytes, of which the packets share the memory.
    pub fn read(bytes: impl Into<Bytes>) -> Result<Self, WireError> {
        let envelope =
            Envelope::decode(bytes.into()).map_err(|error| WireError::new("message", error, MESSAGE))?;
        if envelope.sequence == 0 {
            return Err(WireError::new("sequence", 0, "1 or more"));
        }
        let mut messages = Messages::default();
        let status = |status: &message::DeviceStatus| {
            let device = protobuf::device(&mut messages.names, &status.device, "device")
                .map_err(|bad| WireError::of(bad, MESSAGE))?;
            let battery = status.battery.map(|battery| share(battery, "device battery")).transpose()?;
            Ok(DeviceStatus { device, up: status.up, battery })
        };
        Ok(Self {
            boot: envelope.boot,
            sequence: envelope.sequence,
            sent: envelope
                .sent
                .map(|sent| protobuf::time(Some(sent)).map_err(|bad| WireError::of(bad, MESSAGE)))
                .transpose()?,
            devices: envelope.devices.iter().map(status).collect::<Result<_, _>>()?,
            packets: envelope.packets,
        })
    }

    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        #[expect(clippy::cast_possible_truncation, reason = "a charge; the wire has no more digits")]
        let status = |status: &DeviceStatus| message::DeviceStatus {
            device: status.device.as_str().to_owned(),
            up: status.up,
            battery: status.battery.map(|battery| battery as f32),
        };
        let envelope = Envelope {
            boot: self.boot,
            sequence: self.sequence,
            sent: self.sent.map(protobuf::timestamp),
            packets: self.packets.clone(),
            devices: self.devices.iter().map(status).collect(),
        };
        envelope.encode_to_vec()
    }
}
