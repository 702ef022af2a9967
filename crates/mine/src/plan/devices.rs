//! What is bolted to the walls to find people by.

use adit_core::frames::{MineGrid, Position};
use alloc::string::String;
use serde::{Deserialize, Serialize};

/// A UWB anchor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Anchor {
    /// Its id, as in the logs.
    pub id: String,
    /// Place of the antenna: east, north, height, m.
    #[cfg_attr(feature = "std", schemars(with = "[f64; 3]"))]
    pub position_m: Position<MineGrid>,
    /// What it adds to every range, m; found by calibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_offset_m: Option<f64>,
    /// Antenna delay set in the radio, ns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "std", schemars(extend("minimum" = 0)))]
    pub antenna_delay_ns: Option<f64>,
    /// Transmit power, dBm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tx_power_dbm: Option<f64>,
}

/// What an access point sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Radio {
    /// Wi-Fi.
    #[default]
    Wifi,
    /// Bluetooth low energy.
    Ble,
}

/// A Wi-Fi access point or a BLE beacon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct AccessPoint {
    /// Its id.
    pub id: String,
    /// What it sends.
    #[serde(default)]
    pub radio: Radio,
    /// MAC address as in the logs, with or without colons; the id is used where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mac: Option<String>,
    /// Place of the antenna: east, north, height, m.
    #[cfg_attr(feature = "std", schemars(with = "[f64; 3]"))]
    pub position_m: Position<MineGrid>,
    /// Transmit power, dBm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tx_power_dbm: Option<f64>,
    /// How its signal falls off, where it was calibrated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path_loss: Option<PathLoss>,
}

/// Mean signal strength over distance `d`: `rssi_at_1m − 10 n log₁₀ d`, and with another exponent from the breakpoint on
/// (two-slope model of tunnels).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PathLoss {
    /// Mean signal strength 1 m from the antenna, dBm.
    pub rssi_at_1m_dbm: f64,
    /// Path-loss exponent n; 2 in free space, below 2 in a tunnel that guides the wave.
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub exponent: f64,
    /// Where the second slope begins, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub breakpoint_m: Option<f64>,
    /// Exponent beyond the breakpoint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub exponent_beyond: Option<f64>,
}

/// An RFID reader that sees who passes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RfidPortal {
    /// Its id, as in the logs.
    pub id: String,
    /// Place of the antenna: east, north, height, m.
    #[cfg_attr(feature = "std", schemars(with = "[f64; 3]"))]
    pub position_m: Position<MineGrid>,
    /// How far it sees, m.
    #[cfg_attr(feature = "std", schemars(extend("exclusiveMinimum" = 0)))]
    pub range_m: f64,
}
