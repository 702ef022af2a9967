//! `adit demo --walk`: the whole way from a simulated walk to its judged path.

use crate::args::DemoArgs;
use crate::map;
use crate::method::MethodName;
use crate::output::{print, write_file};
use crate::progress;
use crate::scenario_file::Scenario;
use crate::verbs::simulate::simulate;
use crate::verbs::track::{TrackReport, track};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::plot::{evaluation_figure, evaluation_paths, path_figure};
use adit_evaluation::{EvaluationOptions, evaluate};
use adit_observation::tum;
use anyhow::Result;
use std::path::Path;

/// Size of the map in characters.
const MAP: (usize, usize) = (76, 12);

/// What the simulated sensor is, for the filter.
const FILTER: &str = include_str!("../../../../../scenarios/s2-filter.toml");

/// Simulates, tracks, judges and shows.
pub fn run(args: &DemoArgs) -> Result<()> {
    let folder = args.out.as_deref().unwrap_or(Path::new("out/demo"));
    let scenario = Scenario::demo()?;
    let seed = args.seed.unwrap_or(scenario.seed);
    let made = simulate(&scenario, seed, folder)?;
    let (estimate_path, covariance_path) = (folder.join("estimate.tum"), folder.join("estimate.csv"));
    let filter_path = folder.join("filter.toml");
    write_file(&filter_path, FILTER)?;
    let tracked = track(&TrackReport::arguments(
        made.log.clone(),
        MethodName::FootIns,
        filter_path,
        estimate_path.clone(),
        covariance_path,
    ))?;
    progress::warn(tracked.warnings());

    let (estimate, truth) = (tum::read(&estimate_path)?, tum::read(&made.truth)?);
    let judge = |alignment| {
        let options = EvaluationOptions { alignment, ..EvaluationOptions::default() };
        evaluate(&estimate, &truth, &options)
    };
    let (run, start) = (judge(Alignment::Se2)?, judge(Alignment::Start)?);
    let title = format!("Simulated walk, seed {seed}");
    write_file(&folder.join("path.svg"), &path_figure(&evaluation_paths(&start), &title)?)?;
    write_file(&folder.join("evaluation.svg"), &evaluation_figure(&run, &title)?)?;

    let report = &run.report;
    let end = &start.report.end;
    let share =
        end.end_share.map_or_else(String::new, |share| format!(", {:.2} % of the distance", 100.0 * share));
    print(&format!(
        "A simulated walk (seed {seed}), tracked by {method} from the log of a sensor on the foot, against its truth:\n\n\
         {map}\n\
         distance    {distance:.2} m, truth {truth_m:.2} m, ratio {ratio:.4}\n\
         end error   {end_m:.2} m{share}, {vertical_m:.2} m in height (position and heading matched at the start)\n\
         2D RMSE     {rmse_m:.3} m over the run (SE(2) alignment), largest {largest_m:.2} m\n\
         speed       {speed:.0} × real time\n",
        method = MethodName::FootIns.name(),
        map = map::draw(&start.estimate, MAP.0, MAP.1),
        distance = report.travel.path_estimate_m,
        truth_m = report.travel.path_truth_m,
        ratio = report.travel.path_ratio.unwrap_or(f64::NAN),
        end_m = end.end_2d_m,
        vertical_m = end.end_vertical_m,
        rmse_m = report.position.horizontal_m.rmse,
        largest_m = report.position.horizontal_m.max,
        speed = tracked.times_real_time(),
    ))?;
    print(&next(folder))
}

/// What to look at and to try next.
fn next(folder: &Path) -> String {
    let folder = folder.display();
    format!(
        "\nFigures: {folder}/path.svg, {folder}/evaluation.svg\n\nNow try:\n\
         \x20 adit track {folder}/log.mcap --method foot-ins --config {folder}/filter.toml --smooth -o {folder}/smoothed.tum\n\
         \x20 adit eval {folder}/smoothed.tum --truth {folder}/truth.tum --plot {folder}/smoothed.svg\n\
         \x20 adit eval {folder}/estimate.tum --truth {folder}/truth.tum --align start --covariance {folder}/estimate.csv\n\
         \x20 adit track YOUR_LOG.csv --method foot-ins -o your.tum        (adit track --help: what a log looks like)\n"
    )
}
