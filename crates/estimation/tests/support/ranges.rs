//! Ranges to the anchors of a laboratory, for the tests of the filter on them.

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_estimation::ranging::filter::weighting::{Weighting, WeightingKind};
use adit_estimation::ranging::filter::{FilterParams, HeightParams, RangeFilter};
use adit_estimation::ranging::listener::Link;
use adit_estimation::ranging::{RangeModel, Ranged};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// The anchors of `mines/lab.toml`.
pub const LAB: [[f64; 3]; 4] = [[2.0, 0.2, 3.2], [18.0, 0.2, 2.0], [22.0, 15.8, 3.2], [6.0, 15.8, 2.0]];

pub fn place([x, y, z]: [f64; 3]) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

pub fn seconds(value: f64) -> Time {
    Time::from_seconds(value).unwrap()
}

pub fn link(anchors: &[[f64; 3]], anchor: usize, time_s: f64, range_m: f64, sigma_m: f64) -> Link {
    let model = RangeModel { offset_m: 0.0, scale: 1.0, sigma_m };
    let ranged = Ranged { position_m: place(anchors[anchor]), model, range_m };
    Link { time: seconds(time_s), anchor, ranged, line_of_sight: None }
}

pub fn of_kind(kind: WeightingKind) -> Weighting {
    Weighting { kind, ..Weighting::default() }
}

pub fn filter(params: FilterParams, kind: WeightingKind) -> RangeFilter {
    RangeFilter::new(params, of_kind(kind)).unwrap()
}

pub fn at_height(height_m: f64, sigma_m: f64) -> HeightParams {
    HeightParams { height_m: Some(height_m), sigma_m, ..HeightParams::default() }
}

pub struct Normal(ChaCha8Rng);

impl Normal {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn draw(&mut self, sigma: f64) -> f64 {
        let value: f64 = StandardNormal.sample(&mut self.0);
        sigma * value
    }
}

/// A walk round the laboratory.
pub fn round(time_s: f64) -> Vector3<f64> {
    let angle = 0.12 * time_s;
    Vector3::new(12.0 + 7.0 * angle.cos(), 8.0 + 5.0 * angle.sin(), 1.1)
}
