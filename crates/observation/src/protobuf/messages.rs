//! Observations as protobuf messages and back.

use super::schema::{Timestamp, message};
use crate::device::DeviceId;
use crate::error::on_one_line;
use crate::fix::{FixSource, HeightFix, PositionFix};
use crate::imu::{AccelerationSample, ImuSample, MagneticSample};
use crate::names::{EXPECTED_NAME, Names};
use crate::observation::{Observation, ObservationKind};
use crate::pressure::PressureSample;
use crate::radio::Sighting;
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_core::time::Time;
use prost::Message;

const NANOS_PER_SECOND: i64 = 1_000_000_000;

/// What is wrong with a message.
#[derive(Debug)]
pub(crate) enum BadMessage {
    Undecodable(String),
    Missing(&'static str),
    NotFinite(&'static str, f64),
    Unlikely(&'static str, f64, &'static str),
    Name(&'static str, String),
    Time(String),
}

impl BadMessage {
    /// Field, what was found, what is expected; `message` is what it was taken for.
    pub(crate) fn told(self, message: &str) -> (String, String, String) {
        match self {
            Self::Undecodable(why) => ("message".to_owned(), on_one_line(&why), message.to_owned()),
            Self::Missing(field) => (field.to_owned(), "nothing".to_owned(), "a value".to_owned()),
            Self::NotFinite(field, value) => {
                (field.to_owned(), value.to_string(), "a finite number".to_owned())
            }
            Self::Unlikely(field, value, expected) => {
                (field.to_owned(), value.to_string(), expected.to_owned())
            }
            Self::Name(field, found) => (field.to_owned(), format!("\"{found}\""), EXPECTED_NAME.to_owned()),
            Self::Time(found) => {
                ("timestamp".to_owned(), found, "a time within ±292 years, 0 to 999999999 ns".to_owned())
            }
        }
    }
}

/// Turns observations into messages and back. What holds text is kept and filled anew, so that a message allocates nothing for it.
#[derive(Default)]
pub(crate) struct Messages {
    pub(crate) signal: message::SignalStrength,
    pub(crate) range: message::RangeSample,
    pub(crate) sighting: message::Sighting,
    pub(crate) names: Names,
}

impl Messages {
    /// Appends the message of an observation.
    pub(crate) fn encode(&mut self, observation: &Observation, bytes: &mut Vec<u8>) {
        let timestamp = Some(timestamp(observation.time()));
        match observation {
            Observation::Imu(sample) => message::ImuSample {
                timestamp,
                angular_rate_rad_s: Some(vector(&sample.angular_rate_rad_s)),
                specific_force_m_s2: Some(vector(&sample.specific_force_m_s2)),
            }
            .encode_raw(bytes),
            Observation::Acceleration(sample) => message::AccelerationSample {
                timestamp,
                specific_force_m_s2: Some(vector(&sample.specific_force_m_s2)),
            }
            .encode_raw(bytes),
            Observation::Magnetic(sample) => {
                message::MagneticSample { timestamp, field_ut: Some(vector(&sample.field_ut)) }
                    .encode_raw(bytes);
            }
            Observation::Pressure(sample) => {
                message::PressureSample { timestamp, pressure_pa: Some(sample.pressure_pa) }
                    .encode_raw(bytes);
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
            Observation::Signal(signal) => self.encode_signal(timestamp, signal, bytes),
            Observation::Range(range) => self.encode_range(timestamp, range, bytes),
            Observation::Sighting(sighting) => {
                self.sighting.timestamp = timestamp;
                refill(&mut self.sighting.reader, sighting.reader.as_str());
                self.sighting.encode_raw(bytes);
            }
        }
    }

    /// Reads the message of an observation.
    pub(crate) fn decode(&mut self, kind: ObservationKind, bytes: &[u8]) -> Result<Observation, BadMessage> {
        let observation = match kind {
            ObservationKind::Imu => Observation::Imu(decode_imu(bytes)?),
            ObservationKind::Acceleration => Observation::Acceleration(decode_acceleration(bytes)?),
            ObservationKind::Magnetic => Observation::Magnetic(decode_magnetic(bytes)?),
            ObservationKind::Pressure => Observation::Pressure(decode_pressure(bytes)?),
            ObservationKind::Fix => Observation::Fix(decode_fix(bytes)?),
            ObservationKind::Signal => Observation::Signal(self.decode_signal(bytes)?),
            ObservationKind::Range => Observation::Range(self.decode_range(bytes)?),
            ObservationKind::Sighting => {
                reread(&mut self.sighting, bytes)?;
                let reader = device(&mut self.names, &self.sighting.reader, "reader")?;
                let time = time(self.sighting.timestamp)?;
                Observation::Sighting(Sighting { time, reader })
            }
        };
        match observation.fault() {
            None => Ok(observation),
            Some((name, found, expected)) => Err(BadMessage::Unlikely(name, found, expected)),
        }
    }
}

/// Fills a text anew, in the memory that it has.
pub(crate) fn refill(text: &mut String, with: &str) {
    text.clear();
    text.push_str(with);
}

/// Reads a message in the memory that it has.
pub(crate) fn reread<M: Message>(message: &mut M, bytes: &[u8]) -> Result<(), BadMessage> {
    message.clear();
    message.merge(bytes).map_err(|e| BadMessage::Undecodable(e.to_string()))
}

/// The device of a name in a message.
pub(crate) fn device(names: &mut Names, name: &str, field: &'static str) -> Result<DeviceId, BadMessage> {
    if name.is_empty() {
        return Err(BadMessage::Missing(field));
    }
    names.device(name).ok_or_else(|| BadMessage::Name(field, crate::error::shown(name.as_bytes())))
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

fn decode_acceleration(bytes: &[u8]) -> Result<AccelerationSample, BadMessage> {
    let message: message::AccelerationSample = message(bytes)?;
    Ok(AccelerationSample {
        time: time(message.timestamp)?,
        specific_force_m_s2: checked(message.specific_force_m_s2, "specific_force_m_s2")?,
    })
}

fn decode_magnetic(bytes: &[u8]) -> Result<MagneticSample, BadMessage> {
    let message: message::MagneticSample = message(bytes)?;
    Ok(MagneticSample { time: time(message.timestamp)?, field_ut: checked(message.field_ut, "field_ut")? })
}

fn decode_pressure(bytes: &[u8]) -> Result<PressureSample, BadMessage> {
    let message: message::PressureSample = message(bytes)?;
    let pressure_pa = number(message.pressure_pa, "pressure_pa")?;
    Ok(PressureSample { time: time(message.timestamp)?, pressure_pa })
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
    Ok(PositionFix {
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
    })
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

pub(crate) fn number(value: Option<f64>, name: &'static str) -> Result<f64, BadMessage> {
    match value {
        Some(value) if value.is_finite() => Ok(value),
        Some(bad) => Err(BadMessage::NotFinite(name, bad)),
        None => Err(BadMessage::Missing(name)),
    }
}

pub(crate) fn timestamp(time: Time) -> Timestamp {
    let nanos = time.nanos();
    // The fraction counts forward from the second below, also before the origin.
    let fraction = i32::try_from(nanos.rem_euclid(NANOS_PER_SECOND)).unwrap_or_default();
    Timestamp { seconds: nanos.div_euclid(NANOS_PER_SECOND), nanos: fraction }
}

pub(crate) fn time(timestamp: Option<Timestamp>) -> Result<Time, BadMessage> {
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
