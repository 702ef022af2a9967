//! Prints how `foot-ins` does on the simulated walk of system S2 over many seeds, as Markdown.
//!
//! `cargo run --release -p adit-cli --example simulated_walks`; called by `ci/results.sh`.

#[path = "../tests/common/seeds.rs"]
mod seeds;

use adit_estimation::methods::foot_ins::FootInsParams;
use adit_evaluation::consistency::AverageNees;
use adit_simulation::ImuErrorModel;
use anyhow::Result;
use seeds::SeedRun;

const SEEDS: u64 = 50;
/// Seeds of the comparison with the paper.
const OF_PAPER: usize = 20;

fn main() -> Result<()> {
    let told = seeds::s2_filter()?;
    let untold = FootInsParams::default();
    let rows = [
        (
            "ADIS16448, scale factors calibrated to 0.05 %",
            "its data sheet",
            ImuErrorModel::adis16448_calibrated(),
            &told,
        ),
        (
            "ADIS16448, scale factors calibrated to 0.05 %",
            "the defaults",
            ImuErrorModel::adis16448_calibrated(),
            &untold,
        ),
        ("ADIS16448 as delivered, scale factors ±1 %", "the defaults", ImuErrorModel::adis16448(), &untold),
        ("3DM-GX5-25", "the defaults", ImuErrorModel::microstrain_gx5_25(), &untold),
    ];
    println!(
        "| sensor | filter knows | largest error, mean of {OF_PAPER} seeds | worst seed | end error, mean | of distance | NEES over {SEEDS} seeds | 95 % interval | seconds inside |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|---:|---:|");
    for (sensor, knows, model, params) in rows {
        let runs = seeds::runs(&model, params, SEEDS)?;
        let paper = &runs[..OF_PAPER];
        let mean = |of: &dyn Fn(&SeedRun) -> f64| paper.iter().map(of).sum::<f64>() / OF_PAPER as f64;
        let worst = paper.iter().map(|run| run.largest_m).fold(0.0, f64::max);
        let (largest, end) = (mean(&|run| run.largest_m), mean(&|run| run.end_m));
        let share = 100.0 * mean(&|run| run.end_m / run.distance_m);
        let shortest = runs.iter().map(|run| run.nees.len()).min().unwrap_or(0);
        let nees: Vec<Vec<f64>> = runs.iter().map(|run| run.nees[..shortest].to_vec()).collect();
        let nees = AverageNees::over_runs(3, &nees, 0.95)?;
        println!(
            "| {sensor} | {knows} | {largest:.2} m | {worst:.2} m | {end:.2} m | {share:.2} % | {:.2} | {:.2}–{:.2} | {:.0} % |",
            nees.mean,
            nees.bounds.lower,
            nees.bounds.upper,
            100.0 * nees.share_inside
        );
    }
    Ok(())
}
