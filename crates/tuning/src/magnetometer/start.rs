//! Where the fit begins: an ellipsoid that most of the points agree with, however wrong the others are.
//!
//! Points are thinned along the path of the field, so that a minute on the table counts as one point, and lone spikes are
//! left out. Least median of squares (Rousseeuw 1984) then stands up to nearly half of the rest being wrong: of several hundred ellipsoids
//! through a dozen random points each, and the one through all, the one with the least median residual is taken.

use super::ellipsoid::Ellipsoid;
use crate::robust;
use adit_core::nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Step of the path at which a point is kept, as a share of the radius.
const STEP: f64 = 0.03;
/// A point farther than this from the median of its neighbours is a spike.
const SPIKE: f64 = 0.06;
/// Points that are enough for a start.
const MOST_POINTS: usize = 1500;
/// Points of a random ellipsoid; with nine the noise would decide.
const DRAWN: usize = 12;
/// With 35 % of the points wrong, one draw in 180 has none of them; 1000 draws miss with a chance of 0.4 %.
const DRAWS: usize = 1000;
/// Soft iron beyond this is not believed in a start.
const LARGEST_RATIO: f64 = 8.0;
/// Fixed: the same log gives the same calibration.
const SEED: u64 = 0x0e11_1950;

/// Points of the path, thinned, in order of time; coordinates about 1 in size.
pub fn thinned(points: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut kept: Vec<Vector3<f64>> = Vec::new();
    for window in points.windows(5) {
        let point = window[2];
        if kept.last().is_some_and(|last| (point - last).norm() < STEP) {
            continue;
        }
        let middle = Vector3::from_fn(|axis, _| {
            let mut values =
                [window[0][axis], window[1][axis], window[2][axis], window[3][axis], window[4][axis]];
            values.sort_by(f64::total_cmp);
            values[2]
        });
        if (point - middle).norm() < SPIKE {
            kept.push(point);
        }
    }
    kept
}

/// At most so many of the points, spread over all.
pub fn some(points: &[Vector3<f64>], most: usize) -> Vec<Vector3<f64>> {
    points.iter().step_by(points.len().div_ceil(most).max(1)).copied().collect()
}

/// The ellipsoid that the better half of the points fits best; `None` where no draw gives one.
pub fn ellipsoid(path: &[Vector3<f64>]) -> Option<Ellipsoid> {
    let points = &some(path, MOST_POINTS)[..];
    if points.len() < DRAWN {
        return None;
    }
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut draw = || {
        let index = ((u64::from(random.next_u32()) * points.len() as u64) >> 32) as usize;
        &points[index]
    };
    let all = Ellipsoid::through(points.iter());
    let drawn = (0..DRAWS).filter_map(|_| {
        let chosen: [&Vector3<f64>; DRAWN] = std::array::from_fn(|_| draw());
        Ellipsoid::through(chosen.into_iter())
    });
    let believable = all.into_iter().chain(drawn).filter(|e| e.ratio() < LARGEST_RATIO);
    let judged = believable.filter_map(|e| {
        let residuals = points.iter().map(|p| e.residual(p).abs()).collect();
        Some((robust::median(residuals)?, e))
    });
    judged.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, ellipsoid)| ellipsoid)
}
