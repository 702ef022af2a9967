//! The whole log at once: the same filter, then its record backward.

use super::{Ahrs, AhrsParams, AhrsRecorder, AhrsReport};
use crate::attitude::smoother::{Record, Recorder, Smoothed};
use crate::attitude::state::{AttitudeState, BLOCKS};
use crate::attitude::{AttitudeFilter, Forgotten};
use crate::kalman::blocks::{BlockCovariance, BlockUpdate, Coupling};
use crate::methods::MethodError;
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{UnitQuaternion, Vector3};
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_observation::Observation;
use alloc::vec::Vec;

/// Runs `ahrs` over a whole log and smooths it.
///
/// `progress` hears of the work done, from 0 to twice the number of observations.
pub fn smooth(
    params: AhrsParams,
    log: &[Observation],
    progress: &mut dyn FnMut(usize),
) -> Result<(Vec<Solution>, AhrsReport), MethodError> {
    let mut ahrs = Ahrs::new(params)?;
    let mut memory = Memory::default();
    let mut solutions = Vec::with_capacity(log.len());
    for (done, observation) in log.iter().enumerate() {
        let mut due = ahrs.observe_with(observation, &mut memory)?;
        while let Some(time) = due {
            solutions.extend(ahrs.solution(time));
            due = ahrs.next_due_with(&mut memory)?;
        }
        progress(done);
    }
    while let Some(time) = ahrs.finish_next_with(&mut memory)? {
        solutions.extend(ahrs.solution(time));
    }
    let intervals = memory.record.intervals().max(1);
    let smoothed = memory.record.smooth(|done| progress(log.len() + log.len() * done / intervals));
    memory.correct(&mut solutions, &smoothed);
    Ok((solutions, ahrs.report))
}

/// The record, and where its intervals end among the samples.
#[derive(Debug, Default)]
struct Memory {
    record: Record,
    samples: usize,
    ends: Vec<End>,
}

/// End of an interval.
#[derive(Debug, Clone, Copy)]
struct End {
    /// Index of its last sample.
    sample: usize,
    /// Attitude there before and after the correction.
    before: Attitude,
    after: Attitude,
    /// Samples are missing after it.
    gap: bool,
}

impl Memory {
    /// Corrects the filter's solutions: by what the smoother says at the ends of an interval, interpolated between.
    fn correct(&self, solutions: &mut [Solution], smoothed: &[Smoothed]) {
        let mut start = 0;
        let mut at_start: Option<Vector3<f64>> = None;
        for (end, smoothed) in self.ends.iter().zip(smoothed) {
            let correction = |filtered: &Attitude| smoothed.attitude * filtered.inverse();
            let at_end = correction(&end.before);
            let count = (end.sample + 1 - start) as f64;
            for (index, solution) in solutions.iter_mut().enumerate().take(end.sample + 1).skip(start) {
                let share = (index + 1 - start) as f64 / count;
                let filtered = if index == end.sample { end.before } else { solution.attitude };
                // The first interval may lie in a frame of its own: one turn for all of it.
                let turn = at_start.map_or(at_end, |at_start| {
                    let last = attitude::log(&at_end);
                    attitude::exp(&(at_start + (last - at_start) * share))
                });
                solution.attitude = turn * filtered;
                solution.covariance.fixed_view_mut::<3, 3>(6, 6).copy_from(&smoothed.covariance);
            }
            start = end.sample + 1;
            at_start = (!end.gap).then(|| attitude::log(&correction(&end.after)));
        }
        let tail = at_start.map_or_else(Attitude::identity, |turn| attitude::exp(&turn));
        for solution in solutions.iter_mut().skip(start) {
            solution.attitude = tail * solution.attitude;
        }
    }
}

impl AhrsRecorder for Memory {
    fn sample(&mut self, _time: Time) {
        self.samples += 1;
    }

    fn interval_ends(&mut self, filter: &AttitudeFilter) {
        let attitude = filter.state().attitude;
        self.ends.push(End { sample: self.samples - 1, before: attitude, after: attitude, gap: false });
    }

    fn corrected(&mut self, filter: &AttitudeFilter) {
        if let Some(end) = self.ends.last_mut() {
            end.after = filter.state().attitude;
        }
    }

    fn gap(&mut self) {
        self.record.gap();
        if let Some(end) = self.ends.last_mut() {
            end.gap = true;
        }
    }
}

impl Recorder for Memory {
    fn predicted(
        &mut self,
        state: &AttitudeState,
        covariance: &BlockCovariance<BLOCKS>,
        couplings: &[Coupling; 4],
    ) {
        self.record.predicted(state, covariance, couplings);
    }

    fn rest(&mut self, update: &BlockUpdate<BLOCKS, 1>) {
        self.record.rest(update);
    }

    fn velocity(&mut self, update: &BlockUpdate<BLOCKS, 1>) {
        self.record.velocity(update);
    }

    fn forgot(&mut self, what: Forgotten) {
        self.record.forgot(what);
    }

    fn found_north(&mut self, turn: &UnitQuaternion<f64>, covariance: &BlockCovariance<BLOCKS>) {
        self.record.found_north(turn, covariance);
    }

    fn field(&mut self, update: &BlockUpdate<BLOCKS, 3>) {
        self.record.field(update);
    }
}
