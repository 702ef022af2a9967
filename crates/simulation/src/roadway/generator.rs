//! Samples, fixes and truth of a walk along roadways, in order of time.

use super::walk::{EarthState, RoadwayWalk};
use crate::emission::Emission;
use crate::error::{SimulationError, check_within};
use crate::imu_errors::{ImuErrorModel, ImuErrors};
use crate::scenario::TruthState;
use crate::told_start::{StartErrors, ToldStart};
use adit_core::nalgebra::Vector2;
use adit_core::time::Time;
use adit_observation::{FixSource, PositionFix};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

const FIX_STREAM: u64 = 3;
const START_STREAM: u64 = 4;

/// Position fixes from outside.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FixModel {
    /// Time between fixes, s; the first comes after it.
    pub every_s: f64,
    /// White noise east and north, σ each, m; each fix states it.
    pub sigma_m: f64,
    /// What gives them.
    #[serde(default)]
    pub source: FixSource,
}

/// Iterator of samples and fixes with their truth, in order of their stamps; bounded memory. At equal stamps the sample comes
/// first.
#[derive(Debug, Clone)]
pub struct RoadwayGenerator {
    walk: RoadwayWalk,
    errors: ImuErrors,
    rate_hz: f64,
    fixes: FixModel,
    fix_rng: ChaCha8Rng,
    told: ToldStart,
    count: u64,
    fix_count: u64,
    before: Time,
    /// Drawn, not yet given: its stamp may be late.
    next_sample: Option<Emission>,
}

impl RoadwayGenerator {
    /// An IMU read `rate_hz` times a second on a walk; `seed` fixes all errors.
    pub fn new(
        walk: RoadwayWalk,
        errors: &ImuErrorModel,
        rate_hz: f64,
        fixes: FixModel,
        start: &StartErrors,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        check_within("rate_hz", rate_hz, 10.0, 10_000.0, "10 to 10000 Hz")?;
        check_within("every_s", fixes.every_s, 0.01, 1e6, "0.01 to 1e6 s")?;
        check_within("sigma_m", fixes.sigma_m, 1e-3, 1e4, "1 mm to 10 km")?;
        start.check()?;
        let mut fix_rng = ChaCha8Rng::seed_from_u64(seed);
        fix_rng.set_stream(FIX_STREAM);
        let EarthState { position_m, attitude, .. } = walk.at(0.0);
        let told = ToldStart::draw(&position_m, &attitude, start, seed, START_STREAM);
        Ok(Self {
            walk,
            errors: ImuErrors::new(errors, seed)?,
            rate_hz,
            fixes,
            fix_rng,
            told,
            count: 0,
            fix_count: 0,
            before: Time::ZERO,
            next_sample: None,
        })
    }

    /// The walk under way.
    pub fn walk(&self) -> &RoadwayWalk {
        &self.walk
    }

    /// What somebody is told of the start.
    pub fn told(&self) -> &ToldStart {
        &self.told
    }

    /// Truth at `time`, with the biases of the last sample.
    pub fn truth(&self, time: Time) -> TruthState {
        let EarthState { position_m, velocity_m_s, attitude, standing, .. } = self.walk.at(time.seconds());
        TruthState {
            time,
            position_m,
            velocity_m_s,
            attitude,
            gyro_bias_rad_s: self.errors.gyro_bias_rad_s(),
            acc_bias_m_s2: self.errors.acc_bias_m_s2(),
            stance: standing,
        }
    }

    fn sample(&mut self, time: Time) -> Emission {
        let ideal = self.walk.mean_reading(self.before.seconds(), time.seconds());
        let sample = self.errors.apply(&ideal, time, time - self.before);
        self.count += 1;
        self.before = time;
        Emission::Imu(sample, self.truth(time))
    }

    fn fix(&mut self, time: Time) -> Emission {
        let (east, north): (f64, f64) =
            (StandardNormal.sample(&mut self.fix_rng), StandardNormal.sample(&mut self.fix_rng));
        let FixModel { sigma_m, source, .. } = self.fixes;
        self.fix_count += 1;
        let position_m = self.walk.at(time.seconds()).position_m;
        let level_m = position_m.xy() + Vector2::new(east, north) * sigma_m;
        Emission::Fix(PositionFix::level(time, level_m, sigma_m, source), position_m)
    }
}

impl Iterator for RoadwayGenerator {
    type Item = Emission;

    fn next(&mut self) -> Option<Emission> {
        let end_s = self.walk.duration_s();
        if self.next_sample.is_none() {
            let time = Time::from_seconds((self.count + 1) as f64 / self.rate_hz)?;
            self.next_sample = (time.seconds() <= end_s).then(|| self.sample(time));
        }
        let fix = Time::from_seconds((self.fix_count + 1) as f64 * self.fixes.every_s)?;
        let fix = Some(fix).filter(|fix| fix.seconds() <= end_s);
        match (&self.next_sample, fix) {
            (Some(sample), Some(fix)) if fix < sample.observation().time() => Some(self.fix(fix)),
            (None, Some(fix)) => Some(self.fix(fix)),
            _ => self.next_sample.take(),
        }
    }
}
