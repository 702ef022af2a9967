//! The nearest fingerprints: k nearest neighbours in signal space, plain and weighted (Bahl & Padmanabhan 2000, *RADAR*).
//!
//! Distance between two scans: root of the mean square over all transmitters, in dB; one that is not heard counts as
//! [`NearestParams::unheard_dbm`]. The covariance is the weighted scatter of the neighbours' places about their mean, widened by the
//! mean distance between neighbouring fingerprints.

use super::line::moments;
use super::map::PlaceFix;
use super::{RadioFix, Reading, single};
use adit_core::nalgebra::{Matrix2, Vector2};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// What is taken as known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NearestParams {
    /// Neighbours.
    pub neighbours: usize,
    /// Weight them by one over their distance in signal space.
    pub weighted: bool,
    /// Strength that stands for "not heard", dBm.
    pub unheard_dbm: f64,
}

impl Default for NearestParams {
    fn default() -> Self {
        Self { neighbours: 5, weighted: true, unheard_dbm: -95.0 }
    }
}

/// Fingerprints: what was heard at each surveyed spot, one mean to a transmitter.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Fingerprints {
    /// Transmitters.
    pub transmitters: usize,
    /// East, north, m, and floor of each.
    pub spots: Vec<(Vector2<f64>, i32)>,
    /// Mean strength of every transmitter at every spot, one spot after another, dBm; NaN where it was not heard.
    #[serde(with = "super::map::rounded")]
    pub means_dbm: Vec<f32>,
}

impl Fingerprints {
    /// The fix by the nearest fingerprints; `None` where there are none or nothing known is heard.
    pub fn nearest(&self, readings: &[Reading], params: &NearestParams) -> Option<PlaceFix> {
        let unheard = single(params.unheard_dbm);
        let mut scan = alloc::vec![unheard; self.transmitters];
        let mut any = false;
        for reading in readings {
            if let Some(place) = scan.get_mut(reading.transmitter) {
                *place = single(reading.value);
                any = true;
            }
        }
        if !any || self.spots.is_empty() || self.transmitters == 0 {
            return None;
        }
        let distance = |means: &[f32]| {
            let squares = means.iter().zip(&scan).map(|(mean, read)| {
                let gap = if mean.is_nan() { unheard } else { *mean } - read;
                gap * gap
            });
            squares.sum::<f32>()
        };
        let mut by_distance: Vec<(f32, usize)> =
            self.means_dbm.chunks_exact(self.transmitters).map(distance).zip(0..).collect();
        let count = params.neighbours.clamp(1, by_distance.len());
        if count < by_distance.len() {
            by_distance.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        let chosen = &by_distance[..count];
        let weight = |square: f32| {
            let rms = libm::sqrt(f64::from(square) / self.transmitters as f64);
            if params.weighted { 1.0 / (rms + 0.01) } else { 1.0 }
        };
        // The floor with the most weight; places on others are not averaged in.
        let votes = |floor: i32| {
            let on = chosen.iter().filter(|(_, spot)| self.spots[*spot].1 == floor);
            on.map(|(square, _)| weight(*square)).sum::<f64>()
        };
        let nearest = chosen.iter().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        let mut floor = self.spots[nearest.1].1;
        for (_, spot) in chosen {
            if votes(self.spots[*spot].1) > votes(floor) {
                floor = self.spots[*spot].1;
            }
        }
        let on_floor = chosen.iter().filter(|(_, spot)| self.spots[*spot].1 == floor);
        let (position_m, scatter) =
            moments(on_floor.map(|(square, spot)| (self.spots[*spot].0, weight(*square))))?;
        let all = chosen.iter().map(|(square, _)| weight(*square)).sum::<f64>();
        // Three spots to an axis at least, else the scatter of one or two would be none.
        let spacing = self.spacing_m();
        let fix = RadioFix { position_m, covariance_m2: scatter + Matrix2::identity() * (spacing * spacing) };
        Some(PlaceFix { fix, floor, floor_share: votes(floor) / all })
    }

    /// Typical distance from a spot to the next, m: from the area of their extent.
    fn spacing_m(&self) -> f64 {
        let extent = |axis: usize| {
            let values = self.spots.iter().map(|(spot, _)| spot[axis]);
            let (low, high) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
            high - low
        };
        libm::sqrt((extent(0).max(1.0) * extent(1).max(1.0)) / self.spots.len() as f64)
    }
}
