//! What is excavated: levels, roadways, chambers, and where roadways meet.

use super::{is_yes, yes};
use adit_core::frames::{MineGrid, Position};
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// A level: what lies nearer to its elevation than to that of any other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Its id.
    pub id: String,
    /// Name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Height of its floor, m.
    pub elevation_m: f64,
}

/// What a roadway is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RoadwayKind {
    /// Any other: a drift, an entry, a footpath.
    #[default]
    Drift,
    /// Main haulage or belt roadway.
    Haulage,
    /// Ventilation roadway.
    Ventilation,
    /// Short connection between two roadways.
    Crosscut,
    /// Inclined roadway between levels.
    Ramp,
    /// Vertical or steep opening: shaft, raise, winze. Round, as wide as `width_m`.
    Shaft,
}

/// A roadway: a corridor of constant width and height along a centre line on its floor, its ends and corners rounded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Roadway {
    /// Its id.
    pub id: String,
    /// Name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The level it belongs to; ramps and shafts between levels have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<String>,
    /// What it is.
    #[serde(default)]
    pub kind: RoadwayKind,
    /// Width, m.
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub width_m: f64,
    /// Height of the roof above the floor, m.
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub height_m: f64,
    /// The steepest it is by survey, in metres of height to 100 m of horizontal way; checked against z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "std", schemars(extend("minimum" = 0)))]
    pub max_slope_percent: Option<f64>,
    /// People may walk in it; false for hoisting shafts.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub walkable: bool,
    /// Centre line on the floor: east, north, height of each point, m.
    #[cfg_attr(feature = "std", schemars(with = "Vec<[f64; 3]>", length(min = 2)))]
    pub points_m: Vec<Position<MineGrid>>,
}

/// A room with a level floor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Chamber {
    /// Its id.
    pub id: String,
    /// Name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Height of its floor, m.
    pub floor_m: f64,
    /// Height of its roof above the floor, m.
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub height_m: f64,
    /// Corners east, north, in order round the room, the first not repeated, m.
    #[cfg_attr(feature = "std", schemars(length(min = 3)))]
    pub outline_m: Vec<[f64; 2]>,
}

/// A named place where roadways meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Junction {
    /// Its id.
    pub id: String,
    /// Name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Place on the floor: east, north, height, m.
    #[cfg_attr(feature = "std", schemars(with = "[f64; 3]"))]
    pub position_m: Position<MineGrid>,
    /// Ids of the roadways that meet here; empty = all that come within `snap_m`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub roadways: Vec<String>,
}
