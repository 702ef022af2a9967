//! How the signals of a survey fall off with distance: log-distance or two slopes, for each transmitter, pooled over all.
//!
//! ```text
//! RSSI = A_i − 10 n_i log₁₀ d − Δ · 10 log₁₀(d / b)₊ − L f + e
//! ```
//!
//! b breakpoint, Δ what the exponent changes by beyond it, L loss of each of f floors between. b and Δ are common to all transmitters: they are of the
//! tunnel, not of the antenna. Two slopes are kept where they explain more than their two numbers cost (Bayesian information criterion,
//! Schwarz 1978), with an exponent above zero on both sides. Errors, pooling and what was not heard: [`super::pooled`].

use super::hearing;
use super::pooled::{PooledLines, PooledParams, Record, Value, fit as fit_lines};
use super::{Site, SurveyedScan, by_spot};
use crate::error::TuningError;
use adit_estimation::radio::map::{Hearing, Storeys};
use adit_estimation::radio::path_loss::NEAREST_M;
use adit_estimation::radio::{Emitter, PathLoss};
use serde::Serialize;

/// What is taken as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathLossParams {
    /// Degrees of freedom of the errors.
    pub dof: f64,
    /// Scans within a square of this size are one spot, m.
    pub cell_m: f64,
    /// From floor to floor, m.
    pub storey_m: f64,
    /// Whether a second slope may be tried.
    pub two_slopes: bool,
    /// Probability that a strong transmitter is missed by a scan.
    pub missed: f64,
}

impl Default for PathLossParams {
    fn default() -> Self {
        Self { dof: 4.0, cell_m: 0.4, storey_m: 3.0, two_slopes: true, missed: 0.1 }
    }
}

/// A fitted path loss of all transmitters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathLossFit {
    /// Each transmitter's model, `None` where its place is not known.
    pub emitters: Vec<Option<Emitter>>,
    /// Strength at 1 m and exponent common to all; those of one never heard.
    pub common: [f64; 2],
    /// How the transmitters differ from it: standard deviations.
    pub between: [f64; 2],
    /// Standard deviation of one reading about its model, dB.
    pub sigma_db: f64,
    /// Where the second slope begins, m, where there is one.
    pub breakpoint_m: Option<f64>,
    /// Storeys and what they cost; no loss where all is on one floor.
    pub storeys: Storeys,
    /// Which strengths are heard.
    pub hearing: Hearing,
    /// Means of spots that the fit stands on.
    pub values: usize,
}

/// Strength at 1 m and exponent before any data: 2.4 GHz, 20 dBm, in buildings and tunnels (Rappaport 2002, table 4.2: n 1.6 to 6).
const LINE: [f64; 2] = [-40.0, 2.5];
const LINE_SIGMA: [f64; 2] = [15.0, 1.0];
const EXPONENTS: [f64; 2] = [0.5, 8.0];
/// Values to fit, at the least.
const FEWEST: usize = 10;
/// Rounds between where hearing ends and how signals fall off, at the most.
const HEARING_ROUNDS: usize = 10;
/// Silence that widens the scatter of what was heard by more is no matter of distance: walls stand there, and a path loss bent to explain them
/// would be wrong everywhere.
const MOST_SCATTER: f64 = 1.2;
/// Where nothing is known of hearing.
const HEARING: Hearing = Hearing { half_dbm: -90.0, width_db: 4.0, unsure: 0.1 };

/// Fits the path loss of transmitters of which `sites` are known.
pub fn fit(
    scans: &[SurveyedScan],
    sites: &[Option<Site>],
    params: &PathLossParams,
) -> Result<PathLossFit, TuningError> {
    let mut records = records(scans, sites, params);
    let read = records.iter().filter(|record| matches!(record.value, Value::Read(_))).count();
    let lines_params = PooledParams {
        dof: params.dof,
        line: LINE,
        line_sigma: LINE_SIGMA,
        slopes: EXPONENTS,
        missed: params.missed,
    };
    let few = || TuningError::TooFewReadings { sensor: "radio", found: read, expected: FEWEST };
    if read < FEWEST {
        return Err(few());
    }
    // First by what was heard alone; that tells where hearing ends, and then silence counts too.
    let heard: Vec<Record> =
        records.iter().filter(|record| matches!(record.value, Value::Read(_))).copied().collect();
    let mut one = fit_lines(&heard, sites.len(), &lines_params).ok_or_else(few)?;
    let (mut before, alone) = (f64::NAN, one.sigma);
    for _ in 0..HEARING_ROUNDS {
        let limit = hear(&records, &one, params).half_dbm;
        if limit.to_bits() == before.to_bits() {
            break;
        }
        before = limit;
        for record in &mut records {
            if let Value::Below(below) = &mut record.value {
                *below = limit;
            }
        }
        let with_silence = fit_lines(&records, sites.len(), &lines_params).ok_or_else(few)?;
        if with_silence.sigma > MOST_SCATTER * alone {
            break;
        }
        one = with_silence;
    }
    let two =
        if params.two_slopes { second_slope(&mut records, sites.len(), &lines_params, &one) } else { None };
    let (lines, breakpoint_m) = if let Some((lines, breakpoint_m)) = two {
        (lines, Some(breakpoint_m))
    } else {
        for record in &mut records {
            record.shared[1] = 0.0;
        }
        (one, None)
    };
    let hearing = hear(&records, &lines, params);
    let emitter = |(site, [at_1m, exponent]): (&Option<Site>, &[f64; 2])| {
        site.map(|site| Emitter {
            position_m: site.position_m,
            path_loss: PathLoss {
                rssi_at_1m_dbm: *at_1m,
                exponent: *exponent,
                breakpoint_m,
                exponent_beyond: breakpoint_m.map(|_| (exponent + lines.shared[1]).max(EXPONENTS[0])),
            },
            sigma_db: lines.sigma,
        })
    };
    Ok(PathLossFit {
        emitters: sites.iter().zip(&lines.lines).map(emitter).collect(),
        common: lines.common,
        between: lines.between,
        sigma_db: lines.sigma,
        breakpoint_m,
        storeys: Storeys { height_m: params.storey_m, loss_db: lines.shared[0].max(0.0) },
        hearing,
        values: read,
    })
}

/// What every known transmitter read at every spot, or that it did not.
fn records(scans: &[SurveyedScan], sites: &[Option<Site>], params: &PathLossParams) -> Vec<Record> {
    let spots = by_spot(scans, sites.len(), params.cell_m);
    let mut records = Vec::new();
    for spot in &spots {
        for (group, (reading, site)) in spot.readings.iter().zip(sites).enumerate() {
            let Some(site) = site else { continue };
            let (distance, floors) = site.away(&spot.position_m, spot.floor, params.storey_m);
            let value = match reading.count {
                0 if spot.whole_scans > 0 => Value::Below(HEARING.half_dbm),
                0 => continue,
                _ => Value::Read(reading.mean),
            };
            let x = -10.0 * distance.max(NEAREST_M).log10();
            records.push(Record { group, x, shared: [-floors, 0.0], value });
        }
    }
    records
}

/// Which strengths are heard, by lines that say how strong everything is.
fn hear(records: &[Record], lines: &PooledLines, params: &PathLossParams) -> Hearing {
    let pairs: Vec<(f64, bool)> =
        records.iter().map(|r| (lines.mean(r), matches!(r.value, Value::Read(_)))).collect();
    hearing::fit(&pairs, params.missed).unwrap_or(HEARING)
}

/// The best breakpoint of some, where it is worth its numbers.
fn second_slope(
    records: &mut [Record],
    groups: usize,
    params: &PooledParams,
    one: &PooledLines,
) -> Option<(PooledLines, f64)> {
    let mut distances: Vec<f64> =
        records.iter().filter(|r| matches!(r.value, Value::Read(_))).map(|r| -r.x).collect();
    let mut best: Option<(PooledLines, f64)> = None;
    for share in [0.2, 0.35, 0.5, 0.65, 0.8] {
        let turn = crate::robust::quantile(&mut distances, share)?;
        for record in records.iter_mut() {
            record.shared[1] = -(-record.x - turn).max(0.0);
        }
        let Some(lines) = fit_lines(records, groups, params) else { continue };
        let physical = lines.common[1] + lines.shared[1] >= EXPONENTS[0];
        if physical && best.as_ref().is_none_or(|(best, _)| lines.log_likelihood > best.log_likelihood) {
            best = Some((lines, 10_f64.powf(0.1 * turn)));
        }
    }
    // Two numbers more: breakpoint and slope.
    let (lines, breakpoint_m) = best?;
    let gain = lines.log_likelihood - one.log_likelihood;
    if gain <= (one.read as f64).ln() {
        return None;
    }
    for record in records.iter_mut() {
        record.shared[1] = -(-record.x - 10.0 * breakpoint_m.log10()).max(0.0);
    }
    Some((lines, breakpoint_m))
}
