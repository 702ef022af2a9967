//! What was odd about a log though work could go on; returned as data, shown by whoever has a screen.

use crate::error::{At, Place};
use adit_core::time::{Interval, Time};
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// Gaps listed one by one; later ones are only counted, so that memory stays bounded.
const GAPS_LISTED: usize = 20;

/// Something odd in a log.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LogWarning {
    /// Columns that are not used.
    IgnoredColumns {
        /// The header line.
        place: Place,
        /// Their names.
        columns: Vec<String>,
    },
    /// A magnetic field without a physical unit cannot become an observation in µT.
    NormalisedMagneticField {
        /// The header line.
        place: Place,
    },
    /// Topics of an MCAP file that are not used.
    IgnoredTopics {
        /// The file.
        place: Place,
        /// The first of them.
        topics: Vec<String>,
    },
    /// Rows or messages dropped because the same sensor or device has said something at that time before.
    RepeatedTime {
        /// The first one dropped.
        first: Place,
        /// How many.
        count: u64,
    },
    /// Observations by radio that came after newer ones; passed on.
    Late {
        /// The first one.
        first: Place,
        /// How many.
        count: u64,
        /// The longest delay.
        longest: Interval,
    },
    /// Observations by radio dropped because they came later than the limit.
    TooLate {
        /// The first one dropped.
        first: Place,
        /// How many.
        count: u64,
        /// The longest delay.
        longest: Interval,
        /// The limit they exceed.
        limit: Interval,
    },
    /// No inertial sample for longer than the limit.
    Gap {
        /// The first line after the gap.
        place: Place,
        /// Time before the gap.
        before: Time,
        /// Time after the gap.
        after: Time,
        /// The limit it exceeds.
        limit: Interval,
    },
    /// Gaps past the first twenty.
    MoreGaps {
        /// The file.
        place: Place,
        /// How many more.
        count: u64,
        /// The longest of these.
        longest: Interval,
    },
    /// Rows of a truth file without a value where one is needed.
    SkippedRows {
        /// The first one skipped.
        first: Place,
        /// How many.
        count: u64,
    },
    /// Ranges longer than an indoor radio reaches.
    UnlikelyRange {
        /// The line of the last range looked at.
        place: Place,
        /// Their median, mm (an integer, so that warnings compare).
        median_mm: i64,
    },
    /// The specific force at rest is neither gravity nor gravity in a wrong unit.
    UnlikelyGravity {
        /// The line of the last sample looked at.
        place: Place,
        /// Median length of the specific force, mm/s² (an integer, so that warnings compare).
        median_mm_s2: i64,
    },
}

impl fmt::Display for LogWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IgnoredColumns { place, columns } => {
                write!(f, "{place}: ignored columns that are not known: {}", columns.join(", "))
            }
            Self::NormalisedMagneticField { place } => write!(
                f,
                "{place}: the magnetic field is normalised, not in µT: no magnetic observations are made of it"
            ),
            Self::IgnoredTopics { place, topics } => {
                write!(f, "{place}: ignored topics that are not known: {}", topics.join(", "))
            }
            Self::RepeatedTime { first, count } => {
                write!(f, "{first}: dropped repetitions (same source, same time), from here on: {count}")
            }
            Self::Late { first, count, longest } => write!(
                f,
                "{first}: observations by radio came late, from here on: {count}, at most {} s",
                longest.seconds()
            ),
            Self::TooLate { first, count, longest, limit } => write!(
                f,
                "{first}: dropped observations by radio more than {} s late, from here on: {count}, at most {} s",
                limit.seconds(),
                longest.seconds()
            ),
            Self::UnlikelyRange { place, median_mm } => write!(
                f,
                "{place}: the ranges have a median of {} m up to here, longer than a radio indoors reaches: are they in cm or mm?",
                *median_mm as f64 / 1000.0
            ),
            Self::Gap { place, before, after, limit } => write!(
                f,
                "{place}: no inertial sample for {} s (from {before} s to {after} s, limit {} s)",
                (*after - *before).seconds(),
                limit.seconds()
            ),
            Self::MoreGaps { place, count, longest } => {
                write!(f, "{place}: {count} more gaps, the longest of {} s", longest.seconds())
            }
            Self::SkippedRows { first, count } => {
                write!(f, "{first}: skipped rows with empty fields, from here on: {count}")
            }
            Self::UnlikelyGravity { place, median_mm_s2 } => write!(
                f,
                "{place}: the specific force has a median length of {} m/s² up to here, gravity is 9.8 m/s²",
                *median_mm_s2 as f64 / 1000.0
            ),
        }
    }
}

/// Collects warnings in bounded memory.
#[derive(Debug, Clone, Default)]
pub struct Warnings {
    list: Vec<LogWarning>,
    gaps: usize,
    last_repeated: Option<At>,
}

impl Warnings {
    /// Everything so far, in order of first appearance.
    pub fn list(&self) -> &[LogWarning] {
        &self.list
    }

    /// Adds one.
    pub fn push(&mut self, warning: LogWarning) {
        self.list.push(warning);
    }

    /// Counts a dropped repetition; the several observations of one row count once.
    pub fn repeated(&mut self, file: &Arc<Path>, at: At) {
        if self.last_repeated.replace(at) == Some(at) {
            return;
        }
        for warning in &mut self.list {
            if let LogWarning::RepeatedTime { count, .. } = warning {
                *count += 1;
                return;
            }
        }
        self.list.push(LogWarning::RepeatedTime { first: Place::new(file, at), count: 1 });
    }

    /// Counts an observation that came late.
    pub fn late(&mut self, file: &Arc<Path>, at: At, delay: Interval) {
        for warning in &mut self.list {
            if let LogWarning::Late { count, longest, .. } = warning {
                *count += 1;
                *longest = delay.max(*longest);
                return;
            }
        }
        self.list.push(LogWarning::Late { first: Place::new(file, at), count: 1, longest: delay });
    }

    /// Counts an observation dropped because it came too late.
    pub fn too_late(&mut self, file: &Arc<Path>, at: At, delay: Interval, limit: Interval) {
        for warning in &mut self.list {
            if let LogWarning::TooLate { count, longest, .. } = warning {
                *count += 1;
                *longest = delay.max(*longest);
                return;
            }
        }
        self.list.push(LogWarning::TooLate { first: Place::new(file, at), count: 1, longest: delay, limit });
    }

    /// Counts a skipped row.
    pub fn skipped(&mut self, file: &Arc<Path>, at: At) {
        for warning in &mut self.list {
            if let LogWarning::SkippedRows { count, .. } = warning {
                *count += 1;
                return;
            }
        }
        self.list.push(LogWarning::SkippedRows { first: Place::new(file, at), count: 1 });
    }

    /// Lists or counts a gap.
    pub fn gap(&mut self, place: Place, before: Time, after: Time, limit: Interval) {
        self.gaps += 1;
        if self.gaps <= GAPS_LISTED {
            self.list.push(LogWarning::Gap { place, before, after, limit });
            return;
        }
        let length = after - before;
        for warning in &mut self.list {
            if let LogWarning::MoreGaps { count, longest, .. } = warning {
                *count += 1;
                *longest = length.max(*longest);
                return;
            }
        }
        let place = Place { at: At::File, ..place };
        self.list.push(LogWarning::MoreGaps { place, count: 1, longest: length });
    }
}
