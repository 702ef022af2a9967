//! Time stamps and intervals as whole nanoseconds.
//!
//! A stamp counts from the origin of its log: the Unix epoch for live data, the first sample for a recorded set.
//! Nanoseconds in an `i64` reach 292 years with no rounding, so that a stamp survives every file format unchanged;
//! seconds as `f64` appear only where a formula needs an interval.

use core::fmt;
use core::ops::{Add, Sub};
use serde::{Deserialize, Serialize};

const NANOS_PER_SECOND: f64 = 1e9;

/// An instant, nanoseconds since the origin of its log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Time(i64);

/// A signed span between two instants, nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Interval(i64);

impl Time {
    /// The origin of the log.
    pub const ZERO: Self = Self(0);

    /// From nanoseconds since the origin.
    pub const fn from_nanos(nanos: i64) -> Self {
        Self(nanos)
    }

    /// Nanoseconds since the origin.
    pub const fn nanos(self) -> i64 {
        self.0
    }

    /// From seconds since the origin, to the nearest nanosecond (below 104 days; for Unix stamps an `f64` itself is
    /// only good to some 0.2 µs); `None` when not finite or past ±292 years.
    pub fn from_seconds(seconds: f64) -> Option<Self> {
        nanos_from_seconds(seconds).map(Self)
    }

    /// Seconds since the origin (exact to 1 µs for Unix stamps of this century).
    pub fn seconds(self) -> f64 {
        self.0 as f64 / NANOS_PER_SECOND
    }

    /// The span from `earlier` to `self`; saturates at ±292 years.
    pub const fn since(self, earlier: Self) -> Interval {
        Interval(self.0.saturating_sub(earlier.0))
    }
}

impl Interval {
    /// No time at all.
    pub const ZERO: Self = Self(0);

    /// From nanoseconds.
    pub const fn from_nanos(nanos: i64) -> Self {
        Self(nanos)
    }

    /// Nanoseconds.
    pub const fn nanos(self) -> i64 {
        self.0
    }

    /// From seconds, to the nearest nanosecond; `None` when not finite or past ±292 years.
    pub fn from_seconds(seconds: f64) -> Option<Self> {
        nanos_from_seconds(seconds).map(Self)
    }

    /// Seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / NANOS_PER_SECOND
    }
}

fn nanos_from_seconds(seconds: f64) -> Option<i64> {
    let nanos = libm::round(seconds * NANOS_PER_SECOND);
    // 2^63 is exact as f64; NaN fails the comparison.
    #[expect(clippy::cast_possible_truncation, reason = "the range is checked in the same expression")]
    (nanos.abs() < 9_223_372_036_854_775_808.0).then_some(nanos as i64)
}

impl Sub for Time {
    type Output = Interval;
    fn sub(self, earlier: Self) -> Interval {
        self.since(earlier)
    }
}

impl Add<Interval> for Time {
    type Output = Self;
    fn add(self, span: Interval) -> Self {
        Self(self.0.saturating_add(span.0))
    }
}

impl Sub<Interval> for Time {
    type Output = Self;
    fn sub(self, span: Interval) -> Self {
        Self(self.0.saturating_sub(span.0))
    }
}

impl fmt::Display for Time {
    /// Seconds with all nine decimals, as TUM files carry them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_seconds(f, self.0)
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_seconds(f, self.0)
    }
}

fn write_seconds(f: &mut fmt::Formatter<'_>, nanos: i64) -> fmt::Result {
    let sign = if nanos < 0 { "-" } else { "" };
    let magnitude = nanos.unsigned_abs();
    write!(f, "{sign}{}.{:09}", magnitude / 1_000_000_000, magnitude % 1_000_000_000)
}
