//! A nine-axis log of a hand that turns, waves and rests, with its true attitude; 2000/7 Hz as the BROAD recordings.
//!
//! Attitude and position are sums of sines of a phase that stops at every rest. Rates and forces are means over the
//! sample, as a sensor gives them; noise and biases are those of a good consumer part.

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::{ImuSample, MagneticSample, Observation};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Time between samples, s.
pub const INTERVAL_S: f64 = 0.0035;
const GRAVITY_M_S2: f64 = 9.81;
/// East, north, up, µT: middle Europe.
const FIELD_UT: [f64; 3] = [0.0, 18.0, -45.0];
/// Moving, then resting, s.
const CYCLE_S: f64 = 20.0;
const REST_S: f64 = 4.0;

/// One sample of all sensors, and the truth at its time.
#[derive(Debug, Clone, Copy)]
pub struct NineAxis {
    pub imu: ImuSample,
    pub magnetic: MagneticSample,
    pub attitude: Attitude,
}

impl NineAxis {
    /// As a log reader gives it: the field of a row after its inertial sample.
    pub fn observations(&self) -> [Observation; 2] {
        [Observation::Imu(self.imu), Observation::Magnetic(self.magnetic)]
    }
}

/// The first `count` samples.
pub fn log(count: u32, seed: u64) -> Vec<NineAxis> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noise = |sigma: f64| -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let draw: f64 = StandardNormal.sample(&mut random);
            sigma * draw
        })
    };
    let (gyro_bias, acc_bias) = (noise(3e-3), noise(0.02));
    (1..=count)
        .map(|index| {
            let time_s = f64::from(index) * INTERVAL_S;
            let (before, now) = (attitude_at(time_s - INTERVAL_S), attitude_at(time_s));
            let rate = attitude::log(&(before.inverse() * now)) / INTERVAL_S;
            let middle = attitude_at(time_s - 0.5 * INTERVAL_S);
            let force = middle.inverse() * (acceleration(time_s) + Vector3::z() * GRAVITY_M_S2);
            let time = Time::from_seconds(time_s).unwrap_or_default();
            NineAxis {
                imu: ImuSample {
                    time,
                    angular_rate_rad_s: rate + gyro_bias + noise(1.5e-3),
                    specific_force_m_s2: force + acc_bias + noise(0.03),
                },
                magnetic: MagneticSample {
                    time,
                    field_ut: now.inverse() * Vector3::from(FIELD_UT) + noise(0.4),
                },
                attitude: now,
            }
        })
        .collect()
}

/// Time spent moving, s, without a jump of its rate.
fn phase(time_s: f64) -> f64 {
    let (cycles, within) = ((time_s / CYCLE_S).floor(), time_s.rem_euclid(CYCLE_S));
    let moving_s = CYCLE_S - REST_S;
    let share = (within / moving_s).min(1.0);
    // 1 - cos: starts and stops softly, and lasts as long.
    moving_s * (cycles + share - (TAU * share).sin() / TAU)
}

fn attitude_at(time_s: f64) -> Attitude {
    let s = phase(time_s);
    let heading = 1.4 * (0.9 * s).sin() + 0.25 * s;
    let tilt = Vector3::new(0.9 * (1.3 * s).sin() + 0.3 * (2.9 * s).cos(), 0.8 * (1.1 * s + 0.4).sin(), 0.0);
    attitude::exp(&Vector3::new(0.0, 0.0, heading)) * attitude::exp(&tilt)
}

fn position(time_s: f64) -> Vector3<f64> {
    let s = phase(time_s);
    Vector3::new(0.15 * (2.1 * s).sin(), 0.12 * (1.7 * s + 1.0).sin(), 0.08 * (2.6 * s).cos())
}

/// Mean acceleration over a sample that ends then, m/s².
fn acceleration(end_s: f64) -> Vector3<f64> {
    let middle = end_s - 0.5 * INTERVAL_S;
    (position(middle + INTERVAL_S) - position(middle) * 2.0 + position(middle - INTERVAL_S))
        / (INTERVAL_S * INTERVAL_S)
}
