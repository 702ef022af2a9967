//! The book of alarms: which conditions hold, and the alarm of each.
//!
//! A condition that begins raises its alarm, unless its kind is switched off or was cleared a moment ago: then the alarm waits for the end of
//! its hold-off, and comes if the condition still holds. A condition that ends clears its alarm. A condition has one alarm at most.

use super::pairs;
use super::record::{About, Alarm, AlarmId, AlarmKey, AlarmKind, AlarmState, Deed, Note};
use crate::event::Event;
use crate::refused::Refused;
use crate::rules::Rules;
use crate::time::seconds;
use adit_core::frames::{MineGrid, Position};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};

/// How many cleared alarms are kept for those who look back; all are in the store of the server.
const CLEARED: usize = 1000;
/// How many notes an alarm has at most.
const NOTES: usize = 100;
/// How long a note is at most, characters.
pub const NOTE_LENGTH: usize = 2000;

/// A condition that holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Condition {
    since: Time,
    position_m: Option<Position<MineGrid>>,
    alarm: Option<AlarmId>,
}

/// All alarms that are open, and the last that were cleared.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct AlarmBook {
    last: u64,
    #[serde(with = "pairs")]
    open: BTreeMap<AlarmId, Alarm>,
    #[serde(with = "pairs")]
    conditions: BTreeMap<AlarmKey, Condition>,
    /// How many conditions have no alarm.
    waiting: usize,
    /// Before when an alarm is not raised again.
    #[serde(with = "pairs")]
    quiet_until: BTreeMap<AlarmKey, Time>,
    cleared: VecDeque<Alarm>,
}

impl AlarmBook {
    /// A condition holds, since when, with whom where.
    pub fn begin(
        &mut self,
        now: Time,
        key: AlarmKey,
        (since, position_m): (Time, Option<Position<MineGrid>>),
        rules: &Rules,
        events: &mut Vec<Event>,
    ) {
        if self.conditions.contains_key(&key) {
            return;
        }
        let mut condition = Condition { since, position_m, alarm: None };
        if self.may_be_raised(now, &key, rules) {
            condition.alarm = Some(self.raise(now, &key, &condition, rules, events));
        } else {
            self.waiting += 1;
        }
        self.conditions.insert(key, condition);
    }

    /// A condition holds no more.
    pub fn end(&mut self, now: Time, key: &AlarmKey, rules: &Rules, events: &mut Vec<Event>) {
        self.remove(now, key, None, rules, events);
    }

    /// All conditions of some kind or other hold no more.
    pub fn end_all(
        &mut self,
        now: Time,
        which: impl Fn(&AlarmKey) -> bool,
        rules: &Rules,
        events: &mut Vec<Event>,
    ) {
        let keys: Vec<AlarmKey> = self.conditions.keys().filter(|key| which(key)).cloned().collect();
        for key in keys {
            self.end(now, &key, rules, events);
        }
    }

    fn remove(
        &mut self,
        now: Time,
        key: &AlarmKey,
        by: Option<&str>,
        rules: &Rules,
        events: &mut Vec<Event>,
    ) {
        let Some(condition) = self.conditions.remove(key) else { return };
        let Some(alarm) = condition.alarm else {
            self.waiting -= 1;
            return;
        };
        let until = now + seconds(rules.alarms.of(key.kind).hold_off_s);
        if until > now {
            self.quiet_until.insert(key.clone(), until);
        }
        self.close(now, alarm, by, events);
    }

    fn close(&mut self, now: Time, alarm: AlarmId, by: Option<&str>, events: &mut Vec<Event>) {
        let Some(mut alarm) = self.open.remove(&alarm) else { return };
        alarm.state = AlarmState::Cleared;
        alarm.cleared = Some(Deed { at: now, by: by.map(Into::into) });
        events.push(Event::AlarmCleared { alarm: alarm.clone() });
        if self.cleared.len() >= CLEARED {
            self.cleared.pop_front();
        }
        self.cleared.push_back(alarm);
    }

    fn may_be_raised(&self, now: Time, key: &AlarmKey, rules: &Rules) -> bool {
        rules.alarms.of(key.kind).enabled && self.quiet_until.get(key).is_none_or(|until| now >= *until)
    }

    fn raise(
        &mut self,
        now: Time,
        key: &AlarmKey,
        condition: &Condition,
        rules: &Rules,
        events: &mut Vec<Event>,
    ) -> AlarmId {
        self.last += 1;
        let alarm = Alarm {
            id: AlarmId(self.last),
            key: key.clone(),
            severity: rules.alarms.of(key.kind).severity,
            state: AlarmState::Raised,
            escalation: 0,
            raised_at: now,
            since: condition.since,
            position_m: condition.position_m,
            acknowledged: None,
            cleared: None,
            notes: Vec::new(),
        };
        events.push(Event::AlarmRaised { alarm: alarm.clone() });
        self.open.insert(alarm.id, alarm);
        AlarmId(self.last)
    }

    /// A second has passed: hold-offs end, and what nobody acknowledges goes up.
    pub fn tick(&mut self, now: Time, rules: &Rules, events: &mut Vec<Event>) {
        if self.waiting > 0 {
            self.raise_waiting(now, rules, events);
        }
        self.quiet_until.retain(|_, until| *until > now);
        for alarm in self.open.values_mut().filter(|alarm| alarm.state == AlarmState::Raised) {
            let steps = rules.escalation.of(alarm.severity);
            let due = |step: usize| {
                steps.get(step).is_some_and(|after_s| now >= alarm.raised_at + seconds(*after_s))
            };
            let before = alarm.escalation;
            while due(alarm.escalation as usize) {
                alarm.escalation += 1;
            }
            if alarm.escalation > before {
                events.push(Event::AlarmEscalated { alarm: alarm.clone() });
            }
        }
    }

    fn raise_waiting(&mut self, now: Time, rules: &Rules, events: &mut Vec<Event>) {
        let waiting = self.conditions.iter().filter(|(_, condition)| condition.alarm.is_none());
        let due: Vec<(AlarmKey, Condition)> = waiting
            .filter(|(key, _)| self.may_be_raised(now, key, rules))
            .map(|(key, condition)| (key.clone(), condition.clone()))
            .collect();
        for (key, condition) in due {
            let alarm = self.raise(now, &key, &condition, rules, events);
            if let Some(condition) = self.conditions.get_mut(&key) {
                condition.alarm = Some(alarm);
                self.waiting -= 1;
            }
        }
    }

    /// Kinds that are switched off have no open alarms; what was waiting may be on now.
    pub fn new_rules(&mut self, now: Time, rules: &Rules, events: &mut Vec<Event>) {
        let off: Vec<AlarmKey> = self
            .conditions
            .iter()
            .filter(|(key, condition)| condition.alarm.is_some() && !rules.alarms.of(key.kind).enabled)
            .map(|(key, _)| key.clone())
            .collect();
        for key in off {
            let Some(condition) = self.conditions.get_mut(&key) else { continue };
            if let Some(alarm) = condition.alarm.take() {
                self.waiting += 1;
                self.close(now, alarm, None, events);
            }
        }
        self.raise_waiting(now, rules, events);
    }

    /// Somebody has seen an alarm.
    pub fn acknowledge(
        &mut self,
        now: Time,
        id: AlarmId,
        by: &str,
        note: &str,
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        let alarm = self.find_mut(id)?;
        if let Some(Deed { by: Some(by), .. }) = &alarm.acknowledged {
            return Err(Refused::Acknowledged { alarm: id, by: by.clone() });
        }
        add_note(alarm, now, by, note)?;
        alarm.acknowledged = Some(Deed { at: now, by: Some(by.into()) });
        if alarm.state == AlarmState::Raised {
            alarm.state = AlarmState::Acknowledged;
        }
        events.push(Event::AlarmAcknowledged { alarm: alarm.clone() });
        Ok(())
    }

    /// Somebody says that an alarm is over.
    pub fn clear(
        &mut self,
        now: Time,
        (id, by, note): (AlarmId, &str, &str),
        rules: &Rules,
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        let alarm = self.find_mut(id)?;
        if alarm.state == AlarmState::Cleared {
            return Err(Refused::Cleared { alarm: id });
        }
        if !alarm.key.kind.is_cleared_by_hand() {
            return Err(Refused::EndsByItself { alarm: id });
        }
        add_note(alarm, now, by, note)?;
        let key = alarm.key.clone();
        self.remove(now, &key, Some(by), rules, events);
        Ok(())
    }

    /// Somebody says something to an alarm.
    pub fn comment(
        &mut self,
        now: Time,
        id: AlarmId,
        by: &str,
        text: &str,
        events: &mut Vec<Event>,
    ) -> Result<(), Refused> {
        let alarm = self.find_mut(id)?;
        if add_note(alarm, now, by, text)?
            && let Some(note) = alarm.notes.last()
        {
            events.push(Event::AlarmCommented { alarm: id, note: note.clone() });
        }
        Ok(())
    }

    fn find_mut(&mut self, id: AlarmId) -> Result<&mut Alarm, Refused> {
        let cleared = self.cleared.iter_mut().find(|alarm| alarm.id == id);
        self.open.get_mut(&id).or(cleared).ok_or(Refused::UnknownAlarm { alarm: id })
    }

    /// An alarm that is open or among the last that were cleared.
    pub fn find(&self, id: AlarmId) -> Option<&Alarm> {
        self.open.get(&id).or_else(|| self.cleared.iter().find(|alarm| alarm.id == id))
    }

    /// Open alarms, in the order in which they were raised.
    pub fn open(&self) -> impl Iterator<Item = &Alarm> {
        self.open.values()
    }

    /// The last that were cleared, the latest last.
    pub fn cleared(&self) -> impl Iterator<Item = &Alarm> {
        self.cleared.iter()
    }

    /// Open alarms about somebody or something.
    pub fn about(&self, about: &About) -> Vec<AlarmId> {
        let of_kind = |kind| {
            let first = AlarmKey { kind, about: about.clone(), zone: None };
            self.conditions.range(first..).take_while(move |(key, _)| key.kind == kind && key.about == *about)
        };
        let mut alarms: Vec<AlarmId> = AlarmKind::ALL
            .into_iter()
            .flat_map(of_kind)
            .filter_map(|(_, condition)| condition.alarm)
            .collect();
        alarms.sort_unstable();
        alarms
    }
}

/// Writes what somebody says; false when it is nothing.
fn add_note(alarm: &mut Alarm, at: Time, by: &str, text: &str) -> Result<bool, Refused> {
    let found = text.chars().count();
    if found > NOTE_LENGTH {
        return Err(Refused::TooLong { what: "a note", limit: NOTE_LENGTH, found });
    }
    if text.is_empty() {
        return Ok(false);
    }
    if alarm.notes.len() >= NOTES {
        return Err(Refused::TooManyNotes { alarm: alarm.id, limit: NOTES });
    }
    alarm.notes.push(Note { by: by.into(), at, text: text.into() });
    Ok(true)
}
