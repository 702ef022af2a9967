//! Where one person is, or one tag that nobody is known to wear: position, zones, level, below or out, heard and moving.

mod crossing;
mod motion;

pub(crate) use crossing::{Change, Path};
pub(crate) use motion::Stillness;

use crate::event::Exit;
use crate::input::Fix;
use crate::people::{Person, Subject, TagKind};
use crate::zones::LevelIndex;
use adit_core::frames::{MineGrid, Position, Vector};
use adit_core::solution::Quality;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A fix that was taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Seen {
    pub time: Time,
    pub position_m: Position<MineGrid>,
    pub velocity_m_s: Option<Vector<MineGrid>>,
    pub radius_95_m: f64,
    pub protection_level_m: f64,
    pub quality: Quality,
    pub method: Arc<str>,
}

impl From<&Fix> for Seen {
    fn from(fix: &Fix) -> Self {
        Self {
            time: fix.time,
            position_m: fix.position_m,
            velocity_m_s: fix.velocity_m_s,
            radius_95_m: fix.radius_95_m,
            protection_level_m: fix.protection_level_m,
            quality: fix.quality,
            method: fix.method.clone(),
        }
    }
}

impl Seen {
    /// East and north, m.
    pub fn plan_m(&self) -> [f64; 2] {
        let p = self.position_m.raw();
        [p.x, p.y]
    }
}

/// Somebody is in a zone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stay {
    pub zone: String,
    pub since: Time,
    /// They are beyond its tolerance, but not yet for as long as its delay.
    pub leaving: Option<Leaving>,
}

/// Since when somebody is beyond the tolerance of a zone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Leaving {
    pub since: Time,
    pub exit: Exit,
}

/// Where in the course of the day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Day {
    #[default]
    Unseen,
    Below {
        shift_since: Time,
    },
    Out {
        since: Time,
        /// The shift that ended then.
        shift_since: Option<Time>,
    },
}

/// All that is known of where somebody is.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Presence {
    /// The last fix that was taken, and the tag that it is of.
    pub seen: Option<Seen>,
    pub seen_by: String,
    pub level: Option<LevelIndex>,
    /// The level they are counted on: none while out.
    pub counted_level: Option<LevelIndex>,
    pub stays: Vec<Stay>,
    pub day: Day,
    pub heard: Option<Time>,
    pub gateway: Option<String>,
    pub lost: bool,
    pub overtime: bool,
    pub still: bool,
    pub stillness: Stillness,
    pub evacuation: Option<crate::evacuation::Mark>,
}

impl Presence {
    pub fn is_below(&self) -> bool {
        matches!(self.day, Day::Below { .. })
    }
}

/// Whom a presence is of.
#[derive(Debug, Clone, Copy)]
pub struct Who<'a> {
    /// `None` for a tag that nobody is known to wear.
    pub person: Option<&'a Person>,
    /// Id of the person or of the tag.
    pub id: &'a str,
    pub kind: TagKind,
}

impl<'a> Who<'a> {
    pub fn person(person: &'a Person) -> Self {
        Self { person: Some(person), id: &person.id, kind: TagKind::Person }
    }

    pub fn tag(id: &'a str, kind: TagKind) -> Self {
        Self { person: None, id, kind }
    }

    pub fn subject(&self) -> Subject {
        if self.person.is_some() { Subject::Person(self.id.into()) } else { Subject::Tag(self.id.into()) }
    }

    /// Somebody, not a vehicle or a thing.
    pub fn is_somebody(&self) -> bool {
        self.kind == TagKind::Person
    }

    /// May be in a restricted zone.
    pub fn may_enter(&self, zone: &crate::zones::LiveZone) -> bool {
        self.person.is_some_and(|person| {
            person.allowed_zones.contains(&zone.zone.id)
                || person.team.as_ref().is_some_and(|team| zone.allowed_teams.contains(team))
        })
    }
}
