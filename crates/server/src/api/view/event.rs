//! What happened, in one flat form: `event` says what, the fields that it has are those of the kind.

use super::alarm::NoteJson;
use super::evacuation::SummaryJson;
use super::{AlarmJson, who, word};
use crate::api::Timestamp;
use adit_core::time::Time;
use adit_tracking::{Alarm, Event, Subject};
use serde::Serialize;
use utoipa::ToSchema;

/// Something that happened. As the store keeps it and as viewers see it.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
#[schema(as = Event)]
pub struct EventJson {
    /// What: `zone-entered`, `zone-left`, `level-changed`, `went-below`, `came-out`, `contact-lost`, `contact-regained`, `tag-appeared`,
    /// `tag-assigned`, `tag-returned`, `device-down`, `device-up`, `alarm-raised`, `alarm-escalated`, `alarm-acknowledged`,
    /// `alarm-commented`, `alarm-cleared`, `evacuation-started`, `evacuation-stopped`.
    pub event: &'static str,
    /// When it happened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<Timestamp>,
    /// Id of the person.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub person: Option<String>,
    /// Id of the tag.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tag: Option<String>,
    /// What kind of tag they are followed by.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    /// Id of the zone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zone: Option<String>,
    /// How it is known: `crossed`, `appeared`, `vanished`, `commanded`, `portal`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub known_by: Option<String>,
    /// When they had come, for `zone-left`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub entered: Option<Timestamp>,
    /// Level before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_level: Option<String>,
    /// Level after.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_level: Option<String>,
    /// Since when the shift ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shift_since: Option<Timestamp>,
    /// When the tag had been heard last.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_heard: Option<Timestamp>,
    /// `gateway` or `anchor`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device_kind: Option<String>,
    /// Id of the device.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// Number of the alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alarm_id: Option<u64>,
    /// The alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alarm: Option<AlarmJson>,
    /// What was said to the alarm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub comment: Option<NoteJson>,
    /// Number of the evacuation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evacuation: Option<u64>,
    /// By whom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
    /// Why, or how it ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Levels to leave.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levels: Option<Vec<String>>,
    /// How everybody stood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub summary: Option<SummaryJson>,
}

fn at(event: &'static str, time: Time) -> EventJson {
    EventJson { event, time: Some(time.into()), ..EventJson::default() }
}

fn of(event: &'static str, time: Time, subject: &Subject) -> EventJson {
    let (person, tag) = who(subject);
    EventJson { person, tag, ..at(event, time) }
}

fn alarm(event: &'static str, alarm: &Alarm) -> EventJson {
    let deed = match event {
        "alarm-acknowledged" => alarm.acknowledged.as_ref(),
        "alarm-cleared" => alarm.cleared.as_ref(),
        _ => None,
    };
    let time = deed.map_or(alarm.raised_at, |deed| deed.at);
    EventJson {
        alarm_id: Some(alarm.id.0),
        alarm: Some(alarm.into()),
        by: deed.and_then(|deed| deed.by.clone()),
        zone: alarm.key.zone.clone(),
        ..at(event, time)
    }
}

impl From<&Event> for EventJson {
    fn from(event: &Event) -> Self {
        match event {
            Event::ZoneEntered { zone, subject, kind, time, entry } => Self {
                zone: Some(zone.clone()),
                kind: Some(word(kind)),
                known_by: Some(word(entry)),
                ..of("zone-entered", *time, subject)
            },
            Event::ZoneLeft { zone, subject, kind, entered, time, exit } => Self {
                zone: Some(zone.clone()),
                kind: Some(word(kind)),
                entered: Some((*entered).into()),
                known_by: Some(word(exit)),
                ..of("zone-left", *time, subject)
            },
            Event::LevelChanged { subject, kind, from, to, time } => Self {
                kind: Some(word(kind)),
                from_level: from.clone(),
                to_level: to.clone(),
                ..of("level-changed", *time, subject)
            },
            Event::WentBelow { subject, kind, time, shift_since } => Self {
                kind: Some(word(kind)),
                shift_since: Some((*shift_since).into()),
                ..of("went-below", *time, subject)
            },
            Event::CameOut { subject, kind, time, shift_since, way } => Self {
                kind: Some(word(kind)),
                shift_since: Some((*shift_since).into()),
                known_by: Some(word(way)),
                ..of("came-out", *time, subject)
            },
            Event::ContactLost { subject, last_heard } => {
                Self { last_heard: Some((*last_heard).into()), ..of("contact-lost", *last_heard, subject) }
            }
            Event::ContactRegained { subject, last_heard, time } => {
                Self { last_heard: Some((*last_heard).into()), ..of("contact-regained", *time, subject) }
            }
            Event::TagAppeared { tag, time } => Self { tag: Some(tag.clone()), ..at("tag-appeared", *time) },
            Event::TagAssigned { tag, person, time } => {
                Self { tag: Some(tag.clone()), person: Some(person.clone()), ..at("tag-assigned", *time) }
            }
            Event::TagReturned { tag, person, time } => {
                Self { tag: Some(tag.clone()), person: Some(person.clone()), ..at("tag-returned", *time) }
            }
            Event::DeviceDown { kind, id, time } => {
                Self { device_kind: Some(word(kind)), device: Some(id.clone()), ..at("device-down", *time) }
            }
            Event::DeviceUp { kind, id, time } => {
                Self { device_kind: Some(word(kind)), device: Some(id.clone()), ..at("device-up", *time) }
            }
            Event::AlarmRaised { alarm: it } => alarm("alarm-raised", it),
            Event::AlarmEscalated { alarm: it } => alarm("alarm-escalated", it),
            Event::AlarmAcknowledged { alarm: it } => alarm("alarm-acknowledged", it),
            Event::AlarmCleared { alarm: it } => alarm("alarm-cleared", it),
            Event::AlarmCommented { alarm, note } => Self {
                alarm_id: Some(alarm.0),
                by: Some(note.by.clone()),
                comment: Some(note.clone().into()),
                ..at("alarm-commented", note.at)
            },
            Event::EvacuationStarted { id, by, note, levels, time } => Self {
                evacuation: Some(*id),
                by: Some(by.clone()),
                note: Some(note.clone()),
                levels: Some(levels.iter().cloned().collect()),
                ..at("evacuation-started", *time)
            },
            Event::EvacuationStopped { id, by, note, time, summary } => Self {
                evacuation: Some(*id),
                by: Some(by.clone()),
                note: Some(note.clone()),
                summary: Some((*summary).into()),
                ..at("evacuation-stopped", *time)
            },
        }
    }
}
