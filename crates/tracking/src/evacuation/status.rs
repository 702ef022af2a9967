//! What is told of an evacuation.

use crate::people::Subject;
use crate::view::LastKnown;
use adit_core::time::{Interval, Time};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// How somebody stands in an evacuation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EvacuationStatus {
    /// Outside.
    Out,
    /// Below, but off the levels that are evacuated.
    OtherLevel,
    /// In a refuge.
    InRefuge,
    /// On the way.
    MovingOut,
    /// Heard of, and still.
    NotMoving,
    /// Not heard of.
    Unknown,
}

impl EvacuationStatus {
    /// Nobody needs to look for them.
    pub const fn is_safe(self) -> bool {
        matches!(self, Self::Out | Self::OtherLevel | Self::InRefuge)
    }
}

/// The shortest way on foot to a refuge or out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Way {
    /// Id of the zone where it ends.
    pub zone: String,
    /// Its length along the roadways from the last known position, m.
    pub length_m: f64,
}

/// Somebody who was below when the evacuation began, or since.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evacuee {
    /// Who.
    pub subject: Subject,
    /// How they stand.
    pub status: EvacuationStatus,
    /// Since when they stand so.
    pub since: Time,
    /// They are expected to be safe by now: see [`rules`](crate::rules).
    pub missing: bool,
    /// The last that is known of where they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_known: Option<LastKnown>,
    /// Shortest way to a refuge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_refuge: Option<Way>,
    /// Shortest way out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_portal: Option<Way>,
    /// By how much the way to the nearest of both has become shorter since the evacuation began, m; negative when longer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nearer_by_m: Option<f64>,
}

/// How many stand how.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvacuationSummary {
    /// Outside.
    pub out: u32,
    /// Below, but off the levels that are evacuated.
    pub other_level: u32,
    /// In a refuge.
    pub in_refuge: u32,
    /// On the way.
    pub moving_out: u32,
    /// Heard of, and still.
    pub not_moving: u32,
    /// Not heard of.
    pub unknown: u32,
    /// Of the last three: expected to be safe by now.
    pub missing: u32,
}

/// An evacuation as it stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvacuationView {
    /// Its number, from 1.
    pub id: u64,
    /// When it was started.
    pub since: Time,
    /// For how long it runs.
    pub running: Interval,
    /// By whom.
    pub by: String,
    /// Why.
    pub note: String,
    /// Levels to leave; the whole mine where it is empty.
    pub levels: BTreeSet<String>,
    /// How many stand how.
    pub summary: EvacuationSummary,
    /// Who stands how, by id.
    pub people: Vec<Evacuee>,
}

impl EvacuationSummary {
    pub(crate) fn add(&mut self, status: EvacuationStatus, missing: bool) {
        let count = match status {
            EvacuationStatus::Out => &mut self.out,
            EvacuationStatus::OtherLevel => &mut self.other_level,
            EvacuationStatus::InRefuge => &mut self.in_refuge,
            EvacuationStatus::MovingOut => &mut self.moving_out,
            EvacuationStatus::NotMoving => &mut self.not_moving,
            EvacuationStatus::Unknown => &mut self.unknown,
        };
        *count += 1;
        self.missing += u32::from(missing);
    }
}
