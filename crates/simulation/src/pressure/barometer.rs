//! What a barometer makes of the pressure.
//!
//! `y = Q( F( p ) + b₀ + b_gm(t) + τ (T(t) − T₀) + n )`
//!
//! | term | model | parameter |
//! |---|---|---|
//! | `F` | one pole | time constant |
//! | `b₀` offset left after calibration | normal, constant in a run | σ |
//! | `b_gm` drift | Gauss–Markov | σ, correlation time |
//! | `τ` temperature coefficient of the offset, `T` temperature of the sensor | normal, constant in a run; `T` follows the air's with one pole from `T₀` | σ of `τ`, time constant, warmth of the tag above the air |
//! | `n` | white, one draw for each reading | σ |
//! | `Q` | rounding | step |
//!
//! Pa, s, K.
//!
//! # Order of the random draws
//! `ChaCha8` of the seed, **stream 4**: at the start `b₀`, `τ`, `b_gm`; for each reading `b_gm`, `n`.

use super::air::MineAir;
use crate::error::{SimulationError, check_within};
use crate::motion::Motion;
use adit_core::time::Time;
use adit_observation::PressureSample;
use core::borrow::Borrow;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Stream of the random draws.
const STREAM: u64 = 4;
/// Temperature of the sensor at the start, at which its offset was calibrated, K.
const START_K: f64 = 295.15;

/// Errors of a barometer; the default is faultless, at 10 Hz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BarometerModel {
    /// Readings per second.
    pub rate_hz: f64,
    /// Time constant of the sensor's filter, s; 0 = none.
    pub response_s: f64,
    /// Offset, σ, Pa.
    pub offset_pa: f64,
    /// Drift: σ (Pa) and correlation time (s).
    pub drift_pa: f64,
    /// See there.
    pub drift_correlation_s: f64,
    /// Temperature coefficient of the offset, σ, Pa/K.
    pub temperature_pa_k: f64,
    /// Time constant of the tag's temperature, s.
    pub warming_s: f64,
    /// How much warmer the tag is than the air, K: body and battery.
    pub warmth_k: f64,
    /// Noise of a reading, σ, Pa.
    pub noise_pa: f64,
    /// Step of a reading, Pa; 0 = none.
    pub quantisation_pa: f64,
}

impl Default for BarometerModel {
    fn default() -> Self {
        Self::ideal()
    }
}

impl BarometerModel {
    /// Without errors, at 10 Hz.
    pub const fn ideal() -> Self {
        Self {
            rate_hz: 10.0,
            response_s: 0.0,
            offset_pa: 0.0,
            drift_pa: 0.0,
            drift_correlation_s: 3600.0,
            temperature_pa_k: 0.0,
            warming_s: 600.0,
            warmth_k: 5.0,
            noise_pa: 0.0,
            quantisation_pa: 0.0,
        }
    }

    /// Bosch BMP280, ultra high resolution without filter. From memory of its data sheet (BST-BMP280-DS001): absolute accuracy ±1 hPa
    /// (taken as 2 σ), offset ±1.5 Pa/K (2 σ), noise 1.3 Pa, step 0.16 Pa; long-term ±1 hPa a year. Drift within hours is chosen.
    pub const fn bmp280() -> Self {
        Self {
            rate_hz: 10.0,
            response_s: 0.06,
            offset_pa: 50.0,
            drift_pa: 3.0,
            temperature_pa_k: 0.75,
            noise_pa: 1.3,
            quantisation_pa: 0.16,
            ..Self::ideal()
        }
    }

    /// Bosch BMP388, standard resolution, short filter. From memory of its data sheet (BST-BMP388-DS001): absolute accuracy ±50 Pa
    /// (2 σ), relative ±8 Pa, offset ±0.75 Pa/K (2 σ), noise 0.5 Pa in this mode, step 0.66 Pa at 16 bits and 0.02 Pa at 20 bits.
    /// Drift within hours is chosen.
    pub const fn bmp388() -> Self {
        Self {
            rate_hz: 25.0,
            response_s: 0.05,
            offset_pa: 25.0,
            drift_pa: 2.0,
            temperature_pa_k: 0.375,
            noise_pa: 0.5,
            quantisation_pa: 0.02,
            ..Self::ideal()
        }
    }

    /// The figures are those of a barometer.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("rate_hz", self.rate_hz, 0.001, 1000.0, "0.001 to 1000 Hz")?;
        check_within("response_s", self.response_s, 0.0, 1000.0, "0 to 1000 s")?;
        check_within("drift_correlation_s", self.drift_correlation_s, 0.1, 1e7, "0.1 to 1e7 s")?;
        check_within("warming_s", self.warming_s, 0.1, 1e6, "0.1 to 1e6 s")?;
        check_within("warmth_k", self.warmth_k, -50.0, 50.0, "-50 to 50 K")?;
        let sizes = [
            ("offset_pa", self.offset_pa),
            ("drift_pa", self.drift_pa),
            ("temperature_pa_k", self.temperature_pa_k),
            ("noise_pa", self.noise_pa),
            ("quantisation_pa", self.quantisation_pa),
        ];
        sizes.into_iter().try_for_each(|(name, size)| check_within(name, size, 0.0, 1e4, "0 to 10000"))
    }
}

/// Truth at the time of a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureTruth {
    /// Time.
    pub time: Time,
    /// The pressure at the sensor, Pa.
    pub pressure_pa: f64,
    /// What the ventilation and open doors have in it, Pa.
    pub ventilation_pa: f64,
    /// Offset, drift and effect of temperature in the reading, Pa.
    pub bias_pa: f64,
}

/// Readings of a barometer that moves through a mine, with their truth, to the end of the motion.
#[derive(Debug, Clone)]
pub struct Barometer<M, A> {
    motion: M,
    air: A,
    model: BarometerModel,
    rng: ChaCha8Rng,
    offset_pa: f64,
    coefficient_pa_k: f64,
    drift_pa: f64,
    temperature_k: f64,
    filtered_pa: Option<f64>,
    count: u64,
}

impl<M: Motion, A: Borrow<MineAir>> Barometer<M, A> {
    /// A barometer on a motion in mine coordinates, in air that is borrowed or shared; `seed` fixes its errors.
    pub fn new(motion: M, air: A, model: &BarometerModel, seed: u64) -> Result<Self, SimulationError> {
        model.check()?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(STREAM);
        let mut normal = |sigma: f64| {
            let draw: f64 = StandardNormal.sample(&mut rng);
            sigma * draw
        };
        let (offset_pa, coefficient_pa_k) = (normal(model.offset_pa), normal(model.temperature_pa_k));
        let drift_pa = normal(model.drift_pa);
        Ok(Self {
            motion,
            air,
            model: *model,
            rng,
            offset_pa,
            coefficient_pa_k,
            drift_pa,
            temperature_k: START_K,
            filtered_pa: None,
            count: 0,
        })
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.rng)
    }
}

impl<M: Motion, A: Borrow<MineAir>> Iterator for Barometer<M, A> {
    type Item = (PressureSample, PressureTruth);

    fn next(&mut self) -> Option<Self::Item> {
        let interval_s = 1.0 / self.model.rate_hz;
        let time = Time::from_seconds((self.count + 1) as f64 * interval_s)?;
        if time.seconds() > self.motion.duration_s() {
            return None;
        }
        self.count += 1;
        let place = self.motion.at(time.seconds()).position_m;
        let air = self.air.borrow();
        let pressure_pa = air.pressure_pa(&place, time.seconds());
        let calm_pa = air.column().pressure_pa(place.z) + air.weather_pa(time.seconds());

        let keep =
            if self.model.response_s > 0.0 { libm::exp(-interval_s / self.model.response_s) } else { 0.0 };
        let filtered_pa =
            self.filtered_pa.map_or(pressure_pa, |before| pressure_pa + keep * (before - pressure_pa));
        self.filtered_pa = Some(filtered_pa);
        let around_k = air.column().temperature_k(place.z) + self.model.warmth_k;
        let lag = libm::exp(-interval_s / self.model.warming_s);
        self.temperature_k = around_k + lag * (self.temperature_k - around_k);
        let remember = libm::exp(-interval_s / self.model.drift_correlation_s);
        let kick = libm::sqrt(1.0 - remember * remember) * self.model.drift_pa;
        self.drift_pa = remember * self.drift_pa + kick * self.normal();
        let noise_pa = self.model.noise_pa * self.normal();

        let warmed_k = self.temperature_k - START_K;
        let bias_pa = self.offset_pa + self.drift_pa + self.coefficient_pa_k * warmed_k;
        let raw_pa = filtered_pa + bias_pa + noise_pa;
        let step = self.model.quantisation_pa;
        let read_pa = if step > 0.0 { step * libm::round(raw_pa / step) } else { raw_pa };
        let truth = PressureTruth { time, pressure_pa, ventilation_pa: pressure_pa - calm_pa, bias_pa };
        Some((PressureSample { time, pressure_pa: read_pa }, truth))
    }
}
