//! What stands or moves in the openings.

use super::{is_yes, yes};
use adit_core::frames::{MineGrid, Position};
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Rock, a support or a machine left standing inside an opening: it blocks sight and way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Pillar {
    /// Its id.
    pub id: String,
    /// The level it stands on; from its floor to that of the next level, unless `height_m` is given.
    pub level: String,
    /// Height above the level's elevation, for what does not reach the roof, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub height_m: Option<f64>,
    /// Corners east, north, in order round it, the first not repeated, m.
    #[cfg_attr(feature = "std", schemars(length(min = 3)))]
    pub outline_m: Vec<[f64; 2]>,
}

/// What a door is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum DoorKind {
    /// Holds the air back: the pressure steps across it.
    #[default]
    Ventilation,
    /// Holds fire back.
    Fire,
    /// Holds people or vehicles back, not the air.
    Gate,
}

/// A door across a roadway.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Door {
    /// Its id.
    pub id: String,
    /// What it is for.
    #[serde(default)]
    pub kind: DoorKind,
    /// The level it stands on.
    pub level: String,
    /// Usually closed.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub closed: bool,
    /// Pressure behind it (left of the line from its first to its second end) less that before it, while closed, Pa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_step_pa: Option<f64>,
    /// How much it weakens radio while closed, dB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "std", schemars(extend("minimum" = 0)))]
    pub attenuation_db: Option<f64>,
    /// Its two ends on the walls: east, north, m.
    pub ends_m: [[f64; 2]; 2],
}

/// A conveyor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Conveyor {
    /// Its id.
    pub id: String,
    /// Middle of the belt: east, north, height, m.
    #[cfg_attr(feature = "std", schemars(with = "Vec<[f64; 3]>", length(min = 2)))]
    pub points_m: Vec<Position<MineGrid>>,
}

/// Where vehicles go, again and again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct VehicleRoute {
    /// Its id.
    pub id: String,
    /// Name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Speed, m/s.
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub speed_m_s: f64,
    /// Ids of the roadways it follows, in order; each meets the next.
    #[cfg_attr(feature = "std", schemars(length(min = 1)))]
    pub roadways: Vec<String>,
}
