//! What becomes of a position fix: it waits for the state, and is then held against where the walker was at its time.

use super::Pdr;
use super::search::{FOUND_RAD, Search, UNKNOWN_RAD};
use crate::methods::MethodWarning;
use adit_core::time::Time;
use adit_observation::PositionFix;
use serde::{Deserialize, Serialize};

/// Fixes that may wait for the steps before them; with more, the oldest are dropped.
pub const MOST_HELD: usize = 64;
/// Outliers in a row after which it is the path that is wrong.
const MOST_OUTLIERS: f64 = 4.0;

/// A fix that waits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeldFix {
    /// The fix.
    pub fix: PositionFix,
    /// Made here of signal strengths: its errors are those of the fixes before it.
    pub by_radio: bool,
}

impl Pdr {
    /// Takes the radio's positions that are due.
    pub(super) fn hear(&mut self, now: Time) {
        while let Some(fix) = self.radio.as_mut().and_then(|radio| radio.due(now)) {
            self.take(HeldFix { fix, by_radio: true });
        }
    }

    /// Keeps a fix until the state has come to its time.
    pub(super) fn take(&mut self, new: HeldFix) {
        if new.fix.fault().is_some() || !self.params.fixes.used {
            return;
        }
        let time = new.fix.time;
        if self.time.is_some_and(|now| time < now) && self.trail.at(time).is_none() {
            self.report.late_fixes += 1;
            return;
        }
        if self.held.len() == MOST_HELD {
            self.held.pop_front();
            self.report.late_fixes += 1;
        }
        let place = self.held.partition_point(|held| held.fix.time <= time);
        self.held.insert(place, new);
    }

    /// The oldest fix held that is not newer than `time`.
    pub(super) fn next_held(&mut self, time: Time) -> Option<HeldFix> {
        self.held.front().filter(|held| held.fix.time <= time)?;
        self.held.pop_front()
    }

    /// Uses a fix of the time of the state, or of one on the trail.
    pub(super) fn correct(&mut self, held: &HeldFix) {
        let HeldFix { fix, by_radio } = held;
        let late = self.time.is_some_and(|time| fix.time < time);
        let way_m = if late { self.trail.at(fix.time) } else { None }.unwrap_or(self.walker.way_m);
        let place_m = self.walker.position_m - self.walker.since(&way_m);
        let weighed = self.radio.as_mut().filter(|_| *by_radio).map(|radio| radio.weigh(fix, &way_m));
        let (fix, share) = weighed.as_ref().map_or((fix, 1.0), |(fix, share)| (fix, *share));
        self.fixed = Some(fix.time);
        if let Some(search) = &mut self.search {
            search.observe(fix, &place_m);
            self.report.searched_fixes += 1;
            self.look();
            return;
        }
        if !self.placed {
            if self.direction_variance() > FOUND_RAD * FOUND_RAD {
                let search = self.search.get_or_insert_default();
                search.observe(fix, &place_m);
            } else {
                self.walker.place(fix, &way_m);
                self.placed = true;
            }
            self.report.searched_fixes += 1;
            return;
        }
        let bound = self.params.fixes.nis_bound;
        let Some(update) = self.walker.correct(fix, &way_m, bound) else { return };
        self.report.note_fix(update.nis, bound);
        // The same error said four times is one outlier.
        self.outliers = if update.nis > bound { self.outliers + share } else { 0.0 };
        if self.outliers >= MOST_OUTLIERS {
            // Not the fixes are wrong, but what the walk was taken for.
            self.outliers = 0.0;
            self.search = Some(Search::anew());
            self.report.warn(MethodWarning::PathReopened { time: fix.time });
        }
    }

    /// Ends the search when the direction is known.
    pub(super) fn look(&mut self) {
        let direction_rad2 = self.direction_variance();
        if let Some(search) = self.search.take_if(|search| search.is_over(direction_rad2)) {
            self.walker = search.place(&self.walker, direction_rad2);
            self.placed = true;
        }
    }

    /// Variance of the direction as far as a magnetometer tells it, rad²; else that of any.
    pub(super) fn direction_variance(&self) -> f64 {
        if self.report.magnetic_heading {
            self.walker.direction_variance()
        } else {
            UNKNOWN_RAD * UNKNOWN_RAD
        }
    }
}
