//! What a real IMU makes of the ideal reading.
//!
//! For each triad, with the ideal reading `x` (rate or specific force, body axes):
//!
//! `y = Q( sat( B( (I + diag(s) + M) x + G f + b₀ + b_gm(t) + b_rw(t) + n ) ) )`
//!
//! | term | model | parameter |
//! |---|---|---|
//! | `b₀` turn-on bias | normal, constant in a run | σ |
//! | `b_gm` bias instability | first-order Gauss–Markov, starts stationary | stationary σ, correlation time τ |
//! | `b_rw` bias random walk | Wiener process, starts at 0 | one-sided density per √s |
//! | `n` white noise | normal, `σ = N/√Δt` for a sample averaged over `Δt` | angle or velocity random walk `N` |
//! | `s` scale factor, `M` misalignment | normal, constant; `M` has six free off-diagonal terms | σ |
//! | `G` g-sensitivity (gyro only) | nine normal terms, constant | σ |
//! | `B` bandwidth | one pole, exact for a piecewise constant input; delays by `1/(2π f)` | −3 dB frequency |
//! | `sat`, `Q` | clipped at ± range, rounded to a multiple of the step | range, step |
//!
//! Stamps carry white jitter, limited to ±0.4 of the interval, so that they still rise; the motion is sampled evenly.
//! Sources: IEEE Std 952-1997, annexes B and C; Woodman, *An introduction to inertial navigation* (UCAM-CL-TR-696, 2007).
//! Limits: no temperature, no vibration rectification, no nonlinearity, the same figures for all three axes.
//!
//! # Order of the random draws
//! `ChaCha8` seeded by a `u64`; standard normals. At the start: gyro `b₀` x y z, `s` x y z, `M` xy xz yx yz zx zy,
//! `b_gm` x y z; the same for the accelerometer; `G` row by row. Per sample: gyro `b_gm`, `b_rw`, `n` (x y z each),
//! the same for the accelerometer, then the jitter. A draw is made even where its σ is 0: switching one error off leaves
//! the others as they are. The same seed gives the same bytes.

use crate::error::SimulationError;
use crate::ideal_imu::Inertial;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::{Interval, Time};
use adit_observation::{ImuSample, ImuSpecification};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Most that the jitter of a stamp may be, as a share of the interval.
pub(crate) const JITTER_LIMIT: f64 = 0.4;

/// Errors of three like sensors; `U` is rad/s for a gyro, m/s² for an accelerometer, µT for a magnetometer.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TriadErrors {
    /// Turn-on bias, σ, U.
    pub turn_on_bias: f64,
    /// Bias instability: stationary σ of the Gauss–Markov process, U.
    pub bias_instability: f64,
    /// Its correlation time, s; ignored when the instability is 0.
    pub bias_correlation_s: f64,
    /// Bias random walk, U/√s.
    pub bias_random_walk: f64,
    /// White noise: angle (velocity) random walk, U·√s.
    pub random_walk: f64,
    /// Scale factor error, σ, 1.
    pub scale_factor: f64,
    /// Misalignment of each axis towards each other axis, σ, rad.
    pub misalignment_rad: f64,
    /// Full scale, U; none = unlimited.
    pub range: Option<f64>,
    /// Step of the output, U; none = continuous.
    pub quantisation: Option<f64>,
    /// −3 dB bandwidth of a one-pole filter, Hz; none = unlimited.
    pub bandwidth_hz: Option<f64>,
}

/// Errors of an IMU. The default has none.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImuErrorModel {
    /// Gyro, rad/s.
    pub gyro: TriadErrors,
    /// Accelerometer, m/s².
    pub accelerometer: TriadErrors,
    /// Gyro bias per specific force, σ of each of nine terms, (rad/s)/(m/s²).
    pub g_sensitivity: f64,
    /// Jitter of the stamps, σ, s.
    pub stamp_jitter_s: f64,
}

impl TriadErrors {
    /// A faultless triad.
    pub(crate) const fn none() -> Self {
        Self {
            turn_on_bias: 0.0,
            bias_instability: 0.0,
            bias_correlation_s: 0.0,
            bias_random_walk: 0.0,
            random_walk: 0.0,
            scale_factor: 0.0,
            misalignment_rad: 0.0,
            range: None,
            quantisation: None,
            bandwidth_hz: None,
        }
    }

    pub(crate) fn check(&self) -> Result<(), SimulationError> {
        let least_zero = [
            ("turn_on_bias", self.turn_on_bias),
            ("bias_instability", self.bias_instability),
            ("bias_correlation_s", self.bias_correlation_s),
            ("bias_random_walk", self.bias_random_walk),
            ("random_walk", self.random_walk),
            ("scale_factor", self.scale_factor),
            ("misalignment_rad", self.misalignment_rad),
        ];
        check_all(&least_zero, |v| v >= 0.0 && v.is_finite(), "a number not below 0")?;
        let positive = [
            ("range", self.range.unwrap_or(1.0)),
            ("quantisation", self.quantisation.unwrap_or(1.0)),
            ("bandwidth_hz", self.bandwidth_hz.unwrap_or(1.0)),
        ];
        check_all(&positive, |v| v > 0.0 && v.is_finite(), "a number above 0")?;
        if self.bias_instability > 0.0 && self.bias_correlation_s == 0.0 {
            let found = self.bias_correlation_s;
            let expected = "above 0 s where there is bias instability";
            return Err(SimulationError::Parameter { name: "bias_correlation_s", found, expected });
        }
        Ok(())
    }

    /// Random walk that grows at first as fast as the modelled bias does, U/√s.
    fn equivalent_bias_walk(&self) -> f64 {
        let markov = if self.bias_instability > 0.0 {
            self.bias_instability * libm::sqrt(2.0 / self.bias_correlation_s)
        } else {
            0.0
        };
        libm::hypot(markov, self.bias_random_walk)
    }
}

pub(crate) fn check_all(
    values: &[(&'static str, f64)],
    good: impl Fn(f64) -> bool,
    expected: &'static str,
) -> Result<(), SimulationError> {
    match values.iter().find(|(_, v)| !good(*v)) {
        Some(&(name, found)) => Err(SimulationError::Parameter { name, found, expected }),
        None => Ok(()),
    }
}

impl ImuErrorModel {
    /// All figures are numbers, none below zero.
    pub fn check(&self) -> Result<(), SimulationError> {
        self.gyro.check()?;
        self.accelerometer.check()?;
        let rest = [("g_sensitivity", self.g_sensitivity), ("stamp_jitter_s", self.stamp_jitter_s)];
        check_all(&rest, |v| v >= 0.0 && v.is_finite(), "a number not below 0")
    }

    /// The white noise and bias walk of this model, as a filter wants to know them.
    ///
    /// Gauss–Markov bias enters by its short-term random walk `σ √(2/τ)`. What a filter cannot know (scale factor,
    /// misalignment, quantisation) is not in it.
    pub fn specification(&self) -> ImuSpecification {
        ImuSpecification {
            angle_random_walk_rad_sqrt_s: self.gyro.random_walk,
            velocity_random_walk_m_s_sqrt_s: self.accelerometer.random_walk,
            gyro_bias_walk_rad_s_sqrt_s: self.gyro.equivalent_bias_walk(),
            acc_bias_walk_m_s2_sqrt_s: self.accelerometer.equivalent_bias_walk(),
        }
    }
}

/// Errors of one IMU in one run: constants drawn, processes under way.
#[derive(Debug, Clone)]
pub struct ImuErrors {
    gyro: Triad,
    accelerometer: Triad,
    g_sensitivity: Matrix3<f64>,
    stamp_jitter_s: f64,
    rng: ChaCha8Rng,
}

impl ImuErrors {
    /// Draws the constants of the run (`ChaCha8` of `seed`, stream 0).
    pub fn new(model: &ImuErrorModel, seed: u64) -> Result<Self, SimulationError> {
        model.check()?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        Ok(Self {
            gyro: Triad::new(model.gyro, &mut rng),
            accelerometer: Triad::new(model.accelerometer, &mut rng),
            g_sensitivity: Matrix3::from_rows(&[
                normals(&mut rng).transpose(),
                normals(&mut rng).transpose(),
                normals(&mut rng).transpose(),
            ]) * model.g_sensitivity,
            stamp_jitter_s: model.stamp_jitter_s,
            rng,
        })
    }

    /// Gyro bias at the last sample (turn-on, Gauss–Markov and random walk), rad/s.
    pub fn gyro_bias_rad_s(&self) -> Vector3<f64> {
        self.gyro.bias()
    }

    /// Accelerometer bias at the last sample, m/s².
    pub fn acc_bias_m_s2(&self) -> Vector3<f64> {
        self.accelerometer.bias()
    }

    /// The reading in place of the ideal one for the interval `span` that ends at `time`.
    pub fn apply(&mut self, ideal: &Inertial, time: Time, span: Interval) -> ImuSample {
        let span_s = span.seconds();
        let force = ideal.specific_force_m_s2;
        let turned_by_force = self.g_sensitivity * force;
        let rate = self.gyro.apply(&ideal.angular_rate_rad_s, &turned_by_force, span_s, &mut self.rng);
        let force = self.accelerometer.apply(&force, &Vector3::zeros(), span_s, &mut self.rng);
        let draw: f64 = StandardNormal.sample(&mut self.rng);
        let limit_s = JITTER_LIMIT * span_s;
        let jitter_s = (draw * self.stamp_jitter_s).clamp(-limit_s, limit_s);
        ImuSample {
            time: time + Interval::from_seconds(jitter_s).unwrap_or(Interval::ZERO),
            angular_rate_rad_s: rate,
            specific_force_m_s2: force,
        }
    }
}

fn normals(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    let mut draw = || StandardNormal.sample(&mut *rng);
    let (x, y, z) = (draw(), draw(), draw());
    Vector3::new(x, y, z)
}

/// Three like sensors in one run.
#[derive(Debug, Clone)]
pub(crate) struct Triad {
    errors: TriadErrors,
    turn_on_bias: Vector3<f64>,
    response: Matrix3<f64>,
    markov_bias: Vector3<f64>,
    walk_bias: Vector3<f64>,
    /// Output of the bandwidth filter; none before the first sample.
    filtered: Option<Vector3<f64>>,
}

impl Triad {
    pub fn new(errors: TriadErrors, rng: &mut ChaCha8Rng) -> Self {
        let turn_on_bias = normals(rng) * errors.turn_on_bias;
        let scale = normals(rng) * errors.scale_factor;
        let (m, n) = (normals(rng) * errors.misalignment_rad, normals(rng) * errors.misalignment_rad);
        let misalignment = Matrix3::new(0.0, m.x, m.y, m.z, 0.0, n.x, n.y, n.z, 0.0);
        Self {
            errors,
            turn_on_bias,
            response: Matrix3::identity() + Matrix3::from_diagonal(&scale) + misalignment,
            markov_bias: normals(rng) * errors.bias_instability,
            walk_bias: Vector3::zeros(),
            filtered: None,
        }
    }

    pub fn bias(&self) -> Vector3<f64> {
        self.turn_on_bias + self.markov_bias + self.walk_bias
    }

    /// Scale factors and misalignment, `I + diag(s) + M`.
    pub fn response(&self) -> Matrix3<f64> {
        self.response
    }

    /// The reading in place of the ideal one over `span_s`; `disturbance` is added before bandwidth, range and steps.
    pub fn apply(
        &mut self,
        ideal: &Vector3<f64>,
        disturbance: &Vector3<f64>,
        span_s: f64,
        rng: &mut ChaCha8Rng,
    ) -> Vector3<f64> {
        let errors = self.errors;
        let markov_draw = normals(rng);
        if errors.bias_instability > 0.0 {
            // Exact discretisation: decay, and noise that keeps the stationary variance.
            let decay = libm::exp(-span_s / errors.bias_correlation_s);
            let spread = errors.bias_instability * libm::sqrt(1.0 - decay * decay);
            self.markov_bias = self.markov_bias * decay + markov_draw * spread;
        }
        self.walk_bias += normals(rng) * (errors.bias_random_walk * libm::sqrt(span_s));
        let noise = normals(rng) * (errors.random_walk / libm::sqrt(span_s));

        let mut reading = self.response * ideal + disturbance + self.bias() + noise;
        if let Some(bandwidth_hz) = errors.bandwidth_hz {
            let gain = 1.0 - libm::exp(-core::f64::consts::TAU * bandwidth_hz * span_s);
            let before = self.filtered.unwrap_or(reading);
            reading = before + (reading - before) * gain;
            self.filtered = Some(reading);
        }
        if let Some(range) = errors.range {
            reading = reading.map(|v| v.clamp(-range, range));
        }
        if let Some(step) = errors.quantisation {
            reading = reading.map(|v| libm::round(v / step) * step);
        }
        reading
    }
}
