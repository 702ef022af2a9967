//! Time of a stretch of the way through the bank: one hypothesis without roadways, one on a roadway, eight.

#[path = "../tests/support/roadways.rs"]
mod roadways;
#[path = "../tests/support/trial.rs"]
mod trial;

use adit_core::nalgebra::Vector3;
use adit_estimation::place::bank::Bank;
use adit_estimation::place::roadways::Roadways;
use criterion::{Criterion, criterion_group, criterion_main};
use roadways::{Carrier, Walker};
use std::path::Path;
use std::sync::Arc;
use trial::{params, walk};

fn stretches(criterion: &mut Criterion) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    let Ok((mine, _)) = adit_mine::file::open(Path::new(file)) else { return };
    let roadways = Arc::new(Roadways::new(&mine));
    let carrier = Carrier::foot();
    let walk = walk(&mine, &carrier, &Walker::default(), 1);
    for (name, known, sigma_m) in [
        ("without roadways", None, 0.5),
        ("on a roadway", Some(&roadways), 0.5),
        ("eight hypotheses", Some(&roadways), 200.0),
    ] {
        let mut bank = Bank::new(params(&carrier), known.cloned());
        let mut start = walk.reckoned.start.clone();
        start.covariance[(0, 0)] = sigma_m * sigma_m;
        start.covariance[(1, 1)] = sigma_m * sigma_m;
        bank.start(start);
        let mut stretch = walk.reckoned.stretches[0];
        let mut index = 0;
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                // To and fro over twenty metres: no hypothesis ever dies of it.
                let way = Vector3::new(stretch.way_m.x.abs().max(0.01), 0.0, 0.0);
                stretch.way_m = if index / 30 % 2 == 0 { way } else { -way };
                index += 1;
                bank.walk(&stretch);
            });
        });
        eprintln!("{name}: {} hypotheses, {} bytes", bank.hypotheses().len(), bank.bytes());
    }
}

criterion_group!(benches, stretches);
criterion_main!(benches);
