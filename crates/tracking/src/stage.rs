//! One presence at a time, with everything that follows of what happens to it: counts, events, conditions of alarms.

use crate::alarms::{About, AlarmBook, AlarmKey, AlarmKind};
use crate::event::{Event, Exit, WayOut};
use crate::ground::Ground;
use crate::presence::{Change, Day, Path, Presence, Seen, Who};
use crate::rules::Rules;
use crate::time::{hours, seconds};
use crate::view::Count;
use crate::zones::{Counts, Shape};
use adit_core::frames::{MineGrid, Position};
use adit_core::time::Time;
use adit_mine::plan::ZoneKind;

/// All but the presences.
pub struct Stage<'a> {
    pub now: Time,
    pub rules: &'a Rules,
    pub ground: &'a Ground,
    pub counts: &'a mut Counts,
    pub alarms: &'a mut AlarmBook,
    pub events: &'a mut Vec<Event>,
}

/// Adds somebody to a count, or takes them off.
fn tally(count: &mut Count, who: &Who<'_>, comes: bool) {
    let place = count.of_mut(who.person.is_some(), who.kind);
    *place = if comes { place.saturating_add(1) } else { place.saturating_sub(1) };
}

impl Stage<'_> {
    /// Somebody is at a place.
    pub fn place(&mut self, who: &Who<'_>, presence: &mut Presence, seen: Seen, tag: &str) {
        let Self { rules, ground, .. } = *self;
        let rule = &rules.position;
        let level = ground.levels.of(presence.level, seen.position_m.raw().z, rule.level_tolerance_m);
        let path = presence
            .seen
            .as_ref()
            .and_then(|last| Path::between((last, presence.level), (&seen, level), rule, &ground.levels));
        let portals = self.portals(presence);
        let mut changes = Vec::new();
        presence.cross(&seen, level, path.as_ref(), &ground.watch, &mut changes);
        presence.level = level;
        let time = seen.time;
        presence.seen = Some(seen);
        if presence.seen_by != tag {
            presence.seen_by.clear();
            presence.seen_by.push_str(tag);
        }
        self.apply(who, presence, (portals, time), &changes);
    }

    /// How many portals somebody is in.
    pub fn portals(&self, presence: &Presence) -> usize {
        let is_portal =
            |zone: &str| self.ground.watch.find(zone).is_some_and(|shape| shape.kind() == ZoneKind::Portal);
        presence.stays.iter().filter(|stay| is_portal(&stay.zone)).count()
    }

    /// What follows of changes of the stays, which were made already; `before` is the number of portals that somebody was in.
    pub fn apply(
        &mut self,
        who: &Who<'_>,
        presence: &mut Presence,
        (before, time): (usize, Time),
        changes: &[Change],
    ) {
        let mut portals = before;
        if !presence.is_below() && before == 0 && self.portals(presence) == 0 {
            self.go_below(who, presence, time);
        }
        for change in changes {
            match *change {
                Change::Entered { zone, time, entry } => {
                    let Some(shape) = self.ground.watch.get(zone) else { continue };
                    let subject = who.subject();
                    let id = shape.id().to_owned();
                    self.events.push(Event::ZoneEntered { zone: id, subject, kind: who.kind, time, entry });
                    self.count(zone, who, true);
                    if shape.kind() == ZoneKind::Portal {
                        portals += 1;
                        self.come_out(who, presence, time, WayOut::Portal);
                    }
                    self.judge_stay(who, presence, shape, time);
                    self.judge_capacity(zone, time);
                }
                Change::Left { zone, entered, time, exit } => {
                    let Some(shape) = self.ground.watch.get(zone) else { continue };
                    self.leave(who, shape, (entered, time), exit);
                    self.count(zone, who, false);
                    self.judge_capacity(zone, time);
                    if shape.kind() == ZoneKind::Portal {
                        portals = portals.saturating_sub(1);
                        if portals == 0 {
                            self.go_below(who, presence, time);
                        }
                    }
                }
            }
        }
        self.count_level(who, presence, time);
    }

    fn leave(&mut self, who: &Who<'_>, shape: &Shape, (entered, time): (Time, Time), exit: Exit) {
        let (zone, subject) = (shape.id().to_owned(), who.subject());
        self.events.push(Event::ZoneLeft { zone, subject, kind: who.kind, entered, time, exit });
        for kind in [AlarmKind::DangerousZone, AlarmKind::RestrictedZone] {
            self.end(who, kind, Some(shape.id()));
        }
    }

    fn count(&mut self, zone: usize, who: &Who<'_>, comes: bool) {
        if let Some(count) = self.counts.zones.get_mut(zone) {
            tally(count, who, comes);
        }
    }

    /// Puts somebody onto the level where they are counted.
    fn count_level(&mut self, who: &Who<'_>, presence: &mut Presence, time: Time) {
        let to = if presence.is_below() { presence.level } else { None };
        let from = core::mem::replace(&mut presence.counted_level, to);
        if from == to {
            return;
        }
        for (level, comes) in [(from, false), (to, true)] {
            if let Some(count) = level.and_then(|level| self.counts.levels.get_mut(usize::from(level))) {
                tally(count, who, comes);
            }
        }
        let id = |level: Option<u16>| level.and_then(|level| self.ground.levels.id(level)).map(str::to_owned);
        let (from, to) = (id(from), id(to));
        self.events.push(Event::LevelChanged { subject: who.subject(), kind: who.kind, from, to, time });
    }

    /// Somebody is below from now on.
    fn go_below(&mut self, who: &Who<'_>, presence: &mut Presence, time: Time) {
        let pause = seconds(self.rules.shifts.break_s);
        let shift_since = match presence.day {
            Day::Below { .. } => return,
            Day::Out { since, shift_since: Some(begun) } if time.since(since) <= pause => begun,
            Day::Out { .. } | Day::Unseen => time,
        };
        presence.day = Day::Below { shift_since };
        tally(&mut self.counts.mine, who, true);
        self.events.push(Event::WentBelow { subject: who.subject(), kind: who.kind, time, shift_since });
        self.count_level(who, presence, time);
    }

    /// Somebody is out from now on.
    fn come_out(&mut self, who: &Who<'_>, presence: &mut Presence, time: Time, way: WayOut) {
        match presence.day {
            Day::Out { .. } => {}
            Day::Unseen => presence.day = Day::Out { since: time, shift_since: None },
            Day::Below { shift_since } => {
                presence.day = Day::Out { since: time, shift_since: Some(shift_since) };
                tally(&mut self.counts.mine, who, false);
                let (subject, kind) = (who.subject(), who.kind);
                self.events.push(Event::CameOut { subject, kind, time, shift_since, way });
                self.count_level(who, presence, time);
                presence.lost = false;
                presence.overtime = false;
                presence.still = false;
                for kind in [AlarmKind::LostContact, AlarmKind::Overtime, AlarmKind::NoMotion] {
                    self.end(who, kind, None);
                }
            }
        }
    }

    /// Takes somebody out of all zones and the mine.
    pub fn withdraw(&mut self, who: &Who<'_>, presence: &mut Presence) {
        let now = self.now;
        for stay in core::mem::take(&mut presence.stays) {
            let Some(zone) = self.ground.watch.index(&stay.zone) else { continue };
            let Some(shape) = self.ground.watch.get(zone) else { continue };
            self.leave(who, shape, (stay.since, now.max(stay.since)), Exit::Commanded);
            self.count(zone, who, false);
            self.judge_capacity(zone, now);
        }
        self.come_out(who, presence, now, WayOut::Commanded);
    }

    /// Whether a stay in a zone makes an alarm.
    pub fn judge_stay(&mut self, who: &Who<'_>, presence: &Presence, shape: &Shape, since: Time) {
        let kind = shape.kind();
        let danger = who.is_somebody() && kind == ZoneKind::Dangerous;
        let trespass = who.is_somebody() && kind == ZoneKind::Restricted && !who.may_enter(&shape.live);
        for (kind, holds) in [(AlarmKind::DangerousZone, danger), (AlarmKind::RestrictedZone, trespass)] {
            if holds {
                self.begin(who, presence, kind, Some(shape.id()), since);
            } else {
                self.end(who, kind, Some(shape.id()));
            }
        }
    }

    /// Whether too many are in a zone.
    pub fn judge_capacity(&mut self, zone: usize, since: Time) {
        let Some((shape, count)) = self.ground.watch.get(zone).zip(self.counts.zones.get(zone)) else {
            return;
        };
        let about = About::Zone(shape.id().to_owned());
        let key = AlarmKey { kind: AlarmKind::OverCapacity, about, zone: None };
        if shape.live.zone.capacity.is_some_and(|capacity| count.heads() > capacity) {
            self.alarms.begin(self.now, key, (since, None), self.rules, self.events);
        } else {
            self.alarms.end(self.now, &key, self.rules, self.events);
        }
    }

    pub fn begin(
        &mut self,
        who: &Who<'_>,
        presence: &Presence,
        kind: AlarmKind,
        zone: Option<&str>,
        since: Time,
    ) {
        let place: Option<Position<MineGrid>> = presence.seen.as_ref().map(|seen| seen.position_m);
        self.alarms.begin(self.now, key(who, kind, zone), (since, place), self.rules, self.events);
    }

    pub fn end(&mut self, who: &Who<'_>, kind: AlarmKind, zone: Option<&str>) {
        self.alarms.end(self.now, &key(who, kind, zone), self.rules, self.events);
    }

    /// Somebody was heard.
    pub fn hear(&mut self, who: &Who<'_>, presence: &mut Presence, time: Time, gateway: Option<&str>) {
        let last = presence.heard;
        if last.is_some_and(|last| time <= last) {
            return;
        }
        presence.heard = Some(time);
        if let Some(gateway) = gateway
            && presence.gateway.as_deref() != Some(gateway)
        {
            presence.gateway = Some(gateway.into());
        }
        if presence.lost && self.now.since(time) <= seconds(self.rules.contact.lost_after_s) {
            presence.lost = false;
            let last_heard = last.unwrap_or(time);
            self.events.push(Event::ContactRegained { subject: who.subject(), last_heard, time });
            self.end(who, AlarmKind::LostContact, None);
        }
    }

    /// A second has passed for somebody. `listening` is since when anybody could have heard them.
    pub fn second(&mut self, who: &Who<'_>, presence: &mut Presence, listening: Time) {
        let (now, rules) = (self.now, self.rules);
        if presence.stays.iter().any(|stay| stay.leaving.is_some()) {
            let portals = self.portals(presence);
            let mut changes = Vec::new();
            presence.expire(now, &self.ground.watch, &mut changes);
            if let Some(time) = changes.last().map(Change::time) {
                self.apply(who, presence, (portals, time), &changes);
            }
        }
        let Day::Below { shift_since } = presence.day else { return };
        if !who.is_somebody() {
            return;
        }
        let heard = presence.heard.map_or(listening, |heard| heard.max(listening));
        if !presence.lost && now.since(heard) > seconds(rules.contact.lost_after_s) {
            presence.lost = true;
            let last_heard = presence.heard.unwrap_or(shift_since);
            self.events.push(Event::ContactLost { subject: who.subject(), last_heard });
            self.begin(who, presence, AlarmKind::LostContact, None, last_heard);
        }
        let limit_h = who.person.and_then(|person| person.shift_limit_h).unwrap_or(rules.shifts.limit_h);
        let overtime = who.person.is_some() && now.since(shift_since) > hours(limit_h);
        if overtime != presence.overtime {
            presence.overtime = overtime;
            if overtime {
                self.begin(who, presence, AlarmKind::Overtime, None, shift_since + hours(limit_h));
            } else {
                self.end(who, AlarmKind::Overtime, None);
            }
        }
        let rest = presence.stillness.is_too_long(&rules.motion).filter(|_| !self.may_rest(presence));
        if rest.is_some() != presence.still {
            presence.still = rest.is_some();
            if let Some(since) = rest {
                self.begin(who, presence, AlarmKind::NoMotion, None, since);
            } else {
                self.end(who, AlarmKind::NoMotion, None);
            }
        }
    }

    /// In a refuge people sit.
    fn may_rest(&self, presence: &Presence) -> bool {
        let refuge =
            |zone: &str| self.ground.watch.find(zone).is_some_and(|shape| shape.kind() == ZoneKind::Refuge);
        presence.stays.iter().any(|stay| refuge(&stay.zone))
    }
}

fn key(who: &Who<'_>, kind: AlarmKind, zone: Option<&str>) -> AlarmKey {
    AlarmKey { kind, about: who.subject().into(), zone: zone.map(Into::into) }
}
