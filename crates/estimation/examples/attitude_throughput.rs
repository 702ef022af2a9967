//! Streams a simulated nine-axis log through `ahrs` and through the VQF of the crate `uf-ahrs`, and prints samples per
//! second of each, best of several runs that take turns.
//!
//! With a path as argument the log is also written there as CSV, so that a rival can do the same work on the same data:
//! see `ci/rival.sh`.

#[path = "../tests/support/mod.rs"]
mod support;

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix, Vector3};
use adit_estimation::methods::MethodError;
use adit_estimation::methods::ahrs::{Ahrs, AhrsParams};
use adit_observation::Observation;
use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;
use std::hint::black_box;
use std::time::{Duration, Instant};
use support::turning::Tag;
use uf_ahrs::{Ahrs as _, Vqf, VqfParams};

/// 2000/7 Hz, as the BROAD recordings.
const INTERVAL_S: f64 = 0.0035;
const RUNS: usize = 30;
/// An estimate further off at the end has lost its way, and its speed says nothing, rad.
const LOST_RAD: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let tag = Tag { rate_hz: 1.0 / INTERVAL_S, duration_s: 210.0, ..Tag::default() };
    let (observations, truth) = tag.record(1);
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, csv(&observations)?)?;
    }
    let single = in_single_precision(&observations);
    let (mut adit_s, mut vqf_s) = (f64::INFINITY, f64::INFINITY);
    let true_last = truth.last().ok_or("no samples")?;
    for _ in 0..RUNS {
        let start = Instant::now();
        let ours = black_box(adit(&observations)?);
        adit_s = adit_s.min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        let theirs = black_box(vqf(&single));
        vqf_s = vqf_s.min(start.elapsed().as_secs_f64());
        for (name, last) in [("adit", ours), ("uf-ahrs", theirs)] {
            let error_rad = last.angle_to(true_last);
            if error_rad > LOST_RAD {
                return Err(format!("{name} is {error_rad} rad off at the end").into());
            }
        }
    }
    let samples = truth.len() as f64;
    println!("{:.0} {:.0}", samples / adit_s, samples / vqf_s);
    Ok(())
}

/// The last attitude.
fn adit(observations: &[Observation]) -> Result<Attitude, MethodError> {
    let mut method = Ahrs::new(AhrsParams::default())?;
    let mut last = Attitude::identity();
    for observation in observations {
        let mut solution = method.observe(observation)?;
        while let Some(now) = solution {
            last = now.attitude;
            solution = method.next_due()?;
        }
    }
    while let Some(now) = method.finish_next()? {
        last = now.attitude;
    }
    Ok(last)
}

/// The same of the rival, whose x axis points north.
fn vqf(samples: &[[Vector3<f32>; 3]]) -> Attitude {
    let mut vqf = Vqf::new(Duration::from_secs_f64(INTERVAL_S), VqfParams::default());
    let mut last = vqf.heading_orientation();
    for [rate, force, field] in samples {
        last = vqf.update(*rate, *force, *field);
    }
    attitude::exp(&Vector3::new(0.0, 0.0, FRAC_PI_2)) * last.cast()
}

/// Rate, force and field of each sample.
fn in_single_precision(observations: &[Observation]) -> Vec<[Vector3<f32>; 3]> {
    let sample = |pair: &[Observation]| match pair {
        [Observation::Imu(imu), Observation::Magnetic(magnetic)] => {
            Some([imu.angular_rate_rad_s, imu.specific_force_m_s2, magnetic.field_ut].map(Matrix::cast))
        }
        _ => None,
    };
    observations.chunks(2).filter_map(sample).collect()
}

fn csv(observations: &[Observation]) -> Result<String, std::fmt::Error> {
    let mut text = String::from(
        "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT\n",
    );
    for pair in observations.chunks(2) {
        let [Observation::Imu(imu), Observation::Magnetic(magnetic)] = pair else { continue };
        let (f, w, b) = (imu.specific_force_m_s2, imu.angular_rate_rad_s, magnetic.field_ut);
        writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{}",
            imu.time, f.x, f.y, f.z, w.x, w.y, w.z, b.x, b.y, b.z
        )?;
    }
    Ok(text)
}
