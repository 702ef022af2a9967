//! The columns of an export: one list for every format.

use crate::store::{AlarmRecord, EventRecord, FixRecord};
use adit_core::solution::Quality;
use adit_core::time::Time;
use jiff::Timestamp;
use serde_json::Value;
use std::borrow::Cow;

/// One column of rows `T`.
pub struct Column<T: 'static> {
    /// Its name; of a time without the unit, which depends on the format.
    pub(crate) name: &'static str,
    /// What a row has there.
    pub(crate) cell: Cell<T>,
}

/// How a row's value is had.
pub(crate) enum Cell<T: 'static> {
    Time(fn(&T) -> Time),
    OptionalTime(fn(&T) -> Option<Time>),
    Number(fn(&T) -> f64),
    Text(fn(&T) -> &str),
    OptionalText(fn(&T) -> Option<&str>),
    Texts(fn(&T) -> &[String]),
    Json(fn(&T) -> &Value),
}

const fn column<T>(name: &'static str, cell: Cell<T>) -> Column<T> {
    Column { name, cell }
}

pub(crate) const FIX: &[Column<FixRecord>] = &[
    column("time", Cell::Time(|fix| fix.time)),
    column("tag", Cell::Text(|fix| &fix.tag)),
    column("person", Cell::OptionalText(|fix| fix.person.as_deref())),
    column("x_m", Cell::Number(|fix| fix.position_m[0])),
    column("y_m", Cell::Number(|fix| fix.position_m[1])),
    column("z_m", Cell::Number(|fix| fix.position_m[2])),
    column("radius_95_m", Cell::Number(|fix| fix.radius_95_m)),
    column("quality", Cell::Text(|fix| quality(fix.quality))),
    column("level", Cell::OptionalText(|fix| fix.level.as_deref())),
    column("zone", Cell::OptionalText(|fix| fix.zone.as_deref())),
];

pub(crate) const EVENT: &[Column<EventRecord>] = &[
    column("time", Cell::Time(|event| event.time)),
    column("kind", Cell::Text(|event| &event.kind)),
    column("subjects", Cell::Texts(|event| &event.subjects)),
    column("body", Cell::Json(|event| &event.body)),
];

pub(crate) const ALARM: &[Column<AlarmRecord>] = &[
    column("id", Cell::Text(|alarm| &alarm.id)),
    column("kind", Cell::Text(|alarm| &alarm.kind)),
    column("state", Cell::Text(|alarm| &alarm.state)),
    column("raised", Cell::Time(|alarm| alarm.raised)),
    column("changed", Cell::Time(|alarm| alarm.changed)),
    column("cleared", Cell::OptionalTime(|alarm| alarm.cleared)),
    column("subjects", Cell::Texts(|alarm| &alarm.subjects)),
    column("body", Cell::Json(|alarm| &alarm.body)),
];

/// As in the CSV of solutions.
const fn quality(quality: Quality) -> &'static str {
    match quality {
        Quality::Fixed => "fixed",
        Quality::DeadReckoning => "dead-reckoning",
        Quality::Lost => "lost",
    }
}

/// RFC 3339 in UTC with milliseconds, cut off.
pub(crate) fn utc(time: Time) -> Cow<'static, str> {
    Timestamp::from_nanosecond(i128::from(time.nanos()))
        .map_or(Cow::Borrowed(""), |stamp| format!("{stamp:.3}").into())
}
