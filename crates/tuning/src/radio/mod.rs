//! What a survey tells about a radio: how its signals fall off ([`path_loss`]), how its ranges are off ([`ranges`]).
//!
//! Both are straight lines for each transmitter, fitted together: `y = a_i + b_i x`, see [`pooled`].

pub mod belief;
pub mod hearing;
pub mod path_loss;
pub mod pooled;
pub mod ranges;

use adit_core::nalgebra::Vector3;
use adit_estimation::radio::Reading;

/// What was heard at a known spot.
#[derive(Debug, Clone, PartialEq)]
pub struct SurveyedScan {
    /// East, north, height of the tag, m.
    pub position_m: Vector3<f64>,
    /// Its floor.
    pub floor: i32,
    /// Signal strengths, dBm, or ranges, m.
    pub readings: Vec<Reading>,
    /// Whether every transmitter that could be heard is in it: then one that is missing was not heard. False of single packets.
    pub whole: bool,
}

/// Where a transmitter is, as a fit wants it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// East, north, height, m.
    pub position_m: Vector3<f64>,
    /// Its floor, where floors count.
    pub floor: Option<i32>,
}

impl Site {
    /// Distance to a tag, m, and floors between, storeys being `storey_m` high.
    pub fn away(&self, position_m: &Vector3<f64>, floor: i32, storey_m: f64) -> (f64, f64) {
        let apart = self.floor.map_or(0.0, |on| f64::from(on) - f64::from(floor));
        let mut away = self.position_m - position_m;
        away.z += apart * storey_m;
        (away.norm(), apart.abs())
    }
}

/// Means of many scans at one spot.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotMeans {
    /// East, north, height, m.
    pub position_m: Vector3<f64>,
    /// Its floor.
    pub floor: i32,
    /// Scans made here.
    pub scans: usize,
    /// Of these, whole ones: what they do not hear is not there.
    pub whole_scans: usize,
    /// Mean, count and sum of squared deviations of each transmitter's readings.
    pub readings: Vec<SpotReading>,
}

/// One transmitter at one spot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpotReading {
    /// Readings.
    pub count: usize,
    /// Their mean; 0 of none.
    pub mean: f64,
    /// Sum of their squared deviations from it.
    pub squares: f64,
}

/// Scans gathered by spot: those on one floor within a square of `cell_m`, in order of the first.
pub fn by_spot(scans: &[SurveyedScan], transmitters: usize, cell_m: f64) -> Vec<SpotMeans> {
    let mut spots: Vec<SpotMeans> = Vec::new();
    let mut known = std::collections::HashMap::new();
    for scan in scans {
        let index = *known.entry(spot_key(scan, cell_m)).or_insert_with(|| {
            spots.push(SpotMeans {
                position_m: Vector3::zeros(),
                floor: scan.floor,
                scans: 0,
                whole_scans: 0,
                readings: vec![SpotReading::default(); transmitters],
            });
            spots.len() - 1
        });
        let spot = &mut spots[index];
        spot.scans += 1;
        spot.whole_scans += usize::from(scan.whole);
        spot.position_m += (scan.position_m - spot.position_m) / spot.scans as f64;
        for reading in &scan.readings {
            if let Some(at) = spot.readings.get_mut(reading.transmitter) {
                // Welford 1962.
                at.count += 1;
                let off = reading.value - at.mean;
                at.mean += off / at.count as f64;
                at.squares += off * (reading.value - at.mean);
            }
        }
    }
    spots
}

/// The square and floor in which a scan was made.
fn spot_key(scan: &SurveyedScan, cell_m: f64) -> (i64, i64, i32) {
    #[expect(clippy::cast_possible_truncation, reason = "saturates: spots so far out fall together")]
    let square = |value: f64| (value / cell_m).floor() as i64;
    (square(scan.position_m.x), square(scan.position_m.y), scan.floor)
}
