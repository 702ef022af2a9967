//! What users want, done or refused.

mod people;
mod zones;

use crate::alarms::{AlarmKind, NOTE_LENGTH};
use crate::command::Command;
use crate::evacuation::Evacuation;
use crate::event::Event;
use crate::input::DeviceKind;
use crate::refused::Refused;
use crate::rules::Rules;
use crate::tracking::{ID_LENGTH, Tracking, device_key, is_id};
use std::collections::BTreeSet;

/// How long a name is at most, characters.
const NAME_LENGTH: usize = 256;

impl Tracking {
    pub(crate) fn command(
        &mut self,
        by: &str,
        command: &Command,
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        let now = self.now;
        match command {
            Command::CreatePerson { person } => self.create_person(person),
            Command::ChangePerson { person } => self.change_person(person, events),
            Command::RemovePerson { person } => self.remove_person(person, events),
            Command::CreateTag { tag } => self.create_tag(tag, events),
            Command::ChangeTag { tag } => self.change_tag(tag, events),
            Command::RemoveTag { tag } => self.remove_tag(tag, events),
            Command::Assign { tag, person, from, until } => self.assign(tag, person, (*from, *until), events),
            Command::Unassign { tag } => self.unassign(tag, events),
            Command::MarkOut { person, note } => self.mark_out(person, note, events),
            Command::CreateZone { zone } => self.create_zone(zone, events),
            Command::ChangeZone { zone } => self.change_zone(zone, events),
            Command::SetCapacity { zone, capacity } => self.set_capacity(zone, *capacity, events),
            Command::RemoveZone { zone } => self.remove_zone(zone, events),
            Command::ResetZones => {
                self.reset_zones(events);
                Ok(())
            }
            Command::Acknowledge { alarm, note } => self.alarms.acknowledge(now, *alarm, by, note, events),
            Command::Clear { alarm, note } => self.alarms.clear(now, (*alarm, by, note), &self.rules, events),
            Command::Comment { alarm, text } => self.alarms.comment(now, *alarm, by, text, events),
            Command::StartEvacuation { levels, note } => self.start_evacuation(by, levels, note, events),
            Command::StopEvacuation { note } => self.stop_evacuation(by, note, events),
            Command::ForgetDevice { kind, id } => self.forget_device(*kind, id, events),
            Command::SetRules { rules } => self.set_rules(rules, events),
        }
    }

    fn start_evacuation(
        &mut self,
        by: &str,
        levels: &BTreeSet<String>,
        note: &str,
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        if let Some(running) = &self.evacuation {
            return Err(Refused::Evacuating { since: running.since });
        }
        if let Some(level) = levels.iter().find(|level| !self.levels.contains(level)) {
            return Err(Refused::UnknownLevel { level: level.clone() });
        }
        no_longer_than("a note", note, NOTE_LENGTH)?;
        self.evacuations += 1;
        let evacuation = Evacuation {
            id: self.evacuations,
            since: self.now,
            by: by.into(),
            note: note.into(),
            levels: levels.clone(),
        };
        let Evacuation { id, since: time, .. } = evacuation;
        let (by, note, levels) = (by.into(), note.into(), levels.clone());
        events.push(Event::EvacuationStarted { id, by, note, levels, time });
        if let Some((stage, roster)) = self.stage(events) {
            for (_, presence) in roster.everybody().filter(|(who, _)| who.is_somebody()) {
                evacuation.follow(presence, stage.now, stage.ground, stage.rules);
            }
        }
        self.evacuation = Some(evacuation);
        Ok(())
    }

    fn stop_evacuation(&mut self, by: &str, note: &str, events: &mut Vec<Event>) -> Result<(), Refused> {
        no_longer_than("a note", note, NOTE_LENGTH)?;
        let summary = self.evacuation().ok_or(Refused::NotEvacuating)?.summary;
        let id = self.evacuations;
        for (_, presence) in self.roster.everybody() {
            presence.evacuation = None;
        }
        self.evacuation = None;
        let (by, note, time) = (by.into(), note.into(), self.now);
        events.push(Event::EvacuationStopped { id, by, note, time, summary });
        let missing = |key: &crate::alarms::AlarmKey| key.kind == AlarmKind::MissingInEvacuation;
        self.alarms.end_all(self.now, missing, &self.rules, events);
        Ok(())
    }

    fn forget_device(&mut self, kind: DeviceKind, id: &str, events: &mut Vec<Event>) -> Result<(), Refused> {
        if self.devices[kind as usize].remove(id).is_none() {
            return Err(Refused::UnknownDevice { id: id.into() });
        }
        self.alarms.end(self.now, &device_key(kind, id), &self.rules, events);
        Ok(())
    }

    fn set_rules(&mut self, rules: &Rules, events: &mut Vec<Event>) -> Result<(), Refused> {
        rules.check()?;
        self.rules = rules.clone();
        self.alarms.new_rules(self.now, &self.rules, events);
        let people: Vec<String> = self.roster.people.keys().cloned().collect();
        for person in people {
            self.judge_tags(&person, events);
        }
        Ok(())
    }
}

fn check_id(what: &'static str, id: &str) -> Result<(), Refused> {
    if is_id(id) {
        return Ok(());
    }
    Err(Refused::BadId { what, id: id.chars().take(ID_LENGTH).collect(), limit: ID_LENGTH })
}

fn no_longer_than(what: &'static str, text: &str, limit: usize) -> Result<(), Refused> {
    let found = text.chars().count();
    if found > limit { Err(Refused::TooLong { what, limit, found }) } else { Ok(()) }
}

fn check_names<'a>(names: impl IntoIterator<Item = &'a String>) -> Result<(), Refused> {
    names.into_iter().try_for_each(|name| no_longer_than("a name", name, NAME_LENGTH))
}

fn check_number(what: &'static str, found: f64, fits: bool, expected: &'static str) -> Result<(), Refused> {
    if fits { Ok(()) } else { Err(Refused::BadNumber { what, expected, found }) }
}
