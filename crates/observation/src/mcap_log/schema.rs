//! Observations as protobuf messages, and the schemas that MCAP files carry so that any tool can decode them.

use crate::imu::{ImuSample, MagneticSample};
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use prost::Message;

/// Types made by prost from `proto/adit/v1/*.proto`.
mod generated {
    include!(concat!(env!("OUT_DIR"), "/schemas.rs"));
}

use generated::adit::v1 as message;
use generated::google::protobuf::Timestamp;

/// `FileDescriptorSet` of all schemas with their imports: the schema data of every channel.
pub(super) const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/adit_v1.descriptors"));
/// Name of encoding and of schema encoding in MCAP.
pub(super) const PROTOBUF: &str = "protobuf";

const NANOS_PER_SECOND: i64 = 1_000_000_000;

/// What a channel carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Imu,
    Magnetic,
}

impl Kind {
    pub(super) const ALL: [Self; 2] = [Self::Imu, Self::Magnetic];

    /// Full name of the protobuf message.
    pub(super) const fn schema_name(self) -> &'static str {
        match self {
            Self::Imu => "adit.v1.ImuSample",
            Self::Magnetic => "adit.v1.MagneticSample",
        }
    }

    /// Topic written; any is read.
    pub(super) const fn topic(self) -> &'static str {
        match self {
            Self::Imu => "/imu",
            Self::Magnetic => "/magnetic",
        }
    }
}

/// What is wrong with a message.
pub(super) enum BadMessage {
    Undecodable(String),
    Missing(&'static str),
    NotFinite(&'static str, f64),
    Time(String),
}

pub(super) fn encode_imu(sample: &ImuSample, bytes: &mut Vec<u8>) {
    let message = message::ImuSample {
        timestamp: Some(timestamp(sample.time)),
        angular_rate_rad_s: Some(vector(&sample.angular_rate_rad_s)),
        specific_force_m_s2: Some(vector(&sample.specific_force_m_s2)),
    };
    message.encode_raw(bytes);
}

pub(super) fn encode_magnetic(sample: &MagneticSample, bytes: &mut Vec<u8>) {
    let message = message::MagneticSample {
        timestamp: Some(timestamp(sample.time)),
        field_ut: Some(vector(&sample.field_ut)),
    };
    message.encode_raw(bytes);
}

pub(super) fn decode_imu(bytes: &[u8]) -> Result<ImuSample, BadMessage> {
    let message = message::ImuSample::decode(bytes).map_err(|e| BadMessage::Undecodable(e.to_string()))?;
    Ok(ImuSample {
        time: time(message.timestamp)?,
        angular_rate_rad_s: checked(message.angular_rate_rad_s, "angular_rate_rad_s")?,
        specific_force_m_s2: checked(message.specific_force_m_s2, "specific_force_m_s2")?,
    })
}

pub(super) fn decode_magnetic(bytes: &[u8]) -> Result<MagneticSample, BadMessage> {
    let message =
        message::MagneticSample::decode(bytes).map_err(|e| BadMessage::Undecodable(e.to_string()))?;
    Ok(MagneticSample { time: time(message.timestamp)?, field_ut: checked(message.field_ut, "field_ut")? })
}

fn timestamp(time: Time) -> Timestamp {
    let nanos = time.nanos();
    // The fraction counts forward from the second below, also before the origin.
    let fraction = i32::try_from(nanos.rem_euclid(NANOS_PER_SECOND)).unwrap_or_default();
    Timestamp { seconds: nanos.div_euclid(NANOS_PER_SECOND), nanos: fraction }
}

fn time(timestamp: Option<Timestamp>) -> Result<Time, BadMessage> {
    let Timestamp { seconds, nanos } = timestamp.ok_or(BadMessage::Missing("timestamp"))?;
    let whole = i128::from(seconds) * i128::from(NANOS_PER_SECOND) + i128::from(nanos);
    i64::try_from(whole)
        .ok()
        .filter(|_| (0..1_000_000_000).contains(&nanos))
        .map(Time::from_nanos)
        .ok_or_else(|| BadMessage::Time(format!("{seconds} s and {nanos} ns")))
}

fn vector(v: &Vector3<f64>) -> message::Vector3 {
    message::Vector3 { x: Some(v.x), y: Some(v.y), z: Some(v.z) }
}

fn checked(vector: Option<message::Vector3>, name: &'static str) -> Result<Vector3<f64>, BadMessage> {
    let Some(message::Vector3 { x: Some(x), y: Some(y), z: Some(z) }) = vector else {
        return Err(BadMessage::Missing(name));
    };
    match [x, y, z].iter().find(|v| !v.is_finite()) {
        Some(bad) => Err(BadMessage::NotFinite(name, *bad)),
        None => Ok(Vector3::new(x, y, z)),
    }
}
