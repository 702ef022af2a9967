//! A radio map from a survey: what every transmitter should read at every place, where nobody stood too.
//!
//! For each transmitter and floor a Gaussian process (Rasmussen & Williams 2006, ch. 2; Ferris, Hähnel & Fox 2006 for signal strengths):
//!
//! ```text
//! mean of readings at spot i     y_i = h(p_i)ᵀ β + f(p_i) + e_i
//! log-distance trend             h = [1, −10 log₁₀ d],   β ~ N(b, B)        (ranges: [1, d]; a level alone where the place is not known)
//! shadowing                      f ~ GP(0, σ_f² exp(−‖p − p'‖ / ℓ))           (Gudmundson 1991)
//! spot                           e_i ~ N(0, σ_s² + s²/n_i)
//! ```
//!
//! s: spread of readings at one spot, known from the survey. `σ_f`, ℓ and `σ_s` are the same for all transmitters of a survey, at the maximum of
//! their joint marginal likelihood. The trend is integrated out: its uncertainty is in the map's.
//!
//! Whether a scan hears the transmitter is a field of its own, a kernel mean of the shares at the spots near by with the
//! overall share as a prior: a process of strengths that saw only what was heard knows nothing of silence.

mod process;
mod scales;

pub use scales::{FieldScales, Search};

use crate::error::TuningError;
use crate::radio::{Site, SpotMeans, SurveyedScan, belief, by_spot};
use adit_core::nalgebra::Vector2;
use adit_estimation::radio::map::Expected;
use adit_estimation::radio::nearest::Fingerprints;
use adit_estimation::radio::{Lattice, MapParams, RadioMap};
use process::Process;
use rayon::prelude::*;

/// What the readings are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadingKind {
    /// Signal strengths, dBm.
    Strength,
    /// Ranges, m.
    Range,
}

/// What is taken as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerprintParams {
    /// What the readings are.
    pub kind: ReadingKind,
    /// Scans within a square of this size are one spot, m.
    pub cell_m: f64,
    /// From floor to floor, m.
    pub storey_m: f64,
    /// Width of the kernel of the share heard, m.
    pub hearing_width_m: f64,
    /// Spots of average hearing that stand as its prior.
    pub hearing_prior: f64,
    /// Heard and not heard are never surer than this.
    pub unsure: f64,
}

impl FingerprintParams {
    /// For readings of a kind.
    pub const fn of(kind: ReadingKind) -> Self {
        Self { kind, cell_m: 0.4, storey_m: 3.0, hearing_width_m: 3.0, hearing_prior: 0.5, unsure: 0.1 }
    }
}

/// Places of a map at the most, and at the least far apart, m; a finer map says no more.
const MOST_PLACES: usize = 2000;
const FINEST_M: f64 = 0.3;
const COARSEST_M: f64 = 1.0;
/// What is expected of a transmitter that a floor has never heard, dBm.
const UNHEARD_DBM: f64 = -100.0;
const UNHEARD_SIGMA_DB: f64 = 10.0;
/// Spots that a process needs on a floor.
const FEWEST_SPOTS: usize = 3;

/// A map and what it was made of.
#[derive(Debug, Clone, PartialEq)]
pub struct FingerprintFit {
    /// What to expect at every place.
    pub map: RadioMap,
    /// The spots' means, for nearest neighbours.
    pub fingerprints: Fingerprints,
    /// Scales of the processes.
    pub scales: FieldScales,
    /// How far to believe the map; not learnt of single packets.
    pub belief: MapParams,
}

/// Where a map may put people: around the spots of a survey, as dense as the survey.
///
/// The step is half the typical distance between spots (0.3 to 1 m), coarser where that would be more than two thousand places; people
/// may be that typical distance away from a spot. `None` of no spots.
pub fn lattice_around(spots: &[(Vector2<f64>, i32)]) -> Option<Lattice> {
    let nearest = |(index, (spot, floor)): (usize, &(Vector2<f64>, i32))| {
        let others = spots.iter().enumerate().filter(|(other, (_, on))| *other != index && on == floor);
        others.map(|(_, (other, _))| (other - spot).norm()).fold(f64::INFINITY, f64::min)
    };
    let gaps: Vec<f64> = spots.iter().enumerate().map(nearest).filter(|gap| gap.is_finite()).collect();
    let spacing = crate::robust::median(gaps).unwrap_or(COARSEST_M).clamp(FINEST_M, 10.0);
    let mut step = (0.5 * spacing).clamp(FINEST_M, COARSEST_M);
    loop {
        let lattice = Lattice::around(spots, step, spacing)?;
        if lattice.len() <= MOST_PLACES || step > 100.0 {
            return Some(lattice);
        }
        step *= 1.25;
    }
}

/// Makes the map of a survey; `sites` of the transmitters where they are known, `lattice` where people may be.
pub fn fit(
    scans: &[SurveyedScan],
    sites: &[Option<Site>],
    lattice: Lattice,
    params: &FingerprintParams,
) -> Result<FingerprintFit, TuningError> {
    let spots = by_spot(scans, sites.len(), params.cell_m);
    let spread = within_spots(&spots);
    let scales = scales::search(&spots, sites, params, spread).ok_or(TuningError::TooFewReadings {
        sensor: "radio",
        found: spots.len(),
        expected: 10,
    })?;
    let empty = || TuningError::TooFewReadings { sensor: "radio", found: 0, expected: 1 };
    let ranges = params.kind == ReadingKind::Range;
    let folds = belief::folds(scans, params.cell_m);
    let of_fold = |(kept, judged): (Vec<SurveyedScan>, Vec<SurveyedScan>)| {
        let kept = by_spot(&kept, sites.len(), params.cell_m);
        Some((map(&kept, sites, lattice.clone(), params, &scales)?, judged))
    };
    let judged: Vec<_> = folds.into_iter().filter_map(of_fold).collect();
    let belief = match (judged.is_empty(), ranges) {
        (false, _) => belief::learn(&judged, ranges),
        (true, true) => MapParams::RANGES,
        (true, false) => MapParams::PACKETS,
    };
    let map = map(&spots, sites, lattice, params, &scales).ok_or_else(empty)?;
    Ok(FingerprintFit { map, fingerprints: fingerprints(&spots, sites.len()), scales, belief })
}

/// The map of spots by processes of known scales.
fn map(
    spots: &[SpotMeans],
    sites: &[Option<Site>],
    lattice: Lattice,
    params: &FingerprintParams,
    scales: &FieldScales,
) -> Option<RadioMap> {
    let places: Vec<(Vector2<f64>, i32)> = lattice.iter().collect();
    let floors = lattice.floors().to_vec();
    let fields: Vec<Vec<Expected>> = (0..sites.len())
        .into_par_iter()
        .map(|transmitter| {
            let mut field =
                vec![Expected { mean: UNHEARD_DBM, sigma: UNHEARD_SIGMA_DB, heard: 0.0 }; places.len()];
            for floor in &floors {
                let process = Process::new(spots, transmitter, sites[transmitter], *floor, params, scales);
                let Some(process) = process.filter(|process| process.spots() >= FEWEST_SPOTS) else {
                    continue;
                };
                for (expected, (place, at)) in
                    field.iter_mut().zip(&places).filter(|(_, (_, at))| at == floor)
                {
                    (expected.mean, expected.sigma) = process.predict(place, *at);
                }
            }
            hear(spots, transmitter, &places, params, &mut field);
            field
        })
        .collect();
    RadioMap::new(lattice, sites.len(), |place, transmitter| fields[transmitter][place])
}

/// The means of the spots as they are, for nearest neighbours.
pub fn fingerprints(spots: &[SpotMeans], transmitters: usize) -> Fingerprints {
    let mean = |reading: &crate::radio::SpotReading| {
        #[expect(clippy::cast_possible_truncation, reason = "a strength or range in single precision")]
        if reading.count > 0 { reading.mean as f32 } else { f32::NAN }
    };
    Fingerprints {
        transmitters,
        spots: spots.iter().map(|spot| (spot.position_m.xy(), spot.floor)).collect(),
        means_dbm: spots.iter().flat_map(|spot| spot.readings.iter().map(mean)).collect(),
    }
}

/// Variance of readings at one spot, over all; that of one decibel and a half where every spot was read once.
fn within_spots(spots: &[SpotMeans]) -> f64 {
    let readings = || spots.iter().flat_map(|spot| &spot.readings).filter(|reading| reading.count > 1);
    let squares: f64 = readings().map(|reading| reading.squares).sum();
    let count: f64 = readings().map(|reading| (reading.count - 1) as f64).sum();
    if count > 0.0 { (squares / count).max(1e-4) } else { 2.25 }
}

/// The share of scans that hear a transmitter, about each place.
fn hear(
    spots: &[SpotMeans],
    transmitter: usize,
    places: &[(Vector2<f64>, i32)],
    params: &FingerprintParams,
    field: &mut [Expected],
) {
    // Packets that come one by one do not tell what was not heard.
    let whole = spots.iter().filter(|spot| spot.whole_scans > 0);
    let shares: Vec<(Vector2<f64>, i32, f64)> = whole
        .map(|spot| {
            let share = spot.readings[transmitter].count as f64 / spot.whole_scans as f64;
            (spot.position_m.xy(), spot.floor, share.min(1.0))
        })
        .collect();
    let overall = shares.iter().map(|(.., share)| share).sum::<f64>() / shares.len().max(1) as f64;
    for (expected, (place, floor)) in field.iter_mut().zip(places) {
        let (mut sum, mut total) = (params.hearing_prior * overall, params.hearing_prior);
        for (spot, _, share) in shares.iter().filter(|(_, on, _)| on == floor) {
            let away = (spot - place).norm_squared() / (params.hearing_width_m * params.hearing_width_m);
            // Beyond five widths a spot says nothing.
            if away < 25.0 {
                let weight = (-0.5 * away).exp();
                sum += weight * share;
                total += weight;
            }
        }
        let share = if shares.is_empty() { 0.5 } else { sum / total };
        expected.heard = params.unsure + (1.0 - 2.0 * params.unsure) * share;
    }
}
