//! Alarms: what they are ([`Alarm`]), and the book of those that are open.

mod book;
mod pairs;
mod record;

pub(crate) use book::{AlarmBook, NOTE_LENGTH};

pub use record::{About, Alarm, AlarmId, AlarmKey, AlarmKind, AlarmState, Deed, Note, Severity};
