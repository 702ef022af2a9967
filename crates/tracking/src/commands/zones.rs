//! Zones drawn, changed and removed while people are in them.

use super::{check_id, check_names, check_number};
use crate::event::{Entry, Event, Exit};
use crate::presence::{Change, Stay};
use crate::refused::Refused;
use crate::tracking::{Tracking, zones_of};
use crate::zones::LiveZone;
use std::collections::{BTreeMap, BTreeSet};

/// Most corners that an outline has: every fix near a zone asks all of them.
const CORNERS: usize = 10_000;

impl Tracking {
    pub(super) fn create_zone(&mut self, zone: &LiveZone, events: &mut Vec<Event>) -> Result<(), Refused> {
        self.check_zone(zone)?;
        if self.zones.contains_key(&zone.zone.id) {
            return Err(Refused::Exists { what: "zone", id: zone.zone.id.clone() });
        }
        self.put_zone(zone, events);
        Ok(())
    }

    pub(super) fn change_zone(&mut self, zone: &LiveZone, events: &mut Vec<Event>) -> Result<(), Refused> {
        self.check_zone(zone)?;
        self.known_zone(&zone.zone.id)?;
        self.put_zone(zone, events);
        Ok(())
    }

    pub(super) fn set_capacity(
        &mut self,
        zone: &str,
        capacity: Option<u32>,
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        let mut zone = self.known_zone(zone)?.clone();
        zone.zone.capacity = capacity;
        self.put_zone(&zone, events);
        Ok(())
    }

    pub(super) fn remove_zone(&mut self, zone: &str, events: &mut Vec<Event>) -> Result<(), Refused> {
        self.known_zone(zone)?;
        let mut zones = self.zones.clone();
        zones.remove(zone);
        self.rezone(zones, events);
        Ok(())
    }

    pub(super) fn reset_zones(&mut self, events: &mut Vec<Event>) {
        if let Some(ground) = &self.ground {
            let zones = zones_of(&ground.mine);
            self.rezone(zones, events);
        }
    }

    fn known_zone(&self, zone: &str) -> Result<&LiveZone, Refused> {
        self.zones.get(zone).ok_or_else(|| Refused::UnknownZone { zone: zone.into() })
    }

    fn put_zone(&mut self, zone: &LiveZone, events: &mut Vec<Event>) {
        let mut zones = self.zones.clone();
        zones.insert(zone.zone.id.clone(), zone.clone());
        self.rezone(zones, events);
    }

    fn check_zone(&self, LiveZone { zone, allowed_teams }: &LiveZone) -> Result<(), Refused> {
        check_id("zone", &zone.id)?;
        check_names(zone.name.iter().chain(allowed_teams))?;
        if !self.levels.contains(&zone.level) {
            return Err(Refused::UnknownLevel { level: zone.level.clone() });
        }
        let corners = zone.outline_m.len();
        if !(3..=CORNERS).contains(&corners) {
            return Err(Refused::BadOutline { found: format!("{corners} corners") });
        }
        // NaN is not within.
        if let Some(corner) = zone.outline_m.iter().find(|c| !c.iter().all(|x| x.abs() <= 1e7)) {
            return Err(Refused::BadOutline { found: format!("{corner:?}") });
        }
        for (what, found) in
            [("exit_tolerance_m", zone.exit_tolerance_m), ("exit_delay_s", zone.exit_delay_s)]
        {
            check_number(what, found, (0.0..=1e6).contains(&found), "from 0 to 10⁶")?;
        }
        Ok(())
    }

    /// Takes other zones. Who is in a zone that stays what it is stays in it, wherever its outline still holds them.
    fn rezone(&mut self, zones: BTreeMap<String, LiveZone>, events: &mut Vec<Event>) {
        let ids: BTreeSet<String> = self.zones.keys().chain(zones.keys()).cloned().collect();
        let changed: BTreeSet<String> =
            ids.into_iter().filter(|id| self.zones.get(id) != zones.get(id)).collect();
        let Some(mut after) = self.ground.clone() else { return };
        after.rezone(&zones);
        let before = self.zones.clone();
        let Some((mut stage, roster)) = self.stage(events) else { return };
        let now = stage.now;
        for (who, presence) in roster.everybody() {
            let portals = stage.portals(presence);
            let mut changes = Vec::new();
            let (level, seen) = (presence.level, presence.seen.clone());
            presence.stays.retain(|stay| {
                let same =
                    |new: &LiveZone| before.get(&stay.zone).is_some_and(|old| old.zone.kind == new.zone.kind);
                let keeps = !changed.contains(&stay.zone)
                    || after
                        .watch
                        .find(&stay.zone)
                        .filter(|shape| same(&shape.live))
                        .zip(seen.as_ref())
                        .is_some_and(|(shape, seen)| shape.keeps(level, seen.plan_m(), seen.radius_95_m));
                if let Some(zone) = stage.ground.watch.index(&stay.zone).filter(|_| !keeps) {
                    let time = now.max(stay.since);
                    changes.push(Change::Left { zone, entered: stay.since, time, exit: Exit::Commanded });
                }
                keeps
            });
            if !changes.is_empty() {
                stage.apply(&who, presence, (portals, now), &changes);
            }
        }
        self.zones = zones;
        self.ground = Some(after);
        self.recount();
        self.enter_changed(&changed, events);
    }

    /// Who is in the new outline of a zone is in it now, and what makes alarms there is judged again.
    fn enter_changed(&mut self, changed: &BTreeSet<String>, events: &mut Vec<Event>) {
        let Some((mut stage, roster)) = self.stage(events) else { return };
        let time = stage.now;
        for (who, presence) in roster.everybody() {
            let portals = stage.portals(presence);
            // Who was marked as out is no more where they were seen last.
            let Some(seen) = presence.seen.as_ref().filter(|_| presence.is_below() || portals > 0) else {
                continue;
            };
            let (level, at, radius_m) = (presence.level, seen.plan_m(), seen.radius_95_m);
            let mut changes = Vec::new();
            for id in changed {
                let Some((zone, shape)) = stage.ground.watch.index(id).zip(stage.ground.watch.find(id))
                else {
                    continue;
                };
                if let Some(stay) = presence.stays.iter().find(|stay| stay.zone == *id) {
                    stage.judge_stay(&who, presence, shape, stay.since);
                } else if shape.takes(level, at, radius_m) {
                    presence.stays.push(Stay { zone: id.clone(), since: time, leaving: None });
                    changes.push(Change::Entered { zone, time, entry: Entry::Commanded });
                }
            }
            if !changes.is_empty() {
                stage.apply(&who, presence, (portals, time), &changes);
            }
        }
        for zone in changed.iter().filter_map(|id| stage.ground.watch.index(id)) {
            stage.judge_capacity(zone, time);
        }
    }
}
