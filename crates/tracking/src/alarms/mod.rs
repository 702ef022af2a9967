//! Alarms: what they are ([`Alarm`]), and the book of those that are open.

mod record;

pub use record::{About, Alarm, AlarmId, AlarmKey, AlarmKind, AlarmState, Deed, Note, Severity};
