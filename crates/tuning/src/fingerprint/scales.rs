//! How rough the fields of a survey are: the scales of its processes, by maximum marginal likelihood.

use super::process::Process;
use super::{FingerprintParams, ReadingKind};
use crate::radio::{Site, SpotMeans};
use rayon::prelude::*;
use serde::Serialize;

/// Scales of the processes of a survey.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FieldScales {
    /// Standard deviation `σ_f` of the shadowing.
    pub shadowing_sigma: f64,
    /// Its correlation length ℓ, m.
    pub length_m: f64,
    /// Standard deviation `σ_s` of what one spot adds.
    pub spot_sigma: f64,
    /// Variance s² of readings at one spot.
    pub within: f64,
    /// How they were found.
    pub search: Search,
}

/// How the scales were found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Search {
    /// Logarithm of the marginal likelihood at the end, up to a constant.
    pub log_likelihood: f64,
    /// Likelihoods computed.
    pub evaluations: usize,
}

impl FieldScales {
    /// Covariance of the shadowing at two places this far apart.
    pub fn shadowing(&self, apart_m: f64) -> f64 {
        self.shadowing_sigma * self.shadowing_sigma * (-apart_m / self.length_m).exp()
    }
}

/// Spots of one transmitter that the search looks at: more say little more and cost the third power.
const MOST_SPOTS: usize = 120;
/// And of how many it needs.
const FEWEST_SPOTS: usize = 5;
/// First and last step, as factors.
const FIRST_STEP: f64 = 2.0;
const LAST_STEP: f64 = 1.08;
/// Bounds of the lengths, m, and of the deviations, as shares of their start.
const LENGTHS_M: [f64; 2] = [0.3, 200.0];
const SHARES: [f64; 2] = [0.02, 20.0];

/// The scales of highest likelihood, by Hooke and Jeeves' pattern search (1961) over their logarithms: coordinate by
/// coordinate, steps halved where none helps. `None` where too few spots heard anything.
pub fn search(
    spots: &[SpotMeans],
    sites: &[Option<Site>],
    params: &FingerprintParams,
    within: f64,
) -> Option<FieldScales> {
    let mut floors: Vec<i32> = spots.iter().map(|spot| spot.floor).collect();
    floors.sort_unstable();
    floors.dedup();
    let pairs =
        || (0..sites.len()).flat_map(|transmitter| floors.iter().map(move |floor| (transmitter, *floor)));
    // Every so-many-th spot of each, so that all parts of the survey are in.
    let thinned = |(transmitter, floor): (usize, i32)| {
        let heard: Vec<&SpotMeans> =
            spots.iter().filter(|spot| spot.floor == floor && spot.readings[transmitter].count > 0).collect();
        let stride = heard.len().div_ceil(MOST_SPOTS).max(1);
        (transmitter, heard.into_iter().step_by(stride).collect::<Vec<_>>())
    };
    let groups: Vec<(usize, Vec<&SpotMeans>)> =
        pairs().map(thinned).filter(|(_, heard)| heard.len() >= FEWEST_SPOTS).collect();
    if groups.is_empty() {
        return None;
    }
    let start = match params.kind {
        ReadingKind::Strength => [4.0, 5.0, 2.0],
        ReadingKind::Range => [1.0, 3.0, 0.5],
    };
    let scales = |[shadowing_sigma, length_m, spot_sigma]: [f64; 3], search: Search| FieldScales {
        shadowing_sigma,
        length_m,
        spot_sigma,
        within,
        search,
    };
    let mut evaluations = 0;
    let mut likelihood = |at: [f64; 3]| {
        evaluations += 1;
        let trial = scales(at, Search { log_likelihood: 0.0, evaluations: 0 });
        let of_group = |(transmitter, heard): &(usize, Vec<&SpotMeans>)| {
            Process::of(heard, *transmitter, sites[*transmitter], params, &trial)
                .map_or(f64::NEG_INFINITY, |process| process.log_likelihood())
        };
        // Summed in order: the same on one thread or many.
        groups.par_iter().map(of_group).collect::<Vec<f64>>().into_iter().sum::<f64>()
    };
    let bounds = [
        [start[0] * SHARES[0], start[0] * SHARES[1]],
        LENGTHS_M,
        [start[2] * SHARES[0], start[2] * SHARES[1]],
    ];
    let (mut here, mut best) = (start, likelihood(start));
    let mut factor = FIRST_STEP;
    while factor > LAST_STEP {
        let mut moved = false;
        for axis in 0..3 {
            for step in [factor, 1.0 / factor] {
                let mut there = here;
                there[axis] = (there[axis] * step).clamp(bounds[axis][0], bounds[axis][1]);
                if there[axis].to_bits() == here[axis].to_bits() {
                    continue;
                }
                let value = likelihood(there);
                if value > best {
                    (here, best, moved) = (there, value, true);
                    break;
                }
            }
        }
        if !moved {
            factor = factor.sqrt();
        }
    }
    best.is_finite().then(|| scales(here, Search { log_likelihood: best, evaluations }))
}
