//! Samples at any rate, evenly stamped or not, as means over bins of equal length.
//!
//! The readings are taken as joined by straight lines; the mean of a bin is the integral of these over [`BIN_S`]. A mean over
//! 40 ms passes 2 Hz with 0.99 and damps 25 Hz to nothing, so that a log of 200 Hz and the same log thinned to 50 Hz give the
//! same steps.

use super::{BIN, BIN_S};
use adit_core::time::{Interval, Time};
use serde::{Deserialize, Serialize};

/// From the middle of a bin to its end.
const HALF_BIN: Interval = Interval::from_nanos(BIN.nanos() / 2);

/// Joins samples and averages them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct NormGrid {
    /// The last sample.
    latest: Option<(Time, f64)>,
    /// How far the integral has come, and the value there.
    reached: (Time, f64),
    /// End of the bin under way.
    edge: Time,
    /// Integral over the bin so far.
    area: f64,
    /// Mean of the last complete bin.
    mean: f64,
}

impl NormGrid {
    /// Time of the last sample.
    #[inline]
    pub fn latest(&self) -> Option<Time> {
        self.latest.map(|(time, _)| time)
    }

    /// Takes a sample, later than the one before; true when a bin is complete.
    #[inline]
    pub fn push(&mut self, time: Time, value: f64) -> bool {
        if self.latest.is_none() {
            self.reached = (time, value);
            self.edge = time + BIN;
            self.mean = value;
        }
        self.latest = Some((time, value));
        if time < self.edge {
            self.integrate(time, value);
            return false;
        }
        true
    }

    /// The next complete bin: its middle and its mean.
    #[inline]
    pub fn pop(&mut self) -> Option<(Time, f64)> {
        let (time, value) = self.latest?;
        // The end of time is no edge of a bin.
        if time < self.edge || self.edge + BIN == self.edge {
            self.integrate(time, value);
            return None;
        }
        let (from, before) = self.reached;
        let span_s = (time - from).seconds();
        let share = if span_s > 0.0 { (self.edge - from).seconds() / span_s } else { 1.0 };
        self.integrate(self.edge, before + (value - before) * share);
        self.mean = self.area / BIN_S;
        self.area = 0.0;
        let middle = self.edge - HALF_BIN;
        self.edge = self.edge + BIN;
        Some((middle, self.mean))
    }

    /// Middle and mean of the last complete bin (the first sample, while there is none).
    pub fn last_bin(&self) -> (Time, f64) {
        (self.edge - BIN - HALF_BIN, self.mean)
    }

    #[inline]
    fn integrate(&mut self, until: Time, value: f64) {
        let (from, before) = self.reached;
        self.area += (until - from).seconds() * 0.5 * (before + value);
        self.reached = (until, value);
    }
}
