//! Logs to calibrate with, simulated: `simulated_calibration DIR` writes `tumble.mcap` and `rest.mcap`.
//!
//! The tumble: two minutes in a hand, 100 Hz; iron about the magnetometer, whose axes are turned by 3.7° against those of the inertial
//! sensor; 0.2 µT of noise; a place whose field differs by 0.4 % from spot to spot; for three seconds a tool lies near. The rest: an
//! hour of an ADIS16448 class sensor. Called by `ci/results.sh` for the page on calibration.

use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use adit_core::time::{Interval, Time};
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{MagneticSample, Observation};
use adit_simulation::{ImuErrorModel, ImuErrors, Inertial, STANDARD_GRAVITY_M_S2};
use anyhow::{Context, Result};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::path::Path;

const SEED: u64 = 1;
const INTERVAL: Interval = Interval::from_nanos(10_000_000);
const TUMBLE_SAMPLES: i64 = 12_000;
const REST_SAMPLES: i64 = 360_000;
/// Freiberg in November 2026, by the World Magnetic Model.
const NORM_UT: f64 = 49.69;
const DIP_DEG: f64 = 66.87;
const OFFSET_UT: Vector3<f64> = Vector3::new(-14.0, 22.0, 9.0);
const NOISE_UT: f64 = 0.2;
const PLACE_UT: f64 = 0.2;
/// Time in which a hand carries the sensor to another spot, s.
const PLACE_S: f64 = 2.0;
const TOOL_UT: Vector3<f64> = Vector3::new(9.0, -4.0, 6.0);
const TOOL_S: std::ops::Range<f64> = 71.0..74.0;

fn main() -> Result<()> {
    let folder = std::env::args().nth(1).context("usage: simulated_calibration DIR")?;
    tumble(&Path::new(&folder).join("tumble.mcap"))?;
    rest(&Path::new(&folder).join("rest.mcap"))
}

/// Body to navigation axes of a hand that shows every side.
fn attitude_at(time_s: f64) -> UnitQuaternion<f64> {
    let turn = |axis: Vector3<f64>, angle: f64| attitude::exp(&(axis * angle));
    turn(Vector3::z(), 0.31 * time_s)
        * turn(Vector3::x(), 1.7 * (0.23 * time_s).sin() + 0.19 * time_s)
        * turn(Vector3::y(), 1.3 * (0.11 * time_s + 0.4).sin())
        * turn(Vector3::z(), 0.83 * time_s + 0.9 * (0.7 * time_s).sin())
}

fn tumble(path: &Path) -> Result<()> {
    let mut log = McapLogWriter::create(path, Packing::Lz4)?;
    let mut errors = ImuErrors::new(&ImuErrorModel::adis16448(), SEED)?;
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut normal = || Vector3::from_fn(|_, _| StandardNormal.sample(&mut random));
    let distortion = Matrix3::new(1.12, 0.03, -0.05, 0.03, 0.91, 0.04, -0.05, 0.04, 1.03);
    let axes = attitude::exp(&Vector3::new(1.0, -2.0, 3.0).map(f64::to_radians)).to_rotation_matrix();
    let (sin, cos) = DIP_DEG.to_radians().sin_cos();
    let field = Vector3::new(0.0, cos, -sin) * NORM_UT;
    let keep = (-INTERVAL.seconds() / PLACE_S).exp();
    let mut place: Vector3<f64> = normal() * PLACE_UT;
    let mut before = attitude_at(-INTERVAL.seconds());
    for i in 0..TUMBLE_SAMPLES {
        let time = Time::from_nanos(i * INTERVAL.nanos());
        let attitude = attitude_at(time.seconds());
        let ideal = Inertial {
            angular_rate_rad_s: attitude::log(&(before.inverse() * attitude)) / INTERVAL.seconds(),
            specific_force_m_s2: attitude.inverse() * Vector3::new(0.0, 0.0, STANDARD_GRAVITY_M_S2),
        };
        before = attitude;
        let sample = errors.apply(&ideal, time, INTERVAL);
        log.push(&Observation::Imu(sample))?;
        place = place * keep + normal() * (PLACE_UT * (1.0 - keep * keep).sqrt());
        let tool = if TOOL_S.contains(&time.seconds()) { TOOL_UT } else { Vector3::zeros() };
        let body = attitude.inverse() * (field + place + tool);
        let field_ut = distortion * (axes.inverse() * body) + OFFSET_UT + normal() * NOISE_UT;
        log.push(&Observation::Magnetic(MagneticSample { time: sample.time, field_ut }))?;
    }
    Ok(log.finish()?)
}

fn rest(path: &Path) -> Result<()> {
    let mut log = McapLogWriter::create(path, Packing::Lz4)?;
    let mut errors = ImuErrors::new(&ImuErrorModel::adis16448(), SEED)?;
    let ideal = Inertial {
        angular_rate_rad_s: Vector3::zeros(),
        specific_force_m_s2: Vector3::new(0.0, 0.0, STANDARD_GRAVITY_M_S2),
    };
    for i in 0..REST_SAMPLES {
        let time = Time::from_nanos(i * INTERVAL.nanos());
        log.push(&Observation::Imu(errors.apply(&ideal, time, INTERVAL)))?;
    }
    Ok(log.finish()?)
}
