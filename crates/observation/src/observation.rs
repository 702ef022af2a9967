//! What a log holds: one [`Observation`] after the other, each of one kind of sensor.
//!
//! A further kind is a type of its own with a time, a variant here, a column group in
//! `csv_log`, a message in `proto/` and an arm in `mcap_log::schema`; order, gaps and merging know kinds only.

use crate::fix::PositionFix;
use crate::imu::{ImuSample, MagneticSample};
use crate::pressure::PressureSample;
use crate::radio::{RangeSample, Sighting, SignalStrength};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// One thing that one sensor said at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Observation {
    /// Gyro and accelerometer.
    Imu(ImuSample),
    /// Magnetometer.
    Magnetic(MagneticSample),
    /// Barometer.
    Pressure(PressureSample),
    /// A position from outside.
    Fix(PositionFix),
    /// Signal strength of a transmitter.
    Signal(SignalStrength),
    /// Distance to an anchor.
    Range(RangeSample),
    /// Seen by a reader at a portal.
    Sighting(Sighting),
}

/// The kinds of observations, in the order in which those of one time are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ObservationKind {
    /// [`Observation::Imu`].
    Imu,
    /// [`Observation::Magnetic`].
    Magnetic,
    /// [`Observation::Pressure`].
    Pressure,
    /// [`Observation::Fix`].
    Fix,
    /// [`Observation::Signal`].
    Signal,
    /// [`Observation::Range`].
    Range,
    /// [`Observation::Sighting`].
    Sighting,
}

impl Observation {
    /// When it was said.
    pub fn time(&self) -> Time {
        match self {
            Self::Imu(sample) => sample.time,
            Self::Magnetic(sample) => sample.time,
            Self::Pressure(sample) => sample.time,
            Self::Fix(fix) => fix.time,
            Self::Signal(signal) => signal.time,
            Self::Range(range) => range.time,
            Self::Sighting(sighting) => sighting.time,
        }
    }

    /// Of what kind it is.
    pub fn kind(&self) -> ObservationKind {
        match self {
            Self::Imu(_) => ObservationKind::Imu,
            Self::Magnetic(_) => ObservationKind::Magnetic,
            Self::Pressure(_) => ObservationKind::Pressure,
            Self::Fix(_) => ObservationKind::Fix,
            Self::Signal(_) => ObservationKind::Signal,
            Self::Range(_) => ObservationKind::Range,
            Self::Sighting(_) => ObservationKind::Sighting,
        }
    }
}

impl ObservationKind {
    /// How many there are.
    pub const COUNT: usize = 7;
    /// All of them.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Imu, Self::Magnetic, Self::Pressure, Self::Fix, Self::Signal, Self::Range, Self::Sighting];
}
