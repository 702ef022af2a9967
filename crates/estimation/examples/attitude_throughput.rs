//! Streams a simulated nine-axis log through `ahrs` and through the VQF of the crate `uf-ahrs`, and prints samples per
//! second of each, best of several runs that take turns.
//!
//! With a path as argument the log is also written there as CSV, so that a rival can do the same work on the same data:
//! see `ci/rival.sh`.

#[path = "../tests/support/nine_axis.rs"]
mod nine_axis;

use adit_core::nalgebra::Vector3;
use adit_estimation::methods::MethodError;
use adit_estimation::methods::ahrs::{Ahrs, AhrsParams};
use adit_observation::Observation;
use nine_axis::{INTERVAL_S, NineAxis, log};
use std::error::Error;
use std::fmt::Write;
use std::hint::black_box;
use std::time::{Duration, Instant};
use uf_ahrs::{Ahrs as _, Vqf, VqfParams};

const SAMPLES: u32 = 60_000;
const RUNS: usize = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let samples = log(SAMPLES, 1);
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, csv(&samples)?)?;
    }
    let observations: Vec<Observation> = samples.iter().flat_map(NineAxis::observations).collect();
    let single: Vec<[Vector3<f32>; 3]> = samples.iter().map(in_single_precision).collect();
    let (mut adit_s, mut vqf_s) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..RUNS {
        let start = Instant::now();
        black_box(ahrs(&observations)?);
        adit_s = adit_s.min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        black_box(vqf(&single));
        vqf_s = vqf_s.min(start.elapsed().as_secs_f64());
    }
    println!("{:.0} {:.0}", f64::from(SAMPLES) / adit_s, f64::from(SAMPLES) / vqf_s);
    Ok(())
}

/// Scalar part of the last attitude.
fn ahrs(observations: &[Observation]) -> Result<f64, MethodError> {
    let mut method = Ahrs::new(AhrsParams::default())?;
    let mut last = 0.0;
    for observation in observations {
        let mut solution = method.observe(observation)?;
        while let Some(now) = solution {
            last = now.attitude.w;
            solution = method.next_due()?;
        }
    }
    Ok(last)
}

fn vqf(samples: &[[Vector3<f32>; 3]]) -> f32 {
    let mut vqf = Vqf::new(Duration::from_secs_f64(INTERVAL_S), VqfParams::default());
    let mut last = 0.0;
    for [rate, force, field] in samples {
        last = vqf.update(*rate, *force, *field).w;
    }
    last
}

fn in_single_precision(sample: &NineAxis) -> [Vector3<f32>; 3] {
    [sample.imu.angular_rate_rad_s, sample.imu.specific_force_m_s2, sample.magnetic.field_ut]
        .map(|v| v.cast())
}

fn csv(samples: &[NineAxis]) -> Result<String, std::fmt::Error> {
    let mut text = String::from(
        "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT\n",
    );
    for NineAxis { imu, magnetic, .. } in samples {
        let (f, w, b) = (imu.specific_force_m_s2, imu.angular_rate_rad_s, magnetic.field_ut);
        writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{}",
            imu.time, f.x, f.y, f.z, w.x, w.y, w.z, b.x, b.y, b.z
        )?;
    }
    Ok(text)
}
