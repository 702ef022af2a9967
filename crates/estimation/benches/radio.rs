//! Time of one position from 20 access points, by each method.
//!
//! The access points stand at random in a hall of 60 × 40 m; the map has 2,000 places and the survey 400 spots.

#![expect(clippy::expect_used, reason = "a benchmark that cannot run should stop")]

use adit_core::nalgebra::{Vector2, Vector3};
use adit_estimation::radio::centroid::{CentroidWeight, centroid};
use adit_estimation::radio::circles::{CircleParams, inner_points};
use adit_estimation::radio::map::{Hearing, Storeys};
use adit_estimation::radio::nearest::{Fingerprints, NearestParams};
use adit_estimation::radio::path_loss::mean_dbm;
use adit_estimation::radio::signal_fit::{SignalFitParams, signal_fit};
use adit_estimation::radio::trilateration::linear_signals;
use adit_estimation::radio::{AreaPrior, Emitter, Heard, Lattice, MapParams, PathLoss, RadioMap, Reading};
use criterion::{Criterion, criterion_group, criterion_main};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal, Uniform};
use std::hint::black_box;

const ACCESS_POINTS: usize = 20;

fn benchmarks(criterion: &mut Criterion) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (east, north) = (Uniform::new(0.0, 60.0).expect("usable"), Uniform::new(0.0, 40.0).expect("usable"));
    let noise = Normal::new(0.0, 4.0).expect("usable");
    let path_loss =
        PathLoss { rssi_at_1m_dbm: -40.0, exponent: 2.5, breakpoint_m: None, exponent_beyond: None };
    let emitters: Vec<Emitter> = (0..ACCESS_POINTS)
        .map(|_| {
            let position_m = Vector3::new(east.sample(&mut random), north.sample(&mut random), 2.5);
            Emitter { position_m, path_loss, sigma_db: 4.0 }
        })
        .collect();
    let tag = Vector3::new(23.0, 17.0, 1.2);
    let heard: Vec<Heard<'_>> = emitters
        .iter()
        .map(|emitter| {
            let mean = mean_dbm(&path_loss, (emitter.position_m - tag).norm());
            Heard { emitter, rssi_dbm: mean + noise.sample(&mut random) }
        })
        .collect();
    let readings: Vec<Reading> = heard
        .iter()
        .enumerate()
        .map(|(transmitter, one)| Reading { transmitter, value: one.rssi_dbm })
        .collect();
    let lattice = Lattice::within(&Vector2::zeros(), &Vector2::new(59.0, 39.0), 1.1).expect("a lattice");
    let placed: Vec<_> = emitters.iter().map(|emitter| (*emitter, None)).collect();
    let storeys = Storeys { height_m: 3.0, loss_db: 0.0 };
    let hearing = Hearing { half_dbm: -85.0, width_db: 4.0, unsure: 0.1 };
    let map = RadioMap::of_emitters(lattice, &placed, 1.2, &storeys, &hearing).expect("a map");
    let spots: Vec<_> =
        (0..400_u32).map(|k| (Vector2::new(f64::from(k % 20) * 3.0, f64::from(k / 20) * 2.0), 0)).collect();
    #[expect(clippy::cast_possible_truncation, reason = "single precision is what fingerprints have")]
    let mean = |spot: &Vector2<f64>, emitter: &Emitter| {
        mean_dbm(&path_loss, (emitter.position_m - Vector3::new(spot.x, spot.y, 1.2)).norm()) as f32
    };
    let means_dbm =
        spots.iter().flat_map(|(spot, _)| emitters.iter().map(move |emitter| mean(spot, emitter)));
    let means_dbm = means_dbm.collect();
    let prints = Fingerprints { transmitters: ACCESS_POINTS, spots: spots.clone(), means_dbm };
    let area = AreaPrior::of(&spots.iter().map(|(spot, _)| *spot).collect::<Vec<_>>(), 1.0).expect("an area");

    let mut group = criterion.benchmark_group("radio, 20 access points");
    group.bench_function("weighted centroid", |bencher| {
        bencher.iter(|| centroid(black_box(&heard), CentroidWeight::InverseRange));
    });
    group.bench_function("inner points, S1", |bencher| {
        bencher.iter(|| inner_points(black_box(&heard), &CircleParams::default()));
    });
    group.bench_function("trilateration, linear", |bencher| {
        bencher.iter(|| linear_signals(black_box(&heard), 1.2));
    });
    let params = SignalFitParams { height_m: 1.2, ..SignalFitParams::default() };
    group.bench_function("robust fit", |bencher| {
        bencher.iter(|| signal_fit(black_box(&heard), Some(&area), &params));
    });
    group.bench_function("nearest 5 of 400", |bencher| {
        bencher.iter(|| prints.nearest(black_box(&readings), &NearestParams::default()));
    });
    group.bench_function("map of 2000 places", |bencher| {
        bencher.iter(|| map.fix(black_box(&readings), &MapParams::SCAN));
    });
    group.finish();
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
