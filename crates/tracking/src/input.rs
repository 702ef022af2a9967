//! What is heard: one entry of the journal each.

use crate::command::Command;
use adit_core::frames::{MineGrid, Position, Vector};
use adit_core::solution::Quality;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// One thing that was heard, or that somebody wants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Input {
    /// Where a tag is.
    Fix(Fix),
    /// A tag was heard, wherever it is.
    Heard(Heard),
    /// How full a tag's battery is.
    Battery(Battery),
    /// The distress button of a tag was pressed.
    Button(Button),
    /// Whether who wears a tag moves.
    Activity(Activity),
    /// A gateway or an anchor came or went.
    Device(Device),
    /// A second has passed.
    Tick,
    /// Somebody wants something.
    Command {
        /// Who, as it will stand in alarms and events.
        by: String,
        /// What.
        command: Command,
    },
}

/// Where a tag is, as its estimator or a system from outside says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fix {
    /// The tag.
    pub tag: String,
    /// Time of validity.
    pub time: Time,
    /// Where, m.
    pub position_m: Position<MineGrid>,
    /// How fast, where it is known, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_m_s: Option<Vector<MineGrid>>,
    /// Radius of the horizontal circle that holds the tag with 95 % probability, m.
    pub radius_95_m: f64,
    /// Radius outside which it is with no more probability than [`INTEGRITY_RISK`](adit_core::solution::INTEGRITY_RISK), m.
    pub protection_level_m: f64,
    /// How far to trust it.
    pub quality: Quality,
    /// Whether it moves, where the method knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving: Option<bool>,
    /// Name of the method, or of the system from outside.
    pub method: Arc<str>,
}

/// A tag was heard through a gateway.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Heard {
    /// The tag.
    pub tag: String,
    /// Time of its last observation.
    pub time: Time,
    /// By whom it was heard.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gateway: Option<String>,
}

/// How full a battery is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Charge {
    /// Share of a full one, 0 to 1.
    Share(f64),
    /// Its voltage, V.
    Volts(f64),
}

/// How full a tag's battery is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Battery {
    /// The tag.
    pub tag: String,
    /// When it was measured.
    pub time: Time,
    /// How full.
    pub charge: Charge,
}

/// The distress button was pressed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Button {
    /// The tag.
    pub tag: String,
    /// When.
    pub time: Time,
}

/// What the tag's own sensors say of who wears it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// Steps, or the motion of somebody who works.
    Moving,
    /// No motion.
    Still,
    /// The tag has seen a fall, or lies as it does on nobody who stands.
    Fallen,
}

/// What the tag's own sensors say of who wears it, wherever that is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Activity {
    /// The tag.
    pub tag: String,
    /// Until when it was so.
    pub time: Time,
    /// What.
    pub motion: Motion,
}

/// What is bolted to the walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeviceKind {
    /// It hears tags and tells the server.
    Gateway,
    /// Tags measure ranges to it.
    Anchor,
}

/// A device came or went.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Device {
    /// What it is.
    pub kind: DeviceKind,
    /// Its id.
    pub id: String,
    /// Since when.
    pub time: Time,
    /// It works.
    pub up: bool,
}
