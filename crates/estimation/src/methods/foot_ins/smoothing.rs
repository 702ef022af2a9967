//! Smoothing of `foot-ins`: the whole log, or a fixed lag while it streams.

use super::foot_filter::FootFilter;
use super::{FootIns, FootInsParams, FootInsReport, NAME};
use crate::inertial::smoother::{Adjoint, Corrections, Record};
use crate::methods::MethodError;
use crate::pedestrian::stance::Stance;
use adit_core::solution::Solution;
use adit_core::time::Interval;
use adit_observation::{ImuSample, Observation};
use alloc::collections::VecDeque;
use alloc::vec::Vec;

/// Samples between two kept filter states: the backward pass runs the filter forward again from the one before.
///
/// Keeps 100 bytes a sample in memory instead of the 4 kB of a full record, for one more forward pass.
const SEGMENT: usize = 256;

/// Smooths a whole log (fixed interval): every solution knows everything before and after it.
///
/// `progress` hears of the samples done, from 0 to twice the number of samples.
pub fn smooth(
    params: FootInsParams,
    observations: &[Observation],
    progress: &mut dyn FnMut(usize),
) -> Result<(Vec<Solution>, FootInsReport), MethodError> {
    let mut method = FootIns::new(params)?;
    let mut tape: Vec<(ImuSample, Stance)> = Vec::new();
    let mut kept: Vec<FootFilter> = Vec::new();
    let mut observations = observations.iter();
    loop {
        let due = match observations.next() {
            Some(observation) => match method.take(observation)? {
                None => continue,
                due => due,
            },
            None => method.drain()?,
        };
        let Some((imu, stance)) = due else { break };
        if tape.len().is_multiple_of(SEGMENT) {
            kept.extend(method.filter.clone());
            progress(tape.len());
        }
        method.advance(&imu, &stance)?;
        tape.push((imu, stance));
    }

    let mut adjoint = Adjoint::default();
    let mut reversed = Vec::with_capacity(tape.len());
    let mut records = Vec::with_capacity(SEGMENT);
    for (segment, filter) in tape.chunks(SEGMENT).zip(&mut kept).rev() {
        records.clear();
        records.extend(segment.iter().map(|(imu, stance)| record(filter, imu, stance)));
        reversed.extend(records.iter().rev().map(|record| adjoint.step_back(record)));
        progress(tape.len() + reversed.len());
    }
    reversed.reverse();
    Ok((reversed, method.report))
}

/// Runs the filter over one sample and keeps what it did.
fn record(filter: &mut FootFilter, imu: &ImuSample, stance: &Stance) -> Record {
    let (gap, awaiting_stance) = (filter.gap_before(imu).is_some(), filter.is_awaiting_stance());
    let step = filter.predict(imu);
    let (state, covariance) = (*filter.state(), filter.covariance().clone());
    let mut corrections = Corrections::default();
    filter.correct(imu, stance, &mut corrections);
    let after_gap = gap || (awaiting_stance && !filter.is_awaiting_stance());
    Record { time: imu.time, step, state, covariance, corrections, quality: filter.quality(), after_gap }
}

/// Smoothing over a fixed lag while the log streams: solutions leave `lag` later than those of the filter.
#[derive(Debug, Clone)]
pub struct FixedLag {
    method: FootIns,
    lag: Interval,
    records: VecDeque<Record>,
    ready: VecDeque<Solution>,
}

impl FixedLag {
    /// Smooths with a lag in seconds (0.1 to 60).
    pub fn new(params: FootInsParams, lag_s: f64) -> Result<Self, MethodError> {
        let lag = Interval::from_seconds(lag_s)
            .filter(|_| (0.1..=60.0).contains(&lag_s))
            .ok_or(MethodError::Setting { method: NAME, name: "lag (0.1 to 60 s)" })?;
        Ok(Self { method: FootIns::new(params)?, lag, records: VecDeque::new(), ready: VecDeque::new() })
    }

    /// One observation in, at most one solution out.
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        let mut due = self.method.take(observation)?;
        while let Some((imu, stance)) = due {
            self.push(&imu, &stance)?;
            due = self.method.input.next_due();
        }
        Ok(self.ready.pop_front())
    }

    /// A further solution that the observations so far make due, if any.
    pub fn next_due(&mut self) -> Option<Solution> {
        self.ready.pop_front()
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some((imu, stance)) = self.method.drain()? {
            self.push(&imu, &stance)?;
        }
        if self.ready.is_empty() && !self.records.is_empty() {
            let all = self.records.len();
            self.release(all);
        }
        Ok(self.ready.pop_front())
    }

    /// What the run did so far.
    pub fn report(&self) -> &FootInsReport {
        self.method.report()
    }

    fn push(&mut self, imu: &ImuSample, stance: &Stance) -> Result<(), MethodError> {
        let filter = self.method.filter.as_mut().ok_or(MethodError::Empty)?;
        let gap = filter.gap_before(imu);
        let record = record(filter, imu, stance);
        let finite = filter.is_finite();
        let innovation = record.corrections.contact.as_ref().map(|update| &update.innovation);
        self.method.report.note(imu.time, gap, stance, innovation, finite)?;
        self.records.push_back(record);
        // A backward pass over lag and a quarter of it releases that quarter: five steps back for every one forward.
        let block = Interval::from_nanos(self.lag.nanos() / 4);
        let first_kept = imu.time - self.lag;
        if self.records.front().is_some_and(|first| first.time + block <= first_kept) {
            let count = self.records.partition_point(|record| record.time < first_kept);
            self.release(count);
        }
        Ok(())
    }

    fn release(&mut self, count: usize) {
        let mut adjoint = Adjoint::default();
        let smoothed: Vec<Solution> =
            self.records.iter().rev().map(|record| adjoint.step_back(record)).collect();
        let newest_first = smoothed.into_iter().rev().take(count);
        self.ready.extend(newest_first);
        self.records.drain(..count);
    }
}
