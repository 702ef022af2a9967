//! What is told on request.

use crate::alarms::AlarmId;
use crate::input::{Charge, DeviceKind, Motion};
use crate::people::{Assignment, Person, Subject, Tag, TagKind};
use crate::zones::LiveZone;
use adit_core::frames::{MineGrid, Position, Vector};
use adit_core::solution::Quality;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The last that is known of where somebody is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LastKnown {
    /// The tag that says so.
    pub tag: String,
    /// When.
    pub time: Time,
    /// Where, m.
    pub position_m: Position<MineGrid>,
    /// How fast, where it is known, m/s.
    pub velocity_m_s: Option<Vector<MineGrid>>,
    /// Radius of the circle that held them then with 95 % probability, m.
    pub radius_95_m: f64,
    /// Radius of the circle that holds them now: `radius_95_m` and the way that they may have gone since, m.
    pub radius_now_m: f64,
    /// Protection level then, m.
    pub protection_level_m: f64,
    /// How far to trust it.
    pub quality: Quality,
    /// Name of the method.
    pub method: Arc<str>,
    /// Id of the level.
    pub level: Option<String>,
    /// For how long nothing newer has come, s.
    pub age_s: f64,
}

/// Whether somebody moves, as far as is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MotionView {
    /// What.
    pub motion: Motion,
    /// Since when without a break.
    pub since: Time,
}

/// Where somebody is in the course of the day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
pub enum Whereabouts {
    /// Never seen.
    Unseen,
    /// Below.
    Below {
        /// Since when the shift runs.
        shift_since: Time,
    },
    /// Out.
    Out {
        /// Since when.
        since: Time,
    },
}

/// A zone that somebody is in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StayView {
    /// Id of the zone.
    pub zone: String,
    /// Since when.
    pub since: Time,
}

/// Somebody, or a tag that nobody is known to wear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SubjectView {
    /// Who.
    pub subject: Subject,
    /// What kind of tag they are followed by.
    pub kind: TagKind,
    /// Where in the course of the day.
    pub whereabouts: Whereabouts,
    /// Where.
    pub last_known: Option<LastKnown>,
    /// Level, zones that they are in.
    pub zones: Vec<StayView>,
    /// Zones that they may be in: the last fix was too coarse to tell.
    pub possible_zones: Vec<String>,
    /// One of their tags is heard.
    pub in_contact: bool,
    /// When one was heard last.
    pub last_heard: Option<Time>,
    /// By which gateway.
    pub gateway: Option<String>,
    /// Whether they move.
    pub motion: Option<MotionView>,
    /// Open alarms about them.
    pub alarms: Vec<AlarmId>,
}

/// A person with all that is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PersonView {
    /// The person.
    pub person: Person,
    /// The tags they wear.
    pub tags: Vec<String>,
    /// Where they are.
    pub live: SubjectView,
}

/// A tag with all that is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TagView {
    /// The tag.
    pub tag: Tag,
    /// Somebody has entered it; else it was only heard.
    pub registered: bool,
    /// Who wears it now.
    pub person: Option<String>,
    /// This assignment and those to come.
    pub assignments: Vec<Assignment>,
    /// Where it is.
    pub last_known: Option<LastKnown>,
    /// It is heard.
    pub in_contact: bool,
    /// When it was heard last.
    pub last_heard: Option<Time>,
    /// By which gateway.
    pub gateway: Option<String>,
    /// How full its battery is, and when that was measured.
    pub battery: Option<(Time, Charge)>,
    /// Whether it moves.
    pub motion: Option<MotionView>,
}

/// How many are in a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Count {
    /// People.
    pub people: u32,
    /// Tags for people that nobody is known to wear.
    pub unassigned_tags: u32,
    /// Vehicles.
    pub vehicles: u32,
    /// Things.
    pub assets: u32,
}

impl Count {
    /// People, known and unknown.
    pub const fn heads(&self) -> u32 {
        self.people + self.unassigned_tags
    }

    /// The part of a person, or of a tag of a kind that nobody is known to wear.
    pub(crate) const fn of_mut(&mut self, is_person: bool, kind: TagKind) -> &mut u32 {
        match (is_person, kind) {
            (true, _) => &mut self.people,
            (false, TagKind::Person) => &mut self.unassigned_tags,
            (false, TagKind::Vehicle) => &mut self.vehicles,
            (false, TagKind::Asset) => &mut self.assets,
        }
    }
}

/// A zone and how many are in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ZoneView {
    /// The zone.
    pub live: LiveZone,
    /// How many are in it.
    pub count: Count,
    /// Who.
    pub inside: Vec<Subject>,
    /// Who may be in it: their last fix was too coarse to tell.
    pub possible: Vec<Subject>,
}

/// How many are where.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Headcount {
    /// Below.
    pub mine: Count,
    /// On each level, by id; levels in the order of the plan.
    pub levels: Vec<(String, Count)>,
    /// In each zone, by id.
    pub zones: Vec<(String, Count)>,
    /// Below and not heard of: part of `mine`.
    pub out_of_contact: u32,
}

/// A gateway or an anchor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceView {
    /// What it is.
    pub kind: DeviceKind,
    /// Its id.
    pub id: String,
    /// It works.
    pub up: bool,
    /// Since when.
    pub since: Time,
}
