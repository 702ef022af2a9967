//! Seconds of the rules as spans of time.

use adit_core::time::{Interval, Time};

/// A span of so many seconds; none for what is no number. Rules are checked to be far from the end of the range.
pub fn seconds(seconds: f64) -> Interval {
    Interval::from_seconds(seconds).unwrap_or(Interval::ZERO)
}

/// A span of so many hours.
pub fn hours(hours: f64) -> Interval {
    seconds(hours * 3600.0)
}

/// The moment at this share of the way from one to another.
pub fn between(from: Time, to: Time, share: f64) -> Time {
    (from + seconds(to.since(from).seconds() * share)).clamp(from, to.max(from))
}
