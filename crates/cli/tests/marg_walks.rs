//! `marg-ins` on the simulated walk of system S3: within 1 % of the distance, and no car drags its heading.
//!
//! Three of the twenty seeds of `docs/methods/marg-ins.md`, which `ci/results.sh` runs.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "common/marg_seeds.rs"]
mod marg_seeds;

use marg_seeds::{S3_FILTER, SeedRun, heading_errors_deg, judge, scenario, settings, simulate, track};
use std::path::Path;

const SEEDS: [u64; 3] = [0, 1, 2];
/// 1 % of 80 m: spec S3.
const LIMIT_M: f64 = 0.8;
/// Spec S3, with a disturbance of 30 µT.
const HEADING_LIMIT_DEG: f64 = 3.0;

fn run(file: &str, seed: u64, gated: bool) -> SeedRun {
    let adit = Path::new(env!("CARGO_BIN_EXE_adit"));
    let folder = simulate(adit, &scenario(file), seed).unwrap();
    let (solutions, truth) = track(folder.path(), &settings(S3_FILTER, gated).unwrap()).unwrap();
    assert_eq!(heading_errors_deg(&solutions, &truth).len(), solutions.len());
    judge(&solutions, &truth).unwrap()
}

#[test]
fn the_walk_of_s3_stays_within_one_per_cent() {
    for seed in SEEDS {
        let SeedRun { largest_m, mean_m, return_m, heading_deg, .. } = run("s3.toml", seed, true);
        assert!(
            largest_m <= LIMIT_M && mean_m <= LIMIT_M && return_m <= LIMIT_M,
            "{seed}: {largest_m} {mean_m} {return_m}"
        );
        assert!(heading_deg < HEADING_LIMIT_DEG, "{seed}: {heading_deg}");
    }
}

#[test]
fn steel_cars_do_not_drag_the_heading_that_they_drag_without_the_gate() {
    for file in ["s3-steel.toml", "s3-steel-stop.toml"] {
        let gated = run(file, 1, true);
        assert!(gated.heading_deg < HEADING_LIMIT_DEG, "{file}: {}", gated.heading_deg);
        assert!(gated.heading_within > 0.9, "{file}: {}", gated.heading_within);
    }
    let naive = run("s3-steel-stop.toml", 1, false);
    assert!(naive.heading_deg > 3.0 * HEADING_LIMIT_DEG, "{}", naive.heading_deg);
}
