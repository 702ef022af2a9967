//! Position from what radios say: signal strengths and round-trip ranges of Wi-Fi and BLE.
//!
//! | method | needs | module |
//! |---|---|---|
//! | centroid, weighted centroid of the transmitters | their places | [`centroid`] |
//! | centroids of the inner points of three circles, the improved one of system S1 among them | and a path loss | [`circles`] |
//! | linear least squares on circles | the same | [`trilateration`] |
//! | robust least squares on signal strengths, or on ranges | the same | [`signal_fit`], [`range_fit`] |
//! | likelihood over a lattice of places | a [`RadioMap`]: of a path loss, of ranges, or of fingerprints | [`map`] |
//! | nearest fingerprints | fingerprints | [`nearest`] |
//! | a walk over the lattice | a map | [`walk`] |
//!
//! In a log: signals are gathered into scans ([`scan`]), a [`locator`] with what is known of the [`site`] makes a position of each, and a
//! [`Listener`] is both of them, for the methods that use radio.
//!
//! Frame: east and north of the mine's grid or any local level frame, m. Heights count where transmitters and tag have one: the
//! distance is that in space. Signal strength in dBm, its errors in dB; a path loss is [`adit_mine::plan::PathLoss`].
//! Every method tells a covariance, from the errors of its readings carried to first order; how honest it is stands in
//! `docs/methods/radio.md`.
//!
//! Nothing here learns: models and maps are made by `adit-tuning`.

pub mod centroid;
pub mod circles;
mod fix;
pub(crate) mod gauss_newton;
pub mod lattice;
mod line;
mod listener;
pub mod locator;
pub mod map;
pub mod model;
pub mod nearest;
pub mod path_loss;
pub mod range_fit;
pub mod scan;
pub mod signal_fit;
pub mod site;
pub mod trilateration;
pub mod walk;

pub use fix::{AreaPrior, RadioFix};
pub use lattice::Lattice;
pub(crate) use listener::first_names;
pub use listener::{HeardReport, Listener};
pub use map::{MapParams, PlaceFix, RadioMap, Reading};
pub use site::{CentreLines, RadioSite, SiteAnchor, Surveyed, SurveyedMap};

pub use adit_mine::plan::PathLoss;

use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A transmitter (or fixed receiver) whose place and path loss are known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Emitter {
    /// East, north, height of its antenna, m.
    pub position_m: Vector3<f64>,
    /// Mean signal strength over distance.
    pub path_loss: PathLoss,
    /// Standard deviation of one reading about it, dB.
    pub sigma_db: f64,
}

/// A transmitter and how strong it was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heard<'a> {
    /// Which.
    pub emitter: &'a Emitter,
    /// Its signal strength, dBm.
    pub rssi_dbm: f64,
}

impl Heard<'_> {
    /// Level distance by the path loss, for a tag at this height, m. Zero where the signal is stronger than straight below.
    pub fn level_range_m(&self, height_m: f64) -> f64 {
        let slant = path_loss::distance_m(&self.emitter.path_loss, self.rssi_dbm);
        let drop = self.emitter.position_m.z - height_m;
        libm::sqrt((slant * slant - drop * drop).max(0.0))
    }

    /// Standard deviation of that distance, m: the error of the reading carried through the path loss.
    pub fn range_sigma_m(&self) -> f64 {
        let slant = path_loss::distance_m(&self.emitter.path_loss, self.rssi_dbm);
        slant * self.emitter.sigma_db / path_loss::fall_db(&self.emitter.path_loss, slant)
    }
}

/// In single precision: a strength, a range or a probability needs no more.
#[expect(clippy::cast_possible_truncation, reason = "what is lost is far below any error of a radio")]
fn single(value: f64) -> f32 {
    value as f32
}
