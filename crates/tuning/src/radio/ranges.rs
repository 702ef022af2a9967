//! How the ranges of each device are off: offset and scale, robust, pooled over the devices.
//!
//! ```text
//! r = o_i + s_i d + e,   e ~ Student t_ν(σ)
//! ```
//!
//! A round-trip range of Wi-Fi has an offset of its own for each access point and grows faster than the distance where walls stand between. Fitted at
//! spots whose place is known; nothing of the readings at a spot is kept.

use super::pooled::{PooledParams, Record, Value, fit as fit_lines};
use super::{Site, SurveyedScan, by_spot};
use crate::error::TuningError;
use adit_estimation::radio::range_fit::RangeModel;
use serde::Serialize;

/// A fitted range model of all devices.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RangesFit {
    /// Each device's model, `None` where its place is not known.
    pub models: Vec<Option<RangeModel>>,
    /// Offset, m, and scale common to all.
    pub common: [f64; 2],
    /// How devices differ from it: standard deviations.
    pub between: [f64; 2],
    /// Standard deviation of a range about its model, m.
    pub sigma_m: f64,
    /// Means of spots that the fit stands on.
    pub values: usize,
}

/// Offsets of a metre or two, scales about 1.
const PARAMS: PooledParams =
    PooledParams { dof: 4.0, line: [0.0, 1.0], line_sigma: [2.0, 0.3], slopes: [0.5, 2.0], missed: 0.0 };
const FEWEST: usize = 10;
const CELL_M: f64 = 0.4;

/// Fits offset and scale of devices of which `sites` are known.
pub fn fit(scans: &[SurveyedScan], sites: &[Option<Site>]) -> Result<RangesFit, TuningError> {
    let spots = by_spot(scans, sites.len(), CELL_M);
    let of_spot = |spot: &super::SpotMeans| {
        let pairs = spot.readings.iter().zip(sites).enumerate();
        let records = pairs.filter_map(|(group, (reading, site))| {
            let (distance, _) = site.as_ref()?.away(&spot.position_m, spot.floor, 0.0);
            let value = Value::Read(reading.mean);
            (reading.count > 0).then_some(Record { group, x: distance, shared: [0.0; 2], value })
        });
        records.collect::<Vec<_>>()
    };
    let records: Vec<Record> = spots.iter().flat_map(of_spot).collect();
    let few = || TuningError::TooFewReadings { sensor: "ranges", found: records.len(), expected: FEWEST };
    if records.len() < FEWEST {
        return Err(few());
    }
    let lines = fit_lines(&records, sites.len(), &PARAMS).ok_or_else(few)?;
    let model = |(site, [offset_m, scale]): (&Option<Site>, &[f64; 2])| {
        site.map(|_| RangeModel { offset_m: *offset_m, scale: *scale, sigma_m: lines.sigma })
    };
    Ok(RangesFit {
        models: sites.iter().zip(&lines.lines).map(model).collect(),
        common: lines.common,
        between: lines.between,
        sigma_m: lines.sigma,
        values: records.len(),
    })
}
