//! `pdr` with the radio of a site: late fixes, correlated errors, and whether the covariance is honest.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::frames::Position;
use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_estimation::methods::MethodSettings;
use adit_estimation::methods::pdr::{Direction, Pdr, PdrParams};
use adit_estimation::methods::wifi::WifiParams;
use adit_estimation::pedestrian::step_length::StepLength;
use adit_estimation::radio::locator::{LocatorMethod, LocatorParams};
use adit_estimation::radio::path_loss::mean_dbm;
use adit_estimation::radio::{PathLoss, RadioSite};
use adit_mine::plan::{AccessPoint, Grid, MinePlan, Radio as SiteRadio, Roadway, RoadwayKind};
use adit_observation::{DeviceId, FixSource, Observation, PositionFix, Radio, SignalStrength};
use std::sync::Arc;
use support::Draws;
use support::strides::Strides;

const LOSS: PathLoss =
    PathLoss { rssi_at_1m_dbm: -40.0, exponent: 2.2, breakpoint_m: None, exponent_beyond: None };
const SHADOWING_DB: f64 = 4.0;
const SHADOWING_M: f64 = 4.0;

fn run(params: PdrParams, log: &[Observation]) -> (Vec<Solution>, Pdr) {
    let mut method = Pdr::new(params).unwrap();
    let mut solutions = Vec::new();
    for observation in log {
        solutions.extend(method.observe(observation).unwrap());
        solutions.extend(core::iter::from_fn(|| method.next_due()));
    }
    while let Some(solution) = method.finish_next().unwrap() {
        solutions.push(solution);
    }
    assert!(solutions.windows(2).all(|pair| pair[0].time < pair[1].time));
    (solutions, method)
}

fn true_at(truth: &[(Time, Vector2<f64>)], time: Time) -> Vector2<f64> {
    let index = truth.partition_point(|(at, _)| *at < time);
    truth[index.min(truth.len() - 1)].1
}

/// Round a block of 60 by 40 m.
fn block() -> Strides {
    let corners = [(30.0, 1), (54.0, 2), (92.0, 3)];
    let turns = corners.map(|(time_s, _)| (time_s, 2.0, core::f64::consts::FRAC_PI_2)).to_vec();
    Strides { steps: 220, heading_rad: 0.0, turns, ..Strides::default() }
}

fn params(walk: &Strides) -> PdrParams {
    PdrParams {
        length: StepLength::Constant { length_m: walk.step_m },
        direction: Direction::Mounted,
        ..PdrParams::default()
    }
}

/// Access points about the walk, and roadways over all of it.
fn site(truth: &[(Time, Vector2<f64>)]) -> MinePlan {
    let low = truth.iter().fold(truth[0].1, |low, (_, at)| low.inf(at)).add_scalar(-8.0);
    let high = truth.iter().fold(truth[0].1, |high, (_, at)| high.sup(at)).add_scalar(8.0);
    let mut plan = MinePlan::new("block", Grid::Local {});
    for (k, (u, v)) in
        (0..).zip([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.0), (0.5, 1.0), (0.5, 0.5)])
    {
        let (x, y) = (low.x + u * (high.x - low.x), low.y + v * (high.y - low.y));
        plan.access_points.push(AccessPoint {
            id: format!("ap{k}"),
            radio: SiteRadio::Wifi,
            mac: None,
            position_m: Position::new(x, y, 2.5),
            tx_power_dbm: None,
            path_loss: Some(LOSS),
        });
    }
    let width_m = 10.0;
    let mut north = low.y + 0.5 * width_m;
    while north < high.y {
        plan.roadways.push(Roadway {
            id: format!("r{north}"),
            name: None,
            level: None,
            kind: RoadwayKind::Drift,
            width_m,
            height_m: 3.0,
            max_slope_percent: None,
            walkable: true,
            points_m: vec![Position::new(low.x, north, 0.0), Position::new(high.x, north, 0.0)],
        });
        north += width_m;
    }
    plan
}

/// Signals once a second with shadowing that is alike over the way (an Ornstein–Uhlenbeck process of the distance walked).
fn signals(truth: &[(Time, Vector2<f64>)], plan: &MinePlan, seed: u64) -> Vec<Observation> {
    let mut draws = Draws::new(seed);
    let mut shadows: Vec<f64> = plan.access_points.iter().map(|_| SHADOWING_DB * draws.normal()).collect();
    let (mut before, mut all) = (truth[0].1, Vec::new());
    let mut due = truth[0].0;
    for (time, at) in truth {
        if *time < due {
            continue;
        }
        due = *time + Interval::from_seconds(1.0).unwrap();
        let kept = (-(at - before).norm() / SHADOWING_M).exp();
        before = *at;
        for (shadow, access_point) in shadows.iter_mut().zip(&plan.access_points) {
            *shadow = *shadow * kept + SHADOWING_DB * (1.0 - kept * kept).sqrt() * draws.normal();
            let place = access_point.position_m.raw();
            let distance = (place.xy() - at).norm().hypot(1.5);
            all.push(Observation::Signal(SignalStrength {
                time: *time,
                transmitter: DeviceId::new(&access_point.id).unwrap(),
                rssi_dbm: mean_dbm(&LOSS, distance) + *shadow + draws.normal(),
                radio: Radio::Wifi,
            }));
        }
    }
    all
}

fn merged(log: &[Observation], more: &[Observation]) -> Vec<Observation> {
    let mut all = [log, more].concat();
    all.sort_by_key(Observation::time);
    all
}

#[test]
fn a_fix_that_comes_late_is_worth_what_it_was() {
    let walk = block();
    let (log, truth) = walk.record(3);
    let mut draws = Draws::new(5);
    let fixes: Vec<PositionFix> = truth
        .iter()
        .step_by(500)
        .map(|(time, at)| {
            let off = Vector2::new(draws.normal(), draws.normal());
            PositionFix::level(*time, at + off, 1.0, FixSource::Survey)
        })
        .collect();
    let on_time: Vec<Observation> = fixes.iter().map(|fix| Observation::Fix(*fix)).collect();
    let (plain, method) = run(params(&walk), &merged(&log, &on_time));
    // The same fixes stand five seconds later in the log, some seven steps.
    let mut late: Vec<(Time, Observation)> = log.iter().map(|one| (one.time(), one.clone())).collect();
    let later = Interval::from_seconds(5.0).unwrap();
    late.extend(fixes.iter().map(|fix| (fix.time + later, Observation::Fix(*fix))));
    late.sort_by_key(|(arrived, _)| *arrived);
    let late: Vec<Observation> = late.into_iter().map(|(_, one)| one).collect();
    let (delayed, late_method) = run(params(&walk), &late);
    assert_eq!(late_method.report().late_fixes, 0);
    let used = |method: &Pdr| method.report().used_fixes + method.report().searched_fixes;
    assert_eq!(used(&method), used(&late_method));
    let (a, b) = (plain.last().unwrap(), delayed.last().unwrap());
    // A late fix cannot have the noise of the steps since taken out of its prediction: 8 % of seven steps of 0.7 m, 0.15 m, in a
    // position that is known to 0.4 m.
    assert!((a.position_m - b.position_m).norm() < 0.15, "{:?} {:?}", a.position_m, b.position_m);
    let radii = (a.radius_95_m(), b.radius_95_m());
    assert!((radii.0 / radii.1 - 1.0).abs() < 0.15, "{radii:?}");
}

#[test]
fn radio_holds_a_walk_and_its_covariance_is_honest() {
    const SEEDS: u64 = 40;
    let walk = block();
    let (mut nees, mut alone_m, mut held_m, mut inside, mut judged) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for seed in 0..SEEDS {
        let (log, truth) = walk.record(100 + seed);
        let plan = site(&truth);
        let radio = Arc::new(RadioSite::of_plan(&plan));
        let log = merged(&log, &signals(&truth, &plan, seed));
        let locator = LocatorParams {
            method: LocatorMethod::Map,
            sigma_db: SHADOWING_DB,
            offset_sigma_db: 1.0,
            step_m: 2.0,
            ..LocatorParams::default()
        };
        let mut settings = params(&walk).at_site(&radio);
        settings.radio.locator = locator;
        let (solutions, method) = run(settings, &log);
        assert!(method.report().heard.as_ref().unwrap().fixes > 20);
        let last = solutions.last().unwrap();
        let off = last.position_m.xy() - true_at(&truth, last.time);
        let covariance: Matrix2<f64> = last.covariance.fixed_view::<2, 2>(0, 0).into_owned();
        nees += off.dot(&(covariance.try_inverse().unwrap() * off));
        // From half of the walk on.
        let off_m = |solution: &Solution| (solution.position_m.xy() - true_at(&truth, solution.time)).norm();
        let later: Vec<&Solution> = solutions.iter().skip(solutions.len() / 2).collect();
        held_m += later.iter().map(|solution| off_m(solution)).sum::<f64>() / later.len() as f64;
        inside += later.iter().filter(|solution| off_m(solution) < solution.radius_95_m()).count() as f64;
        judged += later.len() as f64;
        let mut alone = WifiParams { locator, ..WifiParams::default() }.at_site(&radio).start().unwrap();
        let positions: Vec<Solution> = log.iter().filter_map(|one| alone.observe(one).unwrap()).collect();
        alone_m += positions.iter().map(off_m).sum::<f64>() / positions.len() as f64;
    }
    let count = SEEDS as f64;
    let (nees, held_m, alone_m, inside) = (nees / count, held_m / count, alone_m / count, inside / judged);
    println!("NEES {nees:.2}, {held_m:.2} m, by radio alone {alone_m:.2} m, inside {inside:.3}");
    // χ² of 80 degrees of freedom over 40: below 2.90 in 999 of 1000. Errors are taken to be alike for longer than they are here.
    assert!(nees < 2.90 && inside > 0.95, "{nees} {inside}");
    assert!(held_m < 0.75 * alone_m, "{held_m} {alone_m}");
}
