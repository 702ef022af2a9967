//! Streams the simulated example walk through `foot-ins` and prints samples per second, best of several runs.
//!
//! With a path as argument the walk is also written there as CSV, with one more column that says where the detector
//! called the foot still, so that a rival can do the same work on the same data: see `ci/rival.sh`.

use adit_estimation::methods::MethodError;
use adit_estimation::methods::foot_ins::{FootIns, FootInsParams};
use adit_estimation::pedestrian::stance::{Stance, StanceDetector};
use adit_observation::{ImuSample, Observation};
use adit_simulation::{FootWalkScenario, ImuErrorModel, generate};
use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

const RUNS: usize = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let samples: Vec<ImuSample> = generate(&FootWalkScenario::demo_walk(), &ImuErrorModel::adis16448(), 1)?
        .map(|(sample, _)| sample)
        .collect();
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, with_stance(&samples)?)?;
    }

    let observations: Vec<Observation> = samples.iter().copied().map(Observation::Imu).collect();
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        std::hint::black_box(track(&observations)?);
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{:.0}", observations.len() as f64 / best);
    Ok(())
}

/// East coordinate at the end of the walk.
fn track(observations: &[Observation]) -> Result<f64, MethodError> {
    let mut method = FootIns::new(FootInsParams::default())?;
    let mut east = 0.0;
    for observation in observations {
        if let Some(solution) = method.observe(observation)? {
            east = solution.position_m.x;
        }
    }
    while let Some(solution) = method.finish_next()? {
        east = solution.position_m.x;
    }
    Ok(east)
}

fn with_stance(samples: &[ImuSample]) -> Result<String, std::fmt::Error> {
    let params = FootInsParams::default();
    let mut detector = StanceDetector::new(params.stance, params.gravity_m_s2);
    for sample in samples {
        detector.push(*sample);
    }
    let mut text = String::from("time_s,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z,still\n");
    let judged: Vec<(ImuSample, Stance)> = std::iter::from_fn(|| detector.drain()).collect();
    for (sample, stance) in judged {
        let (w, f) = (sample.angular_rate_rad_s, sample.specific_force_m_s2);
        let still = u8::from(stance.is_still());
        writeln!(text, "{},{},{},{},{},{},{},{still}", sample.time, w.x, w.y, w.z, f.x, f.y, f.z)?;
    }
    Ok(text)
}
