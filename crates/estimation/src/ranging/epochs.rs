//! Ranges of a log, gathered into epochs: what a position is made of.
//!
//! Anchors answer one after the other. What comes within [`EpochParams::epoch_s`] after a first range of the same tag is one epoch. It is
//! closed when a range comes that is later than that, and at the latest `wait_s` after its end by the clock (the newest time of anything wired in the
//! log), since what comes by radio may be late. What belongs to an epoch that was reported is counted and left.
//! Memory: [`MOST_RANGES`] in each of [`MOST_OPEN`] epochs.

use crate::settings::{first_unusable, not_negative, positive};
use adit_core::time::{Interval, Time};
use adit_observation::{DeviceId, RangeSample};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Ranges in an epoch; further ones are left out and counted.
pub const MOST_RANGES: usize = 256;
/// Epochs open at once: the oldest is reported when there are more.
pub const MOST_OPEN: usize = 64;

/// How ranges are gathered.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EpochParams {
    /// What comes within this after the first range is one epoch, s.
    pub epoch_s: f64,
    /// What is late is waited for so long, s.
    pub wait_s: f64,
}

impl Default for EpochParams {
    fn default() -> Self {
        Self { epoch_s: 0.05, wait_s: 1.0 }
    }
}

impl EpochParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("ranges.epoch_s", positive(self.epoch_s) && self.epoch_s <= 60.0),
            ("ranges.wait_s", not_negative(self.wait_s) && self.wait_s <= 3600.0),
        ])
    }
}

/// Ranges of one tag at about one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Epoch {
    first: Time,
    last: Time,
    /// As they came.
    pub ranges: Vec<RangeSample>,
}

/// Gathers the ranges of a log, streaming.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Epochs {
    params: EpochParams,
    /// Of anything wired.
    clock: Option<Time>,
    /// Of a range.
    newest: Option<Time>,
    /// In order of their first ranges.
    open: VecDeque<Epoch>,
    /// First range of the newest epoch that was reported, of each tag; the oldest tag goes.
    reported: VecDeque<(Option<DeviceId>, Time)>,
    late: u64,
    left_out: u64,
}

impl Epoch {
    /// Mean time of its ranges.
    pub fn time(&self) -> Time {
        let after_ns = self.ranges.iter().map(|range| (range.time - self.first).nanos()).sum::<i64>();
        let count = i64::try_from(self.ranges.len().max(1)).unwrap_or(i64::MAX);
        self.first + Interval::from_nanos(after_ns / count)
    }

    fn takes(&self, range: &RangeSample, length: Interval) -> bool {
        let span = self.last.max(range.time) - self.first.min(range.time);
        span < length && self.ranges.first().is_some_and(|first| first.tag == range.tag)
    }
}

impl Epochs {
    /// Nothing measured yet; settings must be usable.
    pub(crate) fn new(params: EpochParams) -> Self {
        Self {
            params,
            clock: None,
            newest: None,
            open: VecDeque::new(),
            reported: VecDeque::new(),
            late: 0,
            left_out: 0,
        }
    }

    /// Ranges that came after the report of the epoch that they belong to.
    pub fn late(&self) -> u64 {
        self.late
    }

    /// Ranges of which there were more than an epoch holds.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Takes a range; one with a fault is left, and one that came before: of the same anchor and time.
    pub fn observe(&mut self, range: &RangeSample) {
        if range.fault().is_some() {
            return;
        }
        self.newest = self.newest.max(Some(range.time));
        let length = Interval::from_seconds(self.params.epoch_s).unwrap_or_default();
        if let Some(epoch) = self.open.iter_mut().find(|epoch| epoch.takes(range, length)) {
            if epoch.ranges.iter().any(|known| known.anchor == range.anchor && known.time == range.time) {
                return;
            }
            if epoch.ranges.len() >= MOST_RANGES {
                self.left_out += 1;
                return;
            }
            epoch.first = epoch.first.min(range.time);
            epoch.last = epoch.last.max(range.time);
            epoch.ranges.push(range.clone());
            return;
        }
        let told = self.reported.iter().find(|(tag, _)| *tag == range.tag);
        if told.is_some_and(|(_, first)| range.time - *first < length) {
            self.late += 1;
            return;
        }
        let at = self.open.partition_point(|epoch| epoch.first <= range.time);
        let epoch = Epoch { first: range.time, last: range.time, ranges: alloc::vec![range.clone()] };
        self.open.insert(at, epoch);
    }

    /// Time has come to `now`; it does not go back.
    pub fn advance(&mut self, now: Time) {
        self.clock = self.clock.max(Some(now));
    }

    /// The next epoch that is closed, if any.
    pub fn pop(&mut self) -> Option<Epoch> {
        let first = self.open.front()?.first;
        let since = |time: Option<Time>| time.map_or(0.0, |time| (time - first).seconds());
        let EpochParams { epoch_s, wait_s } = self.params;
        let closed = since(self.newest) >= epoch_s
            || since(self.clock) >= epoch_s + wait_s
            || self.open.len() > MOST_OPEN;
        if closed { self.finish() } else { None }
    }

    /// After the last observation: what is left, one epoch after the other.
    pub fn finish(&mut self) -> Option<Epoch> {
        let epoch = self.open.pop_front()?;
        let tag = epoch.ranges.first()?.tag.clone();
        self.reported.retain(|(known, _)| *known != tag);
        if self.reported.len() >= MOST_OPEN {
            self.reported.pop_front();
        }
        self.reported.push_back((tag, epoch.first));
        Some(epoch)
    }
}
