//! What a mine file says: plain records with the units in their names. [`Mine`](crate::Mine) is what is made of them.
//!
//! Coordinates are those of the mine's grid ([`MineGrid`](adit_core::frames::MineGrid)): x east, y north, z up, m. Where a roadway or a
//! chamber is concerned, z is the **floor**. Every entry has an id that is unique in the file.

mod devices;
mod grid;
mod openings;
mod works;
mod zone;

pub use devices::{AccessPoint, Anchor, PathLoss, Radio, RfidPortal};
pub use grid::{ControlPoint, Fit, Grid};
pub use openings::{Chamber, Junction, Level, Roadway, RoadwayKind};
pub use works::{Conveyor, Door, DoorKind, Pillar, VehicleRoute};
pub use zone::{Zone, ZoneKind};

use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// The version of the format that this program reads and writes.
pub const FORMAT: u32 = 1;
/// How far apart centre lines may end and still meet, when the file does not say, m.
pub const SNAP_M: f64 = 0.1;

/// A mine as its file describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MinePlan {
    /// Version of this format: 1.
    #[serde(default = "format")]
    pub format: u32,
    /// Name of the mine.
    pub name: String,
    /// How far apart centre lines may end and still meet, m.
    #[serde(default = "snap_m")]
    pub snap_m: f64,
    /// What the coordinates mean.
    pub grid: Grid,
    /// Levels, in any order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<Level>,
    /// Roadways, ramps and shafts as centre lines; they meet where they come within `snap_m` of each other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub roadways: Vec<Roadway>,
    /// Rooms that are no roadways: halls, stations, workshops.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub chambers: Vec<Chamber>,
    /// Names of places where roadways meet; only needed where a name or a check is wanted, or where two roadways cross.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub junctions: Vec<Junction>,
    /// Areas with a meaning.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub zones: Vec<Zone>,
    /// UWB anchors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub anchors: Vec<Anchor>,
    /// Wi-Fi access points and BLE beacons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub access_points: Vec<AccessPoint>,
    /// RFID readers that see who passes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rfid_portals: Vec<RfidPortal>,
    /// Rock or machines left standing inside roadways and chambers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pillars: Vec<Pillar>,
    /// Doors across roadways.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doors: Vec<Door>,
    /// Conveyors: they disturb radio and magnetometers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conveyors: Vec<Conveyor>,
    /// Where vehicles go.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vehicle_routes: Vec<VehicleRoute>,
}

impl MinePlan {
    /// A plan with nothing in it.
    pub fn new(name: impl Into<String>, grid: Grid) -> Self {
        Self {
            format: FORMAT,
            name: name.into(),
            snap_m: SNAP_M,
            grid,
            levels: Vec::new(),
            roadways: Vec::new(),
            chambers: Vec::new(),
            junctions: Vec::new(),
            zones: Vec::new(),
            anchors: Vec::new(),
            access_points: Vec::new(),
            rfid_portals: Vec::new(),
            pillars: Vec::new(),
            doors: Vec::new(),
            conveyors: Vec::new(),
            vehicle_routes: Vec::new(),
        }
    }

    /// Turns every outline counter-clockwise about its first corner, the one form in which plans are kept.
    #[must_use]
    pub fn canonical(mut self) -> Self {
        let chambers = self.chambers.iter_mut().map(|c| &mut c.outline_m);
        let zones = self.zones.iter_mut().map(|z| &mut z.outline_m);
        let pillars = self.pillars.iter_mut().map(|p| &mut p.outline_m);
        for outline in chambers.chain(zones).chain(pillars) {
            if crate::geometry::polygon::signed_area_m2(outline) < 0.0 {
                outline[1..].reverse();
            }
        }
        self
    }
}

const fn format() -> u32 {
    FORMAT
}

const fn snap_m() -> f64 {
    SNAP_M
}

const fn yes() -> bool {
    true
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde wants it so")]
const fn is_yes(flag: &bool) -> bool {
    *flag
}
