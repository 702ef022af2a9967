//! Draws what the step detector makes of a walk in closed form: `step_figure OUT.svg`.
//!
//! A hand fumbles, then somebody walks with two peaks to a step, turns about with steps that hardly lift the body, walks on and
//! stops. Called by `ci/results.sh` for the page of `pdr`.

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_estimation::pedestrian::steps::bumps::Smoother;
use adit_estimation::pedestrian::steps::{StepDetector, StepParams};
use adit_evaluation::plot::{TimeCurve, time_figure};
use anyhow::{Context, Result};
use std::f64::consts::TAU;

const GRAVITY_M_S2: f64 = 9.81;
const RATE_HZ: f64 = 100.0;
const LENGTH_S: f64 = 20.0;
/// Steps per second, and when the walk, the turn about and the rest begin, s.
const CADENCE_HZ: f64 = 1.8;
const WALK_S: f64 = 4.0;
const STEPS: f64 = 24.0;
const WEAK_STEPS: std::ops::Range<f64> = 11.0..14.0;
/// Bumps of the hand: time, s, and height, m/s².
const FUMBLES: [(f64, f64); 5] = [(0.6, 6.0), (0.85, 3.0), (1.5, 8.0), (2.1, 2.5), (2.35, 5.0)];
/// Where the steps are drawn, m/s².
const BASE_M_S2: f64 = -6.0;

/// Norm of the specific force less gravity.
fn norm_m_s2(time_s: f64) -> f64 {
    let fumble: f64 =
        FUMBLES.iter().map(|(at, height)| height * (-((time_s - at) / 0.08).powi(2)).exp()).sum();
    let phase = (time_s - WALK_S) * CADENCE_HZ;
    if !(0.0..STEPS).contains(&phase) {
        return fumble;
    }
    let loud = if WEAK_STEPS.contains(&phase) { 0.15 } else { 1.0 };
    loud * (-2.5 * (TAU * phase).cos() - 2.2 * (2.0 * TAU * phase).cos())
}

fn main() -> Result<()> {
    let out = std::env::args().nth(1).context("usage: step_figure OUT.svg")?;
    let params = StepParams::default();
    let mut detector = StepDetector::new(&params);
    let (mut norm, mut steps) = (Vec::new(), Vec::new());
    let times = (0..).map(|index| f64::from(index) / RATE_HZ);
    for time_s in times.take_while(|time_s| *time_s < LENGTH_S) {
        let force = GRAVITY_M_S2 + norm_m_s2(time_s);
        norm.push((time_s, force - GRAVITY_M_S2));
        detector.observe(Time::from_seconds(time_s).context("time")?, &(Vector3::z() * force));
    }
    detector.end();
    while let Some(step) = detector.pop() {
        let time_s = step.time.seconds();
        steps.extend([(time_s - 0.01, BASE_M_S2), (time_s, BASE_M_S2 + 1.5), (time_s + 0.01, BASE_M_S2)]);
    }
    let mut ticks = vec![(0.0, BASE_M_S2)];
    ticks.append(&mut steps);
    ticks.push((LENGTH_S, BASE_M_S2));

    // As on a walk: as wide as a step lasts.
    let mut smoother = Smoother::new(params.smoothing_share / CADENCE_HZ);
    let smooth = norm.chunks(4).filter_map(|bin| {
        let mean = bin.iter().map(|(_, value)| value).sum::<f64>() / bin.len() as f64;
        let (time, value) = smoother.push(Time::from_seconds(bin.first()?.0 + 0.02)?, mean);
        (time.seconds() > 0.0).then_some((time.seconds(), value))
    });
    let curves = [
        TimeCurve { label: "‖f‖ − g".into(), points: norm.clone() },
        TimeCurve { label: "smoothed".into(), points: smooth.collect() },
        TimeCurve { label: "steps".into(), points: ticks },
    ];
    let figure = time_figure(&curves, "A fumble, two peaks a step, a turn about", "m/s²")?;
    std::fs::write(&out, figure).with_context(|| out.clone())
}
