//! Among the transmitters that are heard: the mean of their places, plain or weighted (Blumenthal et al. 2007, *Weighted centroid
//! localization in Zigbee-based sensor networks*).
//!
//! The covariance is the weighted scatter of the transmitters about the mean: the tag is somewhere among them. A tag is
//! drawn to the middle of the transmitters; outside their hull this fails.

use super::line::moments;
use super::{Heard, RadioFix};
use adit_core::nalgebra::Matrix2;

/// Weight of a transmitter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CentroidWeight {
    /// All the same.
    Equal,
    /// One over the distance by the path loss.
    InverseRange,
}

/// The centroid of the transmitters heard; `None` of none.
pub fn centroid(heard: &[Heard<'_>], weight: CentroidWeight) -> Option<RadioFix> {
    let weighted = heard.iter().map(|one| {
        let range = super::path_loss::distance_m(&one.emitter.path_loss, one.rssi_dbm);
        let weight = match weight {
            CentroidWeight::Equal => 1.0,
            CentroidWeight::InverseRange => 1.0 / range,
        };
        (one.emitter.position_m.xy(), weight)
    });
    let (position_m, scatter) = moments(weighted)?;
    // One transmitter alone: anywhere on its circle.
    let nearest = heard
        .iter()
        .map(|one| super::path_loss::distance_m(&one.emitter.path_loss, one.rssi_dbm))
        .fold(f64::INFINITY, f64::min);
    let circle = Matrix2::identity() * (0.5 * nearest * nearest);
    Some(RadioFix { position_m, covariance_m2: scatter + circle })
}
