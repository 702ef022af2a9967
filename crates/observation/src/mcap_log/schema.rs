//! Observations as protobuf messages, and the schemas that MCAP files carry so that any tool can decode them.

use crate::fix::{FixSource, HeightFix, PositionFix};
use crate::imu::{ImuSample, MagneticSample};
use crate::observation::{Observation, ObservationKind};
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_core::time::Time;
use prost::Message;

/// Types made by prost from `proto/adit/v1/*.proto`.
#[expect(clippy::doc_markdown, clippy::trivially_copy_pass_by_ref, reason = "as prost writes enums")]
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

/// Full name of the protobuf message of a kind.
pub(super) const fn schema_name(kind: ObservationKind) -> &'static str {
    match kind {
        ObservationKind::Imu => "adit.v1.ImuSample",
        ObservationKind::Magnetic => "adit.v1.MagneticSample",
        ObservationKind::Fix => "adit.v1.PositionFix",
        ObservationKind::Pressure => "adit.v1.PressureSample",
        ObservationKind::Signal => "adit.v1.SignalStrength",
        ObservationKind::Range => "adit.v1.RangeSample",
        ObservationKind::Sighting => "adit.v1.Sighting",
    }
}

/// Topic written; any is read.
pub(super) const fn topic(kind: ObservationKind) -> &'static str {
    match kind {
        ObservationKind::Imu => "/imu",
        ObservationKind::Magnetic => "/magnetic",
        ObservationKind::Fix => "/fix",
        ObservationKind::Pressure => "/pressure",
        ObservationKind::Signal => "/signal",
        ObservationKind::Range => "/range",
        ObservationKind::Sighting => "/sighting",
    }
}

/// What is wrong with a message.
pub(super) enum BadMessage {
    Undecodable(String),
    Missing(&'static str),
    NotFinite(&'static str, f64),
    Unlikely(&'static str, f64, &'static str),
    Time(String),
}

/// Appends the message of an observation.
pub(super) fn encode(observation: &Observation, bytes: &mut Vec<u8>) {
    let timestamp = Some(timestamp(observation.time()));
    match observation {
        Observation::Imu(sample) => message::ImuSample {
            timestamp,
            angular_rate_rad_s: Some(vector(&sample.angular_rate_rad_s)),
            specific_force_m_s2: Some(vector(&sample.specific_force_m_s2)),
        }
        .encode_raw(bytes),
        Observation::Magnetic(sample) => {
            message::MagneticSample { timestamp, field_ut: Some(vector(&sample.field_ut)) }.encode_raw(bytes);
        }
        Observation::Fix(fix) => message::PositionFix {
            timestamp,
            east_m: Some(fix.level_m.x),
            north_m: Some(fix.level_m.y),
            cov_e_e_m2: Some(fix.covariance_m2[(0, 0)]),
            cov_e_n_m2: Some(fix.covariance_m2[(0, 1)]),
            cov_n_n_m2: Some(fix.covariance_m2[(1, 1)]),
            up_m: fix.height.map(|height| height.up_m),
            up_sigma_m: fix.height.map(|height| height.sigma_m),
            source: source_to_message(fix.source).into(),
        }
        .encode_raw(bytes),
        _ => {} // WIP
    }
}

/// Reads the message of an observation.
pub(super) fn decode(kind: ObservationKind, bytes: &[u8]) -> Result<Observation, BadMessage> {
    match kind {
        ObservationKind::Imu => decode_imu(bytes).map(Observation::Imu),
        ObservationKind::Magnetic => decode_magnetic(bytes).map(Observation::Magnetic),
        ObservationKind::Fix => decode_fix(bytes).map(Observation::Fix),
        _ => Err(BadMessage::Missing("WIP")),
    }
}

fn message<M: Message + Default>(bytes: &[u8]) -> Result<M, BadMessage> {
    M::decode(bytes).map_err(|e| BadMessage::Undecodable(e.to_string()))
}

fn decode_imu(bytes: &[u8]) -> Result<ImuSample, BadMessage> {
    let message: message::ImuSample = message(bytes)?;
    Ok(ImuSample {
        time: time(message.timestamp)?,
        angular_rate_rad_s: checked(message.angular_rate_rad_s, "angular_rate_rad_s")?,
        specific_force_m_s2: checked(message.specific_force_m_s2, "specific_force_m_s2")?,
    })
}

fn decode_magnetic(bytes: &[u8]) -> Result<MagneticSample, BadMessage> {
    let message: message::MagneticSample = message(bytes)?;
    Ok(MagneticSample { time: time(message.timestamp)?, field_ut: checked(message.field_ut, "field_ut")? })
}

fn decode_fix(bytes: &[u8]) -> Result<PositionFix, BadMessage> {
    let message: message::PositionFix = message(bytes)?;
    let source = source_from_message(message.source());
    let height = match (message.up_m, message.up_sigma_m) {
        (None, None) => None,
        (up_m, sigma_m) => {
            Some(HeightFix { up_m: number(up_m, "up_m")?, sigma_m: number(sigma_m, "up_sigma_m")? })
        }
    };
    let cov_e_n = number(message.cov_e_n_m2, "cov_e_n_m2")?;
    let fix = PositionFix {
        time: time(message.timestamp)?,
        level_m: Vector2::new(number(message.east_m, "east_m")?, number(message.north_m, "north_m")?),
        covariance_m2: Matrix2::new(
            number(message.cov_e_e_m2, "cov_e_e_m2")?,
            cov_e_n,
            cov_e_n,
            number(message.cov_n_n_m2, "cov_n_n_m2")?,
        ),
        height,
        source,
    };
    match fix.fault() {
        None => Ok(fix),
        Some((name, found, expected)) => Err(BadMessage::Unlikely(name, found, expected)),
    }
}

fn source_to_message(source: FixSource) -> message::FixSource {
    match source {
        FixSource::Unknown => message::FixSource::Unspecified,
        FixSource::Wifi => message::FixSource::Wifi,
        FixSource::Uwb => message::FixSource::Uwb,
        FixSource::Bluetooth => message::FixSource::Bluetooth,
        FixSource::Rfid => message::FixSource::Rfid,
        FixSource::Survey => message::FixSource::Survey,
        FixSource::Gnss => message::FixSource::Gnss,
    }
}

/// A source that a later version of the schema knows is unknown here.
fn source_from_message(source: message::FixSource) -> FixSource {
    FixSource::ALL.into_iter().find(|ours| source_to_message(*ours) == source).unwrap_or_default()
}

fn number(value: Option<f64>, name: &'static str) -> Result<f64, BadMessage> {
    match value {
        Some(value) if value.is_finite() => Ok(value),
        Some(bad) => Err(BadMessage::NotFinite(name, bad)),
        None => Err(BadMessage::Missing(name)),
    }
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
