//! Time of one range in the filter on ranges, by each weighting: four anchors, forty ranges a second, one in twenty wrong.

#![expect(clippy::expect_used, reason = "a benchmark that cannot run should stop")]

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::Time;
use adit_estimation::ranging::filter::weighting::{Weighting, WeightingKind};
use adit_estimation::ranging::filter::{FilterParams, RangeFilter};
use adit_estimation::ranging::listener::Link;
use adit_estimation::ranging::{RangeModel, Ranged};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const LAB: [[f64; 3]; 4] = [[2.0, 0.2, 3.2], [18.0, 0.2, 2.0], [22.0, 15.8, 3.2], [6.0, 15.8, 2.0]];
const RANGES: u32 = 1000;

fn walk() -> Vec<Link> {
    let model = RangeModel { offset_m: 0.0, scale: 1.0, sigma_m: 0.08 };
    (0..RANGES)
        .map(|tick| {
            let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
            let angle = 0.12 * time_s;
            let at = Vector3::new(12.0 + 7.0 * angle.cos(), 8.0 + 5.0 * angle.sin(), 1.1);
            let position_m = Vector3::from(LAB[anchor]);
            let wrong = if tick % 20 == 7 { 2.0 } else { 0.0 };
            let range_m = (at - position_m).norm() + wrong + 0.05 * f64::from(tick * 7 % 11) - 0.25;
            let time = Time::from_seconds(time_s).expect("a time");
            Link { time, anchor, ranged: Ranged { position_m, model, range_m }, line_of_sight: None }
        })
        .collect()
}

fn benchmarks(criterion: &mut Criterion) {
    let ranges = walk();
    let mut group = criterion.benchmark_group("range-filter");
    group.throughput(Throughput::Elements(u64::from(RANGES)));
    for (name, kind) in
        [("ekf", WeightingKind::Equal), ("rkf", WeightingKind::Igg3), ("aekf", WeightingKind::Adaptive)]
    {
        let weighting = Weighting { kind, ..Weighting::default() };
        let mut filter = RangeFilter::new(FilterParams::default(), weighting).expect("usable settings");
        filter.start_at(Time::ZERO, Vector3::new(19.0, 8.0, 1.1), &Matrix3::identity());
        group.bench_function(name, |bencher| {
            bencher.iter_batched(
                || filter.clone(),
                |mut filter| {
                    for link in &ranges {
                        black_box(filter.observe(link, 0));
                    }
                    filter
                },
                BatchSize::SmallInput,
            );
        });
    }
    group.finish();
}

criterion_group!(all, benchmarks);
criterion_main!(all);
