//! The air of a mine: pressure at any place and time.

use super::doors::{Doors, Passage};
use super::ventilation::Ventilation;
use crate::error::{SimulationError, check_within};
use crate::people::Person;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use core::f64::consts::TAU;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use serde::{Deserialize, Serialize};

/// Standard gravity over the gas constant of dry air, K/m (ISO 2533: 9.80665 m/s², 287.05287 J/(kg K)).
const GRAVITY_OVER_GAS_CONSTANT: f64 = 9.806_65 / 287.052_87;
/// Stream of the random draws for the weather.
const STREAM: u64 = 3;
/// Periods of the weather's sinusoids, s.
const PERIODS_S: [f64; 5] = [3.0 * 3600.0, 6.0 * 3600.0, 12.0 * 3600.0, 26.0 * 3600.0, 60.0 * 3600.0];

/// A column of still air whose temperature changes evenly with height.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AirColumn {
    /// Height on the mine's grid to which pressure and temperature belong, m.
    pub height_m: f64,
    /// Pressure there, Pa.
    pub pressure_pa: f64,
    /// Temperature there, K.
    pub temperature_k: f64,
    /// How much colder it is for each metre up, K/m; 0 for air of one temperature.
    pub lapse_k_m: f64,
}

impl Default for AirColumn {
    /// The standard atmosphere at sea level.
    fn default() -> Self {
        Self { height_m: 0.0, pressure_pa: 101_325.0, temperature_k: 288.15, lapse_k_m: 0.0065 }
    }
}

impl AirColumn {
    /// The values are those of air on Earth.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("height_m", self.height_m, -1e4, 1e4, "-10 to 10 km")?;
        check_within("pressure_pa", self.pressure_pa, 3e4, 1.5e5, "30 to 150 kPa")?;
        check_within("temperature_k", self.temperature_k, 220.0, 350.0, "220 to 350 K")?;
        check_within("lapse_k_m", self.lapse_k_m, -0.02, 0.02, "-0.02 to 0.02 K/m")
    }

    /// Temperature at a height, K.
    pub fn temperature_k(&self, z_m: f64) -> f64 {
        self.temperature_k - self.lapse_k_m * (z_m - self.height_m)
    }

    /// Pressure at a height, Pa: `p (1 − L h / T)^(g / R L)` (ISO 2533:1975, eq. 12), and its limit for an even temperature.
    pub fn pressure_pa(&self, z_m: f64) -> f64 {
        let up_m = z_m - self.height_m;
        let depth = GRAVITY_OVER_GAS_CONSTANT * up_m / self.temperature_k;
        let cooling = self.lapse_k_m * up_m / self.temperature_k;
        // ln(1 − x)/x, which goes to −1.
        let shape = if cooling.abs() < 1e-12 { -1.0 } else { libm::log1p(-cooling) / cooling };
        self.pressure_pa * libm::exp(depth * shape)
    }
}

/// What the air of a mine is like.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AirSpec {
    /// The column at the start.
    pub column: AirColumn,
    /// How much the weather changes the pressure, rms over days, Pa.
    pub weather_rms_pa: f64,
}

/// The air of one mine.
#[derive(Debug, Clone)]
pub struct MineAir {
    spec: AirSpec,
    /// Amplitude (Pa), angular frequency (rad/s), phase (rad).
    weather: [[f64; 3]; 5],
    ventilation: Ventilation,
    doors: Doors,
}

impl MineAir {
    /// Finds the doors on the network and the pressures along it; `seed` fixes the weather.
    pub fn new(mine: &Mine, spec: &AirSpec, seed: u64) -> Result<Self, SimulationError> {
        spec.column.check()?;
        check_within("weather_rms_pa", spec.weather_rms_pa, 0.0, 5000.0, "0 to 5000 Pa")?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(STREAM);
        // Amplitudes as the period: the slope of each is the same.
        let squares: f64 = PERIODS_S.iter().map(|period| period * period).sum();
        let weather = PERIODS_S.map(|period_s| {
            let amplitude = spec.weather_rms_pa * libm::sqrt(2.0 / squares) * period_s;
            let draw = Uniform::new(0.0, TAU).map_or(0.0, |uniform| uniform.sample(&mut rng));
            [amplitude, TAU / period_s, draw]
        });
        let doors = Doors::new(mine);
        let ventilation = Ventilation::new(mine, &doors);
        Ok(Self { spec: spec.clone(), weather, ventilation, doors })
    }

    /// The column of air.
    pub fn column(&self) -> &AirColumn {
        &self.spec.column
    }

    /// What drives the air.
    pub fn ventilation(&self) -> &Ventilation {
        &self.ventilation
    }

    /// When somebody passes which door, in order of time.
    pub fn passages_of(&self, person: &Person) -> Vec<Passage> {
        self.doors.passages(person)
    }

    /// From now on these passages count; all people's, in any order.
    pub fn open_doors(&mut self, passages: impl IntoIterator<Item = Passage>) {
        self.doors.open(passages);
    }

    /// Change by the weather since the start, Pa.
    pub fn weather_pa(&self, time_s: f64) -> f64 {
        let tone = |[amplitude, omega, phase]: &[f64; 3]| {
            amplitude * (libm::sin(omega * time_s + phase) - libm::sin(*phase))
        };
        self.weather.iter().map(tone).sum()
    }

    /// The pressure at a place (mine grid) and time, Pa.
    pub fn pressure_pa(&self, place_m: &Vector3<f64>, time_s: f64) -> f64 {
        let ventilation = self.ventilation.pressure_pa(place_m);
        let calm = self.spec.column.pressure_pa(place_m.z) + self.weather_pa(time_s);
        calm + ventilation + self.doors.relief_pa(place_m, ventilation, &self.ventilation, time_s)
    }
}
