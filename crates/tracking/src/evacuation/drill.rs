//! A running evacuation, and how each who is concerned stands in it.

use super::status::EvacuationStatus;
use crate::ground::Ground;
use crate::presence::{Day, Presence};
use crate::rules::Rules;
use crate::time::seconds;
use crate::zones::LevelIndex;
use adit_core::time::Time;
use adit_mine::plan::ZoneKind;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// An evacuation that runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evacuation {
    pub id: u64,
    pub since: Time,
    pub by: String,
    pub note: String,
    pub levels: BTreeSet<String>,
}

/// How somebody stands in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    pub status: EvacuationStatus,
    /// Since when they stand so.
    pub since: Time,
    /// When they were found to be concerned, and how long the way to the nearest exit was from there, m.
    pub began: Time,
    pub way_m: Option<f64>,
    pub missing: bool,
}

impl Evacuation {
    /// Is this level to be left?
    pub fn concerns(&self, level: Option<LevelIndex>, ground: &Ground) -> bool {
        self.levels.is_empty()
            || level.and_then(|level| ground.levels.id(level)).is_some_and(|id| self.levels.contains(id))
    }

    /// How somebody stands now.
    pub fn status(&self, presence: &Presence, now: Time, ground: &Ground, rules: &Rules) -> EvacuationStatus {
        if !matches!(presence.day, Day::Below { .. }) {
            return EvacuationStatus::Out;
        }
        let refuge =
            |zone: &str| ground.watch.find(zone).is_some_and(|shape| shape.kind() == ZoneKind::Refuge);
        if presence.stays.iter().any(|stay| refuge(&stay.zone)) {
            return EvacuationStatus::InRefuge;
        }
        if !self.concerns(presence.counted_level, ground) {
            return EvacuationStatus::OtherLevel;
        }
        let lost_after = seconds(rules.contact.lost_after_s);
        if presence.heard.is_none_or(|heard| now.since(heard) > lost_after) {
            return EvacuationStatus::Unknown;
        }
        let still_after = seconds(rules.evacuation.not_moving_after_s);
        match presence.stillness.rest(&rules.motion) {
            Some(rest) if rest.lasting >= still_after => EvacuationStatus::NotMoving,
            _ => EvacuationStatus::MovingOut,
        }
    }

    /// Takes somebody who is below into account, or brings up to date how they stand. True when that makes them missing.
    pub fn follow(&self, presence: &mut Presence, now: Time, ground: &Ground, rules: &Rules) -> bool {
        let concerned = presence.is_below() && self.concerns(presence.counted_level, ground);
        if presence.evacuation.is_none() && !concerned {
            return false;
        }
        let status = self.status(presence, now, ground, rules);
        let place = presence.seen.as_ref().map(|seen| seen.position_m);
        let mark = presence.evacuation.get_or_insert_with(|| Mark {
            status,
            since: now,
            began: now,
            way_m: place.and_then(|place| ground.exits.nearest(&ground.mine, &place).length_m()),
            missing: false,
        });
        // Who stops and goes on has not been away from both: being late begins with the first stop.
        let stuck = |status| matches!(status, EvacuationStatus::NotMoving | EvacuationStatus::Unknown);
        if mark.status != status {
            if !(stuck(mark.status) && stuck(status)) {
                mark.since = now;
            }
            mark.status = status;
        }
        let missing_after = seconds(rules.evacuation.missing_after_s);
        let walk = seconds(mark.way_m.unwrap_or(0.0) / rules.evacuation.walking_m_s);
        mark.missing = !status.is_safe()
            && (now >= mark.began + walk + missing_after
                || (stuck(status) && now >= mark.since + missing_after));
        mark.missing
    }
}
