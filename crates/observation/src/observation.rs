//! What a log holds: one [`Observation`] after the other, each of one kind of sensor.
//!
//! A further kind (signal strength, range, pressure) is a type of its own with a time, a variant here, a column group in
//! `csv_log`, a message in `proto/` and an arm in `mcap_log::schema`; order, gaps and merging know kinds only.

use crate::fix::PositionFix;
use crate::imu::{ImuSample, MagneticSample};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// One thing that one sensor said at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Observation {
    /// Gyro and accelerometer.
    Imu(ImuSample),
    /// Magnetometer.
    Magnetic(MagneticSample),
    /// A position from outside.
    Fix(PositionFix),
}

/// The kinds of observations, in the order in which those of one time are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ObservationKind {
    /// [`Observation::Imu`].
    Imu,
    /// [`Observation::Magnetic`].
    Magnetic,
    /// [`Observation::Fix`].
    Fix,
}

impl Observation {
    /// When it was said.
    pub fn time(&self) -> Time {
        match self {
            Self::Imu(sample) => sample.time,
            Self::Magnetic(sample) => sample.time,
            Self::Fix(fix) => fix.time,
        }
    }

    /// Of what kind it is.
    pub fn kind(&self) -> ObservationKind {
        match self {
            Self::Imu(_) => ObservationKind::Imu,
            Self::Magnetic(_) => ObservationKind::Magnetic,
            Self::Fix(_) => ObservationKind::Fix,
        }
    }
}

impl ObservationKind {
    /// How many there are.
    pub const COUNT: usize = 3;
    /// All of them.
    pub const ALL: [Self; Self::COUNT] = [Self::Imu, Self::Magnetic, Self::Fix];
}
