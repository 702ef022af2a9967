//! `uwb-ls` in the laboratory of system S4: epochs, solvers, what is late, unknown or of another tag.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_estimation::methods::uwb_ls::{UwbLsParams, UwbLsReport};
use adit_estimation::methods::{MethodError, MethodSettings, MethodWarning};
use adit_estimation::radio::{RadioSite, SiteAnchor};
use adit_estimation::ranging::listener::RangesParams;
use adit_estimation::ranging::solver::{SolverKind, SolverParams};
use adit_observation::{DeviceId, ImuSample, Observation, Radio, RangeSample};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;

const SIGMA_M: f64 = 0.1;
const EPOCHS: u32 = 400;

/// The anchors of `mines/lab.toml`.
fn lab() -> Arc<RadioSite> {
    let places =
        [("a1", 2.0, 0.2, 3.2), ("a2", 18.0, 0.2, 2.0), ("a3", 22.0, 15.8, 3.2), ("a4", 6.0, 15.8, 2.0)];
    let anchors = places.map(|(id, x, y, z)| SiteAnchor {
        id: id.into(),
        position_m: Vector3::new(x, y, z),
        range_offset_m: 0.0,
    });
    Arc::new(RadioSite { anchors: anchors.into(), ..RadioSite::default() })
}

fn seconds(value: f64) -> Time {
    Time::from_seconds(value).unwrap()
}

/// Along the ring of the laboratory, a tag at the waist.
fn truth(time_s: f64) -> Vector3<f64> {
    Vector3::new(3.0 + 0.4 * time_s, 3.0 + 3.0 * (0.3 * time_s).sin().powi(2), 1.1)
}

fn range(anchor: &str, time_s: f64, range_m: f64) -> RangeSample {
    RangeSample {
        time: seconds(time_s),
        anchor: DeviceId::new(anchor).unwrap(),
        tag: None,
        range_m,
        sigma_m: None,
        line_of_sight: None,
        in_the_way: None,
        radio: Radio::Uwb,
        reception: None,
    }
}

/// Ten epochs a second, the four anchors 5 ms after each other.
fn walk(site: &RadioSite, seed: u64) -> Vec<RangeSample> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut ranges = Vec::new();
    for epoch in 0..EPOCHS {
        for (k, anchor) in site.anchors.iter().enumerate() {
            let time_s = 0.1 * f64::from(epoch) + 0.005 * k as f64;
            let noise: f64 = StandardNormal.sample(&mut random);
            let distance = (truth(time_s) - anchor.position_m).norm();
            ranges.push(range(&anchor.id, time_s, distance + anchor.range_offset_m + SIGMA_M * noise));
        }
    }
    ranges
}

fn params(site: &Arc<RadioSite>, kind: SolverKind, height_sigma_m: f64) -> UwbLsParams {
    let solver = SolverParams { kind, height_m: Some(1.1), height_sigma_m, ..SolverParams::default() };
    let ranges = RangesParams { sigma_m: SIGMA_M, ..RangesParams::default() };
    UwbLsParams { ranges, solver, ..UwbLsParams::default() }.at_site(site)
}

fn run(
    params: UwbLsParams,
    log: impl IntoIterator<Item = Observation>,
) -> Result<(Vec<Solution>, UwbLsReport), MethodError> {
    let mut method = params.start()?;
    let mut all = Vec::new();
    for observation in log {
        let mut solution = method.observe(&observation)?;
        while let Some(now) = solution {
            all.push(now);
            solution = method.next_due()?;
        }
    }
    while let Some(last) = method.finish_next()? {
        all.push(last);
    }
    Ok((all, method.report().clone()))
}

fn observations(ranges: Vec<RangeSample>) -> impl Iterator<Item = Observation> {
    ranges.into_iter().map(Observation::Range)
}

fn level_errors(solutions: &[Solution]) -> Vec<f64> {
    let error = |one: &Solution| (one.position_m - truth(one.time.seconds())).xy().norm();
    let mut errors: Vec<f64> = solutions.iter().map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

#[test]
fn every_epoch_is_a_position_as_sure_as_it_says() {
    let mut site = lab();
    Arc::make_mut(&mut site).anchors[1].range_offset_m = 0.4;
    for kind in [SolverKind::Linear, SolverKind::Robust] {
        let (solutions, report) = run(params(&site, kind, 0.0), observations(walk(&site, 3))).unwrap();
        assert_eq!((report.heard.ranges, report.heard.epochs, report.fixes), (1600, 400, 400), "{kind:?}");
        assert_eq!((report.heard.late_ranges, report.heard.unknown_ranges, solutions.len()), (0, 0, 400));
        let errors = level_errors(&solutions);
        let expected = solutions.iter().map(|one| one.covariance[(0, 0)] + one.covariance[(1, 1)]);
        let expected = (expected.sum::<f64>() / f64::from(EPOCHS)).sqrt();
        // The fit believes in long tails that are not here: ν/(ν−2) = 2 times the variance of normal errors with four ranges, a share of 1/√2 and some per cent
        // for its weights; the linear one in normal errors. Shares over 400 epochs: ±0.025.
        let share = rms(&errors) / expected;
        let honest = if kind == SolverKind::Linear { 0.9..1.1 } else { 0.65..0.8 };
        assert!(honest.contains(&share), "{kind:?}: {share}");
        assert!(solutions.windows(2).all(|pair| pair[0].time < pair[1].time));
        // Mean time of four that are 5 ms apart.
        assert!((solutions[0].time.seconds() - 0.0075).abs() < 1e-9);
    }
}

#[test]
fn a_range_around_a_corner_moves_the_robust_fix_less() {
    let mut site = lab();
    // Six anchors: one wrong of four is not found with the place still open in two directions.
    let anchors = &mut Arc::make_mut(&mut site).anchors;
    for (id, position_m) in [("a5", Vector3::new(0.2, 8.0, 2.5)), ("a6", Vector3::new(23.8, 8.0, 2.5))] {
        let first = anchors[0].clone();
        anchors.push(SiteAnchor { id: id.into(), position_m, ..first });
    }
    let mut ranges = walk(&site, 4);
    for long in ranges.iter_mut().filter(|range| range.anchor.as_str() == "a3") {
        long.range_m += 2.0;
    }
    let errors = |kind| {
        let (solutions, _) = run(params(&site, kind, 0.3), observations(ranges.clone())).unwrap();
        rms(&level_errors(&solutions))
    };
    let (linear, robust) = (errors(SolverKind::Linear), errors(SolverKind::Robust));
    assert!(robust < 0.2 && linear > 3.0 * robust, "{linear} {robust}");
}

#[test]
fn late_unknown_and_foreign_ranges_are_counted_and_left() {
    let site = lab();
    let mut ranges = walk(&site, 5);
    let late = RangeSample { time: seconds(0.002), ..ranges[0].clone() };
    ranges.insert(40, late);
    ranges.insert(20, range("a9", 0.501, 4.0));
    let wifi = RangeSample { radio: Radio::Wifi, range_m: 50.0, ..ranges[24].clone() };
    ranges.insert(24, wifi);
    let (solutions, report) =
        run(params(&site, SolverKind::Robust, 0.0), observations(ranges.clone())).unwrap();
    assert_eq!((report.heard.ranges, report.heard.late_ranges, report.heard.unknown_ranges), (1602, 1, 1));
    assert_eq!(solutions.len(), 400);
    let warning = MethodWarning::UnknownAnchors { anchors: 1, ranges: 1, names: "a9".into() };
    assert_eq!(report.warnings, [warning]);
    let none = UwbLsParams {
        ranges: RangesParams { tag: Some("t2".into()), ..RangesParams::default() },
        ..params(&site, SolverKind::Robust, 0.0)
    };
    let error = run(none, observations(ranges)).unwrap_err();
    assert!(matches!(error, MethodError::NoRangeFix { ranges: 0, .. }), "{error}");
}

/// Ranges that come half a second after the sensors of their time still make whole epochs.
#[test]
fn a_delay_of_the_radio_splits_no_epoch() {
    let site = lab();
    let ranges = walk(&site, 6);
    let mut log: Vec<(f64, Observation)> =
        ranges.iter().map(|range| (range.time.seconds() + 0.5, Observation::Range(range.clone()))).collect();
    for tick in 0..4200 {
        let time_s = 0.01 * f64::from(tick);
        let imu = ImuSample {
            time: seconds(time_s),
            angular_rate_rad_s: Vector3::zeros(),
            specific_force_m_s2: Vector3::z() * 9.81,
        };
        log.push((time_s, Observation::Imu(imu)));
    }
    log.sort_by(|a, b| a.0.total_cmp(&b.0));
    let delayed = run(params(&site, SolverKind::Robust, 0.0), log.into_iter().map(|(_, one)| one)).unwrap();
    let plain = run(params(&site, SolverKind::Robust, 0.0), observations(ranges)).unwrap();
    assert_eq!(delayed.1, plain.1);
    assert_eq!(delayed.0, plain.0);
}

#[test]
fn settings_and_sites_that_cannot_be_used_are_told() {
    let site = lab();
    let bad = SolverParams { dof: 0.0, ..SolverParams::default() };
    let error = UwbLsParams { solver: bad, ..UwbLsParams::default() }.at_site(&site).start().err().unwrap();
    assert!(matches!(error, MethodError::Setting { name: "solver.dof", .. }), "{error}");
    let error = UwbLsParams::default().start().err().unwrap();
    assert_eq!(error.to_string(), "uwb-ls needs the places of the anchors (--mine)");
}
