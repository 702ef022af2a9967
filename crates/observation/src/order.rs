//! The order of time, checked once for every kind of log.
//!
//! - Time that runs backwards, of any sensor, is an error: either the log is broken or two were glued together.
//! - An observation with the same time as the one before it of the same sensor is a repetition: it is dropped and
//!   counted as a warning. Loggers write such rows (the public foot-loops recordings did), and a zero interval has no place in
//!   a filter.
//!   Fixes of one time from two sources are two sensors; from one source, a repetition.
//! - More than [`Ordered::gap_limit`] between two inertial samples is a warning: the log goes on, whoever integrates
//!   should know.

use crate::error::{At, LogError, Place};
use crate::observation::{Observation, ObservationKind};
use crate::source::LogSource;
use crate::warning::Warnings;
use adit_core::time::{Interval, Time};
use std::path::Path;
use std::sync::Arc;

/// Gap reported when nothing else is asked for: 0.25 s, a quarter of a stride.
pub const DEFAULT_GAP_LIMIT: Interval = Interval::from_nanos(250_000_000);

/// A log whose order is checked.
pub struct Ordered<S> {
    source: S,
    gap_limit: Interval,
    latest: Option<Time>,
    latest_of: [Option<Observation>; ObservationKind::COUNT],
}

impl<S: LogSource> Ordered<S> {
    /// Checks the order of `source`.
    pub fn new(source: S, gap_limit: Interval) -> Self {
        Self { source, gap_limit, latest: None, latest_of: [const { None }; ObservationKind::COUNT] }
    }

    /// The gap from which on a warning is given.
    pub fn gap_limit(&self) -> Interval {
        self.gap_limit
    }
}

impl<S: LogSource> LogSource for Ordered<S> {
    fn next_observation(&mut self, warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError> {
        while let Some((observation, at)) = self.source.next_observation(warnings)? {
            let time = observation.time();
            if let Some(before) = self.latest
                && time < before
            {
                let place = Place::new(self.source.file(), at);
                return Err(LogError::TimeBackwards { place, found: time, before });
            }
            let kind = observation.kind();
            let before = self.latest_of[kind as usize].replace(observation.clone());
            if before.as_ref().is_some_and(|before| repeats(before, &observation)) {
                warnings.repeated(self.source.file(), at);
                continue;
            }
            if let Some(before) = before.as_ref().map(Observation::time)
                && kind == ObservationKind::Imu
                && time - before > self.gap_limit
            {
                warnings.gap(Place::new(self.source.file(), at), before, time, self.gap_limit);
            }
            self.latest = Some(time);
            return Ok(Some((observation, at)));
        }
        Ok(None)
    }

    fn file(&self) -> &Arc<Path> {
        self.source.file()
    }
}

/// The same sensor at the same time; fixes of two sources are of two sensors.
fn repeats(before: &Observation, now: &Observation) -> bool {
    let same_sensor = match (before, now) {
        (Observation::Fix(before), Observation::Fix(now)) => before.source == now.source,
        _ => true,
    };
    same_sensor && before.time() == now.time()
}
