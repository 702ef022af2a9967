//! The live state as JSON: times as RFC 3339, positions as `[east, north, height]` on the mine's grid, m.

mod alarm;
mod evacuation;
mod event;
mod place;
mod zone;

pub use alarm::AlarmJson;
pub(super) use evacuation::EvacuationJson;
pub use event::EventJson;
pub(super) use place::{DeviceJson, PersonJson, TagJson};
pub use place::{LiveJson, WhereJson};
pub(super) use zone::{HeadcountJson, ZoneJson};

use adit_tracking::Subject;
use serde::Serialize;

/// The word that a plain enum has in JSON.
pub(super) fn word<T: Serialize>(value: &T) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

/// Who, as two fields: a person, else a tag that nobody is known to wear.
pub(super) fn who(subject: &Subject) -> (Option<String>, Option<String>) {
    match subject {
        Subject::Person(id) => (Some(id.clone()), None),
        Subject::Tag(id) => (None, Some(id.clone())),
    }
}
