//! What a log holds: one [`Observation`] after the other, each of one kind of sensor.
//!
//! A further kind is a type of its own with a time and a `fault()`, a variant here, a column group in
//! `csv_log`, a message in `proto/` and an arm in `mcap_log::messages`; order, gaps and merging know kinds only.

use crate::fix::PositionFix;
use crate::imu::{AccelerationSample, ImuSample, MagneticSample};
use crate::pressure::PressureSample;
use crate::radio::{RangeSample, Sighting, SignalStrength};
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// One thing that one sensor said at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Observation {
    /// Gyro and accelerometer.
    Imu(ImuSample),
    /// Accelerometer without a gyro.
    Acceleration(AccelerationSample),
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ObservationKind {
    /// [`Observation::Imu`].
    Imu,
    /// [`Observation::Acceleration`].
    Acceleration,
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
            Self::Acceleration(sample) => sample.time,
            Self::Magnetic(sample) => sample.time,
            Self::Pressure(sample) => sample.time,
            Self::Fix(fix) => fix.time,
            Self::Signal(signal) => signal.time,
            Self::Range(range) => range.time,
            Self::Sighting(sighting) => sighting.time,
        }
    }

    /// The same, said at another time.
    #[must_use]
    pub fn at(mut self, time: Time) -> Self {
        *match &mut self {
            Self::Imu(sample) => &mut sample.time,
            Self::Acceleration(sample) => &mut sample.time,
            Self::Magnetic(sample) => &mut sample.time,
            Self::Pressure(sample) => &mut sample.time,
            Self::Fix(fix) => &mut fix.time,
            Self::Signal(signal) => &mut signal.time,
            Self::Range(range) => &mut range.time,
            Self::Sighting(sighting) => &mut sighting.time,
        } = time;
        self
    }

    /// Of what kind it is.
    pub fn kind(&self) -> ObservationKind {
        match self {
            Self::Imu(_) => ObservationKind::Imu,
            Self::Acceleration(_) => ObservationKind::Acceleration,
            Self::Magnetic(_) => ObservationKind::Magnetic,
            Self::Pressure(_) => ObservationKind::Pressure,
            Self::Fix(_) => ObservationKind::Fix,
            Self::Signal(_) => ObservationKind::Signal,
            Self::Range(_) => ObservationKind::Range,
            Self::Sighting(_) => ObservationKind::Sighting,
        }
    }

    /// What cannot be right, if anything: (name of the quantity, its value, what is expected).
    ///
    /// Every value of an inertial or magnetic sample that is finite may be one; a sighting has none.
    pub fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        let vectors = match self {
            Self::Imu(sample) => [
                ("angular_rate_rad_s", &sample.angular_rate_rad_s),
                ("specific_force_m_s2", &sample.specific_force_m_s2),
            ],
            Self::Acceleration(sample) => [("specific_force_m_s2", &sample.specific_force_m_s2); 2],
            Self::Magnetic(sample) => [("field_ut", &sample.field_ut); 2],
            Self::Pressure(sample) => return sample.fault(),
            Self::Fix(fix) => return fix.fault(),
            Self::Signal(signal) => return signal.fault(),
            Self::Range(range) => return range.fault(),
            Self::Sighting(_) => return None,
        };
        let odd = |(name, vector): (&'static str, &Vector3<f64>)| {
            let odd = vector.iter().find(|value| !value.is_finite())?;
            Some((name, *odd, "a finite number"))
        };
        vectors.into_iter().find_map(odd)
    }
}

impl ObservationKind {
    /// How many there are.
    pub const COUNT: usize = 8;
    /// All of them.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Imu,
        Self::Acceleration,
        Self::Magnetic,
        Self::Pressure,
        Self::Fix,
        Self::Signal,
        Self::Range,
        Self::Sighting,
    ];

    /// Whether the tag itself says it, by its own clock and in order; the others come by radio, and may come late.
    pub const fn is_wired(self) -> bool {
        matches!(self, Self::Imu | Self::Acceleration | Self::Magnetic | Self::Pressure)
    }
}
