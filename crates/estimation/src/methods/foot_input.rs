//! What comes in from a sensor on a foot: samples checked, the start aligned, stances found.

use super::{MethodError, NoiseParameter};
use crate::inertial::alignment::{Aligned, RestAlignment};
use crate::pedestrian::stance::{Stance, StanceDetector, StanceParams};
use adit_core::time::Time;
use adit_observation::{ImuSample, MagneticSample};
use serde::{Deserialize, Serialize};

/// What tuning may search of every method on the foot: [`SensorNoise`](crate::inertial::filter::SensorNoise) and what the stance tells.
pub(super) const NOISE: [NoiseParameter; 12] = [
    // From a ring laser's 0.003 deg/sqrt(h) to what a foot shakes out of a clipped gyro; accelerometers from 10 µg/sqrt(Hz).
    NoiseParameter::new("noise.angle_random_walk_rad_sqrt_s", 1e-6, 5e-2),
    NoiseParameter::new("noise.rate_share_sqrt_s", 1e-5, 1e-2),
    NoiseParameter::new("noise.velocity_random_walk_m_s_sqrt_s", 1e-4, 1e-1),
    NoiseParameter::new("noise.force_share_sqrt_s", 1e-5, 5e-2),
    NoiseParameter::new("noise.gyro_bias_walk_rad_s_sqrt_s", 1e-8, 1e-3),
    NoiseParameter::new("noise.acc_bias_walk_m_s2_sqrt_s", 1e-7, 1e-2),
    // A foot on rock, and one on scree or a moving belt.
    NoiseParameter::new("zero_velocity.sigma_m_s", 1e-3, 0.5),
    NoiseParameter::new("zero_velocity.statistic_sigma_m_s", 1e-4, 0.2),
    NoiseParameter::new("zero_velocity.lever_sigma_m", 1e-3, 0.5),
    NoiseParameter::new("zero_rate.sigma_rad_s", 1e-5, 5e-2),
    NoiseParameter::new("zero_rate.rate_share", 1e-2, 10.0),
    NoiseParameter::new("rest_gravity.sigma_m_s2", 1e-3, 2.0),
];

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
