//! The Gaussian process of one transmitter on one floor.

use super::scales::FieldScales;
use super::{FingerprintParams, ReadingKind};
use crate::radio::{Site, SpotMeans};
use adit_core::nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2, Vector3};
use adit_estimation::radio::path_loss::NEAREST_M;

/// Trend before any data, and how sure: strength at 1 m and exponent, or offset and scale of a range.
const STRENGTH_TREND: ([f64; 2], [f64; 2]) = ([-40.0, 2.5], [15.0, 1.0]);
const RANGE_TREND: ([f64; 2], [f64; 2]) = ([0.0, 1.0], [2.0, 0.2]);
/// Where the place of a transmitter is not known: a level alone.
const LEVEL: ([f64; 2], [f64; 2]) = ([-75.0, 0.0], [20.0, 0.0]);

/// Spots that heard one transmitter, their covariance factored.
pub struct Process {
    spots: Vec<Spot>,
    trend: Trend,
    scales: FieldScales,
    factor: Cholesky<f64, Dyn>,
    residual: DVector<f64>,
    weights: DVector<f64>,
}

struct Spot {
    place: Vector2<f64>,
    basis: [f64; 2],
}

struct Trend {
    site: Option<Site>,
    kind: ReadingKind,
    storey_m: f64,
    height_m: f64,
    mean: [f64; 2],
    variance: [f64; 2],
}

impl Trend {
    fn basis(&self, place: &Vector2<f64>, floor: i32) -> [f64; 2] {
        let Some(site) = &self.site else { return [1.0, 0.0] };
        let tag = Vector3::new(place.x, place.y, self.height_m);
        let (distance, _) = site.away(&tag, floor, self.storey_m);
        match self.kind {
            // Within a metre the trend is held: the map need not be sharp there.
            ReadingKind::Strength => [1.0, -10.0 * distance.max(NEAREST_M.max(1.0)).log10()],
            ReadingKind::Range => [1.0, distance],
        }
    }

    fn at(&self, basis: &[f64; 2]) -> f64 {
        basis[0] * self.mean[0] + basis[1] * self.mean[1]
    }

    fn covariance(&self, a: &[f64; 2], b: &[f64; 2]) -> f64 {
        a[0] * b[0] * self.variance[0] + a[1] * b[1] * self.variance[1]
    }
}

impl Process {
    /// Of the spots that heard the transmitter on a floor; `None` of none.
    pub fn new(
        all: &[SpotMeans],
        transmitter: usize,
        site: Option<Site>,
        floor: i32,
        params: &FingerprintParams,
        scales: &FieldScales,
    ) -> Option<Self> {
        let chosen: Vec<&SpotMeans> =
            all.iter().filter(|spot| spot.floor == floor && spot.readings[transmitter].count > 0).collect();
        Self::of(&chosen, transmitter, site, params, scales)
    }

    /// Of chosen spots that all heard the transmitter, on one floor.
    pub fn of(
        chosen: &[&SpotMeans],
        transmitter: usize,
        site: Option<Site>,
        params: &FingerprintParams,
        scales: &FieldScales,
    ) -> Option<Self> {
        let first = chosen.first()?;
        let (mean, sigma) = match (site, params.kind) {
            (None, _) => LEVEL,
            (Some(_), ReadingKind::Strength) => STRENGTH_TREND,
            (Some(_), ReadingKind::Range) => RANGE_TREND,
        };
        let height_m = first.position_m.z;
        let (kind, storey_m) = (params.kind, params.storey_m);
        let trend = Trend { site, kind, storey_m, height_m, mean, variance: sigma.map(|s| s * s) };
        let spots: Vec<Spot> = chosen
            .iter()
            .map(|spot| {
                let place = spot.position_m.xy();
                Spot { place, basis: trend.basis(&place, spot.floor) }
            })
            .collect();
        let count = spots.len();
        let mut covariance = DMatrix::zeros(count, count);
        for row in 0..count {
            for column in 0..=row {
                let (a, b) = (&spots[row], &spots[column]);
                let value =
                    scales.shadowing((a.place - b.place).norm()) + trend.covariance(&a.basis, &b.basis);
                covariance[(row, column)] = value;
                covariance[(column, row)] = value;
            }
            let readings = chosen[row].readings[transmitter].count as f64;
            covariance[(row, row)] += scales.spot_sigma * scales.spot_sigma + scales.within / readings;
        }
        let factor = covariance.cholesky()?;
        let residual = DVector::from_iterator(
            count,
            chosen
                .iter()
                .zip(&spots)
                .map(|(one, spot)| one.readings[transmitter].mean - trend.at(&spot.basis)),
        );
        let weights = factor.solve(&residual);
        Some(Self { spots, trend, scales: *scales, factor, residual, weights })
    }

    /// How many spots.
    pub fn spots(&self) -> usize {
        self.spots.len()
    }

    /// Logarithm of the marginal likelihood, up to a constant.
    pub fn log_likelihood(&self) -> f64 {
        let diagonal = self.factor.l_dirty().diagonal();
        -0.5 * self.residual.dot(&self.weights) - diagonal.iter().map(|d| d.ln()).sum::<f64>()
    }

    /// Mean of one reading at a place, and its standard deviation.
    pub fn predict(&self, place: &Vector2<f64>, floor: i32) -> (f64, f64) {
        let basis = self.trend.basis(place, floor);
        let mut with_spots = DVector::from_iterator(
            self.spots.len(),
            self.spots.iter().map(|spot| {
                self.scales.shadowing((spot.place - place).norm())
                    + self.trend.covariance(&spot.basis, &basis)
            }),
        );
        let mean = self.trend.at(&basis) + with_spots.dot(&self.weights);
        let own = self.scales.shadowing(0.0) + self.trend.covariance(&basis, &basis);
        // What the spots explain, by one triangular solution.
        let explained = if self.factor.l_dirty().solve_lower_triangular_mut(&mut with_spots) {
            with_spots.norm_squared()
        } else {
            0.0
        };
        let one_reading = self.scales.spot_sigma * self.scales.spot_sigma + self.scales.within;
        (mean, ((own - explained).max(0.0) + one_reading).sqrt())
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::super::Search;
    use super::*;
    use crate::radio::SpotReading;

    /// `tests/reference/process.py`: the trend solved for, by numpy, in place of a kernel of its own.
    #[test]
    fn it_agrees_with_the_explicit_trend_of_numpy() {
        let text = include_str!("../../tests/reference/process.csv");
        let rows = |name: &'static str| {
            text.lines().filter_map(move |line| line.strip_prefix(name)).map(|rest| {
                rest.split_whitespace().map(|value| value.parse::<f64>().unwrap()).collect::<Vec<_>>()
            })
        };
        let spots: Vec<SpotMeans> = rows("spot")
            .map(|row| {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
                let count = row[3] as usize;
                let reading = SpotReading { count, mean: row[2], squares: 0.0 };
                let position_m = Vector3::new(row[0], row[1], 0.0);
                SpotMeans { position_m, floor: 0, scans: count, whole_scans: count, readings: vec![reading] }
            })
            .collect();
        let scales = |shadowing_sigma, length_m, spot_sigma| FieldScales {
            shadowing_sigma,
            length_m,
            spot_sigma,
            within: 1.7,
            search: Search { log_likelihood: 0.0, evaluations: 0 },
        };
        let site = Site { position_m: Vector3::new(12.0, 7.0, 2.5), floor: None };
        let params = FingerprintParams::of(ReadingKind::Strength);
        let process = |scales: FieldScales| Process::new(&spots, 0, Some(site), 0, &params, &scales).unwrap();
        let made = process(scales(5.0, 9.0, 2.0));
        assert_eq!(made.spots(), 25);
        for row in rows("place") {
            let (mean, sigma) = made.predict(&Vector2::new(row[0], row[1]), 0);
            // Twelve digits in the file, conditions of some 10⁴ in the matrices.
            assert!((mean - row[2]).abs() < 1e-7 && (sigma - row[3]).abs() < 1e-7, "{row:?}: {mean} {sigma}");
        }
        for row in rows("likelihood") {
            let value = process(scales(row[0], row[1], row[2])).log_likelihood();
            assert!((value - row[3]).abs() < 1e-7, "{row:?}: {value}");
        }
    }
}
