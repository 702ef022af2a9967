//! Nine-axis samples per second of `ahrs`, streaming and smoothed, beside the VQF of the crate `uf-ahrs` on the same samples.
//!
//! The log is simulated: 105 s at 2000/7 Hz of a hand that turns, waves and rests.

#![expect(clippy::expect_used, reason = "a benchmark that cannot run should stop")]

#[path = "../tests/support/nine_axis.rs"]
mod nine_axis;

use adit_core::nalgebra::Vector3;
use adit_estimation::methods::ahrs::{Ahrs, AhrsParams, smooth};
use adit_observation::Observation;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nine_axis::{INTERVAL_S, NineAxis, log};
use std::hint::black_box;
use std::time::Duration;
use uf_ahrs::{Ahrs as _, Vqf, VqfParams};

const SAMPLES: u32 = 30_000;

fn stream(observations: &[Observation]) -> f64 {
    let mut method = Ahrs::new(AhrsParams::default()).expect("the defaults are usable");
    let mut last = 0.0;
    for observation in observations {
        let mut solution = method.observe(observation).expect("the log can be tracked");
        while let Some(now) = solution {
            last = now.attitude.w;
            solution = method.next_due().expect("the log can be tracked");
        }
    }
    last
}

fn benchmarks(criterion: &mut Criterion) {
    let samples = log(SAMPLES, 1);
    let nine_axis: Vec<Observation> = samples.iter().flat_map(NineAxis::observations).collect();
    let six_axis: Vec<Observation> = samples.iter().map(|sample| Observation::Imu(sample.imu)).collect();
    let single: Vec<[Vector3<f32>; 3]> = samples
        .iter()
        .map(|s| [s.imu.angular_rate_rad_s, s.imu.specific_force_m_s2, s.magnetic.field_ut].map(|v| v.cast()))
        .collect();

    let mut group = criterion.benchmark_group("ahrs");
    group.throughput(Throughput::Elements(u64::from(SAMPLES)));
    group.sample_size(20).measurement_time(Duration::from_secs(4));
    group.bench_function("stream-9-axis", |bencher| bencher.iter(|| stream(black_box(&nine_axis))));
    group.bench_function("stream-6-axis", |bencher| bencher.iter(|| stream(black_box(&six_axis))));
    group.bench_function("uf-ahrs-vqf-9-axis", |bencher| {
        bencher.iter(|| {
            let mut vqf = Vqf::new(Duration::from_secs_f64(INTERVAL_S), VqfParams::default());
            let mut last = 0.0;
            for [rate, force, field] in black_box(&single) {
                last = vqf.update(*rate, *force, *field).w;
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
