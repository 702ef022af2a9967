//! Scans and ranging epochs per second in the example mine of two levels, with and without impulse responses, while walking.

use adit_core::nalgebra::Vector3;
use adit_simulation::radio::{Antenna, Obstacle, RadioSpec, RadioWorld, RangeDetail, Surroundings};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;

/// A tag that walks back and forth on the longest edge, with 200 people along the mine.
fn speed(criterion: &mut Criterion) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines/two-level.toml");
    let Ok((mine, _)) = adit_mine::file::open(&file) else { return };
    let Some(edge) = mine.network().edges().iter().max_by(|a, b| a.length_m().total_cmp(&b.length_m()))
    else {
        return;
    };
    let people: Vec<Obstacle> = (0..200)
        .map(|i| {
            let edges = mine.network().edges();
            let edge = &edges[i % edges.len()];
            Obstacle::person(*edge.at(0.3 * edge.length_m()).raw())
        })
        .collect();
    let around = Surroundings { obstacles: &people, conveyors_run: true };
    let Ok(world) = RadioWorld::new(mine.clone(), &RadioSpec::default(), &[], 1) else { return };
    let at = |epoch: u32, rate_hz: f64| {
        let along = (f64::from(epoch) * 1.3 / rate_hz) % edge.length_m();
        let position_m = edge.at(along).raw() + Vector3::new(0.0, 0.0, 1.3);
        Antenna { position_m, facing_rad: Some(0.4) }
    };
    let mut group = criterion.benchmark_group("radio");
    group.throughput(Throughput::Elements(1));
    for (name, detail) in [
        ("ranging_epoch", RangeDetail::Range),
        ("ranging_epoch_with_responses", RangeDetail::ImpulseResponse),
    ] {
        let (mut tag, mut epoch, mut out) = (world.tag(1).with_detail(detail), 0_u32, Vec::new());
        let mut ranges = 0_u64;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                epoch += 1;
                out.clear();
                tag.ranges(&world, f64::from(epoch) * 0.1, &at(epoch, 10.0), &around, &mut out);
                ranges += out.len() as u64;
                black_box(out.len())
            });
        });
        println!("{name}: {:.1} ranges per epoch", ranges as f64 / f64::from(epoch));
    }
    let (mut tag, mut scan, mut out) = (world.tag(1), 0_u32, Vec::new());
    group.bench_function("scan", |bencher| {
        bencher.iter(|| {
            scan += 1;
            out.clear();
            tag.scan(&world, f64::from(scan), &at(scan, 1.0), &around, &mut out);
            black_box(out.len())
        });
    });
    println!("scan: {} heard in the last one", out.len());
    group.finish();
}

criterion_group!(benches, speed);
criterion_main!(benches);
