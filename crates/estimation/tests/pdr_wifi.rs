//! `pdr-wifi`: its filter against a dense one, and the whole method on a walk along a roadway that is known.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::frames::Position;
use adit_core::nalgebra::{Matrix4, Vector2, Vector4};
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_estimation::methods::pdr_wifi::{
    Components, Fusion, FusionParams, PdrWifi, PdrWifiParams, Report, Walk, squared_error_m2,
};
use adit_estimation::methods::{MethodError, MethodSettings};
use adit_estimation::pedestrian::step_length::StepLength;
use adit_estimation::radio::path_loss::mean_dbm;
use adit_estimation::radio::{PathLoss, RadioSite};
use adit_mine::plan::{AccessPoint, Grid, MinePlan, Radio as SiteRadio, Roadway, RoadwayKind};
use adit_observation::{DeviceId, Observation, Radio, SignalStrength, StartPose};
use std::sync::Arc;
use support::Draws;
use support::strides::Strides;

/// Reports of a walk on which dead reckoning drifts, at uneven times.
fn reports(seed: u64) -> Walk {
    let mut draws = Draws::new(seed);
    let mut time_s = 3.0;
    let mut drift = Vector2::new(0.4, -0.3);
    let reports = (0..200).map(|_| {
        let dt = 5.0 + draws.normal();
        time_s += dt;
        drift += Vector2::new(0.08, -0.03) * dt + Vector2::new(draws.normal(), draws.normal()) * 0.2;
        let truth = Vector2::new(1.5 * time_s, 0.2 * time_s);
        let fix_m = truth + Vector2::new(draws.normal() * 4.0, draws.normal() * 2.0);
        (Report { time_s, reckoned_m: truth + drift, fix_m }, truth)
    });
    Walk { reports: reports.collect() }
}

fn params() -> FusionParams {
    FusionParams {
        process_scale: Components { east: 3.0, north: 0.2, east_velocity: 40.0, north_velocity: 7.0 },
        measurement_scale: Components { east: 0.5, north: 2.0, east_velocity: 3.0, north_velocity: 0.7 },
        ..FusionParams::default()
    }
}

/// Eq. 8 to 12 of the paper as they stand, four states and four measurements at once.
fn dense(
    params: &FusionParams,
    start_sigma_m: Vector2<f64>,
    walk: &Walk,
) -> Vec<(Vector2<f64>, Option<f64>)> {
    let FusionParams { process_scale: q, measurement_scale: r, .. } = params;
    let q = Vector4::new(q.east, q.north, q.east_velocity, q.north_velocity);
    let r = Vector4::new(r.east, r.north, r.east_velocity, r.north_velocity);
    let (p, v) = (params.position_walk_m2_s, params.velocity_walk_m2_s3);
    let q = q.component_mul(&Vector4::new(p, p, v, v));
    let (fix, rate) = (params.fix_sigma_m.powi(2), params.velocity_sigma_m_s.powi(2));
    let start = start_sigma_m.component_mul(&start_sigma_m);
    let mut state = Vector4::zeros();
    let mut covariance = Matrix4::from_diagonal(&Vector4::new(start.x, start.y, rate, rate));
    let mut last: Option<Report> = None;
    let mut fused = Vec::new();
    for (report, _) in &walk.reports {
        let offset = report.reckoned_m - report.fix_m;
        let (mut z, mut noise) = (Vector4::new(offset.x, offset.y, 0.0, 0.0), r * fix);
        let mut nis = None;
        if let Some(last) = last {
            let dt = report.time_s - last.time_s;
            let mut step = Matrix4::identity();
            (step[(0, 2)], step[(1, 3)]) = (dt, dt);
            state = step * state;
            covariance = step * covariance * step.transpose() + Matrix4::from_diagonal(&(q * dt));
            let speed = (offset - (last.reckoned_m - last.fix_m)) / dt;
            (z[2], z[3]) = (speed.x, speed.y);
            (noise[2], noise[3]) = (2.0 * noise[2] / (dt * dt), 2.0 * noise[3] / (dt * dt));
        } else {
            // No velocity yet: so uncertain that it says nothing.
            (noise[2], noise[3]) = (1e12, 1e12);
        }
        let innovation = z - state;
        let spread = covariance + Matrix4::from_diagonal(&noise);
        let inverse = spread.try_inverse().unwrap();
        if last.is_some() {
            nis = Some((innovation.transpose() * inverse * innovation)[(0, 0)]);
        }
        let gain = covariance * inverse;
        state += gain * innovation;
        covariance = (Matrix4::identity() - gain) * covariance;
        last = Some(*report);
        fused.push((report.reckoned_m - state.xy(), nis));
    }
    fused
}

#[test]
fn two_filters_of_two_states_are_the_dense_one_of_four() {
    let start = Vector2::new(0.7, 1.3);
    let walk = reports(5);
    let mut fusion = Fusion::new(&params(), start);
    let mut squared = 0.0;
    for ((report, truth), (expected_m, nis)) in walk.reports.iter().zip(dense(&params(), start, &walk)) {
        let fused = fusion.observe(report);
        // Rounding of 200 updates, and 1e-12 of information that the dense one has of the first velocity.
        assert!((fused.position_m - expected_m).norm() < 1e-8, "{}", report.time_s);
        assert_eq!(fused.nis.is_some(), nis.is_some());
        let (found, expected) = (fused.nis.unwrap_or(0.0), nis.unwrap_or(0.0));
        assert!((found - expected).abs() < 1e-7 * (1.0 + expected), "{found} {expected}");
        squared += (fused.position_m - truth).norm_squared();
    }
    assert_eq!(squared_error_m2(&params(), start, &[walk]), squared);
}

#[test]
fn a_velocity_made_of_the_same_fixes_is_never_a_surprise() {
    let (mut sum, mut count) = (0.0, 0);
    for seed in 0..40 {
        let walk = reports(seed);
        let mut fusion = Fusion::new(&FusionParams::default(), Vector2::repeat(1.0));
        for (report, _) in &walk.reports {
            if let Some(nis) = fusion.observe(report).nis {
                sum += nis;
                count += 1;
            }
        }
    }
    // Position and velocity of a report come of the same fix: the filter takes them for independent and is never surprised.
    let mean = sum / f64::from(count);
    assert!((1.0..4.0).contains(&mean), "{mean}");
}

#[test]
fn an_old_report_changes_nothing() {
    let walk = reports(2);
    let mut fusion = Fusion::new(&params(), Vector2::zeros());
    for (report, _) in &walk.reports[..9] {
        fusion.observe(report);
    }
    let before = fusion.clone();
    let old = fusion.observe(&walk.reports[3].0);
    assert!(old.nis.is_none());
    fusion.observe(&walk.reports[8].0);
    assert_eq!(fusion, before);
}

const LOSS: PathLoss =
    PathLoss { rssi_at_1m_dbm: -40.0, exponent: 2.0, breakpoint_m: None, exponent_beyond: None };
const START: StartPose = StartPose {
    position_m: [0.0, 0.0],
    position_sigma_m: [0.3, 0.3],
    heading_deg: 90.0,
    pitch_deg: 0.0,
    roll_deg: 0.0,
    attitude_sigma_deg: 2.0,
};

/// Steps east, of which dead reckoning believes that they are 5 % longer.
fn walk() -> Strides {
    Strides { steps: 400, heading_rad: core::f64::consts::FRAC_PI_2, ..Strides::default() }
}

/// A roadway east with an access point every 50 m on its northern wall.
fn site() -> Arc<RadioSite> {
    let mut plan = MinePlan::new("roadway", Grid::Local {});
    plan.roadways.push(Roadway {
        id: "r".to_owned(),
        name: None,
        level: None,
        kind: RoadwayKind::Haulage,
        width_m: 4.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: vec![Position::new(-5.0, 0.0, 0.0), Position::new(320.0, 0.0, 0.0)],
    });
    plan.access_points.extend((0..7).map(|k| AccessPoint {
        id: format!("ap-{k}"),
        radio: SiteRadio::Wifi,
        mac: None,
        position_m: Position::new(50.0 * f64::from(k), 1.9, 2.5),
        tx_power_dbm: None,
        path_loss: Some(LOSS),
    }));
    Arc::new(RadioSite::of_plan(&plan))
}

/// The log with a scan a second of white noise.
fn log(noise_db: f64, seed: u64) -> (Vec<Observation>, Vec<(Time, Vector2<f64>)>) {
    let (mut all, truth) = walk().record(seed);
    let mut draws = Draws::new(seed + 100);
    let mut next = Time::ZERO;
    for (time, at) in &truth {
        if *time < next {
            continue;
        }
        next = *time + Interval::from_nanos(1_000_000_000);
        for k in 0..7 {
            let away = Vector2::new(50.0 * f64::from(k), 1.9) - at;
            let slant_m = (away.norm_squared() + 1.5 * 1.5).sqrt();
            let rssi_dbm = mean_dbm(&LOSS, slant_m) + noise_db * draws.normal();
            let transmitter = DeviceId::new(&format!("ap-{k}")).unwrap();
            all.push(Observation::Signal(SignalStrength {
                time: *time,
                transmitter,
                rssi_dbm,
                radio: Radio::Wifi,
            }));
        }
    }
    all.sort_by_key(Observation::time);
    (all, truth)
}

fn settings(start: Option<StartPose>) -> PdrWifiParams {
    let mut params = PdrWifiParams::default();
    params.pdr.length = StepLength::Constant { length_m: 1.05 * walk().step_m };
    params.pdr.start = start;
    params.at_site(&site())
}

fn run(mut method: PdrWifi, log: &[Observation]) -> (Vec<Solution>, PdrWifi) {
    let mut solutions = Vec::new();
    for observation in log {
        solutions.extend(method.observe(observation).unwrap());
        solutions.extend(core::iter::from_fn(|| method.next_due()));
    }
    while let Some(solution) = method.finish_next().unwrap() {
        solutions.push(solution);
    }
    (solutions, method)
}

fn errors_m(solutions: &[Solution], truth: &[(Time, Vector2<f64>)]) -> Vec<f64> {
    let error = |solution: &Solution| {
        let index = truth.partition_point(|(at, _)| *at < solution.time).min(truth.len() - 1);
        (solution.position_m.xy() - truth[index].1).norm()
    };
    solutions.iter().map(error).collect()
}

#[test]
fn wifi_takes_off_what_dead_reckoning_is_off_by() {
    let (log, truth) = log(1.0, 3);
    let (solutions, method) = run(PdrWifi::new(settings(Some(START))).unwrap(), &log);
    assert!(solutions.windows(2).all(|pair| pair[0].time < pair[1].time));
    let report = method.report();
    // 280 m at 1.26 m/s: a report every 5 s.
    assert!((44..50).contains(&report.reports), "{}", report.reports);
    assert_eq!(report.late_fixes, 0);
    // 5 % of 280 m, and of 1.26 m/s.
    assert!((report.offset_m[0] - 14.0).abs() < 3.0, "{:?}", report.offset_m);
    assert!((report.rate_m_s[0] - 0.063).abs() < 0.05, "{:?}", report.rate_m_s);
    let errors = errors_m(&solutions, &truth);
    let late = &errors[errors.len() / 2..];
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    // Dead reckoning alone is 7 to 14 m off there.
    assert!(mean < 2.5, "{mean}");
}

#[test]
fn without_a_start_the_first_position_by_radio_is_it() {
    let (log, truth) = log(0.5, 4);
    let (solutions, _) = run(PdrWifi::new(settings(None)).unwrap(), &log);
    let first = solutions.first().unwrap().time;
    assert!((first - truth[0].0).seconds() < 6.0, "{first:?}");
    let errors = errors_m(&solutions, &truth);
    assert!(errors[errors.len() / 2..].iter().all(|error| *error < 6.0));
}

#[test]
fn a_run_that_is_stopped_and_continued_is_the_whole_run_bit_for_bit() {
    let (log, _) = log(1.0, 6);
    let (whole, method) = run(PdrWifi::new(settings(Some(START))).unwrap(), &log);
    for part in [7, log.len() / 3, log.len() / 2 + 13] {
        let mut first = PdrWifi::new(settings(Some(START))).unwrap();
        let mut solutions = Vec::new();
        for observation in &log[..part] {
            solutions.extend(first.observe(observation).unwrap());
            solutions.extend(core::iter::from_fn(|| first.next_due()));
        }
        let kept = serde_json::to_string(&first).unwrap();
        let (rest, second) = run(serde_json::from_str(&kept).unwrap(), &log[part..]);
        solutions.extend(rest);
        assert_eq!(solutions, whole, "{part}");
        assert_eq!(second.report(), method.report());
    }
}

#[test]
fn what_cannot_be_worked_with_is_refused_by_name() {
    let refused = |params: PdrWifiParams| PdrWifi::new(params).unwrap_err();
    let mut params = settings(None);
    params.fusion.process_scale.north = 0.0;
    assert!(matches!(refused(params), MethodError::Setting { name: "fusion.process_scale", .. }));
    let mut params = settings(None);
    params.fusion.fix_sigma_m = f64::NAN;
    assert!(matches!(refused(params), MethodError::Setting { name: "fusion.fix_sigma_m", .. }));
    assert!(matches!(refused(PdrWifiParams::default()), MethodError::NoRadio { .. }));
    let silent: Vec<Observation> =
        log(1.0, 1).0.into_iter().filter(|one| !matches!(one, Observation::Signal(_))).collect();
    let mut method = PdrWifi::new(settings(None)).unwrap();
    for observation in &silent {
        assert!(method.observe(observation).unwrap().is_none());
    }
    assert!(matches!(method.finish_next(), Err(MethodError::NoPosition { signals: 0, .. })));
}
