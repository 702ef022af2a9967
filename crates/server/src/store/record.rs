//! What is written: rounds of records, each at its position of the journal.

use adit_core::solution::Quality;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Everything that one entry of the journal led to; written whole or not at all, and once.
#[derive(Debug, Clone, PartialEq)]
pub struct Round {
    /// Position of the entry in the journal, from 1.
    pub position: u64,
    /// What it led to, in order.
    pub records: Vec<Record>,
}

/// One thing to keep.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// Where a tag was.
    Fix(FixRecord),
    /// Something happened.
    Event(EventRecord),
    /// An alarm as it stands now; replaces the one with the same id.
    Alarm(AlarmRecord),
    /// A user changed something, or tried to.
    Audit(AuditRecord),
}

/// Where a tag was at a time, and how well that is known.
///
/// Stored are times in ms and lengths in cm (to the nearest), and the radius in cm with six significant bits, rounded up: at most 3.2 %
/// too large, never too small. What is read is the same before and after fixes are packed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FixRecord {
    /// Who carries the tag, if anybody.
    pub person: Option<String>,
    /// Id of the tag.
    pub tag: String,
    /// When.
    pub time: Time,
    /// Mine grid, m: east, north, height.
    pub position_m: [f64; 3],
    /// Level circle that holds the truth with 95 %, m.
    pub radius_95_m: f64,
    /// How far to trust it.
    pub quality: Quality,
    /// Id of the level.
    pub level: Option<String>,
    /// Id of the zone.
    pub zone: Option<String>,
}

/// Something that happened.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRecord {
    /// When.
    pub time: Time,
    /// Which kind.
    pub kind: String,
    /// Ids of people, tags, zones and devices that it is about: it is found by each of them.
    pub subjects: Vec<String>,
    /// The whole event.
    pub body: Value,
}

/// An alarm as it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct AlarmRecord {
    /// Its id: the same from raised to cleared.
    pub id: String,
    /// Which kind.
    pub kind: String,
    /// Its state: raised, acknowledged, cleared and the like.
    pub state: String,
    /// When it was raised.
    pub raised: Time,
    /// When it changed last.
    pub changed: Time,
    /// When it was cleared; an alarm that is not is kept for ever.
    pub cleared: Option<Time>,
    /// Ids of people, tags, zones and devices that it is about.
    pub subjects: Vec<String>,
    /// The whole alarm.
    pub body: Value,
}

/// What a user did, or tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AuditRecord {
    /// When.
    pub time: Time,
    /// Name of the user or token, or `adit` itself.
    pub who: String,
    /// What: a verb and its object, `tag.assign`.
    pub what: String,
    /// From where: address of the client.
    pub source: String,
    /// How it ended: `done`, `refused` or the error.
    pub outcome: String,
    /// The particulars.
    pub detail: Value,
}

/// What a commit wrote.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Committed {
    /// Position of the journal up to which everything is stored now.
    pub applied: u64,
    /// Records written.
    pub written: u64,
    /// Records of rounds that were stored before, left out.
    pub repeated: u64,
    /// Fixes that no column holds (a number that is none, farther than 20,000 km, a time past its years), left out: an error of whoever made them.
    pub refused: u64,
}
