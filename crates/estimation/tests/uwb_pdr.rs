//! `uwb-pdr` (system S4): alignment in time, the environment, the weights, and the whole method on a walk that is known.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::frames::Position;
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_estimation::methods::alignment::{Alignment, Event};
use adit_estimation::methods::pdr::{Direction, PdrParams};
use adit_estimation::methods::uwb_pdr::{
    Environment, Fusion, FusionParams, UwbPdr, UwbPdrParams, UwbPdrReport, Weights,
};
use adit_estimation::methods::{MethodError, MethodSettings, MethodWarning};
use adit_estimation::pedestrian::step_length::StepLength;
use adit_estimation::radio::RadioSite;
use adit_estimation::ranging::listener::{Link, RangeListener, RangesParams};
use adit_estimation::ranging::solver::{SolverKind, SolverParams};
use adit_estimation::ranging::{RangeModel, Ranged};
use adit_mine::plan::{Anchor, Grid, MinePlan};
use adit_observation::{DeviceId, Observation, Radio, RangeSample, StartPose};
use core::f64::consts::FRAC_PI_2;
use std::sync::Arc;
use support::Draws;
use support::strides::Strides;

const HEIGHT_M: f64 = 1.0;
/// What is in the way adds to a range, m.
const EXCESS_M: f64 = 3.0;

fn at(seconds: f64) -> Time {
    Time::from_seconds(seconds).unwrap()
}

fn link(line_of_sight: Option<f64>) -> Link {
    let model = RangeModel { offset_m: 0.0, scale: 1.0, sigma_m: 0.1 };
    let ranged = Ranged { position_m: Vector3::zeros(), model, range_m: 5.0 };
    Link { time: at(0.0), anchor: 0, ranged, line_of_sight }
}

#[test]
fn the_environment_is_told_by_the_clear_links() {
    let of = |told: &[Option<f64>]| {
        let links: Vec<Link> = told.iter().map(|p| link(*p)).collect();
        Environment::of(&links, 3)
    };
    let (clear, not) = (Some(0.9), Some(0.2));
    assert_eq!(of(&[clear; 4]), Environment::Ideal);
    assert_eq!(of(&[clear, clear, clear, not]), Environment::WithError);
    assert_eq!(of(&[clear, clear, not, not]), Environment::PartlyBlocked);
    assert_eq!(of(&[not; 4]), Environment::Blocked);
    // What nobody has judged counts as clear.
    assert_eq!(of(&[None, None, None, clear]), Environment::Ideal);
    assert_eq!(of(&[]), Environment::Blocked);
}

/// Eq. 11 with inverse variances, by hand.
#[test]
fn weights_are_inverse_variances_and_sum_to_one() {
    let params = FusionParams { weights: Weights::Scalar, drift_share: 0.1, ..FusionParams::default() };
    let mut fusion = Fusion::new(FusionParams { standing_m_sqrt_s: 0.0, ..params }, Some(0.09));
    fusion.walk(at(0.0), &Vector2::zeros());
    // After 4 m: 0.3 + 0.4 m.
    let uwb = Matrix2::new(0.3, 0.1, 0.1, 0.1);
    let way_m = Vector2::new(4.0, 0.0);
    let told = fusion.observe(at(2.0), &way_m, &Vector2::new(4.5, 0.5), &uwb, Environment::Ideal);
    let expected = 0.49 / (0.49 + 0.2);
    assert!((told - expected).abs() < 1e-12, "{told}");
    let (place_m, covariance_m2) = fusion.place(&way_m).unwrap();
    assert!((place_m - Vector2::new(4.0 + 0.5 * expected, 0.5 * expected)).norm() < 1e-12);
    let left =
        Matrix2::identity() * (0.49 * (1.0 - expected) * (1.0 - expected)) + uwb * (expected * expected);
    assert!((covariance_m2 - left).norm() < 1e-12);
}

#[test]
fn matrices_weigh_each_direction_for_itself() {
    let uwb = Matrix2::new(0.01, 0.0, 0.0, 100.0);
    let after = |weights| {
        let mut fusion = Fusion::new(FusionParams { weights, ..FusionParams::default() }, Some(1.0));
        fusion.observe(at(1.0), &Vector2::zeros(), &Vector2::new(1.0, 1.0), &uwb, Environment::Ideal);
        fusion.place(&Vector2::zeros()).unwrap().0
    };
    let (scalar, matrix) = (after(Weights::Scalar), after(Weights::Matrix));
    assert!((matrix - Vector2::new(1.0 / 1.01, 1.0 / 101.0)).norm() < 1e-9, "{matrix}");
    assert!(scalar.x < 0.03 && (scalar.x - scalar.y).abs() < 1e-12, "{scalar}");
}

#[test]
fn errors_that_stay_count_once() {
    let uwb = Matrix2::identity();
    // Ten epochs a second for ten seconds beside what is in the way.
    let after = |environment| {
        let mut fusion = Fusion::new(
            FusionParams { standing_m_sqrt_s: 0.0, correlation_s: 2.0, ..FusionParams::default() },
            Some(1.0),
        );
        for epoch in 0..100 {
            let time = at(0.1 * f64::from(epoch));
            fusion.observe(time, &Vector2::zeros(), &Vector2::repeat(1.0), &uwb, environment);
        }
        fusion.place(&Vector2::zeros()).unwrap().1[(0, 0)]
    };
    // 100 independent ones leave 1/101; 0.1/2 of each of 99 and the first leave 1/(2 + 99/20).
    assert!((after(Environment::Ideal) - 1.0 / 101.0).abs() < 1e-9);
    let blocked = after(Environment::Blocked);
    assert!((blocked - 1.0 / (2.0 + 99.0 / 20.0)).abs() < 1e-6, "{blocked}");
}

/// A hall of 40 × 30 m around the walk.
fn site() -> Arc<RadioSite> {
    let mut plan = MinePlan::new("hall", Grid::Local {});
    let corners = [[-5.0, -10.0, 3.0], [45.0, -10.0, 2.0], [45.0, 20.0, 3.0], [-5.0, 20.0, 2.0]];
    plan.anchors.extend(corners.iter().enumerate().map(|(k, [x, y, z])| Anchor {
        id: format!("a{k}"),
        position_m: Position::new(*x, *y, *z),
        range_offset_m: None,
        antenna_delay_ns: None,
        tx_power_dbm: None,
    }));
    Arc::new(RadioSite::of_plan(&plan))
}

/// Steps east and then north, of which dead reckoning believes that they are 5 % longer.
fn walk() -> Strides {
    Strides { steps: 60, heading_rad: FRAC_PI_2, turns: vec![(20.0, 2.0, -FRAC_PI_2)], ..Strides::default() }
}

/// The log with four ranges every 0.1 s: from 10 to 22 s two of them have something in the way.
fn log(seed: u64, judged: bool) -> (Vec<Observation>, Vec<(Time, Vector2<f64>)>) {
    let (mut all, truth) = walk().record(seed);
    let mut draws = Draws::new(seed + 50);
    let site = site();
    let mut next = Time::ZERO;
    for (time, place_m) in &truth {
        if *time < next {
            continue;
        }
        next = *time + Interval::from_nanos(100_000_000);
        for (k, anchor) in site.anchors.iter().enumerate() {
            let in_the_way = k < 2 && (10.0..22.0).contains(&time.seconds());
            let distance_m = (place_m.push(HEIGHT_M) - anchor.position_m).norm();
            let excess_m = if in_the_way { EXCESS_M } else { 0.0 };
            let p = if in_the_way { 0.05 } else { 0.95 };
            all.push(Observation::Range(RangeSample {
                time: *time,
                anchor: DeviceId::new(&anchor.id).unwrap(),
                tag: None,
                range_m: distance_m + excess_m + 0.05 * draws.normal(),
                sigma_m: None,
                line_of_sight: judged.then_some(p),
                in_the_way: None,
                radio: Radio::Uwb,
                reception: None,
            }));
        }
    }
    all.sort_by_key(Observation::time);
    (all, truth)
}

fn settings(kind: SolverKind) -> UwbPdrParams {
    let solver =
        SolverParams { kind, height_m: Some(HEIGHT_M), height_sigma_m: 0.1, ..SolverParams::default() };
    let start = StartPose {
        position_m: [0.0, 0.0],
        position_sigma_m: [0.3, 0.3],
        heading_deg: 90.0,
        pitch_deg: 0.0,
        roll_deg: 0.0,
        attitude_sigma_deg: 2.0,
    };
    let mut params = UwbPdrParams { solver, ..UwbPdrParams::default() };
    params.pdr.length = StepLength::Constant { length_m: 1.05 * walk().step_m };
    params.pdr.start = Some(start);
    params.at_site(&site())
}

fn run(mut method: UwbPdr, log: &[Observation]) -> (Vec<Solution>, UwbPdrReport) {
    let mut solutions = Vec::new();
    for observation in log {
        solutions.extend(method.observe(observation).unwrap());
        solutions.extend(core::iter::from_fn(|| method.next_due().unwrap()));
    }
    while let Some(solution) = method.finish_next().unwrap() {
        solutions.push(solution);
    }
    (solutions, method.report().clone())
}

fn mean_error_m(solutions: &[Solution], truth: &[(Time, Vector2<f64>)]) -> f64 {
    let error = |solution: &Solution| {
        let index = truth.partition_point(|(at, _)| *at < solution.time).min(truth.len() - 1);
        (solution.position_m.xy() - truth[index].1).norm()
    };
    solutions.iter().map(error).sum::<f64>() / solutions.len() as f64
}

#[test]
fn what_is_in_the_way_leaves_the_place_to_dead_reckoning() {
    // Linear squares have two clear ranges and weigh the other two alike.
    for (kind, most_m) in [(SolverKind::Linear, 0.5), (SolverKind::Robust, 0.25)] {
        let (observations, truth) = log(1, true);
        let (solutions, report) = run(UwbPdr::new(settings(kind)).unwrap(), &observations);
        assert!(solutions.windows(2).all(|pair| pair[0].time < pair[1].time));
        assert_eq!(report.heard.late_ranges, 0);
        let counts = report.environments;
        assert_eq!((counts.blocked, counts.with_error), (0, 0));
        assert!((118..=122).contains(&counts.partly_blocked), "{counts:?}");
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
        let judged = mean_error_m(&solutions, &truth);
        let (blind, _) = run(UwbPdr::new(settings(kind)).unwrap(), &log(1, false).0);
        let unjudged = mean_error_m(&blind, &truth);
        // Dead reckoning gains 1 m of 20 in the dark time; ranges that nobody judges take the place metres away.
        assert!(judged < most_m, "{kind:?} {judged}");
        assert!(unjudged > 2.0 * judged, "{kind:?} {unjudged} {judged}");
    }
}

#[test]
fn ranges_that_nobody_judged_are_believed_with_a_warning() {
    let (observations, _) = log(2, false);
    let (_, report) = run(UwbPdr::new(settings(SolverKind::Robust)).unwrap(), &observations);
    let epochs = report.heard.epochs;
    assert_eq!(report.unjudged_epochs, epochs);
    assert_eq!(report.warnings, [MethodWarning::Unjudged { epochs }]);
}

#[test]
fn without_inertial_sensors_it_is_uwb_alone() {
    let (observations, truth) = log(3, true);
    let ranges: Vec<Observation> =
        observations.into_iter().filter(|one| matches!(one, Observation::Range(_))).collect();
    let (solutions, report) = run(UwbPdr::new(settings(SolverKind::Robust)).unwrap(), &ranges);
    assert_eq!(solutions.len() as u64, report.heard.epochs);
    // Two clear ranges and two that are known to be poor.
    assert!(mean_error_m(&solutions, &truth) < 0.5);
}

#[test]
fn events_come_in_order_of_time_however_late_ranges_arrive() {
    let (observations, _) = log(4, true);
    let delayed = |delay_s: f64| {
        let mut log: Vec<(f64, &Observation)> = observations
            .iter()
            .map(|one| {
                let late_s = if matches!(one, Observation::Range(_)) { delay_s } else { 0.0 };
                (one.time().seconds() + late_s, one)
            })
            .collect();
        log.sort_by(|a, b| a.0.total_cmp(&b.0));
        let listener = RangeListener::new("test", Some(&site()), RangesParams::default()).unwrap();
        let pdr = PdrParams { direction: Direction::Mounted, ..PdrParams::default() };
        let mut alignment = Alignment::new(listener, Some(pdr)).unwrap();
        let mut events = Vec::new();
        for (_, observation) in log {
            alignment.observe(observation).unwrap();
            events.extend(core::iter::from_fn(|| alignment.pop()));
        }
        alignment.finish().unwrap();
        events.extend(core::iter::from_fn(|| alignment.pop()));
        events
    };
    let time = |event: &Event| match event {
        Event::Reckoned(solution) => solution.time,
        Event::Ranges(epoch, _) => epoch.time(),
    };
    let plain = delayed(0.0);
    assert!(plain.windows(2).all(|pair| time(&pair[0]) <= time(&pair[1])));
    let epochs = |events: &[Event]| {
        let of = |event: &Event| match event {
            Event::Ranges(epoch, way_m) => Some((epoch.time(), way_m.unwrap())),
            Event::Reckoned(_) => None,
        };
        let mut all: Vec<(Time, Vector2<f64>)> = events.iter().filter_map(of).collect();
        all.sort_by_key(|(time, _)| *time);
        all
    };
    assert!(epochs(&plain).len() > 300);
    // Ten seconds late: held against where the walker was at their own time.
    assert_eq!(epochs(&plain), epochs(&delayed(10.0)));
}

#[test]
fn a_run_that_is_stopped_and_continued_is_the_whole_run_bit_for_bit() {
    let (log, _) = log(6, true);
    let (whole, report) = run(UwbPdr::new(settings(SolverKind::Robust)).unwrap(), &log);
    for part in [7, log.len() / 3, log.len() / 2 + 13] {
        let mut first = UwbPdr::new(settings(SolverKind::Robust)).unwrap();
        let mut solutions = Vec::new();
        for observation in &log[..part] {
            solutions.extend(first.observe(observation).unwrap());
            solutions.extend(core::iter::from_fn(|| first.next_due().unwrap()));
        }
        let kept = serde_json::to_string(&first).unwrap();
        let (rest, second) = run(serde_json::from_str(&kept).unwrap(), &log[part..]);
        solutions.extend(rest);
        assert_eq!(solutions, whole, "{part}");
        assert_eq!(second, report);
    }
}

#[test]
fn what_cannot_be_worked_with_is_refused_by_name() {
    let refused = |params: UwbPdrParams| UwbPdr::new(params).unwrap_err();
    let mut params = settings(SolverKind::Robust);
    params.fusion.drift_share = -1.0;
    assert!(matches!(refused(params), MethodError::Setting { name: "fusion.drift_share", .. }));
    let mut params = settings(SolverKind::Robust);
    params.ranges.nlos_sigma_m = f64::NAN;
    assert!(matches!(refused(params), MethodError::Setting { name: "ranges.nlos_sigma_m", .. }));
    assert!(matches!(refused(UwbPdrParams::default()), MethodError::NoRadio { .. }));
    let silent: Vec<Observation> =
        log(1, true).0.into_iter().filter(|one| !matches!(one, Observation::Range(_))).collect();
    let mut params = settings(SolverKind::Robust);
    params.pdr.start = None;
    let mut method = UwbPdr::new(params).unwrap();
    for observation in &silent {
        assert!(method.observe(observation).unwrap().is_none());
    }
    assert!(matches!(method.finish_next(), Err(MethodError::NoRangeFix { ranges: 0, .. })));
}
