//! People, tags and who wears which.

use super::{check_id, check_names, check_number};
use crate::alarms::{About, AlarmKey, AlarmKind};
use crate::event::Event;
use crate::people::{Assignment, Person, PersonRecord, Tag, TagKind, TagRecord};
use crate::presence::{Presence, Who};
use crate::refused::Refused;
use crate::time::seconds;
use crate::tracking::Tracking;
use adit_core::time::Time;
use std::collections::BTreeSet;

fn check_person(person: &Person) -> Result<(), Refused> {
    check_id("person", &person.id)?;
    let texts = [&person.team, &person.contact, &person.shift].into_iter().flatten();
    check_names([&person.name].into_iter().chain(texts).chain(&person.allowed_zones))?;
    person.shift_limit_h.map_or(Ok(()), |found| {
        check_number("shift_limit_h", found, found > 0.0 && found <= 1e5, "above 0 and at most 100 000 h")
    })
}

fn check_tag(tag: &Tag) -> Result<(), Refused> {
    check_id("tag", &tag.id)?;
    check_names(&tag.name)
}

impl Tracking {
    pub(super) fn create_person(&mut self, person: &Person) -> Result<(), Refused> {
        check_person(person)?;
        if self.roster.people.contains_key(&person.id) {
            return Err(Refused::Exists { what: "person", id: person.id.clone() });
        }
        let (tags, presence) = (BTreeSet::new(), Presence::default());
        let record = PersonRecord { person: person.clone(), tags, lead: None, presence };
        self.roster.people.insert(person.id.clone(), record);
        Ok(())
    }

    pub(super) fn change_person(&mut self, person: &Person, events: &mut Vec<Event>) -> Result<(), Refused> {
        check_person(person)?;
        self.person_mut(&person.id)?.person = person.clone();
        let Some((mut stage, roster)) = self.stage(events) else { return Err(Refused::NoMine) };
        if let Some(PersonRecord { person, presence, .. }) = roster.people.get(&person.id) {
            for stay in &presence.stays {
                if let Some(shape) = stage.ground.watch.find(&stay.zone) {
                    stage.judge_stay(&Who::person(person), presence, shape, stay.since);
                }
            }
        }
        Ok(())
    }

    pub(super) fn remove_person(&mut self, person: &str, events: &mut Vec<Event>) -> Result<(), Refused> {
        let record = self.person_mut(person)?;
        let id = || person.to_owned();
        if record.presence.is_below() {
            return Err(Refused::PersonBelow { person: id() });
        }
        if let Some(tag) = record.tags.first() {
            return Err(Refused::PersonWears { person: id(), tag: tag.clone() });
        }
        let tags = self.roster.tags.values();
        if let Some(given) = tags.flat_map(|tag| &tag.assignments).find(|given| given.person == person) {
            return Err(Refused::PersonWears { person: id(), tag: given.tag.clone() });
        }
        if let Some((mut stage, roster)) = self.stage(events)
            && let Some(PersonRecord { person, presence, .. }) = roster.people.get_mut(person)
        {
            // Who is out may still be in the zone of a portal.
            stage.withdraw(&Who::person(person), presence);
        }
        self.roster.people.remove(person);
        let about = About::Person(id());
        self.alarms.end_all(self.now, |key| key.about == about, &self.rules, events);
        Ok(())
    }

    pub(super) fn create_tag(&mut self, tag: &Tag, events: &mut Vec<Event>) -> Result<(), Refused> {
        check_tag(tag)?;
        match self.roster.tags.get_mut(&tag.id) {
            Some(record) if record.registered => {
                return Err(Refused::Exists { what: "tag", id: tag.id.clone() });
            }
            Some(record) => {
                record.registered = true;
                self.roster.unregistered = self.roster.unregistered.saturating_sub(1);
            }
            None => {
                let record = TagRecord { tag: tag.clone(), registered: true, ..TagRecord::default() };
                self.roster.tags.insert(tag.id.clone(), record);
            }
        }
        self.describe_tag(tag, events)
    }

    pub(super) fn change_tag(&mut self, tag: &Tag, events: &mut Vec<Event>) -> Result<(), Refused> {
        check_tag(tag)?;
        let record = self.tag_mut(&tag.id)?;
        let given = record.assignments.first();
        if let Some(given) = given.filter(|_| tag.kind != TagKind::Person) {
            return Err(Refused::TagWorn { tag: tag.id.clone(), person: given.person.clone() });
        }
        if !record.registered {
            record.registered = true;
            self.roster.unregistered = self.roster.unregistered.saturating_sub(1);
        }
        self.describe_tag(tag, events)
    }

    /// Takes a new description. A tag of another kind is counted as another from its next fix on.
    fn describe_tag(&mut self, tag: &Tag, events: &mut Vec<Event>) -> Result<(), Refused> {
        let kind = self.tag_mut(&tag.id)?.tag.kind;
        if kind != tag.kind {
            self.take_out_tag(&tag.id, events);
        }
        self.tag_mut(&tag.id)?.tag = tag.clone();
        Ok(())
    }

    pub(super) fn remove_tag(&mut self, tag: &str, events: &mut Vec<Event>) -> Result<(), Refused> {
        let record = self.tag_mut(tag)?;
        if let Some(given) = record.assignments.first() {
            return Err(Refused::TagWorn { tag: tag.into(), person: given.person.clone() });
        }
        self.take_out_tag(tag, events);
        if self.roster.tags.remove(tag).is_some_and(|record| !record.registered) {
            self.roster.unregistered = self.roster.unregistered.saturating_sub(1);
        }
        let about = About::Tag(tag.into());
        self.alarms.end_all(self.now, |key| key.about == about, &self.rules, events);
        Ok(())
    }

    /// A tag that nobody was known to wear is followed no more as such. Distress stays until somebody clears it.
    fn take_out_tag(&mut self, tag: &str, events: &mut Vec<Event>) {
        let Some((mut stage, roster)) = self.stage(events) else { return };
        let Some(record) = roster.tags.get_mut(tag) else { return };
        stage.withdraw(&Who::tag(&record.tag.id, record.tag.kind), &mut record.presence);
        record.presence = Presence::default();
        let about = About::Tag(tag.into());
        let ends = |key: &AlarmKey| {
            key.about == about && !key.kind.is_cleared_by_hand() && key.kind != AlarmKind::LowBattery
        };
        stage.alarms.end_all(stage.now, ends, stage.rules, stage.events);
    }

    pub(super) fn assign(
        &mut self,
        tag: &str,
        person: &str,
        (from, until): (Option<Time>, Option<Time>),
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        let now = self.now;
        self.person_mut(person)?;
        let record = self.tag_mut(tag)?;
        if record.tag.kind != TagKind::Person {
            return Err(Refused::NotWorn { tag: tag.into() });
        }
        let from = from.unwrap_or(now).max(now);
        if let Some(until) = until.filter(|until| *until <= from) {
            return Err(Refused::EndsBeforeItBegins { from, until });
        }
        let given = Assignment { tag: tag.into(), person: person.into(), from, until };
        if let Some(other) =
            record.assignments.iter().find(|other| !other.is_over(now) && other.meets(&given))
        {
            return Err(Refused::TagWorn { tag: tag.into(), person: other.person.clone() });
        }
        record.assignments.push(given);
        record.assignments.sort_by_key(|given| given.from);
        self.settle(tag, events);
        self.roster.schedule(now);
        Ok(())
    }

    pub(super) fn unassign(&mut self, tag: &str, events: &mut Vec<Event>) -> Result<(), Refused> {
        let record = self.tag_mut(tag)?;
        if record.assignments.is_empty() {
            return Err(Refused::TagNotWorn { tag: tag.into() });
        }
        record.assignments.clear();
        self.settle(tag, events);
        self.roster.schedule(self.now);
        Ok(())
    }

    /// Lets a tag be worn by whom it is given to now.
    pub(crate) fn settle(&mut self, tag: &str, events: &mut Vec<Event>) {
        let now = self.now;
        let Some(record) = self.roster.tags.get_mut(tag) else { return };
        record.assignments.retain(|given| !given.is_over(now));
        let person =
            record.assignments.first().filter(|given| given.holds(now)).map(|given| given.person.clone());
        if record.wearer == person {
            return;
        }
        let heard_after = now - seconds(self.rules.contact.lost_after_s);
        if let Some(before) = record.wearer.take() {
            record.presence = Presence::default();
            if let Some(record) = self.roster.people.get_mut(&before) {
                record.tags.remove(tag);
            }
            self.roster.choose_lead(&before, heard_after);
            events.push(Event::TagReturned { tag: tag.into(), person: before.clone(), time: now });
            self.judge_tags(&before, events);
        }
        let Some(person) = person else { return };
        self.take_out_tag(tag, events);
        if let Some(record) = self.roster.tags.get_mut(tag) {
            record.wearer = Some(person.clone());
        }
        if let Some(record) = self.roster.people.get_mut(&person) {
            record.tags.insert(tag.into());
        }
        self.roster.choose_lead(&person, heard_after);
        events.push(Event::TagAssigned { tag: tag.into(), person: person.clone(), time: now });
        self.judge_tags(&person, events);
        self.hand_over(tag, heard_after, events);
    }

    /// Who is given a tag that was heard a moment ago is where it is.
    fn hand_over(&mut self, tag: &str, heard_after: Time, events: &mut Vec<Event>) {
        let Some((mut stage, roster)) = self.stage(events) else { return };
        let Some(record) = roster.tags.get(tag) else { return };
        let (heard, seen) = (record.heard, record.seen.clone());
        let Some((who, presence)) = roster.followed(tag) else { return };
        if let Some(heard) = heard.filter(|heard| *heard >= heard_after) {
            stage.hear(&who, presence, heard, None);
        }
        let newer = |time: Time| presence.seen.as_ref().is_none_or(|last| last.time < time);
        if let Some(seen) = seen.filter(|seen| seen.time >= heard_after && newer(seen.time)) {
            stage.place(&who, presence, seen, tag);
        }
    }

    /// Whether a person wears more tags than one may.
    pub(super) fn judge_tags(&mut self, person: &str, events: &mut Vec<Event>) {
        let Some(record) = self.roster.people.get(person) else { return };
        let place = record.presence.seen.as_ref().map(|seen| seen.position_m);
        let key = AlarmKey { kind: AlarmKind::TwoTags, about: About::Person(person.into()), zone: None };
        if record.tags.len() > self.rules.shifts.tags_per_person as usize {
            self.alarms.begin(self.now, key, (self.now, place), &self.rules, events);
        } else {
            self.alarms.end(self.now, &key, &self.rules, events);
        }
    }

    pub(super) fn mark_out(
        &mut self,
        person: &str,
        note: &str,
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        super::no_longer_than("a note", note, crate::alarms::NOTE_LENGTH)?;
        if !self.person_mut(person)?.presence.is_below() {
            return Err(Refused::PersonNotBelow { person: person.into() });
        }
        let Some((mut stage, roster)) = self.stage(events) else { return Err(Refused::NoMine) };
        if let Some(PersonRecord { person, presence, .. }) = roster.people.get_mut(person) {
            stage.withdraw(&Who::person(person), presence);
        }
        Ok(())
    }

    fn person_mut(&mut self, person: &str) -> Result<&mut PersonRecord, Refused> {
        self.roster.people.get_mut(person).ok_or_else(|| Refused::UnknownPerson { person: person.into() })
    }

    fn tag_mut(&mut self, tag: &str) -> Result<&mut TagRecord, Refused> {
        self.roster.tags.get_mut(tag).ok_or_else(|| Refused::UnknownTag { tag: tag.into() })
    }
}
