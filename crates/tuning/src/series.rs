//! Readings of one sensor in order of time.

use crate::error::TuningError;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;

/// Readings of a three-axis sensor, sensor axes, each with its time; 32 bytes a reading.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    times: Vec<Time>,
    readings: Vec<Vector3<f64>>,
}

impl Series {
    /// Adds a reading; its time must come after the one before.
    pub fn push(&mut self, time: Time, reading: Vector3<f64>) -> Result<(), TuningError> {
        if let Some(before) = self.times.last()
            && time <= *before
        {
            return Err(TuningError::TimeNotRising { found: time, before: *before });
        }
        if !reading.iter().all(|v| v.is_finite()) {
            return Err(TuningError::NotFinite { time });
        }
        self.times.push(time);
        self.readings.push(reading);
        Ok(())
    }

    /// Number of readings.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Times, rising.
    pub fn times(&self) -> &[Time] {
        &self.times
    }

    /// Readings, in order of time.
    pub fn readings(&self) -> &[Vector3<f64>] {
        &self.readings
    }

    /// From the first reading to the last, s.
    pub fn duration_s(&self) -> f64 {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) => (*last - *first).seconds(),
            _ => 0.0,
        }
    }

    /// Times in seconds from `origin`.
    pub(crate) fn seconds_from(&self, origin: Time) -> Vec<f64> {
        self.times.iter().map(|time| (*time - origin).seconds()).collect()
    }
}
