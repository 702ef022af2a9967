//! Steps of `pdr` on the recorded sets: one setting for every person and every place of the tag.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "common/recorded.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod recorded;

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_estimation::methods::pdr::{Pdr, PdrParams};
use adit_estimation::pedestrian::steps::{StepDetector, StepParams};
use adit_observation::{Observation, open};
use recorded::{folder, trials};
use std::collections::HashMap;
use std::path::Path;

/// Mean and worst error of the count, %. The goals of the project are 0.5 and 1.5, and 3 in the mean.
const STEPS: (f64, f64) = (0.5, 1.5);
const LOWBACK_MEAN: f64 = 3.0;
/// Replayed slower and faster, thinned and turned, the same people are to be counted nearly as well.
const CHANGED_STEPS: (f64, f64) = (0.6, 1.8);
const CHANGED_LOWBACK_MEAN: f64 = 4.0;

type Sample = (Time, Vector3<f64>);

/// Name, specific forces and true count of every recording.
fn recordings(folder: &Path, table: &str) -> Vec<(String, Vec<Sample>, f64)> {
    let text = std::fs::read_to_string(folder.join(table)).unwrap();
    let column = text.lines().next().unwrap().split(',').position(|name| name == "steps_true").unwrap();
    let counts: HashMap<&str, f64> = text
        .lines()
        .skip(1)
        .map(|line| (line.split(',').next().unwrap(), line.split(',').nth(column).unwrap().parse().unwrap()))
        .collect();
    let forces = |path: &Path| {
        let force = |observation: Observation| match observation {
            Observation::Imu(imu) => Some((imu.time, imu.specific_force_m_s2)),
            Observation::Acceleration(sample) => Some((sample.time, sample.specific_force_m_s2)),
            _ => None,
        };
        open(path).unwrap().filter_map(|observation| force(observation.unwrap())).collect()
    };
    trials(folder)
        .into_iter()
        .map(|(name, path)| (name.clone(), forces(&path), counts[name.as_str()]))
        .collect()
}

fn count(samples: &[Sample], changed: impl Fn(usize, &Sample) -> Option<Sample>) -> f64 {
    let mut detector = StepDetector::new(&StepParams::default());
    for (index, sample) in samples.iter().enumerate() {
        if let Some((time, force)) = changed(index, sample) {
            detector.observe(time, &force);
        }
    }
    detector.end();
    core::iter::from_fn(|| detector.pop()).map(|_| 1.0).sum()
}

/// Mean and worst error, %.
fn errors(
    recordings: &[(String, Vec<Sample>, f64)],
    changed: impl Fn(usize, &Sample) -> Option<Sample>,
) -> (f64, f64) {
    let error = |(name, samples, truth): &(String, Vec<Sample>, f64)| {
        let found = count(samples, &changed);
        println!("{name}: {found} of {truth}");
        100.0 * (found - truth).abs() / truth
    };
    let errors: Vec<f64> = recordings.iter().map(error).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    (mean, errors.iter().fold(0.0, |worst: f64, error| worst.max(*error)))
}

fn later(time: Time, factor: f64) -> Time {
    Time::from_seconds(time.seconds() * factor).unwrap()
}

#[test]
fn the_steps_of_every_carrying_position_are_counted() {
    let Some(folder) = folder("steps") else { return };
    let recordings = recordings(&folder, "counts.csv");
    let (mean, worst) = errors(&recordings, |_, sample| Some(*sample));
    println!("steps: {mean:.2} / {worst:.2} %");
    assert!(mean <= STEPS.0 && worst <= STEPS.1, "{mean} {worst}");
    let turn = attitude::exp(&Vector3::new(1.0, -2.0, 0.7));
    for (name, change) in [
        ("slower", Box::new(|_: usize, s: &Sample| Some((later(s.0, 1.3), s.1))) as Box<dyn Fn(_, &_) -> _>),
        ("faster", Box::new(|_, s: &Sample| Some((later(s.0, 0.75), s.1)))),
        ("every second", Box::new(|index, s: &Sample| (index % 2 == 0).then_some(*s))),
        ("every fourth", Box::new(|index, s: &Sample| (index % 4 == 0).then_some(*s))),
        ("turned", Box::new(move |_, s: &Sample| Some((s.0, turn * s.1)))),
    ] {
        let (mean, worst) = errors(&recordings, change);
        println!("steps, {name}: {mean:.2} / {worst:.2} %");
        assert!(mean <= CHANGED_STEPS.0 && worst <= CHANGED_STEPS.1, "{name}: {mean} {worst}");
    }
}

#[test]
fn the_steps_of_ten_people_with_a_turn_are_counted() {
    let Some(folder) = folder("gait-lowback") else { return };
    let recordings = recordings(&folder, "trials.csv");
    let (mean, worst) = errors(&recordings, |_, sample| Some(*sample));
    println!("gait-lowback: {mean:.2} / {worst:.2} %");
    assert!(mean <= LOWBACK_MEAN, "{mean}");
    for (name, change) in [
        ("slower", Box::new(|_: usize, s: &Sample| Some((later(s.0, 1.3), s.1))) as Box<dyn Fn(_, &_) -> _>),
        ("faster", Box::new(|_, s: &Sample| Some((later(s.0, 0.75), s.1)))),
        ("every fourth", Box::new(|index, s: &Sample| (index % 4 == 0).then_some(*s))),
    ] {
        let (mean, worst) = errors(&recordings, change);
        println!("gait-lowback, {name}: {mean:.2} / {worst:.2} %");
        assert!(mean <= CHANGED_LOWBACK_MEAN, "{name}: {mean}");
    }
}

#[test]
fn ten_metres_out_and_back_end_where_they_began() {
    let Some(folder) = folder("gait-lowback") else { return };
    let (mut ways, mut ends) = (Vec::new(), Vec::new());
    for (_, path) in trials(&folder) {
        let mut method = Pdr::new(PdrParams::default()).unwrap();
        let mut last = None;
        for observation in open(&path).unwrap() {
            let mut solution = method.observe(&observation.unwrap()).unwrap();
            while solution.is_some() {
                last = solution;
                solution = method.next_due();
            }
        }
        while let Some(solution) = method.finish_next().unwrap() {
            last = Some(solution);
        }
        ways.push(method.report().distance_m);
        ends.push(last.unwrap().position_m.norm());
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    ends.sort_by(f64::total_cmp);
    let median = ends[ends.len() / 2];
    println!("way {:.2} m, end {median:.2} m from the start (median)", mean(&ways));
    // 20 m and a turn; the model of the length is off by 8 % from one person to the next.
    assert!((mean(&ways) - 20.5).abs() < 1.5, "{}", mean(&ways));
    assert!(median < 2.0, "{median}");
}
