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
    /// Observations not yet worked off: those that alignment waits for, or for which nobody has asked yet.
    held: VecDeque<Observation>,
    /// Time of the last inertial sample taken in, and of the last that went through the filter.
    latest: Option<Time>,
    time: Option<Time>,
    filter: Option<AttitudeFilter>,
    report: AhrsReport,
}

impl Ahrs {
    /// A tag of which nothing is known yet.
    pub fn new(params: AhrsParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        let (held, report) = (VecDeque::new(), AhrsReport::default());
        Ok(Self { params, held, latest: None, time: None, filter: None, report })
    }

    /// One observation in, at most one solution out; those of the first moments come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        let due = self.observe_with(observation, &mut ())?;
        Ok(due.and_then(|time| self.solution(time)))
    }

    /// A further solution that the observations so far make due, if any.
    #[inline]
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        let due = self.next_due_with(&mut ())?;
        Ok(due.and_then(|time| self.solution(time)))
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        let due = self.finish_next_with(&mut ())?;
        Ok(due.and_then(|time| self.solution(time)))
    }

    /// What the run did so far.
    pub fn report(&self) -> &AhrsReport {
        &self.report
    }

    /// The estimator, once aligned.
    pub fn filter(&self) -> Option<&AttitudeFilter> {
        self.filter.as_ref()
    }

    /// [`Self::observe`] for who listens to the filter: the time of an inertial sample that went through it, if one did.
    #[inline]
    pub(crate) fn observe_with(
        &mut self,
        observation: &Observation,
        recorder: &mut impl AhrsRecorder,
    ) -> Result<Option<Time>, MethodError> {
        match observation {
            Observation::Imu(imu) => {
                if !imu.is_reading() {
                    return Err(MethodError::NoReading { time: imu.time });
                }
                if let Some(before) = self.latest
                    && imu.time <= before
                {
                    return Err(MethodError::TimeNotRising { found: imu.time, before });
                }
                self.latest = Some(imu.time);
            }
            Observation::Magnetic(magnetic) if !magnetic.is_reading() => return Ok(None),
            // Before the first inertial sample there is nothing to hold a field against.
            Observation::Magnetic(_) if self.latest.is_none() => return Ok(None),
            Observation::Magnetic(_) => {}
            _ => return Ok(None),
        }
        if self.held.is_empty() && self.gap_before(observation).is_none() {
            return self.advance(observation, recorder);
        }
        self.held.push_back(observation.clone());
        self.work_off(false, recorder)
    }

    /// True after the first inertial sample.
    pub(crate) fn has_begun(&self) -> bool {
        self.latest.is_some()
    }

    /// [`Self::next_due`] in the same way.
    #[inline]
    pub(crate) fn next_due_with(
        &mut self,
        recorder: &mut impl AhrsRecorder,
    ) -> Result<Option<Time>, MethodError> {
        if !self.held.is_empty() {
            return self.work_off(false, recorder);
        }
        if self.held.capacity() > 0 {
            // There is nothing to hold until the next gap.
            self.held = VecDeque::new();
        }
        Ok(None)
    }

    /// [`Self::finish_next`] in the same way.
    pub(crate) fn finish_next_with(
        &mut self,
        recorder: &mut impl AhrsRecorder,
    ) -> Result<Option<Time>, MethodError> {
        if self.latest.is_none() {
            return Err(MethodError::Empty);
        }
        self.work_off(true, recorder)
    }

    /// Time before an observation over which the filter cannot go, s: infinite before the first.
    #[inline]
    fn gap_before(&self, observation: &Observation) -> Option<f64> {
        let Some(time) = self.time else { return Some(f64::INFINITY) };
        let interval_s = (observation.time() - time).seconds();
        (matches!(observation, Observation::Imu(_)) && interval_s > self.params.gap_s).then_some(interval_s)
    }

    /// Takes what is held up to the next inertial sample; at a gap only once it is enough to align on, or all there is.
    fn work_off(
        &mut self,
        all_there_is: bool,
        recorder: &mut impl AhrsRecorder,
    ) -> Result<Option<Time>, MethodError> {
        while let (Some(first), Some(last)) = (self.held.front(), self.held.back()) {
            if let Some(gap_s) = self.gap_before(first) {
                let held_s = (last.time() - first.time()).seconds();
                if !all_there_is && held_s < self.params.interval_s && self.held.len() < MOST_HELD {
                    return Ok(None);
                }
                self.align(gap_s, recorder)?;
            }
            let Some(observation) = self.held.pop_front() else { break };
            if let Some(time) = self.advance(&observation, recorder)? {
                return Ok(Some(time));
            }
        }
        Ok(None)
    }

    /// Levels the tag with what is held of the first moments after a gap.
    fn align(&mut self, gap_s: f64, recorder: &mut impl AhrsRecorder) -> Result<(), MethodError> {
        let mut alignment = RestAlignment::default();
        let mut first = None;
        for observation in &self.held {
            let elapsed_s = (observation.time() - *first.get_or_insert(observation.time())).seconds();
            if elapsed_s > self.params.interval_s {
                break;
            }
            match observation {
                Observation::Imu(imu) => alignment.observe_imu(imu),
                Observation::Magnetic(magnetic) => alignment.observe_magnetic(magnetic),
                _ => {}
            }
        }
        let aligned = alignment.align(self.params.declination_rad).ok_or(MethodError::NoForce)?;
        if aligned.at_rest && !(0.5..=1.5).contains(&(aligned.force_m_s2 / self.params.gravity_m_s2)) {
            let (found, expected) = (aligned.force_m_s2, self.params.gravity_m_s2);
            return Err(MethodError::NotGravity { found, expected });
        }
        match &mut self.filter {
            None => self.filter = Some(AttitudeFilter::new(&self.params, aligned.attitude)),
            Some(filter) => {
                if filter.pending_s() > 0.0 {
                    correct(filter, recorder);
                }
                recorder.gap();
                filter.realign(&aligned, gap_s);
                let time = first.unwrap_or_default();
                self.report.warn(MethodWarning::Gap { time, length_s: gap_s });
            }
        }
        self.time = first;
        Ok(())
    }

    /// Propagate, and once an interval correct: the method.
    #[inline]
    fn advance(
        &mut self,
        observation: &Observation,
        recorder: &mut impl AhrsRecorder,
    ) -> Result<Option<Time>, MethodError> {
        let Some(filter) = self.filter.as_mut() else { return Err(MethodError::Empty) };
        match observation {
            Observation::Magnetic(magnetic) => {
                let lead_s = self.time.map_or(0.0, |time| (magnetic.time - time).seconds());
                if lead_s.abs() <= self.params.gap_s {
                    filter.add_field(&magnetic.field_ut, lead_s);
                }
                Ok(None)
            }
            Observation::Imu(imu) => {
                let interval_s = self.time.map_or(0.0, |time| (imu.time - time).seconds());
                self.time = Some(imu.time);
                recorder.sample(imu.time);
                if filter.propagate(&imu.angular_rate_rad_s, &imu.specific_force_m_s2, interval_s) {
                    correct(filter, recorder);
                }
                self.report.note(filter);
                if filter.state().attitude.coords.iter().all(|v| v.is_finite()) {
                    Ok(Some(imu.time))
                } else {
                    Err(MethodError::Diverged { time: imu.time })
                }
            }
            _ => Ok(None),
        }
    }

    #[inline]
    fn solution(&self, time: Time) -> Option<Solution> {
        self.filter.as_ref().map(|filter| solution(time, filter))
    }
}

/// A [`Recorder`] that also hears of samples, intervals and gaps.
pub(crate) trait AhrsRecorder: Recorder {
    /// The next inertial sample is being taken.
    fn sample(&mut self, _time: Time) {}
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
