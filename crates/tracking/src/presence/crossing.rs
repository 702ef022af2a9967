//! From one fix to the next: which zones were entered and left, and when.
//!
//! The way between two fixes is taken for straight where that is plausible ([`Path::between`]); zones that it leads through were entered
//! and left at the moments of crossing, at even speed between the fixes. Where it is not plausible (the first fix, a long silence, a
//! jump), only the new fix counts, from its own time on.
//!
//! A fix whose 95 % radius is larger than half the diagonal of a zone's bounds cannot tell whether it is inside: it begins no stay there,
//! and ends one only when the whole circle lies beyond the tolerance.

use super::{Leaving, Presence, Seen, Stay};
use crate::event::{Entry, Exit};
use crate::rules::PositionRules;
use crate::time::{between, seconds};
use crate::zones::{LevelIndex, Levels, Shape, Watch};
use adit_core::time::Time;

/// Halvings of the way by which the moment of leaving is found: below a nanosecond of any plausible way.
const HALVINGS: usize = 40;

/// A zone was entered or left; zones by their number in the watch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    Entered { zone: usize, time: Time, entry: Entry },
    Left { zone: usize, entered: Time, time: Time, exit: Exit },
}

impl Change {
    pub fn time(&self) -> Time {
        match self {
            Self::Entered { time, .. } | Self::Left { time, .. } => *time,
        }
    }
}

/// A straight way between two fixes.
#[derive(Debug, Clone)]
pub struct Path {
    from_m: [f64; 2],
    to_m: [f64; 2],
    times: (Time, Time),
    levels: (Option<LevelIndex>, Option<LevelIndex>),
    /// At which share of the way the level changes.
    border: f64,
    radius_m: f64,
}

impl Path {
    /// The way from the last fix to this one; `None` where too much time lies between them, or more distance than `crossing_speed_m_s` and
    /// the radii of both explain.
    pub fn between(
        from: (&Seen, Option<LevelIndex>),
        to: (&Seen, Option<LevelIndex>),
        rules: &PositionRules,
        levels: &Levels,
    ) -> Option<Self> {
        let ((a, from_level), (b, to_level)) = (from, to);
        let gap_s = b.time.since(a.time).seconds();
        let distance_m = (b.position_m - a.position_m).norm();
        let reach_m = rules.crossing_speed_m_s * gap_s + a.radius_95_m + b.radius_95_m;
        if gap_s > rules.crossing_gap_s || distance_m > reach_m {
            return None;
        }
        let border = if from_level == to_level {
            1.0
        } else {
            let (low, high) = (a.position_m.raw().z, b.position_m.raw().z);
            let band = &levels.band(from_level?)?.height_m;
            let border_m = if high > low { band.end } else { band.start };
            // NaN where the height stays and the level does not: then it changes at once.
            ((border_m - low) / (high - low)).clamp(0.0, 1.0).max(0.0)
        };
        Some(Self {
            from_m: a.plan_m(),
            to_m: b.plan_m(),
            times: (a.time, b.time),
            levels: (from_level, to_level),
            border,
            radius_m: a.radius_95_m.max(b.radius_95_m),
        })
    }

    fn at(&self, share: f64) -> [f64; 2] {
        let step = |axis: usize| self.from_m[axis] + share * (self.to_m[axis] - self.from_m[axis]);
        [step(0), step(1)]
    }

    fn time(&self, share: f64) -> Time {
        between(self.times.0, self.times.1, share)
    }

    /// The part of the way that is on the level of a zone, as shares of the way.
    fn part(&self, level: Option<LevelIndex>) -> Option<(f64, f64)> {
        match (level == self.levels.0, level == self.levels.1) {
            (true, true) => Some((0.0, 1.0)),
            (true, false) => Some((0.0, self.border)),
            (false, true) => Some((self.border, 1.0)),
            (false, false) => None,
        }
    }

    /// First entry and last exit, as shares of the way.
    fn through(&self, shape: &Shape) -> Option<(f64, f64)> {
        if !shape.is_near(self.from_m, self.to_m) || !shape.is_told_by(self.radius_m) {
            return None;
        }
        let (begin, end) = self.part(shape.level)?;
        let (first, last) = shape.live.zone.passage(self.at(begin), self.at(end))?;
        Some((begin + first * (end - begin), begin + last * (end - begin)))
    }

    /// When somebody who was inside at this share of the way came beyond the tolerance.
    fn leaves(&self, shape: &Shape, inside: f64) -> Time {
        let end = self.part(shape.level).map_or(inside, |(_, end)| end);
        let holds = |share: f64| {
            let [x, y] = self.at(share);
            shape.live.zone.holds(true, x, y)
        };
        if holds(end) {
            return self.time(end);
        }
        let (mut inside, mut outside) = (inside, end.max(inside));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if holds(middle) { inside = middle } else { outside = middle }
        }
        self.time(outside)
    }
}

impl Presence {
    /// Takes a fix into the stays. Changes come in the order of their times.
    pub fn cross(
        &mut self,
        to: &Seen,
        level: Option<LevelIndex>,
        path: Option<&Path>,
        watch: &Watch,
        changes: &mut Vec<Change>,
    ) {
        let (at, radius_m) = (to.plan_m(), to.radius_95_m);
        self.stays.retain_mut(|stay| {
            let Some((zone, shape)) = watch.index(&stay.zone).and_then(|i| Some((i, watch.get(i)?))) else {
                return false;
            };
            let keeps = shape.keeps(level, at, radius_m);
            if keeps && stay.leaving.is_none() {
                return true;
            }
            let through = path.and_then(|path| Some((path, path.through(shape)?)));
            if let Some(leaving) = stay.leaving {
                let back = through.map(|(path, (first, _))| path.time(first)).or(keeps.then_some(to.time));
                let until = leaving.since + seconds(shape.live.zone.exit_delay_s);
                if back.is_none_or(|back| back >= until) && to.time >= until {
                    let Leaving { since: time, exit } = leaving;
                    changes.push(Change::Left { zone, entered: stay.since, time, exit });
                    return false;
                }
            }
            if keeps {
                stay.leaving = None;
                return true;
            }
            let leaving = match (stay.leaving, through, path) {
                (_, Some((path, (_, last))), _) => {
                    Leaving { since: path.leaves(shape, last), exit: Exit::Crossed }
                }
                (Some(leaving), None, _) => leaving,
                // Inside by the tolerance only, and straight away from it.
                (None, None, Some(path)) if shape.is_told_by(path.radius_m) => {
                    Leaving { since: path.leaves(shape, 0.0), exit: Exit::Crossed }
                }
                (None, None, _) => Leaving { since: to.time, exit: Exit::Vanished },
            };
            let leaving = Leaving { since: leaving.since.max(stay.since), ..leaving };
            stay.leaving = Some(leaving);
            let gone = to.time >= leaving.since + seconds(shape.live.zone.exit_delay_s);
            if gone {
                let Leaving { since: time, exit } = leaving;
                changes.push(Change::Left { zone, entered: stay.since, time, exit });
            }
            !gone
        });
        for level_of_zones in [level, path.and_then(|path| path.levels.0).filter(|from| Some(*from) != level)]
        {
            let Some(zones_level) = level_of_zones else { continue };
            for (zone, shape) in watch.on_level(zones_level) {
                self.enter(to, level, path, (zone, shape), changes);
            }
        }
        if changes.len() > 1 {
            changes.sort_by_key(Change::time);
        }
    }

    fn enter(
        &mut self,
        to: &Seen,
        level: Option<LevelIndex>,
        path: Option<&Path>,
        (zone, shape): (usize, &Shape),
        changes: &mut Vec<Change>,
    ) {
        let from = path.map_or_else(|| to.plan_m(), |path| path.from_m);
        if !shape.is_near(from, to.plan_m()) || self.stays.iter().any(|stay| stay.zone == shape.id()) {
            return;
        }
        let through = path.and_then(|path| Some((path, path.through(shape)?)));
        let (time, entry) = match through {
            Some((path, (first, _))) => (path.time(first), Entry::Crossed),
            None if shape.takes(level, to.plan_m(), to.radius_95_m) => (to.time, Entry::Appeared),
            None => return,
        };
        // The passage that ended a stay does not begin another.
        let is_left = |change: &&Change| matches!(change, Change::Left { zone: left, .. } if *left == zone);
        if changes.iter().filter(is_left).any(|left| left.time() > time) {
            return;
        }
        changes.push(Change::Entered { zone, time, entry });
        let mut leaving = None;
        if let Some((path, (_, last))) = through
            && !shape.keeps(level, to.plan_m(), to.radius_95_m)
        {
            let since = path.leaves(shape, last).max(time);
            if to.time >= since + seconds(shape.live.zone.exit_delay_s) {
                changes.push(Change::Left { zone, entered: time, time: since, exit: Exit::Crossed });
                return;
            }
            leaving = Some(Leaving { since, exit: Exit::Crossed });
        }
        self.stays.push(Stay { zone: shape.id().into(), since: time, leaving });
    }

    /// Ends the stays whose delay is over, though no fix has come since.
    pub fn expire(&mut self, now: Time, watch: &Watch, changes: &mut Vec<Change>) {
        self.stays.retain(|stay| {
            let Some(Leaving { since, exit }) = stay.leaving else { return true };
            let Some((zone, shape)) = watch.index(&stay.zone).and_then(|i| Some((i, watch.get(i)?))) else {
                return false;
            };
            let gone = now >= since + seconds(shape.live.zone.exit_delay_s);
            if gone {
                changes.push(Change::Left { zone, entered: stay.since, time: since, exit });
            }
            !gone
        });
        if changes.len() > 1 {
            changes.sort_by_key(Change::time);
        }
    }
}
