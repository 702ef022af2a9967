//! What comes in from a sensor on a foot: samples checked, the start aligned, stances found.

use super::MethodError;
use crate::inertial::alignment::{Aligned, RestAlignment};
use crate::pedestrian::stance::{Stance, StanceDetector, StanceParams};
use adit_core::time::Time;
use adit_observation::{ImuSample, MagneticSample};
use serde::{Deserialize, Serialize};

/// From the first sample to the stance of each, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct FootInput {
    site: Site,
    detector: StanceDetector,
    alignment: RestAlignment,
    aligned: bool,
    first: Option<Time>,
    latest: Option<Time>,
}

/// What the alignment needs to know.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Site {
    /// Gravity, m/s².
    pub gravity_m_s2: f64,
    /// Time at the start of the log over which the sensor is levelled, s.
    pub alignment_s: f64,
    /// Angle from true to magnetic north, positive to the east, rad.
    pub declination_rad: f64,
}

impl FootInput {
    pub fn new(stance: &StanceParams, site: Site) -> Self {
        Self {
            detector: StanceDetector::new(stance.clone(), site.gravity_m_s2),
            site,
            alignment: RestAlignment::default(),
            aligned: false,
            first: None,
            latest: None,
        }
    }

    /// Takes a reading of the magnetometer while the alignment lasts; false once it is over.
    pub fn align_with(&mut self, magnetic: &MagneticSample) -> bool {
        if !self.aligned && magnetic.is_reading() {
            self.alignment.observe_magnetic(magnetic);
        }
        !self.aligned
    }

    /// Checks a sample and hands it to alignment and detector; returns the one that is now due.
    ///
    /// `start` hears of the time of the first sample and its alignment, before the first is due.
    #[inline]
    pub fn take(
        &mut self,
        imu: &ImuSample,
        start: impl FnOnce(Time, &Aligned),
    ) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        if !imu.is_reading() {
            return Err(MethodError::NoReading { time: imu.time });
        }
        if let Some(before) = self.latest
            && imu.time <= before
        {
            return Err(MethodError::TimeNotRising { found: imu.time, before });
        }
        self.latest = Some(imu.time);
        self.detector.push(*imu);
        if !self.aligned {
            let elapsed = (imu.time - *self.first.get_or_insert(imu.time)).seconds();
            if elapsed < self.site.alignment_s {
                self.alignment.observe_imu(imu);
                return Ok(None);
            }
            self.align(start)?;
        }
        Ok(self.detector.pop())
    }

    /// A further sample that is due.
    pub fn next_due(&mut self) -> Option<(ImuSample, Stance)> {
        if self.aligned { self.detector.pop() } else { None }
    }

    /// After the last sample: those still waiting, one at a time.
    pub fn drain(
        &mut self,
        start: impl FnOnce(Time, &Aligned),
    ) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        if !self.aligned {
            self.align(start)?;
        }
        Ok(self.detector.drain())
    }

    /// Memory held by the queues, bytes.
    pub fn heap_bytes(&self) -> usize {
        self.detector.heap_bytes()
    }

    /// Levels the sensor by what it read at the start.
    fn align(&mut self, start: impl FnOnce(Time, &Aligned)) -> Result<(), MethodError> {
        let first = self.first.ok_or(MethodError::Empty)?;
        let gravity = self.site.gravity_m_s2;
        let aligned = self.alignment.align(self.site.declination_rad).ok_or(MethodError::NoForce)?;
        if aligned.at_rest {
            if !(0.5..=1.5).contains(&(aligned.force_m_s2 / gravity)) {
                return Err(MethodError::NotGravity { found: aligned.force_m_s2, expected: gravity });
            }
            self.detector.set_rest_force(aligned.force_m_s2);
        }
        self.aligned = true;
        start(first, &aligned);
        Ok(())
    }
}
