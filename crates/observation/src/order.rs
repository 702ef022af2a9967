//! The order of time, checked once for every kind of log.
//!
//! **The tag's own sensors** (inertial, magnetic, pressure: [`ObservationKind::is_wired`]) share its clock and come in order:
//!
//! - Time that runs backwards among them is an error: either the log is broken or two were glued together.
//! - An observation with the same time as the one before it of the same sensor is a repetition: it is dropped and
//!   counted as a warning. Loggers write such rows (the public foot-loops recordings did), and a zero interval has no place in
//!   a filter.
//! - More than [`Ordered::gap_limit`] between two inertial samples is a warning: the log goes on, whoever integrates
//!   should know.
//!
//! **What comes by radio** (fixes, signal strengths, ranges, sightings) comes late, twice and out of order; the log is as it is:
//!
//! - Late is what is older than the last reading of the tag's own sensors or, in a log without any, than the newest thing heard. It is
//!   passed on at its place in the log and counted in a warning, up to [`Ordered::late_limit`].
//! - Beyond the limit, in a log with sensors of its own: dropped, and counted in a warning. The sensors tell what time it is, so it is the
//!   straggler that is wrong (kept in a buffer through a dead zone, or stamped by another clock), and eight hours of a shift
//!   are not thrown away for one packet.
//! - Beyond the limit, in a log without: an error, time runs backwards. Nobody can tell which of the two stamps is wrong.
//! - The same kind, device, tag, radio and time as one of the last [`REMEMBERED`] is a repetition (a packet sent again, or heard by two
//!   gateways): dropped and counted, whatever its value, also when others came between. Two devices at one time are none.

use crate::device::DeviceId;
use crate::error::{At, LogError, Place};
use crate::fix::FixSource;
use crate::observation::{Observation, ObservationKind};
use crate::radio::Radio;
use crate::source::LogSource;
use crate::warning::Warnings;
use adit_core::time::{Interval, Time};
use std::collections::{HashSet, VecDeque};
use std::path::Path;
use std::sync::Arc;

/// Gap reported when nothing else is asked for: 0.25 s, a quarter of a stride.
pub const DEFAULT_GAP_LIMIT: Interval = Interval::from_nanos(250_000_000);
/// Lateness let through when nothing else is asked for: 60 s. Networks repeat and delay for seconds; a minute is a buffer emptied, or
/// another clock, and a walker is a hundred metres further on.
pub const DEFAULT_LATE_LIMIT: Interval = Interval::from_nanos(60_000_000_000);
/// Radio observations remembered to know a repetition: twenty seconds of twenty anchors at 10 Hz.
pub const REMEMBERED: usize = 4096;

/// A log whose order is checked.
pub struct Ordered<S> {
    source: S,
    gap_limit: Interval,
    late_limit: Interval,
    /// Last time of the tag's own sensors, and of each.
    clock: Option<Time>,
    latest_of: [Option<Time>; ObservationKind::COUNT],
    /// Newest time heard by radio.
    newest_heard: Option<Time>,
    heard: Heard,
}

/// What becomes of an observation.
enum Verdict {
    Pass,
    Repeated,
    TooLate(Interval),
    Backwards { before: Time },
}

impl<S: LogSource> Ordered<S> {
    /// Checks the order of `source`.
    pub fn new(source: S, gap_limit: Interval, late_limit: Interval) -> Self {
        Self {
            source,
            gap_limit,
            late_limit,
            clock: None,
            latest_of: [None; ObservationKind::COUNT],
            newest_heard: None,
            heard: Heard::default(),
        }
    }

    /// The gap from which on a warning is given.
    pub fn gap_limit(&self) -> Interval {
        self.gap_limit
    }

    /// How late an observation by radio may be.
    pub fn late_limit(&self) -> Interval {
        self.late_limit
    }

    fn judge_wired(&mut self, kind: ObservationKind, time: Time, at: At, warnings: &mut Warnings) -> Verdict {
        if let Some(before) = self.clock
            && time < before
        {
            return Verdict::Backwards { before };
        }
        let before = self.latest_of[kind as usize].replace(time);
        if before == Some(time) {
            return Verdict::Repeated;
        }
        if let Some(before) = before
            && matches!(kind, ObservationKind::Imu | ObservationKind::Acceleration)
            && time - before > self.gap_limit
        {
            warnings.gap(Place::new(self.source.file(), at), before, time, self.gap_limit);
        }
        self.clock = Some(time);
        Verdict::Pass
    }

    fn judge_heard(&mut self, key: Key, at: At, warnings: &mut Warnings) -> Verdict {
        let now = self.clock.or(self.newest_heard).unwrap_or(key.time);
        let late = now - key.time;
        if late > self.late_limit {
            return match self.clock {
                Some(_) => Verdict::TooLate(late),
                None => Verdict::Backwards { before: now },
            };
        }
        let time = key.time;
        if !self.heard.is_new(key) {
            return Verdict::Repeated;
        }
        self.newest_heard = self.newest_heard.max(Some(time));
        if late > Interval::ZERO {
            warnings.late(self.source.file(), at, late);
        }
        Verdict::Pass
    }
}

impl<S: LogSource> LogSource for Ordered<S> {
    fn next_observation(&mut self, warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError> {
        while let Some((observation, at)) = self.source.next_observation(warnings)? {
            let verdict = match Key::of(&observation) {
                None => self.judge_wired(observation.kind(), observation.time(), at, warnings),
                Some(key) => self.judge_heard(key, at, warnings),
            };
            match verdict {
                Verdict::Pass => return Ok(Some((observation, at))),
                Verdict::Repeated => warnings.repeated(self.source.file(), at),
                Verdict::TooLate(late) => warnings.too_late(self.source.file(), at, late, self.late_limit),
                Verdict::Backwards { before } => {
                    let place = Place::new(self.source.file(), at);
                    return Err(LogError::TimeBackwards { place, found: observation.time(), before });
                }
            }
        }
        Ok(None)
    }

    fn file(&self) -> &Arc<Path> {
        self.source.file()
    }
}

/// What two observations by radio have in common when one repeats the other.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Key {
    time: Time,
    said: Said,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Said {
    Fix(FixSource),
    Signal(DeviceId, Radio),
    Range(DeviceId, Option<DeviceId>, Radio),
    Sighting(DeviceId),
}

impl Key {
    /// `None` for the tag's own sensors.
    fn of(observation: &Observation) -> Option<Self> {
        let said = match observation {
            Observation::Imu(_)
            | Observation::Acceleration(_)
            | Observation::Magnetic(_)
            | Observation::Pressure(_) => return None,
            Observation::Fix(fix) => Said::Fix(fix.source),
            Observation::Signal(signal) => Said::Signal(signal.transmitter.clone(), signal.radio),
            Observation::Range(range) => Said::Range(range.anchor.clone(), range.tag.clone(), range.radio),
            Observation::Sighting(sighting) => Said::Sighting(sighting.reader.clone()),
        };
        Some(Self { time: observation.time(), said })
    }
}

/// The last observations by radio, at most [`REMEMBERED`].
#[derive(Debug, Default)]
struct Heard {
    keys: HashSet<Key>,
    in_order: VecDeque<Key>,
}

impl Heard {
    /// Remembers it; `false` when it was there.
    fn is_new(&mut self, key: Key) -> bool {
        if !self.keys.insert(key.clone()) {
            return false;
        }
        if self.in_order.len() == REMEMBERED
            && let Some(oldest) = self.in_order.pop_front()
        {
            self.keys.remove(&oldest);
        }
        self.in_order.push_back(key);
        true
    }
}
