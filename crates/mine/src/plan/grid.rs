//! What the coordinates of a mine mean.

use adit_core::frames::{MineGrid, Position};
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// How far a control point may lie from where the fit puts it, when the file does not say, m.
const TOLERANCE_M: f64 = 0.1;

/// What the coordinates mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Grid {
    /// A grid of the mine's own; where on Earth it lies is not known.
    Local {},
    /// Easting, northing and height of a projected coordinate reference system.
    Epsg {
        /// Its EPSG code, for example 32633 for UTM zone 33N.
        code: u32,
    },
    /// A grid of the mine's own, tied to the Earth by points known in both.
    ControlPoints {
        /// How the grid may lie against true east and north.
        #[serde(default)]
        fit: Fit,
        /// How far a control point may lie from where the fit puts it, m.
        #[serde(default = "tolerance_m")]
        tolerance_m: f64,
        /// Points known in both: two at least for a similarity, three for an affine fit.
        points: Vec<ControlPoint>,
    },
}

/// Which horizontal transform is fitted through the control points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Fit {
    /// Shift, turn and one scale (4 parameters).
    #[default]
    Similarity,
    /// Shift and any linear map (6 parameters): for old grids with unequal scales or a skew.
    Affine,
}

/// A point known in the grid and on the Earth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ControlPoint {
    /// Its id.
    pub id: String,
    /// Grid coordinates east, north, height, m.
    #[cfg_attr(feature = "std", schemars(with = "[f64; 3]"))]
    pub grid_m: Position<MineGrid>,
    /// WGS-84 latitude, deg.
    pub latitude_deg: f64,
    /// WGS-84 longitude, east positive, deg.
    pub longitude_deg: f64,
    /// Height above the WGS-84 ellipsoid, m.
    pub height_m: f64,
}

const fn tolerance_m() -> f64 {
    TOLERANCE_M
}
