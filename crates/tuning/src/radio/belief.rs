//! How far to believe a radio map: degrees of freedom, the tag's offset, the weight of silence, and how much of it all.
//!
//! A survey can tell: each fifth of its spots is left out in turn, a map made of the others, and those [`MapParams`] taken under which the scans at the
//! spots left out give most probability to where they were made. The score is the mean logarithm of the posterior density at the truth, a proper score
//! (Good 1952): it punishes a map that is too sure as much as one that is unsure.

use super::{SurveyedScan, spot_key};
use adit_estimation::radio::{MapParams, RadioMap};
use rayon::prelude::*;
use std::collections::HashMap;

/// Folds.
const FOLDS: usize = 5;
/// Spots that it needs.
const FEWEST_SPOTS: usize = 20;
/// Scans judged at one spot, and in one fold.
const SCANS_AT_SPOT: usize = 2;
const MOST_SCANS: usize = 60;

const DOFS: [f64; 4] = [3.0, 5.0, 9.0, 30.0];
/// None below 1.5 dB: a survey is made with one tag and cannot tell how the next one differs from it.
const OFFSETS_DB: [f64; 3] = [1.5, 3.0, 5.0];
const HEARD_WEIGHTS: [f64; 3] = [0.0, 0.3, 0.6];
const SHARES: [f64; 7] = [1.0, 0.8, 0.65, 0.5, 0.4, 0.3, 0.2];

/// Scans to make a map of, and others to judge it by.
pub type Fold = (Vec<SurveyedScan>, Vec<SurveyedScan>);

/// The scans of a survey without each fifth spot in turn, and some of those left out. Empty where there are too few spots, or single
/// packets.
pub fn folds(scans: &[SurveyedScan], cell_m: f64) -> Vec<Fold> {
    if scans.iter().any(|scan| !scan.whole) {
        return Vec::new();
    }
    let mut numbers = HashMap::new();
    let numbered: Vec<(usize, &SurveyedScan)> = scans
        .iter()
        .map(|scan| {
            let next = numbers.len();
            (*numbers.entry(spot_key(scan, cell_m)).or_insert(next), scan)
        })
        .collect();
    if numbers.len() < FEWEST_SPOTS {
        return Vec::new();
    }
    (0..FOLDS).map(|fold| split(&numbered, |spot| spot % FOLDS == fold)).collect()
}

fn split(numbered: &[(usize, &SurveyedScan)], left_out: impl Fn(usize) -> bool) -> Fold {
    let mut at_spot: HashMap<usize, usize> = HashMap::new();
    let (mut kept, mut judged): (Vec<SurveyedScan>, Vec<SurveyedScan>) = (Vec::new(), Vec::new());
    for (spot, scan) in numbered {
        if !left_out(*spot) {
            kept.push((*scan).clone());
        } else if !scan.readings.is_empty() {
            let count = at_spot.entry(*spot).or_default();
            *count += 1;
            if *count <= SCANS_AT_SPOT {
                judged.push((*scan).clone());
            }
        }
    }
    let stride = judged.len().div_ceil(MOST_SCANS).max(1);
    (kept, judged.into_iter().step_by(stride).collect())
}

/// The best of some settings for scans at known spots, each with a map that has not seen them; those for ranges where `ranges`.
pub fn learn(judged: &[(RadioMap, Vec<SurveyedScan>)], ranges: bool) -> MapParams {
    let (offsets, weights): (&[f64], &[f64]) =
        if ranges { (&[0.0], &[0.0]) } else { (&OFFSETS_DB, &HEARD_WEIGHTS) };
    let mut trials = Vec::new();
    for dof in DOFS {
        for offset_sigma in offsets {
            for heard_weight in weights {
                let (offset_sigma, heard_weight) = (*offset_sigma, *heard_weight);
                trials.push(MapParams { dof, offset_sigma, heard_weight, share: 1.0 });
            }
        }
    }
    // Scores summed in order: the same on one thread or many.
    let scored = trials.par_iter().flat_map_iter(|params| scores(judged, params)).collect::<Vec<_>>();
    let best = scored.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, params)| params);
    let default = if ranges { MapParams::RANGES } else { MapParams::SCAN };
    best.filter(|_| !judged.is_empty()).unwrap_or(default)
}

/// Score of each share under settings that are otherwise these.
fn scores(judged: &[(RadioMap, Vec<SurveyedScan>)], params: &MapParams) -> Vec<(f64, MapParams)> {
    let mut sums = [0.0; SHARES.len()];
    let mut log_likelihood = Vec::new();
    for (map, scan) in judged.iter().flat_map(|(map, scans)| scans.iter().map(move |scan| (map, scan))) {
        let Some(place) = nearest_place(map, scan) else { continue };
        map.log_likelihood(&scan.readings, params, &mut log_likelihood);
        let best = log_likelihood.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (sum, share) in sums.iter_mut().zip(SHARES) {
            let total: f64 = log_likelihood.iter().map(|log| (share * (log - best)).exp()).sum();
            *sum += share * (log_likelihood[place] - best) - total.ln();
        }
    }
    sums.iter().zip(SHARES).map(|(sum, share)| (*sum, MapParams { share, ..*params })).collect()
}

fn nearest_place(map: &RadioMap, scan: &SurveyedScan) -> Option<usize> {
    let away = map.lattice().iter().enumerate().filter(|(_, (_, floor))| *floor == scan.floor);
    let away = away.map(|(index, (place, _))| ((place - scan.position_m.xy()).norm_squared(), index));
    away.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, index)| index)
}
