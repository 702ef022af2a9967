//! A shift of one person as a filter reports it once a second.
//!
//! Truth: roadways at right angles, walked at 1.1 to 1.5 m/s with a swing of the gait, work in one place for minutes at a time, a ramp. What a filter adds:
//! an error of 0.2 m that forgets itself within 10 s (Gauss–Markov), 1.5 cm from one fix to the next, 1 cm of height, stamps that are a few ms
//! off the second, a radius that follows the distance to the last anchor.

use crate::common::at;
use adit_core::solution::Quality;
use adit_core::time::Interval;
use adit_server::store::FixRecord;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal, Uniform};

const MEMORY_S: f64 = 10.0;
const WANDER_M: f64 = 0.2;
const STEP_TO_STEP_M: f64 = 0.015;
const JITTER_S: f64 = 0.004;

pub fn shift(tag: &str, fixes: usize, seed: u64) -> Vec<FixRecord> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let unit = Uniform::new(0.0_f64, 1.0).unwrap();
    let quarter = Uniform::new(0_usize, 4).unwrap();
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let mut choice = ChaCha8Rng::seed_from_u64(seed + 1000);
    let mut place = [10_000.0 + 500.0 * unit.sample(&mut choice), 20_000.0, -350.0];
    let (mut direction, mut left, mut speed) = (0, 0.0, 0.0);
    let mut wander = [0.0; 3];
    let mut since_anchor = 0.0;
    let decay = (-1.0 / MEMORY_S).exp();
    (0_i64..)
        .take(fixes)
        .map(|second| {
            if left <= 0.0 {
                let walks = unit.sample(&mut choice) < 0.55;
                left = 30.0 + 200.0 * unit.sample(&mut choice);
                speed = if walks { 1.1 + 0.4 * unit.sample(&mut choice) } else { 0.0 };
                direction = quarter.sample(&mut choice);
            }
            left -= 1.0;
            let along = speed + if speed > 0.0 { 0.05 * (second as f64 * 0.7).sin() } else { 0.0 };
            let (east, north) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][direction];
            place[0] += along * east;
            place[1] += along * north;
            place[2] += 0.02 * along * east;
            since_anchor = if unit.sample(&mut choice) < 0.02 { 0.0 } else { since_anchor + speed };
            for (axis, component) in wander.iter_mut().enumerate() {
                let size = if axis == 2 { 0.05 } else { WANDER_M };
                *component = *component * decay + size * (1.0 - decay * decay).sqrt() * normal();
            }
            let noise = [STEP_TO_STEP_M * normal(), STEP_TO_STEP_M * normal(), 0.01 * normal()];
            FixRecord {
                person: Some(format!("p-{tag}")),
                tag: tag.to_owned(),
                time: at(second) + Interval::from_seconds(JITTER_S * normal()).unwrap(),
                position_m: std::array::from_fn(|axis| place[axis] + wander[axis] + noise[axis]),
                radius_95_m: 0.35 + 0.004 * since_anchor + 0.01 * normal().abs(),
                quality: if since_anchor > 150.0 { Quality::DeadReckoning } else { Quality::Fixed },
                level: Some("L350".to_owned()),
                zone: (since_anchor > 60.0).then(|| format!("zone {direction}")),
            }
        })
        .collect()
}
