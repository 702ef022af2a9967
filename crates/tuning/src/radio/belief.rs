//! How far to believe a radio map: degrees of freedom, the tag's offset, the weight of silence, and how much of it all.
//!
//! A survey can tell: a fifth of its spots is left out, a map made of the others, and those [`MapParams`] taken under which the scans at the spots left out
//! give most probability to where they were made. The score is the mean logarithm of the posterior density at the truth, a proper score
//! (Good 1952): it punishes a map that is too sure as much as one that is unsure.

use super::{SurveyedScan, spot_key};
use adit_estimation::radio::{MapParams, RadioMap};
use rayon::prelude::*;
use std::collections::HashMap;

/// Every so-many-th spot is left out.
const FOLD: usize = 5;
/// Spots that a fold needs.
const FEWEST_SPOTS: usize = 20;
/// Scans judged at one spot, and in all.
const SCANS_AT_SPOT: usize = 3;
const MOST_SCANS: usize = 150;

const DOFS: [f64; 4] = [3.0, 5.0, 9.0, 30.0];
/// None below 1.5 dB: a survey is made with one tag and cannot tell how the next one differs from it.
const OFFSETS_DB: [f64; 3] = [1.5, 3.0, 5.0];
const HEARD_WEIGHTS: [f64; 3] = [0.0, 0.3, 0.6];
const SHARES: [f64; 7] = [1.0, 0.8, 0.65, 0.5, 0.4, 0.3, 0.2];

/// The scans of a survey without every fifth spot, and some of those left out. `None` where there are too few spots, or single packets.
pub fn fold(scans: &[SurveyedScan], cell_m: f64) -> Option<(Vec<SurveyedScan>, Vec<SurveyedScan>)> {
    if scans.iter().any(|scan| !scan.whole) {
        return None;
    }
    let mut numbers = HashMap::new();
    let mut at_spot: HashMap<usize, usize> = HashMap::new();
    let numbered: Vec<(usize, &SurveyedScan)> = scans
        .iter()
        .map(|scan| {
            let next = numbers.len();
            (*numbers.entry(spot_key(scan, cell_m)).or_insert(next), scan)
        })
        .collect();
    if numbers.len() < FEWEST_SPOTS {
        return None;
    }
    let left_out = |spot: usize| spot % FOLD == FOLD / 2;
    let kept =
        numbered.iter().filter(|(spot, _)| !left_out(*spot)).map(|(_, scan)| (*scan).clone()).collect();
    let mut judged: Vec<SurveyedScan> = Vec::new();
    for (spot, scan) in numbered.iter().filter(|(spot, scan)| left_out(*spot) && !scan.readings.is_empty()) {
        let count = at_spot.entry(*spot).or_default();
        *count += 1;
        if *count <= SCANS_AT_SPOT {
            judged.push((*scan).clone());
        }
    }
    let stride = judged.len().div_ceil(MOST_SCANS).max(1);
    Some((kept, judged.into_iter().step_by(stride).collect()))
}

/// The best of some settings for scans at known spots that the map has not seen; those for ranges where `ranges`.
pub fn learn(map: &RadioMap, judged: &[SurveyedScan], ranges: bool) -> MapParams {
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
    let scored = trials.par_iter().flat_map_iter(|params| scores(map, judged, params)).collect::<Vec<_>>();
    let best = scored.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, params)| params);
    best.unwrap_or(if ranges { MapParams::RANGES } else { MapParams::SCAN })
}

/// Score of each share under settings that are otherwise these.
fn scores(map: &RadioMap, judged: &[SurveyedScan], params: &MapParams) -> Vec<(f64, MapParams)> {
    let mut sums = [0.0; SHARES.len()];
    let mut log_likelihood = Vec::new();
    for scan in judged {
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
