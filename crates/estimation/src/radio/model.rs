//! What the calibration of a site's radio is kept in: the files of `adit calibrate pathloss` and `range` (TOML) and `fingerprint` (JSON).
//!
//! Each says its `kind` and the `version` of its form, [`VERSION`]; others are refused where they are read.

use super::map::{Hearing, Storeys};
use super::nearest::Fingerprints;
use super::range_fit::RangeModel;
use super::{AreaPrior, MapParams, RadioMap};
use crate::ranging::correction::RangeCorrection;
use adit_mine::plan::AccessPoint;
use adit_observation::DeviceId;
use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// The version of all forms that this program reads and writes.
pub const VERSION: u32 = 1;

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModelKind {
    /// [`PathLossModel`].
    PathLoss,
    /// [`FingerprintModel`].
    Fingerprint,
    /// [`RangesModel`].
    Ranges,
}

/// How the ranges of a kind of tag and anchors err.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangesModel {
    /// [`ModelKind::Ranges`].
    pub kind: ModelKind,
    /// [`VERSION`].
    pub version: u32,
    /// How they err.
    pub correction: RangeCorrection,
}

/// Path loss of a site's transmitters, `[[access_points]]` as in a mine file, and what the methods need besides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathLossModel {
    /// [`ModelKind::PathLoss`].
    pub kind: ModelKind,
    /// [`VERSION`].
    pub version: u32,
    /// How strengths scatter about the path loss.
    pub signal: SignalScatter,
    /// How weak a signal is heard.
    pub hearing: Hearing,
    /// What a floor between takes.
    pub storeys: Storeys,
    /// Where people are.
    pub area: AreaPrior,
    /// How far to believe a map of it.
    pub belief: MapParams,
    /// Offsets of ranges, by transmitter.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub ranges: BTreeMap<String, RangeModel>,
    /// Floors of the transmitters, where they are told.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub floors: BTreeMap<String, i32>,
    /// The transmitters.
    pub access_points: Vec<AccessPoint>,
}

/// How strengths scatter about the path loss, and its common parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalScatter {
    /// Height of the tag in the survey, m.
    pub height_m: f64,
    /// Standard deviation of one reading, dB.
    pub sigma_db: f64,
    /// Mean over the transmitters of the strength at 1 m, dBm.
    pub rssi_at_1m_dbm: f64,
    /// Mean exponent.
    pub exponent: f64,
}

/// Fingerprints of a site and the maps made of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerprintModel {
    /// [`ModelKind::Fingerprint`].
    pub kind: ModelKind,
    /// [`VERSION`].
    pub version: u32,
    /// Names of the transmitters, in the order of the map.
    pub transmitters: Vec<DeviceId>,
    /// What strengths to expect where, dBm.
    pub strengths: RadioMap,
    /// What ranges to expect where, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ranges: Option<RadioMap>,
    /// How far to believe the strengths.
    pub belief: MapParams,
    /// How far to believe the ranges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_belief: Option<MapParams>,
    /// The spots as surveyed.
    pub fingerprints: Fingerprints,
}
