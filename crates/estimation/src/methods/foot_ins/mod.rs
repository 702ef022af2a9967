//! `foot-ins` (system S2 and beyond): a foot-mounted IMU, zero velocity in stance, nothing else.
//!
//! ```text
//! samples → stance detector (looks ahead) → strapdown → error-state filter → solution
//!                        └────── still ──────→ velocity of the contact, zero rate, gravity ──┘
//! ```
//!
//! After Kang (2023): threshold detection of stance, alignment at rest, quaternion strapdown, zero velocity as the
//! measurement of a Kalman filter. Beyond the paper: an adaptive detector ([`crate::pedestrian::stance`]), the rolling
//! foot as measurement model ([`crate::pedestrian::zero_velocity`]), sensor errors that grow with the motion
//! ([`crate::inertial::filter::SensorNoise`]), estimated biases, an innovation gate that knows the velocity of a foot
//! that is lifted slowly, and smoothing ([`smoothing`]).
//!
//! Frames: local level ENU, z up, origin at the first sample; heading by magnetometer, else the body's x axis is north.

mod foot_filter;
mod method;
mod params;
pub mod smoothing;

pub use crate::pedestrian::stance_updates::ZeroVelocityParams;
pub use foot_filter::FootFilter;
pub use params::{FootInsParams, HeadingAid, InitialSigma, RestGravityParams, ZeroRateParams};
pub use smoothing::{FixedLag, smooth};

use crate::inertial::alignment::RestAlignment;
use crate::kalman::Innovation;
use crate::methods::{MethodError, MethodWarning};
use crate::pedestrian::stance::{Stance, StanceDetector};
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_observation::{ImuSample, Observation};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "foot-ins";
/// Warnings kept in a report; later ones of a broken log are only counted by their effect.
const WARNINGS_KEPT: usize = 100;

/// Foot-mounted inertial navigation of one walker, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FootIns {
    params: FootInsParams,
    detector: StanceDetector,
    alignment: RestAlignment,
    first: Option<Time>,
    latest: Option<Time>,
    filter: Option<FootFilter>,
    report: FootInsReport,
}

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FootInsReport {
    /// IMU samples processed.
    pub samples: u64,
    /// Samples in stance.
    pub still_samples: u64,
    /// Zero-velocity updates used.
    pub accepted_updates: u64,
    /// Zero-velocity updates kept out by the gate.
    pub rejected_updates: u64,
    /// Sum of the normalised innovations squared of the used ones (3 degrees of freedom each).
    pub accepted_nis_sum: f64,
    /// True when the heading came from the magnetometer.
    pub magnetic_heading: bool,
    /// Warnings, at most the first hundred.
    pub warnings: Vec<MethodWarning>,
}

impl FootInsReport {
    /// Mean normalised innovation squared of the used updates: 3 when the filter is consistent.
    pub fn mean_nis(&self) -> Option<f64> {
        (self.accepted_updates > 0).then(|| self.accepted_nis_sum / self.accepted_updates as f64)
    }

    /// Counts what was done and stops at an estimate that is no number any more.
    #[inline]
    fn note(
        &mut self,
        time: Time,
        gap: Option<f64>,
        stance: &Stance,
        innovation: Option<&Innovation>,
        finite: bool,
    ) -> Result<(), MethodError> {
        if let Some(length_s) = gap {
            self.warn(MethodWarning::Gap { time, length_s });
        }
        self.samples += 1;
        self.still_samples += u64::from(stance.is_still());
        match innovation {
            Some(innovation) if innovation.accepted => {
                self.accepted_updates += 1;
                self.accepted_nis_sum += innovation.nis;
            }
            Some(_) => self.rejected_updates += 1,
            None => {}
        }
        if finite { Ok(()) } else { Err(MethodError::Diverged { time }) }
    }

    fn warn(&mut self, warning: MethodWarning) {
        if self.warnings.len() < WARNINGS_KEPT {
            self.warnings.push(warning);
        }
    }
}

impl FootIns {
    /// A walker of whom nothing is known yet.
    pub fn new(params: FootInsParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        Ok(Self {
            detector: StanceDetector::new(params.stance.clone(), params.gravity_m_s2),
            params,
            alignment: RestAlignment::default(),
            first: None,
            latest: None,
            filter: None,
            report: FootInsReport::default(),
        })
    }

    /// One observation in, at most one solution out, later by the look-ahead of the detector.
    ///
    /// Where samples come slower than before, more than one may be due: [`Self::next_due`] hands out the rest.
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match self.take(observation)? {
            Some((imu, stance)) => self.advance(&imu, &stance),
            None => Ok(None),
        }
    }

    /// A further solution that the observations so far make due, if any.
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        match self.filter.is_some().then(|| self.detector.pop()).flatten() {
            Some((imu, stance)) => self.advance(&imu, &stance),
            None => Ok(None),
        }
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        match self.drain()? {
            Some((imu, stance)) => self.advance(&imu, &stance),
            None => Ok(None),
        }
    }

    /// What the run did so far.
    pub fn report(&self) -> &FootInsReport {
        &self.report
    }

    /// The filter, once aligned: estimate, covariance, biases.
    pub fn filter(&self) -> Option<&FootFilter> {
        self.filter.as_ref()
    }

    /// Memory of this walker's state, bytes.
    pub fn state_bytes(&self) -> usize {
        size_of::<Self>() + self.detector.heap_bytes()
    }

    /// Checks an observation and hands it to alignment and detector; returns the sample that is now due.
    #[inline]
    fn take(&mut self, observation: &Observation) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        let imu = match observation {
            Observation::Imu(imu) => imu,
            Observation::Magnetic(magnetic) => {
                if self.filter.is_none() && magnetic.field_ut.iter().all(|v| v.is_finite()) {
                    self.alignment.observe_magnetic(magnetic);
                }
                return Ok(None);
            }
        };
        if !imu.angular_rate_rad_s.iter().chain(imu.specific_force_m_s2.iter()).all(|v| v.is_finite()) {
            return Err(MethodError::NotFinite { time: imu.time });
        }
        if let Some(before) = self.latest
            && imu.time <= before
        {
            return Err(MethodError::TimeNotRising { found: imu.time, before });
        }
        self.latest = Some(imu.time);
        self.detector.push(*imu);
        if self.filter.is_none() {
            let elapsed = (imu.time - *self.first.get_or_insert(imu.time)).seconds();
            if elapsed < self.params.alignment_s {
                self.alignment.observe_imu(imu);
                return Ok(None);
            }
            self.align()?;
        }
        Ok(self.detector.pop())
    }

    fn drain(&mut self) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        if self.filter.is_none() {
            self.align()?;
        }
        Ok(self.detector.drain())
    }

    /// Levels the sensor and starts the filter at the first sample.
    fn align(&mut self) -> Result<(), MethodError> {
        let first = self.first.ok_or(MethodError::Empty)?;
        let gravity = self.params.gravity_m_s2;
        let aligned = self.alignment.align(self.params.declination_rad).ok_or(MethodError::NoForce)?;
        if aligned.at_rest {
            if !(0.5..=1.5).contains(&(aligned.force_m_s2 / gravity)) {
                return Err(MethodError::NotGravity { found: aligned.force_m_s2, expected: gravity });
            }
            self.detector.set_rest_force(aligned.force_m_s2);
        } else {
            self.report.warn(MethodWarning::NoRestAtStart);
        }
        self.report.magnetic_heading = aligned.field.is_some();
        self.filter = Some(FootFilter::new(&self.params, first, &aligned));
        Ok(())
    }

    /// Predict, and in stance update: the method.
    #[inline]
    fn advance(&mut self, imu: &ImuSample, stance: &Stance) -> Result<Option<Solution>, MethodError> {
        let filter = self.filter.as_mut().ok_or(MethodError::Empty)?;
        let gap = filter.gap_before(imu);
        filter.predict(imu);
        let innovation = filter.correct(imu, stance, &mut ());
        let finite = filter.is_finite();
        self.report.note(imu.time, gap, stance, innovation.as_ref(), finite)?;
        Ok(Some(filter.solution()))
    }
}
