//! The state, and what becomes of each input.

use crate::alarms::{About, AlarmBook, AlarmKey, AlarmKind};
use crate::command::{Ignored, Outcome};
use crate::evacuation::Evacuation;
use crate::event::Event;
use crate::ground::Ground;
use crate::input::{Activity, Battery, Button, Charge, Device, DeviceKind, Fix, Heard, Input, Motion};
use crate::people::{Roster, Tag, TagRecord};
use crate::presence::Seen;
use crate::refused::Refused;
use crate::rules::{Rules, RulesError};
use crate::stage::Stage;
use crate::time::seconds;
use crate::zones::{Counts, LiveZone};
use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_mine::Mine;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How long an id is at most.
pub const ID_LENGTH: usize = 128;

/// Everybody and everything that is followed in a mine. See the [crate](crate) for how it is used.
///
/// It is serialised without the mine: what was read back is [attached](Self::attach) to it before it goes on, bit for bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Tracking {
    #[serde(skip)]
    pub(crate) ground: Option<Ground>,
    #[serde(skip)]
    pub(crate) counts: Counts,
    pub(crate) rules: Rules,
    pub(crate) now: Time,
    pub(crate) listening: Listening,
    /// Ids of the levels, in the order of the numbers that presences use.
    pub(crate) levels: Vec<String>,
    pub(crate) zones: BTreeMap<String, LiveZone>,
    pub(crate) roster: Roster,
    pub(crate) alarms: AlarmBook,
    pub(crate) devices: Devices,
    pub(crate) evacuation: Option<Evacuation>,
    pub(crate) evacuations: u64,
}

/// Gateways and anchors by kind and id: whether they work, and since when.
pub type Devices = [BTreeMap<String, (bool, Time)>; 2];

/// Whether anything is heard at all.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Listening {
    /// Since when whoever speaks would be heard.
    pub since: Time,
    pub last_tick: Option<Time>,
    pub last_heard: Option<Time>,
    pub silent: bool,
}

impl Tracking {
    /// Nobody yet, in the zones of the mine's plan.
    pub fn new(mine: Arc<Mine>, rules: Rules) -> Result<Self, RulesError> {
        rules.check()?;
        let mut tracking = Self {
            ground: None,
            counts: Counts::default(),
            rules,
            now: Time::ZERO,
            listening: Listening::default(),
            levels: Vec::new(),
            zones: zones_of(&mine),
            roster: Roster::default(),
            alarms: AlarmBook::default(),
            devices: Devices::default(),
            evacuation: None,
            evacuations: 0,
        };
        tracking.attach(mine);
        Ok(tracking)
    }

    /// Gives a state that was read back its mine. The zones stay those of the state (see [`Command::ResetZones`](crate::Command::ResetZones));
    /// on levels that the mine has no more is nobody.
    pub fn attach(&mut self, mine: Arc<Mine>) {
        let ground = Ground::new(mine, &self.zones);
        let before = core::mem::replace(&mut self.levels, ground.levels.ids().map(Into::into).collect());
        for (_, presence) in self.roster.everybody() {
            for level in [&mut presence.level, &mut presence.counted_level] {
                *level = level.and_then(|level| ground.levels.index(before.get(usize::from(level))?));
            }
        }
        self.ground = Some(ground);
        self.recount();
    }

    /// Counts everybody again.
    pub(crate) fn recount(&mut self) {
        let Some(ground) = &self.ground else { return };
        let mut counts = Counts::new(&ground.levels, &ground.watch);
        for (who, presence) in self.roster.everybody_seen() {
            let is_person = who.person.is_some();
            let places = presence.stays.iter().filter_map(|stay| ground.watch.index(&stay.zone));
            for zone in places {
                if let Some(count) = counts.zones.get_mut(zone) {
                    *count.of_mut(is_person, who.kind) += 1;
                }
            }
            let level = presence.counted_level.map(usize::from);
            if let Some(count) = level.and_then(|level| counts.levels.get_mut(level)) {
                *count.of_mut(is_person, who.kind) += 1;
            }
            if presence.is_below() {
                *counts.mine.of_mut(is_person, who.kind) += 1;
            }
        }
        self.counts = counts;
    }

    /// Takes one input that arrived at `now` and tells what follows of it. Only commands are refused, whole; whatever else comes is
    /// taken, or ignored for a reason that is told. Time does not run backwards: an earlier `now` counts as the last one.
    pub fn hear(&mut self, now: Time, input: &Input, events: &mut Vec<Event>) -> Result<Outcome, Refused> {
        self.now = self.now.max(now);
        if self.ground.is_none() {
            return match input {
                Input::Command { .. } => Err(Refused::NoMine),
                _ => Ok(Outcome::Ignored(Ignored::NoMine)),
            };
        }
        let heard = match input {
            Input::Fix(fix) => self.fix(fix, events),
            Input::Heard(heard) => self.heard(heard, events),
            Input::Battery(battery) => self.battery(battery, events),
            Input::Button(button) => self.button(button, events),
            Input::Activity(activity) => self.activity(activity, events),
            Input::Device(device) => self.device(device, events),
            Input::Tick => {
                self.tick(events);
                Ok(())
            }
            Input::Command { by, command } => {
                self.command(by, command, events)?;
                Ok(())
            }
        };
        Ok(heard.map_or_else(Outcome::Ignored, |()| Outcome::Done))
    }

    /// Everything but the roster, to act on one presence of it.
    pub(crate) fn stage<'a>(&'a mut self, events: &'a mut Vec<Event>) -> Option<(Stage<'a>, &'a mut Roster)> {
        let Self { ground, counts, rules, now, roster, alarms, .. } = self;
        let stage = Stage { now: *now, rules, ground: ground.as_ref()?, counts, alarms, events };
        Some((stage, roster))
    }

    /// The moment of something that is told now: not in the future.
    fn moment(&self, time: Time) -> Result<Time, Ignored> {
        if time > self.now + seconds(self.rules.contact.future_s) {
            return Err(Ignored::Future);
        }
        Ok(time.min(self.now))
    }

    /// A tag speaks: one that nobody has registered is followed too.
    fn speak(
        &mut self,
        (tag, time, gateway): (&str, Time, Option<&str>),
        events: &mut Vec<Event>,
    ) -> Result<(), Ignored> {
        if !self.roster.tags.contains_key(tag) {
            if !is_id(tag) {
                return Err(Ignored::BadId);
            }
            if self.roster.unregistered >= self.rules.contact.unregistered_tags {
                return Err(Ignored::TooManyTags);
            }
            let record = TagRecord { tag: Tag { id: tag.into(), ..Tag::default() }, ..TagRecord::default() };
            self.roster.tags.insert(tag.into(), record);
            self.roster.unregistered += 1;
            events.push(Event::TagAppeared { tag: tag.into(), time });
        }
        self.listening.last_heard = self.listening.last_heard.max(Some(time));
        let limit = self.now - seconds(self.rules.contact.lost_after_s);
        let Some(record) = self.roster.tags.get_mut(tag) else { return Ok(()) };
        let silent_before = record.heard.is_none_or(|heard| heard < limit);
        if record.heard.is_none_or(|heard| heard < time) {
            record.heard = Some(time);
            if let Some(gateway) = gateway.filter(|gateway| record.gateway.as_deref() != Some(*gateway)) {
                record.gateway = Some(gateway.into());
            }
        }
        if silent_before && let Some(wearer) = record.wearer.clone() {
            self.roster.choose_lead(&wearer, limit);
        }
        let Some((mut stage, roster)) = self.stage(events) else { return Ok(()) };
        if let Some((who, presence)) = roster.bearer(tag) {
            stage.hear(&who, presence, time, gateway);
        }
        Ok(())
    }

    fn fix(&mut self, fix: &Fix, events: &mut Vec<Event>) -> Result<(), Ignored> {
        let p = fix.position_m.raw();
        let velocity = fix.velocity_m_s.is_none_or(|v| v.raw().iter().all(|x| x.is_finite()));
        let radii = [fix.radius_95_m, fix.protection_level_m];
        // Coordinates as the check of a mine wants them.
        let place = p.iter().all(|x| x.abs() <= 1e7);
        if !place || !velocity || !radii.iter().all(|r| r.is_finite() && *r >= 0.0) {
            return Err(Ignored::NotANumber);
        }
        let time = self.moment(fix.time)?;
        self.speak((&fix.tag, time, None), events)?;
        if fix.quality == Quality::Lost {
            return Err(Ignored::Lost);
        }
        let Some(record) = self.roster.tags.get_mut(&fix.tag) else { return Ok(()) };
        if record.seen.as_ref().is_some_and(|seen| time <= seen.time) {
            return Err(Ignored::Late);
        }
        let seen = Seen { time, ..Seen::from(fix) };
        record.seen = Some(seen.clone());
        let Some((mut stage, roster)) = self.stage(events) else { return Ok(()) };
        if let Some((who, presence)) = roster.followed(&fix.tag) {
            // A tag that leads since a moment ago may be behind the one that led.
            if presence.seen.as_ref().is_some_and(|last| time <= last.time) {
                return Err(Ignored::Late);
            }
            presence.stillness.fix(&seen, fix.moving, &stage.rules.motion);
            stage.place(&who, presence, seen, &fix.tag);
        }
        Ok(())
    }

    fn heard(&mut self, heard: &Heard, events: &mut Vec<Event>) -> Result<(), Ignored> {
        let time = self.moment(heard.time)?;
        let gateway = heard.gateway.as_deref().filter(|gateway| is_id(gateway));
        self.speak((&heard.tag, time, gateway), events)
    }

    fn battery(&mut self, battery: &Battery, events: &mut Vec<Event>) -> Result<(), Ignored> {
        let (Charge::Share(value) | Charge::Volts(value)) = battery.charge;
        if !value.is_finite() || value < 0.0 {
            return Err(Ignored::NotANumber);
        }
        let time = self.moment(battery.time)?;
        self.speak((&battery.tag, time, None), events)?;
        let Some(record) = self.roster.tags.get_mut(&battery.tag) else { return Ok(()) };
        if record.battery.is_some_and(|(last, _)| time <= last) {
            return Err(Ignored::Late);
        }
        record.battery = Some((time, battery.charge));
        let rules = &self.rules.battery;
        let (low, fine) = match battery.charge {
            Charge::Share(share) => (share <= rules.low_share, share >= rules.fine_share),
            Charge::Volts(volts) => (volts <= rules.low_volts, volts >= rules.fine_volts),
        };
        let low = low || (record.battery_low && !fine);
        if low != record.battery_low {
            record.battery_low = low;
            let place = record.seen.as_ref().map(|seen| seen.position_m);
            let about = About::Tag(battery.tag.clone());
            let key = AlarmKey { kind: AlarmKind::LowBattery, about, zone: None };
            if low {
                self.alarms.begin(self.now, key, (time, place), &self.rules, events);
            } else {
                self.alarms.end(self.now, &key, &self.rules, events);
            }
        }
        Ok(())
    }

    /// Distress is never too late, and never from the future.
    fn button(&mut self, button: &Button, events: &mut Vec<Event>) -> Result<(), Ignored> {
        let time = button.time.min(self.now);
        self.speak((&button.tag, time, None), events)?;
        let Some(record) = self.roster.tags.get_mut(&button.tag) else { return Ok(()) };
        if record.button.is_some_and(|last| time <= last) {
            return Err(Ignored::Late);
        }
        record.button = Some(time);
        let Some((mut stage, roster)) = self.stage(events) else { return Ok(()) };
        if let Some((who, presence)) = roster.bearer(&button.tag) {
            stage.begin(&who, presence, AlarmKind::Distress, None, time);
        }
        Ok(())
    }

    fn activity(&mut self, activity: &Activity, events: &mut Vec<Event>) -> Result<(), Ignored> {
        let time = self.moment(activity.time)?;
        self.speak((&activity.tag, time, None), events)?;
        let Some((mut stage, roster)) = self.stage(events) else { return Ok(()) };
        let fallen = activity.motion == Motion::Fallen;
        if let Some((who, presence)) = roster.followed(&activity.tag) {
            let fixed = presence.seen.as_ref().map(|seen| seen.time);
            if !presence.stillness.activity(activity.motion, time, fixed, &stage.rules.motion) {
                return Err(Ignored::Late);
            }
            if fallen && who.is_somebody() {
                stage.begin(&who, presence, AlarmKind::ManDown, None, time);
            }
        }
        Ok(())
    }

    fn device(&mut self, device: &Device, events: &mut Vec<Event>) -> Result<(), Ignored> {
        let time = self.moment(device.time)?;
        if !is_id(&device.id) {
            return Err(Ignored::BadId);
        }
        let (kind, id) = (device.kind, device.id.clone());
        let known = self.devices[kind as usize].get_mut(&id);
        if known.as_ref().is_some_and(|(_, since)| time < *since) {
            return Err(Ignored::Late);
        }
        let was_up = known.as_ref().map(|(up, _)| *up);
        if was_up == Some(device.up) {
            return Ok(());
        }
        self.devices[kind as usize].insert(id.clone(), (device.up, time));
        let key = device_key(kind, &id);
        if device.up {
            events.push(Event::DeviceUp { kind, id, time });
            self.alarms.end(self.now, &key, &self.rules, events);
        } else {
            events.push(Event::DeviceDown { kind, id, time });
            self.alarms.begin(self.now, key, (time, None), &self.rules, events);
        }
        Ok(())
    }
}

/// The alarm of a device.
pub fn device_key(kind: DeviceKind, id: &str) -> AlarmKey {
    let (kind, about) = match kind {
        DeviceKind::Gateway => (AlarmKind::GatewayDown, About::Gateway(id.into())),
        DeviceKind::Anchor => (AlarmKind::AnchorDown, About::Anchor(id.into())),
    };
    AlarmKey { kind, about, zone: None }
}

/// The zones of a mine's plan.
pub fn zones_of(mine: &Mine) -> BTreeMap<String, LiveZone> {
    mine.plan().zones.iter().map(|zone| (zone.id.clone(), LiveZone::from(zone.clone()))).collect()
}

/// An id that may be kept.
pub fn is_id(id: &str) -> bool {
    !id.is_empty() && id.chars().count() <= ID_LENGTH && !id.chars().any(char::is_control)
}
