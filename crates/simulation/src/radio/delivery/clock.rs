//! A tag's clock: offset, rate error and a rate that wanders.
//!
//! `stamp(t) = t + x(t)`, `ẋ = y`, `y` a random walk (one step per second, so that the clock does not depend on when it is read);
//! the two-state clock model of van Dierendonck, `McGraw` & Brown (1984) without its white phase noise.

use crate::error::{SimulationError, check_within};
use crate::radio::keyed::{Key, normal};
use crate::radio::world::Purpose;
use adit_core::time::Time;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// How wrong a clock is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ClockSpec {
    /// Standard deviation of the offset at the start, s.
    pub offset_sigma_s: f64,
    /// Standard deviation of the rate error at the start, parts per million.
    pub rate_sigma_ppm: f64,
    /// Random walk of the rate, parts per million per root second.
    pub rate_walk_ppm: f64,
}

/// A clock that is read in the order of time.
#[derive(Debug, Clone)]
pub struct DeviceClock {
    rng: ChaCha8Rng,
    walk: f64,
    second: f64,
    offset_s: f64,
    rate: f64,
}

impl Default for ClockSpec {
    /// A quartz of 20 ppm set to within 50 ms.
    fn default() -> Self {
        Self { offset_sigma_s: 0.05, rate_sigma_ppm: 10.0, rate_walk_ppm: 0.002 }
    }
}

impl ClockSpec {
    /// A clock that is right.
    pub const fn perfect() -> Self {
        Self { offset_sigma_s: 0.0, rate_sigma_ppm: 0.0, rate_walk_ppm: 0.0 }
    }
}

impl DeviceClock {
    pub(crate) fn new(spec: &ClockSpec, key: Key) -> Result<Self, SimulationError> {
        check_within("offset_sigma_s", spec.offset_sigma_s, 0.0, 86_400.0, "0 to 86400 s")?;
        check_within("rate_sigma_ppm", spec.rate_sigma_ppm, 0.0, 1e4, "0 to 10000 ppm")?;
        check_within("rate_walk_ppm", spec.rate_walk_ppm, 0.0, 100.0, "0 to 100 ppm per root second")?;
        let mut rng = key.stream();
        let offset_s = spec.offset_sigma_s * normal(&mut rng);
        let rate = 1e-6 * spec.rate_sigma_ppm * normal(&mut rng);
        Ok(Self { rng, walk: 1e-6 * spec.rate_walk_ppm, second: 0.0, offset_s, rate })
    }

    /// The clock of a person's tag.
    pub(crate) fn of_person(spec: &ClockSpec, seed: u64, person: u64) -> Result<Self, SimulationError> {
        Self::new(spec, Key::new(seed, Purpose::Clock as u64).with(person))
    }

    /// What the clock says at a true time, s; times before the second that was last read use that second's rate.
    pub fn stamp(&mut self, time_s: f64) -> Time {
        // Longer than a year in one go is a gap in the log, not a walk of the rate.
        let mut steps = 0;
        while self.second + 1.0 <= time_s && steps < 40_000_000 {
            self.offset_s += self.rate;
            self.rate += self.walk * normal(&mut self.rng);
            self.second += 1.0;
            steps += 1;
        }
        let shown_s = time_s + self.offset_s + self.rate * (time_s - self.second);
        Time::from_seconds(shown_s).unwrap_or(Time::ZERO)
    }
}
