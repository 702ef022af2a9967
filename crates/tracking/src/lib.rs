//! Solutions become tracks, zone entries, headcounts, alarms and evacuation state.
//!
//! A pure library: no clock, no I/O, no thread. Whoever owns a `Tracking` gives it one [`Input`] after the other with the time at which it
//! arrived and gets [`Event`]s; the same inputs give the same state and the same events, bit for bit. Planned door:
//!
//! `new(mine: Arc<Mine>, rules) -> Result<Tracking, RulesError>` · `attach(&mut self, mine: Arc<Mine>)` ·
//! `hear(&mut self, now, &Input, &mut Vec<Event>) -> Result<Outcome, Refused>` · `now()` · `rules()` ·
//! `people() -> impl Iterator<Item = PersonView>` · `person(&str) -> Option<PersonView>` · `tags()` · `tag(&str)` · `wearer(tag) -> Option<&str>` ·
//! `live(&Subject) -> Option<SubjectView>` · `below() -> impl Iterator<Item = SubjectView>` · `zones()` · `zone(&str) -> Option<ZoneView>` ·
//! `headcount() -> Headcount` · `open_alarms() -> impl Iterator<Item = &Alarm>` · `cleared_alarms()` · `alarm(AlarmId) -> Option<&Alarm>` ·
//! `devices()` · `evacuation() -> Option<EvacuationView>`

pub mod alarms;
mod command;
mod commands;
pub mod evacuation;
mod event;
mod ground;
mod input;
pub mod people;
mod presence;
mod query;
mod refused;
pub mod rules;
mod stage;
mod tick;
mod time;
mod tracking;
pub mod view;
pub mod zones;

pub use alarms::{About, Alarm, AlarmId, AlarmKey, AlarmKind, AlarmState, Severity};
pub use command::{Command, Ignored, Outcome};
pub use event::{Entry, Event, Exit, WayOut};
pub use input::{Activity, Battery, Button, Charge, Device, DeviceKind, Fix, Heard, Input, Motion};
pub use people::{Assignment, Person, Subject, Tag, TagKind, Worn};
pub use refused::Refused;
pub use rules::{Rules, RulesError};
pub use tracking::Tracking;
pub use zones::LiveZone;
