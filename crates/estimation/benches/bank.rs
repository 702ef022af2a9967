//! Time of a stretch of the way through the bank: one hypothesis without roadways, one on a roadway, eight.

use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_estimation::place::bank::{Bank, BankParams};
use adit_estimation::place::roadways::Roadways;
use adit_estimation::place::state::{FACTOR, HeadingError, NORTH, State, Stretch, TURN, Vector};
use adit_mine::Mine;
use adit_mine::plan::{Grid, MinePlan, Roadway, RoadwayKind};
use criterion::{Criterion, criterion_group, criterion_main};
use std::sync::Arc;

/// Parallel roadways, 40 m apart, that nothing tells apart.
fn parallel() -> Mine {
    let mut plan = MinePlan::new("parallel", Grid::Local {});
    for index in 0..12 {
        let north_m = 40.0 * f64::from(index);
        plan.roadways.push(Roadway {
            id: format!("r{index}"),
            name: None,
            level: None,
            kind: RoadwayKind::Drift,
            width_m: 4.0,
            height_m: 3.0,
            max_slope_percent: None,
            walkable: true,
            points_m: vec![Position::new(-500.0, north_m, 0.0), Position::new(500.0, north_m, 0.0)],
        });
    }
    Mine::unchecked(plan)
}

fn stretches(criterion: &mut Criterion) {
    let roadways = Arc::new(Roadways::new(&parallel()));
    let cases = [
        ("without roadways", None, 0.5),
        ("on a roadway", Some(&roadways), 0.5),
        ("eight hypotheses", Some(&roadways), 300.0),
    ];
    for (name, known, sigma_m) in cases {
        let mut sigmas = Vector::zeros();
        (sigmas[NORTH], sigmas[TURN], sigmas[FACTOR]) = (sigma_m, 0.03, 0.01);
        let mut state = State::new(&sigmas.component_mul(&sigmas));
        state.position_m.y = 200.0;
        let mut bank = Bank::new(BankParams { tag_height_m: 0.0, ..BankParams::default() }, known.cloned());
        bank.start(state);
        let mut index = 0;
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                // To and fro over twenty metres, 0.4 m each: a strapdown's 0.3 s.
                let east_m = if index / 50 % 2 == 0 { 0.4 } else { -0.4 };
                index += 1;
                bank.walk(&Stretch {
                    way_m: Vector3::new(east_m, 0.0, 0.0),
                    drifting: 0.3,
                    turned_rad: 0.0,
                    along_m2: 1e-5,
                    across_m2: 1e-5,
                    up_m2: 1e-5,
                    about_m2: 0.0,
                    heading: HeadingError::Gyro { walk_rad2: 1e-8 },
                    turn_rad2: 0.0,
                    drift2: 0.0,
                    iron_rad2: 0.0,
                    factor2: 0.0,
                    barometer_m2: 0.0,
                });
            });
        });
        println!("{name}: {} hypotheses, {} bytes", bank.hypotheses().len(), bank.bytes());
    }
}

criterion_group!(benches, stretches);
criterion_main!(benches);
