//! `ahrs`: which way a tag is turned, wherever it is worn; nothing is said of its position.
//!
//! The estimator is [`crate::attitude`]; here it is driven by a log: alignment over the first moments, one solution for
//! every inertial sample, gaps, and the whole-log smoother ([`smoothing`]).
//!
//! Frames: body to ENU, z up; heading by magnetometer, else the body's x axis is north at the start.

mod method;
pub mod smoothing;

pub use method::AhrsReport;
pub use smoothing::smooth;

use crate::attitude::smoother::Recorder;
use crate::attitude::state::ATTITUDE;
use crate::attitude::{AttitudeFilter, AttitudeParams};
use crate::inertial::alignment::RestAlignment;
use crate::methods::{MethodError, MethodWarning};
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_observation::Observation;
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "ahrs";
/// Observations held for the alignment at most: a sensor faster than this aligns over less time.
const MOST_HELD: usize = 4096;

/// Settings of [`Ahrs`].
pub type AhrsParams = AttitudeParams;

/// Attitude of one tag, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Ahrs {
    params: AhrsParams,
    /// Observations until the alignment, and then those not yet worked off.
    held: VecDeque<Observation>,
    alignment: RestAlignment,
    first: Option<Time>,
    latest: Option<Time>,
    filter: Option<AttitudeFilter>,
    /// Time of the last sample that went through the filter.
    time: Option<Time>,
    report: AhrsReport,
}

impl Ahrs {
    /// A tag of which nothing is known yet.
    pub fn new(params: AhrsParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        Ok(Self {
            params,
            held: VecDeque::new(),
            alignment: RestAlignment::default(),
            first: None,
            latest: None,
            filter: None,
            time: None,
            report: AhrsReport::default(),
        })
    }

    /// One observation in, at most one solution out; those of the first moments come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        self.observe_with(observation, &mut ())
    }

    /// A further solution that the observations so far make due, if any.
    #[inline]
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        if self.filter.is_none() || self.held.is_empty() { Ok(None) } else { self.work_off(&mut ()) }
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        if self.filter.is_none() {
            self.align()?;
        }
        self.work_off(&mut ())
    }

    /// What the run did so far.
    pub fn report(&self) -> &AhrsReport {
        &self.report
    }

    /// The estimator, once aligned.
    pub fn filter(&self) -> Option<&AttitudeFilter> {
        self.filter.as_ref()
    }

    fn observe_with(
        &mut self,
        observation: &Observation,
        recorder: &mut impl AhrsRecorder,
    ) -> Result<Option<Solution>, MethodError> {
        let finite = |v: &Vector3<f64>| v.iter().all(|v| v.is_finite());
        match observation {
            Observation::Imu(imu) => {
                if !finite(&imu.angular_rate_rad_s) || !finite(&imu.specific_force_m_s2) {
                    return Err(MethodError::NotFinite { time: imu.time });
                }
                if let Some(before) = self.latest
                    && imu.time <= before
                {
                    return Err(MethodError::TimeNotRising { found: imu.time, before });
                }
                self.latest = Some(imu.time);
            }
            Observation::Magnetic(magnetic) if !finite(&magnetic.field_ut) => return Ok(None),
            Observation::Magnetic(_) => {}
        }
        if self.filter.is_some() && self.held.is_empty() {
            return self.advance(observation, recorder);
        }
        self.held.push_back(*observation);
        if self.filter.is_none() {
            match observation {
                Observation::Imu(imu) => self.alignment.observe_imu(imu),
                Observation::Magnetic(magnetic) => self.alignment.observe_magnetic(magnetic),
            }
            let elapsed_s = (observation.time() - *self.first.get_or_insert(observation.time())).seconds();
            if elapsed_s < self.params.interval_s && self.held.len() < MOST_HELD {
                return Ok(None);
            }
            self.align()?;
        }
        self.work_off(recorder)
    }

    /// Levels the tag with all that is held.
    fn align(&mut self) -> Result<(), MethodError> {
        if self.latest.is_none() {
            return Err(MethodError::Empty);
        }
        let aligned = self.alignment.align(self.params.declination_rad).ok_or(MethodError::NoForce)?;
        if aligned.at_rest && !(0.5..=1.5).contains(&(aligned.force_m_s2 / self.params.gravity_m_s2)) {
            let (found, expected) = (aligned.force_m_s2, self.params.gravity_m_s2);
            return Err(MethodError::NotGravity { found, expected });
        }
        self.filter = Some(AttitudeFilter::new(&self.params, aligned.attitude));
        Ok(())
    }

    /// Takes what is held up to the next inertial sample.
    fn work_off(&mut self, recorder: &mut impl AhrsRecorder) -> Result<Option<Solution>, MethodError> {
        while let Some(observation) = self.held.pop_front() {
            if let Some(solution) = self.advance(&observation, recorder)? {
                return Ok(Some(solution));
            }
        }
        Ok(None)
    }

    /// Propagate, and once an interval correct: the method.
    #[inline]
    fn advance(
        &mut self,
        observation: &Observation,
        recorder: &mut impl AhrsRecorder,
    ) -> Result<Option<Solution>, MethodError> {
        let Some(filter) = self.filter.as_mut() else { return Err(MethodError::Empty) };
        match observation {
            Observation::Magnetic(magnetic) => {
                // A field before the first inertial sample belongs to it.
                let lead_s = self.time.map_or(0.0, |time| (magnetic.time - time).seconds());
                if lead_s.abs() <= self.params.gap_s {
                    filter.add_field(&magnetic.field_ut, lead_s);
                }
                Ok(None)
            }
            Observation::Imu(imu) => {
                let interval_s = self.time.map_or(0.0, |time| (imu.time - time).seconds());
                self.time = Some(imu.time);
                if interval_s > self.params.gap_s {
                    if filter.pending_s() > 0.0 {
                        correct(filter, recorder);
                    }
                    filter.cross_gap(interval_s);
                    recorder.gap();
                    recorder.sample();
                    self.report.warn(MethodWarning::Gap { time: imu.time, length_s: interval_s });
                } else {
                    recorder.sample();
                    if filter.propagate(&imu.angular_rate_rad_s, &imu.specific_force_m_s2, interval_s) {
                        correct(filter, recorder);
                    }
                }
                self.report.note(filter);
                let solution = solution(imu.time, filter);
                if solution.attitude.coords.iter().all(|v| v.is_finite()) {
                    Ok(Some(solution))
                } else {
                    Err(MethodError::Diverged { time: imu.time })
                }
            }
        }
    }
}

/// A [`Recorder`] that also hears of samples, intervals and gaps.
trait AhrsRecorder: Recorder {
    /// The next sample is being taken.
    fn sample(&mut self) {}
    /// An interval ends with the last sample, which the filter has not corrected yet.
    fn interval_ends(&mut self, _filter: &AttitudeFilter) {}
    /// Now it has.
    fn corrected(&mut self, _filter: &AttitudeFilter) {}
    /// Samples are missing after the last interval.
    fn gap(&mut self) {}
}

impl AhrsRecorder for () {}

#[inline]
fn correct(filter: &mut AttitudeFilter, recorder: &mut impl AhrsRecorder) {
    recorder.interval_ends(filter);
    filter.correct(recorder);
    recorder.corrected(filter);
}

/// Attitude with its covariance; position and velocity are not estimated and stand at zero.
#[inline]
fn solution(time: Time, filter: &AttitudeFilter) -> Solution {
    let mut covariance = SolutionCovariance::zeros();
    covariance.fixed_view_mut::<3, 3>(6, 6).copy_from(filter.covariance().block(ATTITUDE, ATTITUDE));
    let held = filter.is_magnetic() && !filter.is_disturbed();
    Solution {
        time,
        position_m: Vector3::zeros(),
        velocity_m_s: Vector3::zeros(),
        attitude: filter.state().attitude,
        covariance,
        quality: if held { Quality::Fixed } else { Quality::DeadReckoning },
    }
}
