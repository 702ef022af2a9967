//! Whether somebody moves: by the tag's own sensors, or else by positions that stay where they are.

use super::Seen;
use crate::input::Motion;
use crate::rules::MotionRules;
use crate::time::seconds;
use crate::view::MotionView;
use adit_core::frames::{MineGrid, Position};
use adit_core::time::{Interval, Time};
use serde::{Deserialize, Serialize};

/// What sensors have said without a break.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Sensed {
    motion: Motion,
    since: Time,
    until: Time,
}

/// Where somebody has been without a break.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Spot {
    position_m: Position<MineGrid>,
    radius_m: f64,
    since: Time,
    until: Time,
}

/// What is known of motion and rest.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Stillness {
    sensed: Option<Sensed>,
    /// Until when the tag's own sensors have spoken: then what the method says of motion is not asked.
    activity_until: Option<Time>,
    spot: Option<Spot>,
    /// How much of the time since the last fix they are known to have rested.
    rested: Interval,
}

/// Somebody does not move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rest {
    pub since: Time,
    /// As far as it is known; silence does not count as rest.
    pub lasting: Interval,
    /// Sensors say so, not positions alone.
    pub sensed: bool,
}

impl Motion {
    const fn is_rest(self) -> bool {
        matches!(self, Self::Still | Self::Fallen)
    }
}

impl Stillness {
    /// The tag's sensors have spoken; false when that is older than what they have said already.
    pub fn activity(&mut self, motion: Motion, time: Time, fixed: Option<Time>, rules: &MotionRules) -> bool {
        if self.activity_until.is_some_and(|until| time <= until) {
            return false;
        }
        self.activity_until = Some(time);
        self.sense(motion, time, fixed, rules);
        true
    }

    fn sense(&mut self, motion: Motion, time: Time, fixed: Option<Time>, rules: &MotionRules) {
        let known = self.sensed.filter(|sensed| time.since(sensed.until) <= seconds(rules.evidence_s));
        self.sensed = Some(match known {
            Some(sensed) if sensed.motion.is_rest() == motion.is_rest() => {
                let until = sensed.until.max(time);
                if motion.is_rest() {
                    let from = fixed.map_or(sensed.until, |fixed| fixed.max(sensed.until));
                    let rested = until.since(from).max(Interval::ZERO);
                    self.rested = Interval::from_nanos(self.rested.nanos().saturating_add(rested.nanos()));
                }
                Sensed { motion, until, ..sensed }
            }
            _ => Sensed { motion, since: time, until: time },
        });
    }

    /// A fix was taken.
    pub fn fix(&mut self, seen: &Seen, moving: Option<bool>, rules: &MotionRules) {
        let fresh = |until: Time| seen.time.since(until) <= seconds(rules.evidence_s);
        if let Some(moving) = moving
            && !self.activity_until.is_some_and(fresh)
        {
            let motion = if moving { Motion::Moving } else { Motion::Still };
            self.sense(motion, seen.time, Some(seen.time), rules);
        }
        self.rested = Interval::ZERO;
        let stayed = self.spot.as_mut().filter(|spot| {
            let reach_m = rules.still_radius_m + spot.radius_m.max(seen.radius_95_m);
            (seen.position_m - spot.position_m).norm() <= reach_m
        });
        if let Some(spot) = stayed {
            spot.until = seen.time;
        } else {
            let Seen { position_m, radius_95_m: radius_m, time, .. } = *seen;
            self.spot = Some(Spot { position_m, radius_m, since: time, until: time });
        }
    }

    /// Since when they do not move, if so. Who rests by the sensors and changes place all the same rides, and does not lie.
    pub fn rest(&self, rules: &MotionRules) -> Option<Rest> {
        let spot = self.spot;
        let newer = |sensed: &Sensed| {
            spot.is_none_or(|spot| spot.until.since(sensed.until) <= seconds(rules.evidence_s))
        };
        match self.sensed.filter(newer) {
            Some(Sensed { motion, since, until }) => motion.is_rest().then(|| {
                let since = spot.map_or(since, |spot| spot.since.max(since));
                Rest { since, lasting: until.since(since).max(Interval::ZERO), sensed: true }
            }),
            None => spot.map(|Spot { since, until, .. }| Rest {
                since,
                lasting: until.since(since),
                sensed: false,
            }),
        }
    }

    /// Has not moved for as long as makes an alarm: since when.
    pub fn is_too_long(&self, rules: &MotionRules) -> Option<Time> {
        let Rest { since, lasting, sensed } = self.rest(rules)?;
        let limit_s = if sensed { rules.still_after_s } else { rules.still_position_after_s };
        (lasting >= seconds(limit_s)).then_some(since)
    }

    /// For how long after the last fix they may have walked.
    pub fn roaming(&self, fixed: Time, now: Time) -> Interval {
        let since = now.since(fixed).nanos().saturating_sub(self.rested.nanos());
        Interval::from_nanos(since.max(0))
    }

    pub fn view(&self) -> Option<MotionView> {
        self.sensed.map(|Sensed { motion, since, .. }| MotionView { motion, since })
    }
}
