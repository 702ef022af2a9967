//! Everything that can be set about the radio of a mine, with the unit in each name and a default that has a source.

use super::uwb::spec::UwbSpec;
use super::wifi::spec::RssiSpec;
use crate::error::{SimulationError, check_within};
use serde::{Deserialize, Serialize};

/// The radios of a mine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RadioSpec {
    /// Access points that send Wi-Fi.
    pub wifi: RssiSpec,
    /// Beacons that send Bluetooth low energy.
    pub ble: RssiSpec,
    /// UWB anchors.
    pub uwb: UwbSpec,
    /// Who wears the tag.
    pub body: BodySpec,
    /// RFID portals.
    pub portals: PortalSpec,
}

/// The wearer of a tag.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BodySpec {
    /// Whether people are in the way of radio, their own tag's and one another's; not where antennas stand clear of them, on caps.
    pub shades: bool,
    /// Half the width of the trunk, m.
    pub half_width_m: f64,
    /// Height, m.
    pub height_m: f64,
    /// Height of the tag above the floor, m.
    pub tag_height_m: f64,
    /// Distance of the antenna from the trunk, m.
    pub gap_m: f64,
}

/// What RFID readers at portals see.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PortalSpec {
    /// Share of the polls within reach and sight that a tag answers.
    pub seen: f64,
    /// Share of them with a body or a vehicle in between.
    pub seen_blocked: f64,
}

impl Default for RadioSpec {
    fn default() -> Self {
        Self {
            wifi: RssiSpec::wifi(),
            ble: RssiSpec::ble(),
            uwb: UwbSpec::default(),
            body: BodySpec::default(),
            portals: PortalSpec::default(),
        }
    }
}

impl Default for BodySpec {
    fn default() -> Self {
        Self { shades: true, half_width_m: 0.2, height_m: 1.75, tag_height_m: 1.3, gap_m: 0.03 }
    }
}

impl Default for PortalSpec {
    fn default() -> Self {
        Self { seen: 0.95, seen_blocked: 0.5 }
    }
}

impl RadioSpec {
    /// The first value for which the models make no sense.
    pub fn check(&self) -> Result<(), SimulationError> {
        self.wifi.check()?;
        self.ble.check()?;
        self.uwb.check()?;
        let BodySpec { half_width_m, height_m, tag_height_m, gap_m, shades: _ } = self.body;
        check_within("half_width_m", half_width_m, 0.05, 1.0, "0.05 to 1 m")?;
        check_within("height_m", height_m, 0.5, 3.0, "0.5 to 3 m")?;
        check_within("tag_height_m", tag_height_m, 0.0, 3.0, "0 to 3 m")?;
        check_within("gap_m", gap_m, 0.0, 1.0, "0 to 1 m")?;
        check_share("seen", self.portals.seen)?;
        check_share("seen_blocked", self.portals.seen_blocked)
    }
}

/// A share lies between 0 and 1.
pub(crate) fn check_share(name: &'static str, found: f64) -> Result<(), SimulationError> {
    check_within(name, found, 0.0, 1.0, "a share from 0 to 1")
}
