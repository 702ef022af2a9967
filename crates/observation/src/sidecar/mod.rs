//! The sidecar of a log: how the sensor was mounted, what its signs mean, how much noise it has.
//!
//! A TOML file beside the log: `walk_imu.csv.gz` has `walk_imu.toml` or `walk_imu.csv.gz.toml` (both at once is an
//! error). Everything in it is optional; a name that is not known is an error.
//!
//! ```toml
//! rate_hz = 200.0                        # nominal rate of the inertial samples
//!
//! [mounting]
//! location = "foot"                      # foot, shank, thigh, waist, chest, head, wrist, hand, pocket, bag, vehicle, other
//! rotation = "x-forward, y-right, z-down"  # where each axis of the sensor points on the body
//! # rotation = [0.0, 1.0, 0.0, 0.0]      # or a quaternion w, x, y, z that turns sensor into body coordinates
//! # rotation = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]   # or the matrix that does
//!
//! [frame]
//! acceleration = "specific-force"        # up at rest; "gravity" for logs in which it points down at rest
//! magnetic_declination_deg = 3.2         # east positive, where the walk was made
//!
//! [noise]                                # one-sided densities, as in a data sheet; all four or none
//! angle_random_walk_rad_sqrt_s = 8.7e-5
//! velocity_random_walk_m_s_sqrt_s = 9.8e-4
//! gyro_bias_walk_rad_s_sqrt_s = 1e-6
//! acc_bias_walk_m_s2_sqrt_s = 1e-5
//!
//! [magnetometer]                         # field = matrix · (reading − offset), sensor axes
//! offset_ut = [-0.6, -10.5, 2.0]         # hard iron
//! matrix = [[1.05, 0.01, 0.0], [0.01, 0.98, 0.0], [0.0, 0.0, 1.02]]   # soft iron, scale, axes of the inertial sensor
//!
//! [magnetic_field]                       # the undisturbed field of the site
//! norm_ut = 49.6
//! dip_deg = 67.1                         # below the horizontal
//!
//! [site]                                 # origin of the level frame of position fixes and solutions
//! latitude_deg = 45.7
//! longitude_deg = 121.3833
//! height_m = -320.0                      # above the ellipsoid; 0 when left out
//!
//! [start]                                # pose at the first inertial sample, as somebody told it
//! position_m = [12.5, -30.0]             # east, north
//! position_sigma_m = [2.0, 2.0]
//! heading_deg = 91.0                     # of the body's x axis, clockwise from north
//! pitch_deg = 0.0                        # of the same axis, above the horizon; 0 when left out
//! roll_deg = 0.0                         # left side up; 0 when left out
//! attitude_sigma_deg = 0.6
//! ```
//!
//! The body frame is x forward, y left, z up. The log reader applies `rotation`, `acceleration` and `[magnetometer]` to
//! every sample, the calibration before the rotation; without them a sample passes bit for bit. [`SidecarEdit`] writes what
//! a calibration has found.

mod edit;
mod magnetometer;
mod rotation;
mod start;

pub use edit::SidecarEdit;
pub use magnetometer::{MagneticFieldReference, MagnetometerCalibration};
pub use rotation::MountingRotation;

use crate::error::{At, LogError, Place};
use crate::imu::ImuSpecification;
use crate::observation::Observation;
use crate::start::{Site, StartPose};
use adit_core::nalgebra::Vector3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A sidecar is a page, not a log.
const LARGEST: u64 = 1 << 16;

/// What is known about a log beside its numbers.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sidecar {
    /// Nominal rate of the inertial samples, Hz.
    #[serde(default, deserialize_with = "positive")]
    pub rate_hz: Option<f64>,
    /// Where and how the sensor sits.
    #[serde(default)]
    pub mounting: Mounting,
    /// What the signs mean, and where north is.
    #[serde(default)]
    pub frame: Frame,
    /// Noise of the inertial sensor.
    #[serde(default, deserialize_with = "noise")]
    pub noise: Option<ImuSpecification>,
    /// Hard and soft iron of the magnetometer.
    #[serde(default)]
    pub magnetometer: Option<MagnetometerCalibration>,
    /// The undisturbed field where the log was made.
    #[serde(default)]
    pub magnetic_field: MagneticFieldReference,
    /// Origin of the level frame.
    #[serde(default, deserialize_with = "start::site")]
    pub site: Option<Site>,
    /// Pose at the first inertial sample.
    #[serde(default, deserialize_with = "start::pose")]
    pub start: Option<StartPose>,
}

/// Where and how the sensor sits.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mounting {
    /// Part of the body.
    pub location: Option<Location>,
    /// Sensor to body axes.
    pub rotation: Option<MountingRotation>,
}

/// Where the sensor sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the names are their own explanation")]
pub enum Location {
    Foot,
    Shank,
    Thigh,
    Waist,
    Chest,
    Head,
    Wrist,
    Hand,
    Pocket,
    Bag,
    Vehicle,
    Other,
}

impl Location {
    /// As written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Foot => "foot",
            Self::Shank => "shank",
            Self::Thigh => "thigh",
            Self::Waist => "waist",
            Self::Chest => "chest",
            Self::Head => "head",
            Self::Wrist => "wrist",
            Self::Hand => "hand",
            Self::Pocket => "pocket",
            Self::Bag => "bag",
            Self::Vehicle => "vehicle",
            Self::Other => "other",
        }
    }
}

/// What the signs mean, and where north is.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Sign of the accelerometer.
    #[serde(default)]
    pub acceleration: AccelerationSign,
    /// Angle from true to magnetic north, east positive, deg.
    #[serde(default, deserialize_with = "finite")]
    pub magnetic_declination_deg: Option<f64>,
}

/// What an accelerometer at rest reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AccelerationSign {
    /// Specific force: up.
    #[default]
    SpecificForce,
    /// Gravity: down, as iOS reports it.
    Gravity,
}

impl Sidecar {
    /// Parses a sidecar; `file` is for messages.
    pub fn parse(file: &Arc<Path>, text: &[u8]) -> Result<Self, LogError> {
        let line_at = |byte: usize| {
            let before = text.get(..byte).unwrap_or(text);
            before.split(|b| *b == b'\n').count() as u64
        };
        let text = std::str::from_utf8(text).map_err(|error| LogError::Sidecar {
            place: Place::line(file, line_at(error.valid_up_to())),
            what: "not UTF-8 text".to_owned(),
        })?;
        toml::from_str(text).map_err(|error| {
            let at = error.span().map_or(At::File, |span| At::Line(line_at(span.start)));
            // One line: the parser adds hints on lines of their own.
            let what = error.message().lines().collect::<Vec<_>>().join("; ");
            LogError::Sidecar { place: Place::new(file, at), what }
        })
    }

    /// The sidecar of a log, where there is one.
    pub fn beside(log: &Path) -> Result<Option<(PathBuf, Self)>, LogError> {
        let mut found: Option<PathBuf> = None;
        for candidate in candidates(log) {
            if !candidate.is_file() {
                continue;
            }
            if let Some(other) = found {
                let what = format!("this log has two sidecars, the other is {}", other.display());
                return Err(LogError::Sidecar { place: Place::file(candidate), what });
            }
            found = Some(candidate);
        }
        found.map(|path| Self::read(&path).map(|sidecar| (path, sidecar))).transpose()
    }

    /// Reads a sidecar file.
    pub fn read(path: &Path) -> Result<Self, LogError> {
        let io = |source| LogError::Io { file: path.to_path_buf(), doing: "read it", source };
        let file = std::fs::File::open(path).map_err(io)?;
        Self::parse(&Arc::from(path), &text_of(path, file)?)
    }

    /// True when [`Self::apply`] changes nothing.
    pub fn leaves_samples_alone(&self) -> bool {
        self.mounting.rotation.is_none()
            && self.frame.acceleration == AccelerationSign::SpecificForce
            && self.magnetometer.is_none()
    }

    /// A sample as the sensor gave it, turned into body axes and into specific force.
    #[must_use]
    pub fn apply(&self, observation: Observation) -> Observation {
        let turn =
            |v: Vector3<f64>| self.mounting.rotation.as_ref().map_or(v, |rotation| rotation.matrix() * v);
        let force = |v| match self.frame.acceleration {
            AccelerationSign::SpecificForce => turn(v),
            AccelerationSign::Gravity => -turn(v),
        };
        match observation {
            Observation::Imu(mut sample) => {
                sample.angular_rate_rad_s = turn(sample.angular_rate_rad_s);
                sample.specific_force_m_s2 = force(sample.specific_force_m_s2);
                Observation::Imu(sample)
            }
            Observation::Acceleration(mut sample) => {
                sample.specific_force_m_s2 = force(sample.specific_force_m_s2);
                Observation::Acceleration(sample)
            }
            Observation::Magnetic(mut sample) => {
                let field_ut = self.magnetometer.map_or(sample.field_ut, |m| m.field_ut(&sample.field_ut));
                sample.field_ut = turn(field_ut);
                Observation::Magnetic(sample)
            }
            // What has no axes: the mounting does not matter.
            other => other,
        }
    }
}

/// The bytes of a sidecar, as many as one can have.
fn text_of(path: &Path, file: std::fs::File) -> Result<Vec<u8>, LogError> {
    let mut text = Vec::new();
    file.take(LARGEST + 1).read_to_end(&mut text).map_err(|source| LogError::Io {
        file: path.to_path_buf(),
        doing: "read it",
        source,
    })?;
    if text.len() as u64 > LARGEST {
        let what = format!("longer than {LARGEST} bytes: not a sidecar");
        return Err(LogError::Sidecar { place: Place::file(path), what });
    }
    Ok(text)
}

/// `walk_imu.csv.gz` → `walk_imu.csv.gz.toml`, `walk_imu.toml`.
fn candidates(log: &Path) -> Vec<PathBuf> {
    let Some(full) = log.file_name().and_then(|n| n.to_str()) else { return Vec::new() };
    let unpacked = full.strip_suffix(".gz").unwrap_or(full);
    let stem = unpacked.rsplit_once('.').map_or(unpacked, |(stem, _)| stem);
    let mut names = vec![log.with_file_name(format!("{full}.toml"))];
    let short = log.with_file_name(format!("{stem}.toml"));
    if short != log && !names.contains(&short) {
        names.push(short);
    }
    names
}

pub(crate) fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let value = f64::deserialize(deserializer)?;
    if value > 0.0 && value.is_finite() {
        return Ok(Some(value));
    }
    Err(D::Error::custom(format!("found {value}, expected a number above 0")))
}

pub(crate) fn finite<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let value = f64::deserialize(deserializer)?;
    if value.is_finite() {
        return Ok(Some(value));
    }
    Err(D::Error::custom(format!("found {value}, expected a finite number")))
}

fn noise<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<ImuSpecification>, D::Error> {
    let noise = ImuSpecification::deserialize(deserializer)?;
    let densities = [
        noise.angle_random_walk_rad_sqrt_s,
        noise.velocity_random_walk_m_s_sqrt_s,
        noise.gyro_bias_walk_rad_s_sqrt_s,
        noise.acc_bias_walk_m_s2_sqrt_s,
    ];
    match densities.into_iter().find(|d| !d.is_finite() || *d < 0.0) {
        Some(bad) => Err(D::Error::custom(format!("found {bad}, expected densities of zero or more"))),
        None => Ok(Some(noise)),
    }
}
