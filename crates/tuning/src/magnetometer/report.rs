//! What a calibration of a magnetometer found.

use super::refine::ParameterMatrix;
use super::{Alignment, AlignmentSource, Coverage, Fitted, Tumble, clock};
use crate::robust;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::Time;
use adit_observation::sidecar::MagnetometerCalibration;
use serde::Serialize;
use std::fmt;

/// Unevenness of the place that is worth a warning, %.
const UNEVEN_PERCENT: f64 = 1.0;
/// Share of outliers that is worth a warning, %.
const MANY_OUTLIERS_PERCENT: f64 = 5.0;
/// Spread of the dip that is worth a warning, deg.
const UNSTEADY_DIP_DEG: f64 = 5.0;

/// How steady the length of a field is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean, µT.
    pub mean_ut: f64,
    /// Standard deviation over the mean, all samples, %.
    pub sd_percent: f64,
    /// The same of the bulk: median absolute deviation as a standard deviation, over the median, %.
    pub robust_sd_percent: f64,
    /// Largest deviation from the mean, %.
    pub largest_percent: f64,
}

impl Spread {
    /// Of lengths, µT.
    pub fn of(lengths_ut: Vec<f64>) -> Self {
        let count = lengths_ut.len().max(1) as f64;
        let mean = lengths_ut.iter().sum::<f64>() / count;
        let square = lengths_ut.iter().map(|l| (l - mean) * (l - mean)).sum::<f64>() / count;
        let largest = lengths_ut.iter().map(|l| (l - mean).abs()).fold(0.0, f64::max);
        let middle = robust::median(lengths_ut.clone()).unwrap_or(mean);
        let bulk = robust::spread_about(lengths_ut.into_iter(), middle).unwrap_or(0.0);
        let percent = |part: f64, of: f64| if of > 0.0 { 100.0 * part / of } else { 0.0 };
        Self {
            mean_ut: mean,
            sd_percent: percent(square.sqrt(), mean),
            robust_sd_percent: percent(bulk, middle),
            largest_percent: percent(largest, mean),
        }
    }
}

/// A calibration and how far it can be trusted. As JSON: every field but those that repeat another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MagnetometerFit {
    /// What goes into the sidecar.
    #[serde(skip)]
    pub calibration: MagnetometerCalibration,
    /// The symmetric matrix before it is turned into the axes of the inertial sensor.
    #[serde(skip)]
    pub soft_iron: Matrix3<f64>,
    /// Covariance of offset (µT) and soft iron (xx, yy, zz, yz, xz, xy).
    #[serde(skip)]
    pub covariance: ParameterMatrix,
    /// Hard iron, µT.
    pub offset_ut: [f64; 3],
    /// Its σ, µT.
    pub offset_sd_ut: [f64; 3],
    /// Soft iron, scale and axes.
    pub matrix: [[f64; 3]; 3],
    /// σ of the soft iron, before it is turned.
    pub matrix_sd: [[f64; 3]; 3],
    /// Length of the calibrated field, µT.
    pub norm_ut: f64,
    /// That length came from outside; else the sensor's own scale stands.
    pub norm_given: bool,
    /// Readings of the magnetometer.
    pub readings: usize,
    /// Readings that the fit left out as wrong.
    pub outliers: usize,
    /// From the first reading to the last, s.
    pub duration_s: f64,
    /// Length of the raw field, all readings.
    pub before: Spread,
    /// Length of the calibrated field, all readings.
    pub after: Spread,
    /// The same, each fifth of the log calibrated by the other four.
    pub held_out: Option<Spread>,
    /// σ of the length from sample to sample: the sensor's noise, %.
    pub noise_percent: f64,
    /// σ of the length from place to place, %.
    pub place_percent: f64,
    /// Longest over shortest axis of the raw ellipsoid.
    pub axis_ratio: f64,
    /// Largest σ of the calibrated length in any direction, from the covariance, %.
    pub direction_sd_percent: f64,
    /// Directions seen.
    pub coverage: Coverage,
    /// Axes against those of the inertial sensor.
    pub alignment: Alignment,
    /// What the user should know.
    pub warnings: Vec<String>,
}

pub(super) fn warnings(
    tumble: &Tumble,
    fitted: &Fitted,
    outliers: usize,
    alignment: &Alignment,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let place_percent = 100.0 * fitted.errors.place;
    if place_percent > UNEVEN_PERCENT {
        warnings.push(format!(
            "the length of the field differs by {place_percent:.1} % from place to place after calibration, expected {UNEVEN_PERCENT} % or \
             less: tumble the sensor on one spot, away from steel, cables and motors"
        ));
    }
    let readings = tumble.field_ut.readings();
    let share = 100.0 * outliers as f64 / readings.len() as f64;
    if share > MANY_OUTLIERS_PERCENT {
        warnings.push(format!(
            "{share:.1} % of the readings are outliers{}",
            at_the_range(tumble, fitted, outliers)
        ));
    }
    let origin = tumble.field_ut.times().first().copied().unwrap_or(Time::default());
    let sensors = [
        ("magnetometer", &tumble.field_ut),
        ("gyro", &tumble.angular_rate_rad_s),
        ("accelerometer", &tumble.specific_force_m_s2),
    ];
    for (sensor, series) in sensors {
        if clock::evened(&series.seconds_from(origin)).is_some() {
            let rate_hz = (series.len() - 1) as f64 / series.duration_s();
            warnings.push(format!(
                "stamps of the {sensor} come in bursts: an even clock of {rate_hz:.1} Hz was used"
            ));
        }
    }
    if alignment.source == AlignmentSource::Gravity && alignment.reason.contains("frame") {
        warnings.push(alignment.reason.clone());
    }
    if alignment.source == AlignmentSource::Assumed {
        warnings.push(format!(
            "axes of magnetometer and inertial sensor are assumed to be parallel ({})",
            alignment.reason
        ));
    }
    if let Some(spread) = alignment.dip_spread_deg.filter(|spread| *spread > UNSTEADY_DIP_DEG) {
        warnings.push(format!(
            "the angle between field and gravity varies by {spread:.1}°, expected {UNSTEADY_DIP_DEG}° or less: fast motion, or axes that are not \
             parallel"
        ));
    }
    warnings
}

/// Readings that stand at the end of the sensor's range.
fn at_the_range(tumble: &Tumble, fitted: &Fitted, outliers: usize) -> String {
    let readings = tumble.field_ut.readings();
    let largest = readings.iter().map(Vector3::amax).fold(0.0, f64::max);
    let clipped = readings.iter().filter(|r| r.amax() >= largest).count();
    if fitted.limit > 0.0 && 2 * clipped > outliers {
        return format!(", {clipped} readings stand at {largest:.1} µT: the range of the sensor");
    }
    String::new()
}

impl fmt::Display for MagnetometerFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "readings    {} over {:.1} s, {} of them outliers",
            self.readings, self.duration_s, self.outliers
        )?;
        writeln!(
            f,
            "{:<22}{:>10}{:>12}{:>12}{:>12}",
            "length of the field", "mean µT", "sd %", "bulk sd %", "largest %"
        )?;
        spread_row(f, "before", &self.before)?;
        spread_row(f, "after", &self.after)?;
        self.held_out.iter().try_for_each(|spread| spread_row(f, "after, held out", spread))?;
        writeln!(
            f,
            "of this     {:.2} % from sample to sample (noise), {:.2} % from place to place",
            self.noise_percent, self.place_percent
        )?;
        writeln!(
            f,
            "coverage    {} of {} directions; error in any direction up to {:.2} %, allowed 2 %",
            self.coverage.cells_seen, self.coverage.cells, self.coverage.worst_error_percent
        )?;
        writeln!(f)?;
        let [x, y, z] = self.offset_ut;
        let [sx, sy, sz] = self.offset_sd_ut;
        writeln!(f, "offset      {x:.2} ± {sx:.2}, {y:.2} ± {sy:.2}, {z:.2} ± {sz:.2} µT")?;
        for (number, row) in self.matrix.iter().enumerate() {
            let label = if number == 0 { "matrix" } else { "" };
            writeln!(f, "{label:<10}{:>9.4}{:>9.4}{:>9.4}", row[0], row[1], row[2])?;
        }
        writeln!(f, "ellipsoid   longest axis {:.2} times the shortest", self.axis_ratio)?;
        let origin = if self.norm_given { "given" } else { "by the sensor's own scale" };
        writeln!(f, "strength    {:.2} µT, {origin}", self.norm_ut)?;
        self.alignment_lines(f)
    }
}

impl MagnetometerFit {
    fn alignment_lines(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let alignment = &self.alignment;
        let by = match alignment.source {
            AlignmentSource::Gyro => "the gyro",
            AlignmentSource::Gravity => "gravity",
            AlignmentSource::Assumed => {
                return writeln!(f, "axes        assumed to be parallel to those of the inertial sensor");
            }
        };
        writeln!(
            f,
            "axes        turned by {:.2} ± {:.2}° onto those of the inertial sensor, by {by}",
            alignment.angle_deg,
            alignment.sd_deg.iter().copied().fold(0.0, f64::max)
        )?;
        if alignment.source == AlignmentSource::Gyro {
            let (lag_ms, sd_ms) = (1000.0 * alignment.lag_s, 1000.0 * alignment.lag_sd_s);
            writeln!(f, "lag         {lag_ms:.1} ± {sd_ms:.1} ms behind the gyro")?;
        }
        if let (Some(dip), Some(spread)) = (alignment.dip_deg, alignment.dip_spread_deg) {
            writeln!(f, "dip         {dip:.1}° below the horizontal, spread {spread:.1}°")?;
        }
        Ok(())
    }
}

fn spread_row(f: &mut fmt::Formatter<'_>, name: &str, spread: &Spread) -> fmt::Result {
    writeln!(
        f,
        "  {name:<20}{:>10.2}{:>12.2}{:>12.2}{:>12.2}",
        spread.mean_ut, spread.sd_percent, spread.robust_sd_percent, spread.largest_percent
    )
}
