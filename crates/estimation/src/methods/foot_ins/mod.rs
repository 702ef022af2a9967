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

use crate::inertial::alignment::Aligned;
use crate::kalman::Innovation;
use crate::methods::foot_input::FootInput;
use crate::methods::{MethodError, MethodWarning};
use crate::pedestrian::stance::Stance;
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
    input: FootInput,
    filter: Option<FootFilter>,
    /// Whether the foot stood at the last sample.
    still: bool,
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
            input: FootInput::new(&params.stance, params.site()),
            params,
            filter: None,
            still: false,
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
        match self.input.next_due() {
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

    /// Whether the foot stood at the sample of the last solution, and the time since the one before, s.
    pub(crate) fn last_sample(&self) -> (bool, f64) {
        (self.still, self.filter.as_ref().map_or(0.0, FootFilter::interval_s))
    }

    /// What led here is no longer corrected, but by whom the way from here on is handed to: else the velocity of a foot that stands moves the place
    /// by what it seems to tell of the heading, over the whole way since the start.
    pub(crate) fn set_origin(&mut self) {
        if let Some(filter) = &mut self.filter {
            filter.set_origin();
        }
    }

    /// Memory of this walker's state, bytes.
    pub fn state_bytes(&self) -> usize {
        size_of::<Self>() + self.input.heap_bytes()
    }

    /// Hands an observation on; returns the sample that is now due.
    #[inline]
    fn take(&mut self, observation: &Observation) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        let Self { params, input, filter, report, .. } = self;
        match observation {
            Observation::Imu(imu) => input.take(imu, start(params, filter, report)),
            Observation::Magnetic(magnetic) => {
                input.align_with(magnetic);
                Ok(None)
            }
            _ => Ok(None),
        }
    }

    fn drain(&mut self) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        let Self { params, input, filter, report, .. } = self;
        input.drain(start(params, filter, report))
    }

    /// Predict, and in stance update: the method.
    #[inline]
    fn advance(&mut self, imu: &ImuSample, stance: &Stance) -> Result<Option<Solution>, MethodError> {
        let filter = self.filter.as_mut().ok_or(MethodError::Empty)?;
        let gap = filter.gap_before(imu);
        filter.predict(imu);
        let innovation = filter.correct(imu, stance, &mut ());
        let finite = filter.is_finite();
        self.still = stance.is_still();
        self.report.note(imu.time, gap, stance, innovation.as_ref(), finite)?;
        Ok(Some(filter.solution()))
    }
}

/// Starts the filter at the first sample.
fn start(
    params: &FootInsParams,
    filter: &mut Option<FootFilter>,
    report: &mut FootInsReport,
) -> impl FnOnce(Time, &Aligned) {
    |first, aligned| {
        if !aligned.at_rest {
            report.warn(MethodWarning::NoRestAtStart);
        }
        report.magnetic_heading = aligned.field.is_some();
        *filter = Some(FootFilter::new(params, first, aligned));
    }
}
