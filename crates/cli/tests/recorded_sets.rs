//! `foot-ins` on the recorded foot-mounted sets: every trial found, one setting, figures as the independent scorer of the
//! acceptance takes them, within the limits of [`limits`].
//!
//! Definitions: the estimate is interpolated at the truth's stamps and must cover 95 % of them. 2D RMSE: horizontal, after an
//! SE(2) fit over the run. End errors: last sample, after matching position and heading at the start. Shares and path ratios
//! leave out trials whose true path is 2 m or less.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "common/recorded.rs"]
mod recorded;

use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_core::trajectory::Trajectory;
use adit_estimation::methods::foot_ins::{FootIns, FootInsParams, smooth};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::evaluate::trajectory;
use adit_evaluation::travel::chord_length_m;
use adit_evaluation::{Evaluation, EvaluationOptions, evaluate};
use adit_observation::{Observation, open, truth};
use rayon::prelude::*;
use recorded::{folder, trials, truth_file};
use std::path::Path;

/// What a set must not exceed; shares are of the true path.
struct Limits {
    rmse_2d_mean_m: f64,
    rmse_2d_median_m: f64,
    rmse_2d_worst_m: f64,
    end_2d_mean_m: f64,
    end_share_mean: f64,
    end_vertical_mean_m: f64,
    /// Distance of the mean path ratio from 1.
    path_ratio_off: f64,
}

/// All limits in one place. A change for the better tightens them.
mod limits {
    use super::Limits;

    pub const VICON: Limits = Limits {
        rmse_2d_mean_m: 0.079,
        rmse_2d_median_m: 0.059,
        rmse_2d_worst_m: 0.30,
        end_2d_mean_m: 0.10,
        end_share_mean: 0.006,
        end_vertical_mean_m: 0.15,
        path_ratio_off: 0.02,
    };
    pub const HALLWAY: Limits = Limits {
        rmse_2d_mean_m: 0.25,
        rmse_2d_median_m: 0.25,
        rmse_2d_worst_m: 0.35,
        end_2d_mean_m: 1.0,
        end_share_mean: 0.010,
        end_vertical_mean_m: 0.5,
        path_ratio_off: 0.02,
    };
    /// Distance in space from first to last position of a walk that ends where it began, as a share of the path:
    /// 0.15 m of 24.5 m and 0.40 m of 61.5 m.
    pub const LOOP_END_SHARE: f64 = 0.0061;
}

/// How a log is tracked.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Streaming,
    Smoothed,
}

/// A figure over the trials of a set.
#[derive(Debug)]
struct Spread {
    mean: f64,
    median: f64,
    most: f64,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len();
        assert!(count > 0, "no trial to judge");
        Self {
            mean: sorted.iter().sum::<f64>() / count as f64,
            median: 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]),
            most: sorted[count - 1],
        }
    }
}

fn track(log: &Path, mode: Mode) -> Trajectory {
    let observations: Vec<Observation> = open(log).unwrap().collect::<Result<_, _>>().unwrap();
    let samples = observations.iter().filter(|o| matches!(o, Observation::Imu(_))).count();
    let params = FootInsParams::default();
    let solutions: Vec<Solution> = match mode {
        Mode::Smoothed => smooth(params, &observations, &mut |_| ()).unwrap().0,
        Mode::Streaming => {
            let mut method = FootIns::new(params).unwrap();
            let mut solutions: Vec<Solution> =
                observations.iter().filter_map(|observation| method.observe(observation).unwrap()).collect();
            while let Some(solution) = method.finish_next().unwrap() {
                solutions.push(solution);
            }
            solutions
        }
    };
    assert_eq!(solutions.len(), samples, "{}: a pose for every inertial sample", log.display());
    trajectory(&solutions).unwrap()
}

fn against_truth(set: &str, start_distance_m: f64, limits: &Limits, mode: Mode) {
    let Some(folder) = folder(set) else { return };
    let judged: Vec<(Evaluation, Evaluation)> = trials(&folder)
        .par_iter()
        .map(|(name, log)| {
            let truth = truth::read(truth_file(&folder, name)).unwrap().trajectory;
            let estimate = track(log, mode);
            let judge = |alignment| {
                let options = EvaluationOptions {
                    alignment,
                    start_distance_m,
                    attitude: false,
                    ..EvaluationOptions::default()
                };
                evaluate(&estimate, &truth, &options).unwrap()
            };
            (judge(Alignment::Se2), judge(Alignment::Start))
        })
        .collect();

    let rmse = Spread::of(judged.iter().map(|(run, _)| run.report.position.horizontal_m.rmse));
    let end = Spread::of(judged.iter().map(|(_, start)| start.report.end.end_2d_m));
    let vertical = Spread::of(judged.iter().map(|(_, start)| start.report.end.end_vertical_m));
    let walked = || judged.iter().filter(|(run, _)| run.report.travel.path_truth_m > 2.0);
    let share = Spread::of(walked().filter_map(|(_, start)| start.report.end.end_share));
    let ratio = Spread::of(walked().filter_map(|(run, _)| run.report.travel.path_ratio));
    println!("{set}, {mode:?}, {} trials", judged.len());
    for (figure, spread) in [
        ("2D RMSE, m", &rmse),
        ("end error, m", &end),
        ("end error, share of path", &share),
        ("vertical end error, m", &vertical),
        ("path ratio", &ratio),
    ] {
        let Spread { mean, median, most } = spread;
        println!("  {figure:<26} mean {mean:.4}  median {median:.4}  most {most:.4}");
    }

    let checks = [
        ("mean 2D RMSE", rmse.mean, limits.rmse_2d_mean_m),
        ("median 2D RMSE", rmse.median, limits.rmse_2d_median_m),
        ("worst 2D RMSE", rmse.most, limits.rmse_2d_worst_m),
        ("mean end error", end.mean, limits.end_2d_mean_m),
        ("mean end share", share.mean, limits.end_share_mean),
        ("mean vertical end error", vertical.mean, limits.end_vertical_mean_m),
        ("path ratio, off 1", (ratio.mean - 1.0).abs(), limits.path_ratio_off),
    ];
    let over: Vec<String> = checks
        .iter()
        .filter(|(_, found, limit)| found.is_nan() || found > limit)
        .map(|(figure, found, limit)| format!("{figure}: {found:.4}, limit {limit}"))
        .collect();
    assert!(over.is_empty(), "{set}, {mode:?}: {}", over.join("; "));
}

#[test]
fn foot_vicon_streaming() {
    against_truth("foot-vicon", 1.0, &limits::VICON, Mode::Streaming);
}

#[test]
fn foot_vicon_smoothed() {
    against_truth("foot-vicon", 1.0, &limits::VICON, Mode::Smoothed);
}

#[test]
fn foot_hallway_streaming() {
    against_truth("foot-hallway", 2.0, &limits::HALLWAY, Mode::Streaming);
}

#[test]
fn foot_hallway_smoothed() {
    against_truth("foot-hallway", 2.0, &limits::HALLWAY, Mode::Smoothed);
}

#[test]
fn foot_loops_end_where_they_began() {
    let Some(folder) = folder("foot-loops") else { return };
    // Some walks of this set are open; its README names the closed ones so.
    let closed = trials(&folder).into_iter().filter(|(name, _)| name.ends_with("_walk"));
    let mut over = Vec::new();
    for ((name, log), mode) in
        closed.flat_map(|trial| [(trial.clone(), Mode::Streaming), (trial, Mode::Smoothed)])
    {
        let path = track(&log, mode);
        let positions: Vec<Vector3<f64>> = path.poses().iter().map(|pose| pose.position_m).collect();
        let end_m = (positions[positions.len() - 1] - positions[0]).norm();
        let distance_m = chord_length_m(&positions);
        let share = end_m / distance_m;
        println!(
            "{name}, {mode:?}: distance {distance_m:.2} m, end error in space {end_m:.3} m, {:.2} %",
            100.0 * share
        );
        if share.is_nan() || share > limits::LOOP_END_SHARE {
            over.push(format!("{name}, {mode:?}: {share:.4}, limit {}", limits::LOOP_END_SHARE));
        }
    }
    assert!(over.is_empty(), "{}", over.join("; "));
}
