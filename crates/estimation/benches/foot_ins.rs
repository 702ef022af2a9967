//! Samples per second of `foot-ins`: prediction alone, the whole streaming method, the whole log smoothed.
//!
//! The log is the example walk of the simulator at 200 Hz with the errors of an ADIS16448: 150 s, 119 m, 35 % at rest.

#![expect(clippy::expect_used, reason = "a benchmark that cannot run should stop")]

use adit_core::attitude::Attitude;
use adit_core::nalgebra::Vector3;
use adit_estimation::inertial::covariance::Covariance;
use adit_estimation::inertial::filter::{FilterState, InertialFilter, SensorNoise};
use adit_estimation::inertial::strapdown::NavigationState;
use adit_estimation::methods::foot_ins::{FixedLag, FootIns, FootInsParams, smooth};
use adit_estimation::pedestrian::stance::{StanceDetector, StanceParams};
use adit_observation::{ImuSample, Observation};
use adit_simulation::{FootWalkScenario, ImuErrorModel, generate};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;

fn walk() -> Vec<ImuSample> {
    generate(&FootWalkScenario::demo_walk(), &ImuErrorModel::adis16448(), 1)
        .expect("the example walk can be simulated")
        .map(|(sample, _)| sample)
        .collect()
}

fn filter() -> InertialFilter {
    let navigation = NavigationState {
        attitude: Attitude::identity(),
        velocity_m_s: Vector3::zeros(),
        position_m: Vector3::zeros(),
        gyro_bias_rad_s: Vector3::zeros(),
        acc_bias_m_s2: Vector3::zeros(),
    };
    let covariance = Covariance::from_variances(&[Vector3::repeat(1e-4); 6]);
    InertialFilter::new(FilterState { navigation, contact_m: Vector3::zeros() }, covariance, 9.80665)
}

fn streaming(observations: &[Observation]) -> f64 {
    let mut method = FootIns::new(FootInsParams::default()).expect("the defaults are usable");
    let mut east = 0.0;
    for observation in observations {
        if let Some(solution) = method.observe(observation).expect("the walk can be tracked") {
            east = solution.position_m.x;
        }
    }
    while let Some(solution) = method.finish_next().expect("the walk can be tracked") {
        east = solution.position_m.x;
    }
    east
}

fn benchmarks(criterion: &mut Criterion) {
    let samples = walk();
    let observations: Vec<Observation> = samples.iter().copied().map(Observation::Imu).collect();
    let mut method = FootIns::new(FootInsParams::default()).expect("the defaults are usable");
    for observation in &observations {
        method.observe(observation).expect("the walk can be tracked");
    }
    println!("state of one walker at 200 Hz: {} bytes", method.state_bytes());

    let mut group = criterion.benchmark_group("foot-ins");
    group.throughput(Throughput::Elements(samples.len() as u64));
    group.sample_size(20).measurement_time(Duration::from_secs(4));

    group.bench_function("predict", |bencher| {
        let noise = SensorNoise::default();
        bencher.iter(|| {
            let mut filter = filter();
            for sample in &samples {
                black_box(filter.predict(sample, 0.005, &noise));
            }
            filter
        });
    });
    group.bench_function("detect", |bencher| {
        bencher.iter(|| {
            let mut detector = StanceDetector::new(StanceParams::default(), 9.80665);
            let mut still = 0_u32;
            for sample in &samples {
                detector.push(*sample);
                still += detector.pop().map_or(0, |(_, stance)| u32::from(stance.is_still()));
            }
            still
        });
    });
    group.bench_function("stream", |bencher| bencher.iter(|| streaming(black_box(&observations))));
    group.sample_size(10);
    group.bench_function("smooth", |bencher| {
        bencher.iter(|| {
            smooth(FootInsParams::default(), black_box(&observations), &mut |_| ()).expect("smooths")
        });
    });
    group.bench_function("fixed-lag-1s", |bencher| {
        bencher.iter(|| {
            let mut method = FixedLag::new(FootInsParams::default(), 1.0).expect("the lag is usable");
            for observation in &observations {
                black_box(method.observe(observation).expect("the walk can be tracked"));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
