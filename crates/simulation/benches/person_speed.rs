//! How fast a person's sensors are simulated.
#![expect(clippy::unwrap_used, reason = "benchmark")]

use adit_mine::Mine;
use adit_simulation::people::{Belt, PopulationSpec, VehicleSpec};
use adit_simulation::scenario::Generator;
use adit_simulation::{Foot, IdealImu, ImuErrorModel, Motion, Person, Population};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

fn somebody() -> Person {
    let mine = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    let (mine, _): (Mine, _) = adit_mine::file::open(std::path::Path::new(mine)).unwrap();
    let spec =
        PopulationSpec { people: 1, vehicles: vec![VehicleSpec::on("ore")], ..PopulationSpec::default() };
    Population::new(&mine, &spec, 7).unwrap().person(0).unwrap().unwrap()
}

fn speed(criterion: &mut Criterion) {
    let person = somebody();
    let mut group = criterion.benchmark_group("person");
    group.sample_size(20);
    group.bench_function("lay an 8 h shift and its steps", |b| {
        b.iter(|| black_box(&person).waist(Belt::back()));
    });
    let (waist, foot) = (person.waist(Belt::back()), person.foot(Foot::instep(), false));
    // 1000 s of the shift, 10 s apart from start to end, at 100 Hz.
    let times: Vec<f64> = (0..1000).map(|i| f64::from(i) * 28.0 + f64::from(i % 100) * 0.01).collect();
    group.throughput(Throughput::Elements(times.len() as u64));
    group.bench_function("coarse view", |b| {
        b.iter(|| times.iter().map(|t| person.at(*t).floor_m.x).sum::<f64>());
    });
    group
        .bench_function("waist", |b| b.iter(|| times.iter().map(|t| waist.at(*t).position_m.x).sum::<f64>()));
    group.bench_function("foot", |b| b.iter(|| times.iter().map(|t| foot.at(*t).position_m.x).sum::<f64>()));
    group.throughput(Throughput::Elements(60_000));
    group.bench_function("waist IMU, 10 min at 100 Hz", |b| {
        b.iter(|| {
            let imu = Generator::new(waist.clone(), IdealImu::default(), 100.0, &ImuErrorModel::mpu6050(), 1);
            imu.unwrap().take(60_000).map(|(sample, _)| sample.specific_force_m_s2.x).sum::<f64>()
        });
    });
    group.finish();
}

criterion_group!(benches, speed);
criterion_main!(benches);
