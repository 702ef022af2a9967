//! `ahrs` on the recorded attitude trials: every trial found, one setting, root mean square errors over the rows that the
//! truth marks, nothing aligned, means over the trials within the limits of [`limits`].
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "common/recorded.rs"]
mod recorded;

use adit_core::solution::Solution;
use adit_core::trajectory::Trajectory;
use adit_estimation::methods::MethodSettings;
use adit_estimation::methods::ahrs::AhrsParams;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::evaluate::trajectory;
use adit_evaluation::{AttitudeEvaluation, EvaluationOptions, WithoutPosition, evaluate_attitude};
use adit_observation::{Observation, open, truth};
use rayon::prelude::*;
use recorded::{folder, trials, truth_file};
use std::path::Path;

const SET: &str = "attitude-broad";

/// What the means over the trials must not exceed, degrees.
struct Limits {
    total: f64,
    heading: f64,
    inclination: f64,
}

/// All limits in one place. A change for the better tightens them.
mod limits {
    use super::Limits;

    /// VQF online reaches 2.57 / 2.39 / 0.77.
    pub const ONLINE: Limits = Limits { total: 1.75, heading: 1.55, inclination: 0.68 };
    /// VQF offline reaches 2.46 / 2.34 / 0.58.
    pub const OFFLINE: Limits = Limits { total: 1.7, heading: 1.5, inclination: 0.6 };
}

/// How a log is tracked.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Online,
    Offline,
}

fn track(observations: &[Observation], mode: Mode) -> Trajectory {
    let settings = AhrsParams::default();
    let solutions: Vec<Solution> = match mode {
        Mode::Offline => settings.smooth(observations, &mut |_| ()).unwrap().0,
        Mode::Online => {
            let mut method = settings.start().unwrap();
            let mut solutions = Vec::with_capacity(observations.len());
            for observation in observations {
                let mut solution = method.observe(observation).unwrap();
                while let Some(now) = solution {
                    solutions.push(now);
                    solution = method.next_due().unwrap();
                }
            }
            while let Some(last) = method.finish_next().unwrap() {
                solutions.push(last);
            }
            solutions
        }
    };
    let samples = observations.iter().filter(|o| matches!(o, Observation::Imu(_))).count();
    assert_eq!(solutions.len(), samples, "a pose for every inertial sample");
    trajectory(&solutions).unwrap()
}

/// Every trial judged; without the magnetometer where that is left out.
fn judged(folder: &Path, mode: Mode, magnetometer: bool) -> Vec<(String, AttitudeEvaluation)> {
    let judge = |(name, log): &(String, _)| {
        let kept = |o: &Observation| magnetometer || matches!(o, Observation::Imu(_));
        let observations: Vec<Observation> = open(log).unwrap().map(Result::unwrap).filter(kept).collect();
        let truth = truth::read(truth_file(folder, name)).unwrap();
        let options = EvaluationOptions {
            alignment: Alignment::None,
            marked: truth.moving,
            ..EvaluationOptions::default()
        };
        let estimate = track(&observations, mode);
        let found =
            evaluate_attitude(&estimate, &truth.trajectory, WithoutPosition::Truth, &options).unwrap();
        (name.clone(), found)
    };
    trials(folder).par_iter().map(judge).collect()
}

fn against_cameras(mode: Mode, limits: &Limits) {
    let Some(folder) = folder(SET) else { return };
    let judged = judged(&folder, mode, true);
    let mut means = [0.0; 3];
    for (name, found) in &judged {
        let attitude = &found.report.attitude;
        let errors = [attitude.total_deg.rmse, attitude.heading_deg.rmse, attitude.inclination_deg.rmse];
        println!("{name}, {mode:?}: {:.3} / {:.3} / {:.3}", errors[0], errors[1], errors[2]);
        for (mean, error) in means.iter_mut().zip(errors) {
            *mean += error / judged.len() as f64;
        }
    }
    println!("{} trials, {mode:?}: {:.3} / {:.3} / {:.3}", judged.len(), means[0], means[1], means[2]);
    for (name, found, limit) in [
        ("total", means[0], limits.total),
        ("heading", means[1], limits.heading),
        ("inclination", means[2], limits.inclination),
    ] {
        assert!(found <= limit, "{mode:?}, mean {name}: {found:.3}°, limit {limit}°");
    }
}

#[test]
fn ahrs_online() {
    against_cameras(Mode::Online, &limits::ONLINE);
}

#[test]
fn ahrs_offline() {
    against_cameras(Mode::Offline, &limits::OFFLINE);
}

#[test]
fn the_inclination_needs_no_magnetometer() {
    let Some(folder) = folder(SET) else { return };
    for (mode, limits) in [(Mode::Online, limits::ONLINE), (Mode::Offline, limits::OFFLINE)] {
        let judged = judged(&folder, mode, false);
        let sum: f64 = judged.iter().map(|(_, found)| found.report.attitude.inclination_deg.rmse).sum();
        let mean = sum / judged.len() as f64;
        println!("{} trials without magnetometer, {mode:?}: inclination {mean:.3}", judged.len());
        assert!(mean <= limits.inclination, "{mode:?}: {mean:.3}°, limit {}°", limits.inclination);
    }
}
