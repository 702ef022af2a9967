//! What holds the place, waiting for the carrier to come to its time.

use super::method::FusedReport;
use crate::ranging::epochs::Epoch;
use adit_core::time::Time;
use adit_observation::PositionFix;
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// What may wait; with more, the oldest are dropped: ten seconds of ranges, pressures and positions.
const MOST: usize = 256;

/// For so many room is kept.
const ROOM: usize = 8;

/// An observation of the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Aiding {
    /// Ranges of about one time.
    Ranges(Epoch),
    /// A position made here of signal strengths: its errors are those of the ones before it.
    Radio(Box<PositionFix>),
    /// A position from outside.
    Fix(Box<PositionFix>),
    /// A height by the barometer.
    Height {
        /// When.
        time: Time,
        /// Above that of the first pressure, m.
        height_m: f64,
    },
    /// A signal strength.
    Signal {
        /// When.
        time: Time,
        /// Its number at the site.
        transmitter: usize,
        /// dBm.
        rssi_dbm: f64,
    },
    /// Passing a portal.
    Sighting {
        /// When.
        time: Time,
        /// Its number at the site.
        reader: usize,
    },
}

impl Aiding {
    /// When it was true.
    pub fn time(&self) -> Time {
        match self {
            Self::Ranges(epoch) => epoch.time(),
            Self::Radio(fix) | Self::Fix(fix) => fix.time,
            Self::Height { time, .. } | Self::Signal { time, .. } | Self::Sighting { time, .. } => *time,
        }
    }
}

/// In order of time; late ones go first.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Waiting {
    held: VecDeque<Aiding>,
}

impl Waiting {
    /// Waits for its time.
    pub fn push(&mut self, aiding: Aiding, report: &mut FusedReport) {
        if self.held.len() == MOST {
            self.held.pop_front();
            report.late += 1;
        }
        let place = self.held.partition_point(|held| held.time() <= aiding.time());
        self.held.insert(place, aiding);
    }

    /// Whether one is due.
    #[inline]
    pub fn is_due(&self, now: Time) -> bool {
        self.held.front().is_some_and(|held| held.time() <= now)
    }

    /// The oldest that is due.
    #[inline]
    pub fn pop(&mut self, now: Time) -> Option<Aiding> {
        if !self.is_due(now) {
            return None;
        }
        let oldest = self.held.pop_front();
        if self.held.capacity() > 4 * self.held.len().max(ROOM) {
            // A gap of the carrier is over.
            self.held.shrink_to(2 * self.held.len().max(ROOM));
        }
        oldest
    }
}
