//! An alarm as it is told.

use crate::people::Subject;
use adit_core::frames::{MineGrid, Position};
use adit_core::time::Time;
use core::fmt;
use serde::{Deserialize, Serialize};

/// Number of an alarm, from 1 in the order in which they were raised; never used twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AlarmId(pub u64);

impl fmt::Display for AlarmId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AlarmKind {
    /// The distress button was pressed.
    Distress,
    /// A tag has seen a fall.
    ManDown,
    /// Somebody has not moved for long.
    NoMotion,
    /// In a dangerous zone.
    DangerousZone,
    /// In a restricted zone without being allowed to.
    RestrictedZone,
    /// More people in a zone or a refuge than it may hold.
    OverCapacity,
    /// Neither out nor in a refuge while the mine is evacuated.
    MissingInEvacuation,
    /// Below and not heard of.
    LostContact,
    /// Below for too long.
    Overtime,
    /// A person wears more tags than one.
    TwoTags,
    /// The battery of a tag is low.
    LowBattery,
    /// A gateway does not answer.
    GatewayDown,
    /// An anchor does not answer.
    AnchorDown,
    /// Nothing is heard of anybody: the fault is on the way to the server.
    Silence,
}

impl AlarmKind {
    /// All kinds.
    pub const ALL: [Self; 14] = [
        Self::Distress,
        Self::ManDown,
        Self::NoMotion,
        Self::DangerousZone,
        Self::RestrictedZone,
        Self::OverCapacity,
        Self::MissingInEvacuation,
        Self::LostContact,
        Self::Overtime,
        Self::TwoTags,
        Self::LowBattery,
        Self::GatewayDown,
        Self::AnchorDown,
        Self::Silence,
    ];

    /// Its end is nothing that sensors can tell: somebody clears it by hand.
    pub const fn is_cleared_by_hand(self) -> bool {
        matches!(self, Self::Distress | Self::ManDown)
    }
}

/// How bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// To know.
    Low,
    /// To see to during the shift.
    Medium,
    /// To see to now.
    High,
    /// Life may be in danger.
    Critical,
}

/// Whom or what an alarm is about.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum About {
    /// A person, by id.
    Person(String),
    /// A tag, by id.
    Tag(String),
    /// A zone, by id.
    Zone(String),
    /// A gateway, by id.
    Gateway(String),
    /// An anchor, by id.
    Anchor(String),
    /// The mine as a whole.
    Mine,
}

impl From<Subject> for About {
    fn from(subject: Subject) -> Self {
        match subject {
            Subject::Person(id) => Self::Person(id),
            Subject::Tag(id) => Self::Tag(id),
        }
    }
}

/// What makes two alarms the same: while one is open, no other with its key is raised.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct AlarmKey {
    /// What is wrong.
    pub kind: AlarmKind,
    /// With whom.
    pub about: About,
    /// Id of the zone where, for alarms of zones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zone: Option<String>,
}

/// Where an alarm is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AlarmState {
    /// Nobody has seen it yet.
    Raised,
    /// Somebody takes care of it.
    Acknowledged,
    /// Its condition is gone, or somebody has cleared it.
    Cleared,
}

/// What somebody said to an alarm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Note {
    /// Who.
    pub by: String,
    /// When.
    pub at: Time,
    /// What.
    pub text: String,
}

/// An alarm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Alarm {
    /// Its number.
    pub id: AlarmId,
    /// What, with whom, where.
    #[serde(flatten)]
    pub key: AlarmKey,
    /// How bad.
    pub severity: Severity,
    /// Where it is in its life.
    pub state: AlarmState,
    /// How often it was escalated for want of acknowledgement.
    pub escalation: u32,
    /// When it was raised.
    pub raised_at: Time,
    /// Since when what it tells was so: an entry between two fixes, the last word of a tag.
    pub since: Time,
    /// Last known position of whom it is about when it was raised, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_m: Option<Position<MineGrid>>,
    /// When and by whom it was acknowledged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acknowledged: Option<Deed>,
    /// When it was cleared, and by whom if by hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cleared: Option<Deed>,
    /// What was said to it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
}

/// When something was done, and by whom.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Deed {
    /// When.
    pub at: Time,
    /// By whom; none when the condition went by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
}
