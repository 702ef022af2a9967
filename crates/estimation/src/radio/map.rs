//! Likelihood over a lattice: what each transmitter should read at every place, and how sure that is.
//!
//! ```text
//! L(p) = Σ heard   −(ν+1)/2 ln(1 + (z_i − c − μ_i(p))² / ν σ_i(p)²) − ln σ_i(p)   − c² / 2σ_c²
//!      + ω Σ heard ln h_i(p)  +  ω Σ not heard ln(1 − h_i(p))
//! ```
//!
//! μ, σ: mean and standard deviation of a reading (dBm, or m for ranges); h: probability that a scan hears it. The offset c of the tag is the
//! best at each place. Student's t keeps one wrong reading from ruling out the truth. Whether a transmitter is heard depends on tag,
//! case and body more than the level does, and such events come together: they count with the weight ω.
//! The fix is mean and covariance of `exp λL` on the likeliest floor; λ ≤ 1 where errors of several transmitters go together. How readings are believed
//! ([`MapParams`]) is best learnt from the survey itself: `adit_tuning::radio::belief`.
//!
//! The readings may be strengths or round-trip ranges; the map may come of a path loss ([`RadioMap::of_emitters`]), of range models
//! ([`RadioMap::of_ranges`]) or of fingerprints (`adit_tuning::fingerprint`).

use super::lattice::Lattice;
use super::line::moments;
use super::path_loss::mean_of_square_dbm;
use super::range_fit::RangeModel;
use super::{Emitter, RadioFix, single};
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// One reading of a transmitter known to the map by its number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Number of the transmitter.
    pub transmitter: usize,
    /// Signal strength, dBm, or range, m.
    pub value: f64,
}

/// How readings are believed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MapParams {
    /// Degrees of freedom ν of the errors.
    pub dof: f64,
    /// Standard deviation `σ_c` of the tag's offset, in the unit of the readings; 0 for none.
    pub offset_sigma: f64,
    /// Weight ω of hearing and not hearing; 0 where the readings are no whole scan.
    pub heard_weight: f64,
    /// How much of the whole is believed, above 0 to 1: less where errors of transmitters go together.
    pub share: f64,
}

impl MapParams {
    /// For scans of signal strengths, before a survey has told better.
    pub const SCAN: Self = Self { dof: 4.0, offset_sigma: 3.0, heard_weight: 0.5, share: 1.0 };
    /// For ranges.
    pub const RANGES: Self = Self { dof: 4.0, offset_sigma: 0.0, heard_weight: 0.0, share: 1.0 };
    /// For packets that come one by one.
    pub const PACKETS: Self = Self { dof: 4.0, offset_sigma: 0.0, heard_weight: 0.0, share: 1.0 };
}

/// A position, the floor, and how sure the floor is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlaceFix {
    /// Position on that floor.
    pub fix: RadioFix,
    /// The likeliest floor.
    pub floor: i32,
    /// Its probability.
    pub floor_share: f64,
}

/// Storeys, for a path loss over several floors (Seidel & Rappaport 1992, *914 MHz path loss prediction models*, eq. 4).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Storeys {
    /// From floor to floor, m.
    pub height_m: f64,
    /// What each floor between takes off the signal, dB.
    pub loss_db: f64,
}

/// The probability of hearing a mean of this strength: half at `half_dbm`, over a width of `width_db`, never surer than `1 − unsure`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hearing {
    /// Strength heard half of the time, dBm.
    pub half_dbm: f64,
    /// Width of the logistic curve, dB.
    pub width_db: f64,
    /// What is left of the other event at either end.
    pub unsure: f64,
}

impl Hearing {
    /// Probability that a transmitter of this mean strength is heard.
    pub fn probability(&self, mean_dbm: f64) -> f64 {
        let curve = 1.0 / (1.0 + libm::exp((self.half_dbm - mean_dbm) / self.width_db));
        self.unsure + (1.0 - 2.0 * self.unsure) * curve
    }
}

/// What is expected of one transmitter at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Mean reading.
    pub mean: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Probability that a scan hears it.
    pub heard: f64,
}

/// Expectations of every transmitter at every place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct RadioMap {
    stored: Stored,
    cells: Vec<Cell>,
    /// Σ ln(1 − h) of each place.
    silence: Vec<f32>,
}

/// What is kept in files; transmitters change fastest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Stored {
    lattice: Lattice,
    transmitters: usize,
    #[serde(with = "rounded")]
    mean: Vec<f32>,
    #[serde(with = "rounded")]
    sigma: Vec<f32>,
    #[serde(with = "rounded")]
    heard: Vec<f32>,
}

/// One transmitter at one place, as the likelihood wants it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    mean: f32,
    information: f32,
    ln_sigma: f32,
    /// ln(h / (1 − h)).
    log_odds: f32,
}

/// Probabilities nearer to 0 or 1 are not believed.
const SUREST: f32 = 1e-3;
/// Standard deviations below this are not believed, in the unit of the readings.
const SHARPEST: f32 = 0.05;
/// Rounds of reweighting for the offset.
const OFFSET_ROUNDS: usize = 3;
/// Places reckoned side by side.
const LANES: usize = 4;
/// So far below the likeliest, as logarithm, a place weighs nothing.
const NOTHING: f64 = -60.0;
/// A product of this size is turned into its logarithm.
const LARGE: f64 = 1e200;

impl RadioMap {
    /// A map of what `expected` says of each place and transmitter; `None` of a lattice without places or of no transmitters.
    pub fn new(
        lattice: Lattice,
        transmitters: usize,
        mut expected: impl FnMut(usize, usize) -> Expected,
    ) -> Option<Self> {
        let (mut mean, mut sigma, mut heard) = (Vec::new(), Vec::new(), Vec::new());
        for place in 0..lattice.len() {
            for transmitter in 0..transmitters {
                let here = expected(place, transmitter);
                mean.push(single(here.mean));
                sigma.push(single(here.sigma));
                heard.push(single(here.heard));
            }
        }
        Self::try_from(Stored { lattice, transmitters, mean, sigma, heard }).ok()
    }

    /// The map of transmitters with a path loss, each with its floor where floors count.
    pub fn of_emitters(
        lattice: Lattice,
        emitters: &[(Emitter, Option<i32>)],
        height_m: f64,
        storeys: &Storeys,
        hearing: &Hearing,
    ) -> Option<Self> {
        let places: Vec<_> = lattice.iter().collect();
        Self::new(lattice, emitters.len(), |place, transmitter| {
            let ((position, floor), (emitter, on)) = (places[place], &emitters[transmitter]);
            let apart = on.map_or(0.0, |on| f64::from(on) - f64::from(floor));
            let level = (position - emitter.position_m.xy()).norm_squared();
            let drop = emitter.position_m.z - height_m + apart * storeys.height_m;
            let mean =
                mean_of_square_dbm(&emitter.path_loss, level + drop * drop) - storeys.loss_db * apart.abs();
            Expected { mean, sigma: emitter.sigma_db, heard: hearing.probability(mean) }
        })
    }

    /// The map of devices that measure ranges.
    pub fn of_ranges(
        lattice: Lattice,
        devices: &[(Vector3<f64>, RangeModel)],
        height_m: f64,
    ) -> Option<Self> {
        let places: Vec<_> = lattice.iter().collect();
        Self::new(lattice, devices.len(), |place, device| {
            let (position_m, model) = &devices[device];
            let drop = position_m.z - height_m;
            let distance = libm::sqrt((places[place].0 - position_m.xy()).norm_squared() + drop * drop);
            Expected { mean: model.scale * distance + model.offset_m, sigma: model.sigma_m, heard: 0.5 }
        })
    }

    /// Its places.
    pub fn lattice(&self) -> &Lattice {
        &self.stored.lattice
    }

    /// How many transmitters it knows.
    pub fn transmitters(&self) -> usize {
        self.stored.transmitters
    }

    /// Logarithm of the likelihood of these readings at every place, into `log_likelihood` (up to a constant).
    ///
    /// Readings of transmitters that the map does not know, and such that are no number, are left out.
    pub fn log_likelihood(&self, readings: &[Reading], params: &MapParams, log_likelihood: &mut Vec<f64>) {
        let count = self.stored.transmitters;
        let known: Vec<Reading> =
            readings.iter().filter(|one| one.transmitter < count && one.value.is_finite()).copied().collect();
        log_likelihood.clear();
        let mut errors: Vec<([f64; LANES], [f64; LANES])> = Vec::with_capacity(known.len());
        for (cells, silence) in self.cells.chunks(LANES * count).zip(self.silence.chunks(LANES)) {
            // Places beyond the last are the last once more, and left out.
            let last = silence.len() - 1;
            let lanes: [usize; LANES] = core::array::from_fn(|lane| lane.min(last));
            let mut log = lanes.map(|lane| params.heard_weight * f64::from(silence[lane]));
            errors.clear();
            for reading in &known {
                let at = lanes.map(|lane| &cells[lane * count + reading.transmitter]);
                let error = at.map(|cell| reading.value - f64::from(cell.mean));
                errors.push((error, at.map(|cell| f64::from(cell.information))));
                for (log, cell) in log.iter_mut().zip(at) {
                    *log += params.heard_weight * f64::from(cell.log_odds) - f64::from(cell.ln_sigma);
                }
            }
            let strengths = strengths(&errors, params);
            let both = log.iter().zip(&strengths).take(silence.len());
            log_likelihood.extend(both.map(|(log, strengths)| params.share * (log + strengths)));
        }
    }

    /// The fix by these readings; `None` where no known transmitter is among them.
    pub fn fix(&self, readings: &[Reading], params: &MapParams) -> Option<PlaceFix> {
        let mut log_likelihood = Vec::with_capacity(self.stored.lattice.len());
        let any =
            readings.iter().any(|one| one.transmitter < self.stored.transmitters && one.value.is_finite());
        if !any {
            return None;
        }
        self.log_likelihood(readings, params, &mut log_likelihood);
        let best = log_likelihood.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for value in &mut log_likelihood {
            let below = *value - best;
            *value = if below > NOTHING { libm::exp(below) } else { 0.0 };
        }
        place_fix(&self.stored.lattice, &log_likelihood)
    }
}

/// Likelihood of the errors (with one over their variance) at some places, the tag's offset at its best at each. The places are independent lanes, so that
/// a processor divides for several at once.
#[inline]
fn strengths(errors: &[([f64; LANES], [f64; LANES])], params: &MapParams) -> [f64; LANES] {
    let dof = params.dof;
    let mut offset = [0.0; LANES];
    let mut log = [0.0; LANES];
    if params.offset_sigma > 0.0 {
        let prior = 1.0 / (params.offset_sigma * params.offset_sigma);
        for _ in 0..OFFSET_ROUNDS {
            let (mut sum, mut total) = ([0.0; LANES], [prior; LANES]);
            for (error, information) in errors {
                for lane in 0..LANES {
                    let rest = error[lane] - offset[lane];
                    let weight = information[lane] * (dof + 1.0) / (dof + rest * rest * information[lane]);
                    sum[lane] += weight * error[lane];
                    total[lane] += weight;
                }
            }
            for lane in 0..LANES {
                offset[lane] = sum[lane] / total[lane];
            }
        }
        log = offset.map(|offset| -0.5 * offset * offset * prior);
    }
    let mut product = [1.0_f64; LANES];
    let mut logs = [0.0; LANES];
    for (error, information) in errors {
        for lane in 0..LANES {
            let rest = error[lane] - offset[lane];
            product[lane] *= 1.0 + rest * rest * information[lane] / dof;
        }
        for (product, logs) in product.iter_mut().zip(&mut logs) {
            if *product > LARGE {
                *logs += libm::log(*product);
                *product = 1.0;
            }
        }
    }
    core::array::from_fn(|lane| log[lane] - 0.5 * (dof + 1.0) * (logs[lane] + libm::log(product[lane])))
}

/// Mean and covariance of weights over the places of the likeliest floor.
pub(super) fn place_fix(lattice: &Lattice, weights: &[f64]) -> Option<PlaceFix> {
    let total: f64 = weights.iter().sum();
    let on = |floor: i32| {
        lattice
            .iter()
            .zip(weights)
            .filter(move |((_, at), _)| *at == floor)
            .map(|((place, _), w)| (place, *w))
    };
    let masses = lattice.floors().iter().map(|floor| (*floor, on(*floor).map(|(_, w)| w).sum::<f64>()));
    let (floor, mass) = masses.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (position_m, scatter): (Vector2<f64>, Matrix2<f64>) = moments(on(floor))?;
    // A place stands for the square about it.
    let square = Matrix2::identity() * (lattice.step_m() * lattice.step_m() / 12.0);
    Some(PlaceFix {
        fix: RadioFix { position_m, covariance_m2: scatter + square },
        floor,
        floor_share: mass / total,
    })
}

impl TryFrom<Stored> for RadioMap {
    type Error = &'static str;

    fn try_from(stored: Stored) -> Result<Self, Self::Error> {
        if !stored.lattice.is_sound() {
            return Err("the lattice of the radio map does not hang together");
        }
        let count = stored.lattice.len().checked_mul(stored.transmitters).filter(|count| *count > 0);
        let count = count.ok_or("a radio map needs a place and a transmitter")?;
        if [&stored.mean, &stored.sigma, &stored.heard].iter().any(|values| values.len() != count) {
            return Err("a radio map needs mean, sigma and heard of every transmitter at every place");
        }
        let all = || stored.mean.iter().zip(&stored.sigma).zip(&stored.heard);
        let usable = |((mean, sigma), heard): ((&f32, &f32), &f32)| {
            mean.is_finite() && sigma.is_finite() && *sigma > 0.0 && (0.0..=1.0).contains(heard)
        };
        if !all().all(usable) {
            return Err(
                "a radio map needs finite means, standard deviations above 0, probabilities from 0 to 1",
            );
        }
        let cell = |((mean, sigma), heard): ((&f32, &f32), &f32)| {
            let (sigma, heard) = (sigma.max(SHARPEST), heard.clamp(SUREST, 1.0 - SUREST));
            Cell {
                mean: *mean,
                information: 1.0 / (sigma * sigma),
                ln_sigma: libm::logf(sigma),
                log_odds: libm::logf(heard / (1.0 - heard)),
            }
        };
        let cells = all().map(cell).collect();
        let silence = stored.heard.chunks_exact(stored.transmitters).map(|at_place| {
            at_place.iter().map(|heard| libm::logf(1.0 - heard.clamp(SUREST, 1.0 - SUREST))).sum()
        });
        let silence = silence.collect();
        Ok(Self { stored, cells, silence })
    }
}

impl From<RadioMap> for Stored {
    fn from(map: RadioMap) -> Self {
        map.stored
    }
}

/// Numbers in files with three decimals; `null` is not a number.
pub(super) mod rounded {
    use alloc::vec::Vec;
    use serde::ser::SerializeSeq;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(values: &[f32], serializer: S) -> Result<S::Ok, S::Error> {
        let mut sequence = serializer.serialize_seq(Some(values.len()))?;
        for value in values {
            let known = value.is_finite().then(|| libm::round(f64::from(*value) * 1000.0) / 1000.0);
            sequence.serialize_element(&known)?;
        }
        sequence.end()
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f32>, D::Error> {
        let values = Vec::<Option<f32>>::deserialize(deserializer)?;
        Ok(values.into_iter().map(|value| value.unwrap_or(f32::NAN)).collect())
    }
}
