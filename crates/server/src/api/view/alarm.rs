//! Alarms.

use super::word;
use crate::api::Timestamp;
use adit_tracking::alarms::{Deed, Note};
use adit_tracking::{About, Alarm};
use serde::Serialize;
use utoipa::ToSchema;

/// What somebody said to an alarm.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = Note)]
pub struct NoteJson {
    by: String,
    at: Timestamp,
    text: String,
}

impl From<Note> for NoteJson {
    fn from(note: Note) -> Self {
        Self { by: note.by, at: note.at.into(), text: note.text }
    }
}

/// When something was done, and by whom.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = Deed)]
pub struct DeedJson {
    at: Timestamp,
    /// Null when the condition went by itself.
    by: Option<String>,
}

impl From<Deed> for DeedJson {
    fn from(deed: Deed) -> Self {
        Self { at: deed.at.into(), by: deed.by }
    }
}

/// An alarm.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = Alarm)]
pub struct AlarmJson {
    /// Its number.
    id: u64,
    /// What is wrong: `distress`, `man-down`, `lost-contact` …
    kind: String,
    /// `person`, `tag`, `zone`, `gateway`, `anchor` or `mine`.
    about: String,
    /// Whose id; null for the mine.
    about_id: Option<String>,
    /// Where, for alarms of zones.
    zone: Option<String>,
    /// `low`, `medium`, `high` or `critical`.
    severity: String,
    /// `raised`, `acknowledged` or `cleared`.
    state: String,
    /// How often it was escalated.
    escalation: u32,
    raised: Timestamp,
    /// Since when what it tells was so.
    since: Timestamp,
    /// Last known position when it was raised, m.
    position_m: Option<[f64; 3]>,
    acknowledged: Option<DeedJson>,
    cleared: Option<DeedJson>,
    notes: Vec<NoteJson>,
}

impl From<&Alarm> for AlarmJson {
    fn from(alarm: &Alarm) -> Self {
        let (about, about_id) = match &alarm.key.about {
            About::Person(id) => ("person", Some(id)),
            About::Tag(id) => ("tag", Some(id)),
            About::Zone(id) => ("zone", Some(id)),
            About::Gateway(id) => ("gateway", Some(id)),
            About::Anchor(id) => ("anchor", Some(id)),
            About::Mine => ("mine", None),
        };
        Self {
            id: alarm.id.0,
            kind: word(&alarm.key.kind),
            about: about.into(),
            about_id: about_id.cloned(),
            zone: alarm.key.zone.clone(),
            severity: word(&alarm.severity),
            state: word(&alarm.state),
            escalation: alarm.escalation,
            raised: alarm.raised_at.into(),
            since: alarm.since.into(),
            position_m: alarm.position_m.map(|position| (*position.raw()).into()),
            acknowledged: alarm.acknowledged.clone().map(DeedJson::from),
            cleared: alarm.cleared.clone().map(DeedJson::from),
            notes: alarm.notes.iter().cloned().map(NoteJson::from).collect(),
        }
    }
}
