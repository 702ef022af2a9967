//! Solutions become tracks, zone entries, headcounts, alarms and evacuation state.
//!
//! A pure library: no clock, no I/O, no thread. Whoever owns a [`Tracking`] gives it one [`Input`] after the other with the time at which it
//! arrived, and gets [`Event`]s; the same inputs give the same state and the same events, bit for bit. The state is serialised without the
//! mine and goes on after [`Tracking::attach`].
//!
//! | question | answer |
//! |---|---|
//! | what follows of an input? | [`Tracking::hear`] |
//! | where is somebody, since when, how sure? | [`Tracking::person`], [`Tracking::live`], [`Tracking::below`], [`Tracking::tag`] |
//! | how many are where? | [`Tracking::headcount`], [`Tracking::zones`] |
//! | what is wrong? | [`Tracking::open_alarms`], [`Tracking::cleared_alarms`] |
//! | who is safe, who is missing? | [`Tracking::evacuation`] |
//!
//! What is an alarm, from when on and how bad, are [`Rules`]. Positions are on the mine's grid, m, z up; times count from the Unix epoch in live
//! data. The rules of zones, alarms, evacuation and the growing radius stand in `docs/live/tracking.md`.
//!
//! ```
//! use adit_core::{frames::Position, solution::Quality, time::Time};
//! use adit_mine::{Mine, plan::{Grid, Level, MinePlan, Zone, ZoneKind}};
//! use adit_tracking::{AlarmKind, Event, Fix, Input, Rules, Tracking};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut plan = MinePlan::new("one zone", Grid::Local {});
//! plan.levels.push(Level { id: "l1".into(), name: None, elevation_m: 0.0 });
//! plan.zones.push(Zone {
//!     id: "goaf".into(),
//!     name: None,
//!     kind: ZoneKind::Dangerous,
//!     level: "l1".into(),
//!     capacity: None,
//!     exit_tolerance_m: 0.0,
//!     exit_delay_s: 0.0,
//!     outline_m: vec![[10.0, -5.0], [12.0, -5.0], [12.0, 5.0], [10.0, 5.0]],
//! });
//! let mut tracking = Tracking::new(Mine::unchecked(plan).into(), Rules::default())?;
//! let mut events = Vec::new();
//! // Two fixes, ten seconds apart, neither of them in the zone.
//! for (seconds, x) in [(100, 6.0), (110, 16.0)] {
//!     let time = Time::from_nanos(seconds * 1_000_000_000);
//!     let fix = Fix {
//!         tag: "7".into(),
//!         time,
//!         position_m: Position::new(x, 0.0, 1.0),
//!         velocity_m_s: None,
//!         radius_95_m: 0.5,
//!         protection_level_m: 1.5,
//!         quality: Quality::Fixed,
//!         moving: None,
//!         method: "fused".into(),
//!     };
//!     tracking.hear(time, &Input::Fix(fix), &mut events)?;
//! }
//! let entered = events.iter().find_map(|event| match event {
//!     Event::ZoneEntered { time, .. } => Some(time.seconds()),
//!     _ => None,
//! });
//! assert_eq!(entered, Some(104.0));
//! assert!(events.iter().any(|event| matches!(event, Event::AlarmCleared { alarm } if alarm.key.kind == AlarmKind::DangerousZone)));
//! # Ok(())
//! # }
//! ```

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
