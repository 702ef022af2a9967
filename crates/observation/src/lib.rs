//! What a sensor said, when, and how well.
//!
//! The types ([`Observation`], [`ImuSample`], …) are `no_std`. With the feature `std` (default) this room also reads
//! and writes the files they travel in:
//!
//! | file | module | in | out |
//! |---|---|---|---|
//! | log as CSV with units in the header, plain or gzip | [`csv_log`] | yes | yes |
//! | log as MCAP with protobuf schemas | [`mcap_log`] | yes | yes |
//! | sidecar of a log: mounting, frames, noise, calibration | [`sidecar`] | yes | yes |
//! | trajectory as TUM text | [`tum`] | yes | yes |
//! | truth as CSV | [`truth`] | yes | – |
//! | radio survey, list of transmitters as CSV | [`survey`] | yes | – |
//! | solutions with covariance as CSV | [`solution_csv`] | yes | yes |
//! | packets of gateways, protobuf | [`wire`] | yes | yes |
//!
//! Whoever wants observations calls [`open`], which tells the format by content, applies the sidecar and checks
//! order and units on the way:
//!
//! ```no_run
//! # fn main() -> Result<(), adit_observation::LogError> {
//! let mut log = adit_observation::open("walk_imu.csv.gz")?;
//! for observation in log.by_ref() {
//!     println!("{}", observation?.time());
//! }
//! for warning in log.warnings() {
//!     eprintln!("{warning}");
//! }
//! # Ok(())
//! # }
//! ```
//!
//! A calibration, which wants what each sensor said before any sidecar, reads [`SensorRows`].
//!
//! Parsers take any [`std::io::Read`] and do no other I/O; every file is written beside its target and renamed when
//! complete, so that none is ever left half written.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod device;
mod fix;
mod imu;
mod observation;
mod pressure;
mod radio;
mod start;

#[cfg(feature = "std")]
pub mod csv_log;
#[cfg(feature = "std")]
mod error;
#[cfg(feature = "std")]
pub mod files;
#[cfg(feature = "std")]
mod log;
#[cfg(feature = "std")]
pub mod mcap_log;
#[cfg(feature = "std")]
mod names;
#[cfg(feature = "std")]
pub mod order;
#[cfg(feature = "std")]
pub mod plausibility;
#[cfg(feature = "std")]
mod protobuf;
#[cfg(feature = "std")]
mod sensor_rows;
#[cfg(feature = "std")]
pub mod sidecar;
#[cfg(feature = "std")]
pub mod solution_csv;
#[cfg(feature = "std")]
mod source;
#[cfg(feature = "std")]
pub mod survey;
#[cfg(feature = "std")]
pub mod truth;
#[cfg(feature = "std")]
pub mod tum;
#[cfg(feature = "std")]
mod warning;
#[cfg(feature = "std")]
pub mod wire;

pub use device::DeviceId;
#[cfg(feature = "std")]
pub use error::{At, LogError, Place};
pub use fix::{FixSource, HeightFix, PositionFix};
pub use imu::{AccelerationSample, ImuSample, ImuSpecification, MagneticSample};
#[cfg(feature = "std")]
pub use log::{LogKind, LogReader, ReadOptions, open, open_with};
pub use observation::{Observation, ObservationKind};
pub use pressure::PressureSample;
pub use radio::{ImpulseResponse, InTheWay, Radio, RangeSample, Reception, Sighting, SignalStrength};
#[cfg(feature = "std")]
pub use sensor_rows::SensorRows;
#[cfg(feature = "std")]
pub use source::LogSource;
pub use start::{Site, StartPose};
#[cfg(feature = "std")]
pub use warning::{LogWarning, Warnings};
