//! Half an hour without infrastructure, by dead reckoning and roadways: `cargo run -p adit-estimation --example roadway_walks [SEEDS] [MINE.toml] [CASE]`.
//!
//! With a case and `TRACE=<seed>` it tells that walk, moment by moment.
#![expect(clippy::unwrap_used, reason = "what tests share")]

#[path = "../tests/support/roadways.rs"]
mod roadways;
#[path = "../tests/support/trial.rs"]
mod trial;

use adit_core::nalgebra::Vector3;
use adit_estimation::place::bank::{Bank, Estimate};
use adit_estimation::place::roadways::Roadways;
use roadways::{Carrier, Walker};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use trial::{Trial, follow, params, radius_m, walk};

fn main() -> Result<(), Box<dyn Error>> {
    let seeds: u64 = std::env::args().nth(1).map_or(Ok(100), |seeds| seeds.parse())?;
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    let file = std::env::args().nth(2).unwrap_or(here.into());
    let only = std::env::args().nth(3);
    let trace: Option<u64> = std::env::var("TRACE").ok().and_then(|seed| seed.parse().ok());
    let (mine, _) = adit_mine::file::open(Path::new(&file))?;
    let roadways = Arc::new(Roadways::new(&mine));
    let turning = Walker::default();
    let steady = Walker { goes_on: 0.85, ..turning };
    let cases = [
        ("foot", Carrier::foot(), turning),
        ("foot, long straights", Carrier::foot(), steady),
        ("poor foot", Carrier::poor_foot(), turning),
        ("poor foot, long straights", Carrier::poor_foot(), steady),
        ("waist", Carrier::waist(), turning),
        ("waist, long straights", Carrier::waist(), steady),
        ("waist, start known by 20 m", Carrier { start_m: 20.0, ..Carrier::waist() }, turning),
        ("foot, start known by 20 m", Carrier { start_m: 20.0, ..Carrier::foot() }, turning),
        ("waist, direction known by 25°", Carrier { start_heading_rad: 0.44, ..Carrier::waist() }, turning),
        ("waist, direction not known", Carrier { start_heading_rad: 1.8, ..Carrier::waist() }, turning),
        ("poor waist", Carrier::poor_waist(), turning),
        ("poor waist, long straights", Carrier::poor_waist(), steady),
    ];
    println!(
        "| {seeds} seeds | end: mean | 95 % | worst | without map: mean | 95 % | inside | wrong roadway | lost | hypotheses | jump |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (name, carrier, walker) in cases {
        if only.as_deref().is_some_and(|only| only != name) {
            continue;
        }
        let (mut held, mut free) = (Vec::new(), Vec::new());
        for seed in 1..=seeds {
            let walk = walk(&mine, &carrier, &walker, seed);
            let told = |bank: &Bank, estimate: &Estimate, truth: &Vector3<f64>, walked_m: f64| {
                if trace == Some(seed) {
                    tell(bank, estimate, truth, walked_m);
                }
            };
            held.push(follow(&walk, Some(&roadways), params(&carrier), seed, told));
            free.push(follow(&walk, None, params(&carrier), seed, |_, _, _, _| {}));
        }
        let mean = |of: fn(&Trial) -> f64| held.iter().map(of).sum::<f64>() / held.len() as f64;
        let [ends, free] = [&held, &free].map(|trials| {
            let mut ends: Vec<f64> =
                trials.iter().map(|trial| 100.0 * trial.end_m / trial.walked_m).collect();
            ends.sort_by(f64::total_cmp);
            ends
        });
        let at = |ends: &[f64], per_cent: usize| ends[(per_cent * (ends.len() - 1) + 50) / 100];
        println!(
            "| {name} | {:.2} % | {:.2} % | {:.2} % | {:.2} % | {:.2} % | {:.1} % | {:.2} % | {:.2} % | {:.2} | {:.2} |",
            ends.iter().sum::<f64>() / ends.len() as f64,
            at(&ends, 95),
            at(&ends, 100),
            free.iter().sum::<f64>() / free.len() as f64,
            at(&free, 95),
            100.0 * mean(|trial| trial.inside),
            100.0 * mean(|trial| trial.wrong),
            100.0 * mean(|trial| trial.lost),
            mean(|trial| trial.hypotheses),
            held.iter().map(|trial| trial.jump).fold(0.0, f64::max),
        );
        held.sort_by(|a, b| (b.end_m / b.walked_m).total_cmp(&(a.end_m / a.walked_m)));
        for trial in held.iter().take(if only.is_some() { 8 } else { 0 }) {
            println!(
                "seed {}: end {:.1} m of {:.0} m, largest {:.1} m, inside {:.1} %, wrong {:.1} %",
                trial.seed,
                trial.end_m,
                trial.walked_m,
                trial.largest_m,
                100.0 * trial.inside,
                100.0 * trial.wrong
            );
        }
    }
    Ok(())
}

fn tell(bank: &Bank, estimate: &Estimate, truth: &Vector3<f64>, walked_m: f64) {
    let off_m = (estimate.position_m - truth).xy().norm();
    let lost = if estimate.lost { "lost" } else { "" };
    let (at, radius_m) = (estimate.position_m, radius_m(estimate));
    print!(
        "{walked_m:6.0} m: {off_m:6.1} of {radius_m:6.1}, {:.0} {:.0} {:.0} at {:.0} {:.0} {:.0} {lost}",
        truth.x, truth.y, truth.z, at.x, at.y, at.z
    );
    for known in bank.hypotheses() {
        let (state, sigma_rad) = (&known.state, known.state.direction_rad2().sqrt());
        print!(
            "; {:?} {:.0} {:.0} w {:.2} f {:.2} t {:.0}±{:.0} s {:.1}",
            known.place,
            state.position_m.x,
            state.position_m.y,
            known.weight(),
            state.factor,
            state.turn_rad.to_degrees(),
            sigma_rad.to_degrees(),
            known.strain
        );
    }
    println!();
}
