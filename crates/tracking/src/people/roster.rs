//! Who there is, which tags there are, who wears which.

use super::record::{Assignment, Person, Tag};
use crate::input::Charge;
use crate::presence::{Presence, Seen, Stillness, Who};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A person with what is known of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PersonRecord {
    pub person: Person,
    /// The tags they wear now.
    pub tags: BTreeSet<String>,
    /// The tag whose fixes count.
    pub lead: Option<String>,
    pub presence: Presence,
}

/// A tag with what is known of it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TagRecord {
    pub tag: Tag,
    pub registered: bool,
    /// Who wears it now.
    pub wearer: Option<String>,
    /// This assignment and those to come, by their beginnings.
    pub assignments: Vec<Assignment>,
    /// Its own last fix.
    pub seen: Option<Seen>,
    pub heard: Option<Time>,
    pub gateway: Option<String>,
    pub battery: Option<(Time, Charge)>,
    pub battery_low: bool,
    /// When its button was pressed last: what is told twice is one press.
    pub button: Option<Time>,
    /// Where it is while nobody is known to wear it.
    pub presence: Presence,
}

/// All people and tags.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Roster {
    pub people: BTreeMap<String, PersonRecord>,
    pub tags: BTreeMap<String, TagRecord>,
    /// How many of the tags nobody has registered.
    pub unregistered: u32,
    /// When an assignment begins or ends next.
    pub next_change: Option<Time>,
}

impl Assignment {
    pub(crate) fn holds(&self, now: Time) -> bool {
        self.from <= now && !self.is_over(now)
    }

    pub(crate) fn is_over(&self, now: Time) -> bool {
        self.until.is_some_and(|until| until <= now)
    }

    /// Have two assignments a moment in common?
    pub(crate) fn meets(&self, other: &Self) -> bool {
        other.until.is_none_or(|until| self.from < until) && self.until.is_none_or(|until| other.from < until)
    }
}

impl Roster {
    /// Whose presence a tag moves, with the presence; `None` for a tag that leads nobody.
    pub fn followed(&mut self, tag: &str) -> Option<(Who<'_>, &mut Presence)> {
        let record = self.tags.get_mut(tag)?;
        let Some(wearer) = &record.wearer else {
            return Some((Who::tag(&record.tag.id, record.tag.kind), &mut record.presence));
        };
        let PersonRecord { person, lead, presence, .. } = self.people.get_mut(wearer)?;
        (lead.as_deref() == Some(tag)).then_some((Who::person(person), presence))
    }

    /// Whom a tag is on, leading or not.
    pub fn bearer(&mut self, tag: &str) -> Option<(Who<'_>, &mut Presence)> {
        let record = self.tags.get_mut(tag)?;
        match &record.wearer {
            None => Some((Who::tag(&record.tag.id, record.tag.kind), &mut record.presence)),
            Some(wearer) => {
                let PersonRecord { person, presence, .. } = self.people.get_mut(wearer)?;
                Some((Who::person(person), presence))
            }
        }
    }

    /// Everybody and everything, people first, each in the order of their ids.
    pub fn everybody(&mut self) -> impl Iterator<Item = (Who<'_>, &mut Presence)> {
        let people = self
            .people
            .values_mut()
            .map(|PersonRecord { person, presence, .. }| (Who::person(person), presence));
        let tags = self.tags.values_mut().filter(|record| record.wearer.is_none());
        people.chain(tags.map(|record| (Who::tag(&record.tag.id, record.tag.kind), &mut record.presence)))
    }

    /// The same, to look at.
    pub fn everybody_seen(&self) -> impl Iterator<Item = (Who<'_>, &Presence)> {
        let people =
            self.people.values().map(|PersonRecord { person, presence, .. }| (Who::person(person), presence));
        let tags = self.tags.values().filter(|record| record.wearer.is_none());
        people.chain(tags.map(|record| (Who::tag(&record.tag.id, record.tag.kind), &record.presence)))
    }

    /// The tag whose fixes count: of those that were heard within the limit, else of all, the one that was given last.
    pub fn choose_lead(&mut self, person: &str, heard_after: Time) {
        let Some(record) = self.people.get(person) else { return };
        let rank = |id: &&String| {
            let tag = self.tags.get(*id);
            let heard = tag.and_then(|tag| tag.heard).is_some_and(|heard| heard >= heard_after);
            (heard, tag.and_then(|tag| tag.assignments.first()).map(|given| given.from), (*id).clone())
        };
        let lead = record.tags.iter().max_by_key(rank).cloned();
        if let Some(record) = self.people.get_mut(person).filter(|record| record.lead != lead) {
            record.lead = lead;
            record.presence.stillness = Stillness::default();
        }
    }

    /// Finds out when an assignment begins or ends next.
    pub fn schedule(&mut self, now: Time) {
        let all = self.tags.values().flat_map(|tag| &tag.assignments);
        let times = all.flat_map(|given| [Some(given.from), given.until]).flatten();
        self.next_change = times.filter(|time| *time > now).min();
    }
}
