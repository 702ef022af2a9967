//! What comes out of a simulation: one sample after the other, each with its truth.

use crate::marg::MagneticTruth;
use crate::pressure::PressureTruth;
use crate::radio::delivery::Stamped;
use crate::radio::{RangeOutcome, RangeTruth};
use crate::scenario::TruthState;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::{
    ImuSample, MagneticSample, Observation, PositionFix, PressureSample, RangeSample, Sighting,
    SignalStrength,
};

/// One sample with its truth.
#[derive(Debug, Clone, PartialEq)]
pub enum Emission {
    /// Gyro and accelerometer.
    Imu(ImuSample, TruthState),
    /// Magnetometer.
    Magnetic(MagneticSample, MagneticTruth),
    /// Barometer.
    Pressure(PressureSample, PressureTruth),
    /// A position from outside, and the true one, level frame, m.
    Fix(PositionFix, Vector3<f64>),
    /// Signal strength.
    Signal(SignalStrength),
    /// Distance to an anchor.
    Range(RangeSample, RangeTruth),
    /// Seen at a portal.
    Sighting(Sighting),
}

impl Emission {
    /// The sample alone.
    pub fn observation(&self) -> Observation {
        match self {
            Self::Imu(sample, _) => Observation::Imu(*sample),
            Self::Magnetic(sample, _) => Observation::Magnetic(*sample),
            Self::Pressure(sample, _) => Observation::Pressure(*sample),
            Self::Fix(fix, _) => Observation::Fix(*fix),
            Self::Signal(signal) => Observation::Signal(signal.clone()),
            Self::Range(range, _) => Observation::Range(range.clone()),
            Self::Sighting(sighting) => Observation::Sighting(sighting.clone()),
        }
    }
}

impl Stamped for Emission {
    fn time(&self) -> Time {
        match self {
            Self::Imu(sample, _) => sample.time,
            Self::Magnetic(sample, _) => sample.time,
            Self::Pressure(sample, _) => sample.time,
            Self::Fix(fix, _) => fix.time,
            Self::Signal(signal) => signal.time,
            Self::Range(range, _) => range.time,
            Self::Sighting(sighting) => sighting.time,
        }
    }

    fn stamped(mut self, stamp: Time) -> Self {
        let time = match &mut self {
            Self::Imu(sample, _) => &mut sample.time,
            Self::Magnetic(sample, _) => &mut sample.time,
            Self::Pressure(sample, _) => &mut sample.time,
            Self::Fix(fix, _) => &mut fix.time,
            Self::Signal(signal) => &mut signal.time,
            Self::Range(range, _) => &mut range.time,
            Self::Sighting(sighting) => &mut sighting.time,
        };
        *time = stamp;
        self
    }
}

impl From<RangeOutcome> for Emission {
    fn from(outcome: RangeOutcome) -> Self {
        Self::Range(outcome.sample, outcome.truth)
    }
}
