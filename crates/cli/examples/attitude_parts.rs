//! What each part of `ahrs` is worth: the recorded attitude trials with one part left out at a time.
//!
//! `attitude_parts DATA TABLE.md FIGURE.svg` takes the folder of the sets, and writes a table of the mean total errors and a
//! figure of the heading error of one trial with and without the delay of the magnetometer. `ci/results.sh` calls it.
//!
//! A part is left out by a setting, as anybody can do by `adit track --config`; the table names it.

use adit_core::solution::Solution;
use adit_estimation::methods::ahrs::AhrsParams;
use adit_estimation::methods::{Method, MethodError, MethodSettings};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::evaluate::trajectory;
use adit_evaluation::plot::{TimeCurve, time_figure};
use adit_evaluation::{AttitudeEvaluation, EvaluationOptions, WithoutPosition, evaluate_attitude};
use adit_observation::truth::{self, Truth};
use adit_observation::{Observation, open};
use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const SET: &str = "attitude-broad";
/// The trial of the figure: rotation and translation at once, up to 800 °/s.
const SHOWN: &str = "21_undisturbed_fast_combined";
/// What is left out, and the settings that do it.
const PARTS: [(&str, &str); 8] = [
    ("nothing", ""),
    ("delay of the magnetometer", "initial.delay_s = 0.0"),
    ("error of the gyro that grows with the rate", "noise.rate_share = 0.0"),
    ("anomaly of the field from place to place", "field_anomaly_ut = 0.01"),
    ("rejection of disturbed fields", "disturbance = { norm_share = 10.0, dip_rad = 10.0 }"),
    ("adoption of new offsets and sites", "disturbance.adopt_after_s = 1000.0"),
    ("scale factors of the gyro", "initial.gyro_scale = 0.0"),
    ("bound of the velocity (3 m/s instead of 0.5)", "velocity_m_s = 3.0"),
];

struct Trial {
    name: String,
    log: Vec<Observation>,
    truth: Truth,
}

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [data, table, figure] = arguments.as_slice() else {
        bail!("usage: attitude_parts DATA TABLE.md FIGURE.svg")
    };
    let folder = data.join(SET);
    if !folder.is_dir() {
        println!("SKIPPED (no test data): {SET}");
        return Ok(());
    }
    let trials = trials(&folder)?;
    let mut text = String::from("| left out | setting | online ° | `--smooth` ° |\n|---|---|---|---|\n");
    for (part, setting) in PARTS {
        let params: AhrsParams = toml::from_str(setting).with_context(|| part.to_owned())?;
        let [online, smoothed] = [mean_total(&trials, &params, false)?, mean_total(&trials, &params, true)?];
        let setting = if setting.is_empty() { String::from("–") } else { format!("`{setting}`") };
        writeln!(text, "| {part} | {setting} | {online:.2} | {smoothed:.2} |")?;
    }
    std::fs::write(table, text).with_context(|| table.display().to_string())?;

    let trial = trials.iter().find(|trial| trial.name.starts_with(SHOWN)).context(SHOWN)?;
    let without = AhrsParams { initial: toml::from_str("delay_s = 0.0")?, ..AhrsParams::default() };
    let curves = [
        curve("delay left out", &judge(trial, &without, false)?),
        curve("ahrs", &judge(trial, &AhrsParams::default(), false)?),
        curve("ahrs --smooth", &judge(trial, &AhrsParams::default(), true)?),
    ];
    let svg =
        time_figure(&curves, "Fast motion: a magnetometer that answers 15 ms late", "heading error, °")?;
    std::fs::write(figure, svg).with_context(|| figure.display().to_string())
}

fn trials(folder: &Path) -> Result<Vec<Trial>> {
    let mut trials = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some((name, end)) = file.split_once("_imu.csv") else { continue };
        let log = open(&path)?.collect::<Result<Vec<_>, _>>()?;
        let truth = truth::read(folder.join(format!("{name}_truth.csv{end}")))?;
        trials.push(Trial { name: name.to_owned(), log, truth });
    }
    trials.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(trials)
}

/// Mean over the trials of the root mean square of the total error, degrees.
fn mean_total(trials: &[Trial], params: &AhrsParams, smoothed: bool) -> Result<f64> {
    let judged: Vec<f64> = trials
        .par_iter()
        .map(|trial| Ok(judge(trial, params, smoothed)?.report.attitude.total_deg.rmse))
        .collect::<Result<_>>()?;
    Ok(judged.iter().sum::<f64>() / judged.len() as f64)
}

fn judge(trial: &Trial, params: &AhrsParams, smoothed: bool) -> Result<AttitudeEvaluation> {
    let solutions = if smoothed {
        params.clone().smooth(&trial.log, &mut |_| ())?.0
    } else {
        let mut method = params.clone().start()?;
        stream(method.as_mut(), &trial.log)?
    };
    let options = EvaluationOptions {
        alignment: Alignment::None,
        marked: trial.truth.moving.clone(),
        ..EvaluationOptions::default()
    };
    let estimate = trajectory(&solutions)?;
    Ok(evaluate_attitude(&estimate, &trial.truth.trajectory, WithoutPosition::Truth, &options)?)
}

fn stream<M: Method + ?Sized>(method: &mut M, log: &[Observation]) -> Result<Vec<Solution>, MethodError> {
    let mut solutions = Vec::with_capacity(log.len());
    for observation in log {
        let mut solution = method.observe(observation)?;
        while let Some(now) = solution {
            solutions.push(now);
            solution = method.next_due()?;
        }
    }
    while let Some(last) = method.finish_next()? {
        solutions.push(last);
    }
    Ok(solutions)
}

fn curve(label: &str, judged: &AttitudeEvaluation) -> TimeCurve {
    let points = judged.times.iter().zip(&judged.errors);
    let points =
        points.map(|(time, error)| (time.seconds(), error.signed_heading_rad.to_degrees())).collect();
    TimeCurve { label: label.to_owned(), points }
}
