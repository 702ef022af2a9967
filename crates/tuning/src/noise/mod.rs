//! Noise of gyro and accelerometer from a rest: Allan deviation, its parts, densities for the filters.
//!
//! | step | module | source |
//! |---|---|---|
//! | the longest still stretch of the log | `rest` | |
//! | overlapping Allan deviation of each axis | `allan` | Riley 2008 (NIST SP 1065) |
//! | quantisation, white noise, bias instability, random walk | `model` | IEEE Std 952-1997, annex C |
//! | what a filter should assume | here | |
//!
//! Readings are taken as evenly spaced, at their mean interval. Limits: no rate ramp (a sensor that warms up shows one: it goes
//! into the random walk), no sinusoids, no correlation between axes.

mod allan;
mod model;
mod rest;

pub use allan::{AllanPoint, overlapping};
pub use model::{NoiseFit, NoiseModel};
pub use rest::{Rest, SHORTEST_REST_S};

use crate::error::TuningError;
use crate::series::Series;
use adit_observation::ImuSpecification;
use serde::Serialize;
use std::fmt;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Averaging time at which quantisation is made into white noise, s.
const WHITE_AT_S: f64 = 1.0;

/// Noise of one axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisNoise {
    /// `x`, `y` or `z`.
    pub axis: &'static str,
    /// The parts found.
    pub fit: NoiseFit,
    /// The curve measured.
    pub curve: Vec<AllanPoint>,
}

/// Noise of a three-axis sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorNoise {
    /// Readings of the rest.
    pub readings: usize,
    /// Their mean rate, Hz.
    pub rate_hz: f64,
    /// Its axes.
    pub axes: [AxisNoise; 3],
    /// White noise that a filter should assume: the worst axis, U·√s.
    pub white: f64,
    /// Random walk of the bias that a filter should assume: the worst axis, U/√s.
    pub bias_walk: f64,
}

/// Noise of an inertial sensor, and the rest that told it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InertialNoise {
    /// From the start of the log to the start of the rest, s.
    pub from_s: f64,
    /// Length of the rest, s.
    pub duration_s: f64,
    /// The log also holds motion or holes.
    pub interrupted: bool,
    /// Gyro, U = rad/s.
    pub gyro: SensorNoise,
    /// Accelerometer, U = m/s².
    pub accelerometer: SensorNoise,
}

impl InertialNoise {
    /// Densities as the sidecar holds them.
    pub fn specification(&self) -> ImuSpecification {
        ImuSpecification {
            angle_random_walk_rad_sqrt_s: self.gyro.white,
            velocity_random_walk_m_s_sqrt_s: self.accelerometer.white,
            gyro_bias_walk_rad_s_sqrt_s: self.gyro.bias_walk,
            acc_bias_walk_m_s2_sqrt_s: self.accelerometer.bias_walk,
        }
    }
}

/// Measures the noise in the longest rest of a log: gyro (rad/s) and accelerometer (m/s²).
///
/// Errors: no rest, one that is too short, an axis without noise. A million readings of both sensors take a second and 100 MB.
pub fn measure(gyro: &Series, accelerometer: &Series) -> Result<InertialNoise, TuningError> {
    let rest = rest::longest(gyro, accelerometer)?;
    let first = gyro.times().first().copied().unwrap_or(rest.from);
    Ok(InertialNoise {
        from_s: (rest.from - first).seconds(),
        duration_s: (rest.to - rest.from).seconds(),
        interrupted: rest.interrupted,
        gyro: sensor("gyro", gyro, &rest)?,
        accelerometer: sensor("accelerometer", accelerometer, &rest)?,
    })
}

fn sensor(sensor: &'static str, series: &Series, rest: &Rest) -> Result<SensorNoise, TuningError> {
    let times = series.times();
    let (start, end) = (times.partition_point(|t| *t < rest.from), times.partition_point(|t| *t <= rest.to));
    let readings = &series.readings()[start..end];
    let interval_s = match times[start..end] {
        [first, .., last] => (last - first).seconds() / (readings.len() - 1) as f64,
        _ => return Err(TuningError::TooFewReadings { sensor, found: readings.len(), expected: 1000 }),
    };
    let axis = |number: usize| {
        let name = AXES[number];
        let values: Vec<f64> = readings.iter().map(|r| r[number]).collect();
        let mut curve = overlapping(&values, interval_s);
        let fit = model::fit(&curve, values.len()).ok_or(TuningError::Frozen { sensor, axis: name })?;
        for point in &mut curve {
            point.sd = fit.model.scatter(point, values.len());
        }
        Ok(AxisNoise { axis: name, fit, curve })
    };
    let axes = [axis(0)?, axis(1)?, axis(2)?];
    let worst = |of: fn(&AxisNoise) -> f64| axes.iter().map(of).fold(0.0, f64::max);
    let (white, bias_walk) = (worst(white), worst(bias_walk));
    Ok(SensorNoise { readings: readings.len(), rate_hz: 1.0 / interval_s, axes, white, bias_walk })
}

/// White noise and quantisation as one density.
fn white(axis: &AxisNoise) -> f64 {
    let NoiseModel { quantisation, white, .. } = axis.fit.model;
    (white * white + 3.0 * quantisation * quantisation / WHITE_AT_S).sqrt()
}

/// The random walk that stands for what the bias does.
///
/// Bias instability is no random walk; the one that is as large where instability emerges from the white noise, at
/// `τ = N²/(0.441 B²)`, is `√3 · 0.441 B²/N`. Where the curve shows neither, the bias may still walk by what its last point cannot
/// exclude.
fn bias_walk(axis: &AxisNoise) -> f64 {
    let NoiseModel { white, instability, walk, .. } = axis.fit.model;
    let flat =
        if white > 0.0 { 3_f64.sqrt() * model::FLICKER * instability * instability / white } else { 0.0 };
    let seen = walk.hypot(flat);
    if seen > 0.0 {
        return seen;
    }
    let unseen = |last: &AllanPoint| {
        // σ of the last point's variance, with the fewest degrees of freedom it can have.
        last.deviation * (3.0 * (2.0_f64 / allan::FEWEST_DEGREES).sqrt() / last.tau_s).sqrt()
    };
    axis.curve.last().map_or(0.0, unseen)
}

impl fmt::Display for InertialNoise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = if self.interrupted { ", the longest still stretch" } else { "" };
        writeln!(
            f,
            "rest        {:.1} s from {:.1} s on{part}; {} readings at {:.1} Hz",
            self.duration_s, self.from_s, self.gyro.readings, self.gyro.rate_hz
        )?;
        sensor_table(f, "gyro", &self.gyro, ["rad", "rad/√s", "rad/s", "rad/s/√s"])?;
        sensor_table(f, "accelerometer", &self.accelerometer, ["m/s", "m/s/√s", "m/s²", "m/s²/√s"])?;
        writeln!(f)?;
        let noise = self.specification();
        writeln!(f, "angle random walk     {:.3e} rad/√s", noise.angle_random_walk_rad_sqrt_s)?;
        writeln!(f, "velocity random walk  {:.3e} m/s/√s", noise.velocity_random_walk_m_s_sqrt_s)?;
        writeln!(f, "gyro bias walk        {:.3e} rad/s/√s", noise.gyro_bias_walk_rad_s_sqrt_s)?;
        writeln!(f, "acc bias walk         {:.3e} m/s²/√s", noise.acc_bias_walk_m_s2_sqrt_s)
    }
}

fn sensor_table(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    sensor: &SensorNoise,
    units: [&str; 4],
) -> fmt::Result {
    write!(f, "\n{name:<14}")?;
    for (part, unit) in ["quantisation", "white noise", "instability", "random walk"].iter().zip(units) {
        write!(f, "{:>23}", format!("{part} {unit}"))?;
    }
    writeln!(f)?;
    for AxisNoise { axis, fit: NoiseFit { model, sd }, .. } in &sensor.axes {
        write!(f, "  {axis:<12}")?;
        for (value, sd) in [
            (model.quantisation, sd.quantisation),
            (model.white, sd.white),
            (model.instability, sd.instability),
            (model.walk, sd.walk),
        ] {
            let shown = if value > 0.0 {
                format!("{value:.2e} ± {:.1} %", (100.0 * sd / value).min(999.0))
            } else {
                "not seen".to_owned()
            };
            write!(f, "{shown:>23}")?;
        }
        writeln!(f)?;
    }
    Ok(())
}
