//! Samples per second of `ahrs`, nine axes and six, streaming and smoothed, beside the VQF of the crate `uf-ahrs` on the
//! same samples.
//!
//! The log is simulated: 105 s at 2000/7 Hz of a tag that rests, turns and is carried about. A sample is one reading of
//! all sensors.

#![expect(clippy::expect_used, reason = "a benchmark that cannot run should stop")]

#[path = "../tests/support/mod.rs"]
mod support;

use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Matrix, Vector3};
use adit_estimation::methods::ahrs::{Ahrs, AhrsParams, smooth};
use adit_observation::Observation;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use support::turning::Tag;
use uf_ahrs::{Ahrs as _, Vqf, VqfParams};

const INTERVAL_S: f64 = 0.0035;

fn stream(observations: &[Observation]) -> Attitude {
    let mut method = Ahrs::new(AhrsParams::default()).expect("the defaults are usable");
    let mut last = Attitude::identity();
    for observation in observations {
        let mut solution = method.observe(observation).expect("the log can be tracked");
        while let Some(now) = solution {
            last = now.attitude;
            solution = method.next_due().expect("the log can be tracked");
        }
    }
    last
}

fn benchmarks(criterion: &mut Criterion) {
    let tag = Tag { rate_hz: 1.0 / INTERVAL_S, duration_s: 105.0, ..Tag::default() };
    let (nine_axis, truth) = tag.record(1);
    let is_inertial = |observation: &&Observation| matches!(observation, Observation::Imu(_));
    let six_axis: Vec<Observation> = nine_axis.iter().filter(is_inertial).cloned().collect();
    let single = nine_axis.chunks(2).map(|pair| match pair {
        [Observation::Imu(imu), Observation::Magnetic(magnetic)] => {
            [imu.angular_rate_rad_s, imu.specific_force_m_s2, magnetic.field_ut].map(Matrix::cast)
        }
        _ => [Vector3::zeros(); 3],
    });
    let single: Vec<[Vector3<f32>; 3]> = single.collect();

    let mut group = criterion.benchmark_group("ahrs");
    group.throughput(Throughput::Elements(truth.len() as u64));
    group.sample_size(20).measurement_time(Duration::from_secs(4));
    group.bench_function("stream-9-axis", |bencher| bencher.iter(|| stream(black_box(&nine_axis))));
    group.bench_function("stream-6-axis", |bencher| bencher.iter(|| stream(black_box(&six_axis))));
    group.bench_function("uf-ahrs-vqf-9-axis", |bencher| {
        bencher.iter(|| {
            let mut vqf = Vqf::new(Duration::from_secs_f64(INTERVAL_S), VqfParams::default());
            let mut last = vqf.heading_orientation();
            for [rate, force, field] in black_box(&single) {
                last = vqf.update(*rate, *force, *field);
            }
            last
        });
    });
    group.sample_size(10);
    group.bench_function("smooth-9-axis", |bencher| {
        bencher.iter(|| smooth(AhrsParams::default(), black_box(&nine_axis), &mut |_| ()).expect("smooths"));
    });
    group.finish();
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
