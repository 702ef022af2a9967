//! What one tag measured since its last packet.

use super::WireError;
use super::runs::{self, Resolution, Runs};
use crate::device::DeviceId;
use crate::observation::{Observation, ObservationKind};
use crate::protobuf::schema::{message, schema_name};
use crate::protobuf::{self, Messages};
use prost::Message;
use prost::bytes::Bytes;
use serde::{Deserialize, Serialize};

/// What one tag measured since its last packet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Packet {
    /// The tag.
    pub tag: DeviceId,
    /// The tag's own number of this packet, rising by one; 0 when it does not count.
    #[serde(default)]
    pub number: u64,
    /// Charge of its battery, 0 to 1.
    #[serde(default)]
    pub battery: Option<f64>,
    /// Its button for help is pressed.
    #[serde(default)]
    pub distress: bool,
    /// In order of time.
    pub observations: Vec<Observation>,
}

/// A packet has no more observations: ten minutes of a sensor at 200 Hz.
pub const MOST_OBSERVATIONS: usize = 120_000;

const MESSAGE: &str = "adit.v1.TagPacket";

/// `adit.v1.TagPacket`, whose single readings stay bytes until they are read: on the wire there is no difference.
#[derive(Clone, PartialEq, Message)]
struct Envelope {
    #[prost(string, tag = "1")]
    tag: String,
    #[prost(uint64, tag = "2")]
    number: u64,
    #[prost(float, optional, tag = "3")]
    battery: Option<f32>,
    #[prost(bool, tag = "4")]
    distress: bool,
    #[prost(message, repeated, tag = "5")]
    inertial_runs: Vec<message::InertialRun>,
    #[prost(message, repeated, tag = "6")]
    magnetic_runs: Vec<message::MagneticRun>,
    #[prost(bytes = "bytes", repeated, tag = "7")]
    imu: Vec<Bytes>,
    #[prost(bytes = "bytes", repeated, tag = "8")]
    acceleration: Vec<Bytes>,
    #[prost(bytes = "bytes", repeated, tag = "9")]
    magnetic: Vec<Bytes>,
    #[prost(bytes = "bytes", repeated, tag = "10")]
    pressure: Vec<Bytes>,
    #[prost(bytes = "bytes", repeated, tag = "11")]
    ranges: Vec<Bytes>,
    #[prost(bytes = "bytes", repeated, tag = "12")]
    signals: Vec<Bytes>,
    #[prost(bytes = "bytes", repeated, tag = "13")]
    sightings: Vec<Bytes>,
    #[prost(bytes = "bytes", repeated, tag = "14")]
    fixes: Vec<Bytes>,
}

impl Envelope {
    fn singles(&mut self, kind: ObservationKind) -> &mut Vec<Bytes> {
        match kind {
            ObservationKind::Imu => &mut self.imu,
            ObservationKind::Acceleration => &mut self.acceleration,
            ObservationKind::Magnetic => &mut self.magnetic,
            ObservationKind::Pressure => &mut self.pressure,
            ObservationKind::Fix => &mut self.fixes,
            ObservationKind::Signal => &mut self.signals,
            ObservationKind::Range => &mut self.ranges,
            ObservationKind::Sighting => &mut self.sightings,
        }
    }
}

/// Reads packets; names of devices that were met before cost no memory.
#[derive(Default)]
pub struct PacketReader {
    messages: Messages,
}

impl PacketReader {
    /// A packet, its observations in order of time, those of the tag's own sensors first.
    pub fn read(&mut self, bytes: &Bytes) -> Result<Packet, WireError> {
        let mut packet =
            Envelope::decode(bytes.clone()).map_err(|error| WireError::new("message", error, MESSAGE))?;
        let tag = protobuf::device(&mut self.messages.names, &packet.tag, "tag");
        let tag = tag.map_err(|bad| WireError::of(bad, MESSAGE))?;

        let singles: usize = ObservationKind::ALL.iter().map(|kind| packet.singles(*kind).len()).sum();
        let in_runs = packet.inertial_runs.iter().map(|run| run.rate.len()).sum::<usize>()
            + packet.magnetic_runs.iter().map(|run| run.field.len()).sum::<usize>();
        let count = singles + in_runs / 3;
        if count > MOST_OBSERVATIONS {
            return Err(WireError::new("observations", count, "at most 120000 in a packet"));
        }
        let mut observations = Vec::with_capacity(count);
        for run in &packet.inertial_runs {
            runs::read_inertial(run, &mut observations)?;
        }
        for run in &packet.magnetic_runs {
            runs::read_magnetic(run, &mut observations)?;
        }
        for kind in ObservationKind::ALL {
            for single in &*packet.singles(kind) {
                let observation = self.messages.decode(kind, single);
                observations.push(observation.map_err(|bad| WireError::of(bad, schema_name(kind)))?);
            }
        }
        // Runs are in order by themselves: next to nothing is left to sort.
        observations.sort_by_key(|observation| (observation.time(), observation.kind() as usize));
        let battery = packet.battery.map(|battery| share(battery, "battery")).transpose()?;
        Ok(Packet { tag, number: packet.number, battery, distress: packet.distress, observations })
    }
}

/// The tag of a packet; the rest is passed over.
#[derive(Clone, PartialEq, Message)]
struct TagOnly {
    #[prost(string, tag = "1")]
    tag: String,
}

impl Packet {
    /// The tag of a packet, of which nothing else is read; `None` when it is none.
    pub fn tag_of(bytes: &Bytes) -> Option<String> {
        TagOnly::decode(bytes.clone()).ok().map(|packet| packet.tag)
    }

    /// As bytes. Inertial and magnetic readings at even times become counts of the resolution, to half of which they are
    /// rounded; all else is exact.
    pub fn to_bytes(&self, resolution: &Resolution) -> Vec<u8> {
        let mut messages = Messages::default();
        #[expect(clippy::cast_possible_truncation, reason = "a charge; the wire has no more digits")]
        let battery = self.battery.map(|battery| battery as f32);
        let mut packet = Envelope {
            tag: self.tag.as_str().to_owned(),
            number: self.number,
            battery,
            distress: self.distress,
            ..Envelope::default()
        };
        let runs = Runs::of(&self.observations, resolution);
        (packet.inertial_runs, packet.magnetic_runs) = (runs.inertial, runs.magnetic);
        for observation in runs.others {
            let mut bytes = Vec::new();
            messages.encode(observation, &mut bytes);
            packet.singles(observation.kind()).push(bytes.into());
        }
        packet.encode_to_vec()
    }
}

/// A charge: 0 to 1.
pub(super) fn share(value: f32, what: &str) -> Result<f64, WireError> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value.into());
    }
    Err(WireError::new(what, value, "0 to 1"))
}
