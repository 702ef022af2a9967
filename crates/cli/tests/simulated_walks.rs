//! `foot-ins` on the simulated walk of system S2: within the paper's error on every seed, and honest about it.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "common/seeds.rs"]
mod seeds;

use adit_evaluation::consistency::AverageNees;
use adit_simulation::ImuErrorModel;

/// Largest error that Kang (2023, table 1) reports over ring and roadway, m.
const PAPER_LARGEST_M: f64 = 0.63;

#[test]
fn the_walk_of_s2_stays_within_the_papers_error_and_its_covariance_is_honest() {
    let runs = seeds::runs(&ImuErrorModel::adis16448_calibrated(), &seeds::s2_filter().unwrap(), 50).unwrap();

    let worst = runs.iter().take(20).map(|run| run.largest_m).fold(0.0, f64::max);
    assert!(worst <= PAPER_LARGEST_M, "worst of 20 seeds: {worst:.3} m");

    let end_share = runs.iter().map(|run| run.end_m / run.distance_m).sum::<f64>() / runs.len() as f64;
    assert!(end_share <= 0.005, "mean end error {:.2} % of the distance", 100.0 * end_share);

    let shortest = runs.iter().map(|run| run.nees.len()).min().unwrap();
    let nees: Vec<Vec<f64>> = runs.into_iter().map(|run| run.nees[..shortest].to_vec()).collect();
    let average = AverageNees::over_runs(3, &nees, 0.95).unwrap();
    assert!(average.bounds.contain(average.mean), "{:.3} outside {:?}", average.mean, average.bounds);
}
