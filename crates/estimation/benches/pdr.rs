//! Samples per second of `pdr`: nine axes, six, and the step detector alone.
//!
//! The log is simulated: 200 s at 100 Hz of somebody who walks with bends. A sample is one reading of all sensors.

#![expect(clippy::expect_used, reason = "a benchmark that cannot run should stop")]

#[path = "../tests/support/mod.rs"]
mod support;

use adit_core::nalgebra::Vector2;
use adit_estimation::methods::pdr::{Pdr, PdrParams};
use adit_estimation::pedestrian::steps::{StepDetector, StepParams};
use adit_observation::Observation;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use support::strides::Strides;

fn track(observations: &[Observation]) -> Vector2<f64> {
    let mut method = Pdr::new(PdrParams::default()).expect("the defaults are usable");
    for observation in observations {
        let mut solution = method.observe(observation).expect("the log can be tracked");
        while solution.is_some() {
            solution = method.next_due();
        }
    }
    method.walker().position_m
}

fn count(observations: &[Observation]) -> u32 {
    let mut detector = StepDetector::new(&StepParams::default());
    let mut steps = 0;
    for observation in observations {
        if let Observation::Imu(imu) = observation {
            detector.observe(imu.time, &imu.specific_force_m_s2);
            while detector.pop().is_some() {
                steps += 1;
            }
        }
    }
    steps
}

fn benchmarks(criterion: &mut Criterion) {
    let turns = (1..18).map(|bend| (f64::from(bend) * 10.0, 2.0, 0.9)).collect();
    let walk = Strides { steps: 350, turns, ..Strides::default() };
    let (nine_axis, truth) = walk.record(1);
    let is_inertial = |observation: &&Observation| matches!(observation, Observation::Imu(_));
    let six_axis: Vec<Observation> = nine_axis.iter().filter(is_inertial).cloned().collect();

    let mut group = criterion.benchmark_group("pdr");
    group.throughput(Throughput::Elements(truth.len() as u64));
    group.sample_size(20).measurement_time(Duration::from_secs(4));
    group.bench_function("stream-9-axis", |bencher| bencher.iter(|| track(black_box(&nine_axis))));
    group.bench_function("stream-6-axis", |bencher| bencher.iter(|| track(black_box(&six_axis))));
    group.bench_function("steps-alone", |bencher| bencher.iter(|| count(black_box(&six_axis))));
    group.finish();
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
