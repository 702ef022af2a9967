//! Odd input to `pdr`: refused or answered, never a panic; and runs that are stopped and continued.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::nalgebra::{Vector2, Vector3};
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_estimation::methods::pdr::{Direction, Pdr, PdrParams};
use adit_estimation::methods::{MethodError, MethodWarning};
use adit_observation::{FixSource, ImuSample, MagneticSample, Observation, PositionFix};
use proptest::prelude::*;
use support::strides::Strides;

fn solve(method: &mut Pdr, log: &[Observation]) -> Result<Vec<Solution>, MethodError> {
    let mut solutions = Vec::new();
    for observation in log {
        solutions.extend(method.observe(observation)?);
        solutions.extend(core::iter::from_fn(|| method.next_due()));
    }
    while let Some(solution) = method.finish_next()? {
        solutions.push(solution);
    }
    Ok(solutions)
}

fn log() -> Vec<Observation> {
    Strides { steps: 30, ..Strides::default() }.record(1).0
}

fn fix(time_s: f64) -> Observation {
    let time = Time::from_seconds(time_s).unwrap();
    Observation::Fix(PositionFix::level(time, Vector2::new(3.0, 4.0), 1.0, FixSource::Wifi))
}

#[test]
fn numbers_that_are_none_and_time_that_runs_backwards_are_errors() {
    for spoil in [0, 1] {
        let mut log = log();
        let Observation::Imu(sample) = &mut log[200] else { unreachable!() };
        let time = sample.time;
        let expected = if spoil == 0 {
            sample.specific_force_m_s2.x = f64::NAN;
            MethodError::NoReading { time }
        } else {
            let before = time - Interval::from_nanos(10_000_000);
            sample.time = before;
            MethodError::TimeNotRising { found: before, before }
        };
        let error = solve(&mut Pdr::new(PdrParams::default()).unwrap(), &log).unwrap_err();
        assert_eq!(error, expected);
    }
}

#[test]
fn fixes_of_any_time_are_used_or_counted() {
    let mut log = log();
    // Before the first sample, out of order but not too late, impossible, late, and from before the walk.
    log.insert(0, fix(-1.0));
    log.insert(800, fix(3.99));
    log.insert(1200, fix(5.9));
    log.insert(1201, fix(5.8));
    let mut bad = fix(6.0);
    if let Observation::Fix(fix) = &mut bad {
        fix.covariance_m2[(0, 0)] = -1.0;
    }
    log.insert(1300, bad);
    let end = log.len() - 1;
    log.insert(end, fix(2.0));
    log.insert(end, fix(-3.0));
    let mut method = Pdr::new(PdrParams::default()).unwrap();
    let solutions = solve(&mut method, &log).unwrap();
    assert!(solutions.windows(2).all(|pair| pair[0].time < pair[1].time));
    let report = method.report();
    assert_eq!(report.fixes, 7);
    assert_eq!(report.late_fixes, 1);
    assert_eq!(report.searched_fixes + report.used_fixes, 5);
}

#[test]
fn more_fixes_than_can_wait_are_dropped_and_counted() {
    let mut log = log();
    let extra: Vec<Observation> = (0..500).map(|index| fix(4.0 + 0.01 * f64::from(index))).collect();
    log.splice(900..900, extra);
    let mut method = Pdr::new(PdrParams::default()).unwrap();
    solve(&mut method, &log).unwrap();
    assert!(method.report().late_fixes >= 400, "{:?}", method.report());
}

#[test]
fn a_gap_is_told_and_makes_the_position_uncertain() {
    let walk = Strides { steps: 60, ..Strides::default() };
    let (log, _) = walk.record(2);
    let within = |o: &Observation| (20.0..30.0).contains(&o.time().seconds());
    let cut: Vec<Observation> = log.into_iter().filter(|o| !within(o)).collect();
    let params = PdrParams { direction: Direction::Mounted, ..PdrParams::default() };
    let mut method = Pdr::new(params).unwrap();
    let solutions = solve(&mut method, &cut).unwrap();
    let gaps = method.report().warnings.iter().filter(|w| matches!(w, MethodWarning::Gap { .. })).count();
    assert_eq!(gaps, 1);
    let radius = |at_s: f64| {
        let index = solutions.partition_point(|s| s.time.seconds() < at_s);
        solutions[index].radius_95_m()
    };
    // 20 m walked, with a length and a direction known to an eighth; then 10 s at a standard deviation of 1 m/s.
    assert!(radius(31.0) > 20.0 && radius(19.0) < 8.0, "{} {}", radius(19.0), radius(31.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn a_split_run_is_the_whole_run(split in 0_usize..4400, with_fixes in any::<bool>()) {
        let mut log = Strides { steps: 24, ..Strides::default() }.record(4).0;
        if with_fixes {
            log.extend((0..12).map(|index| fix(4.003 + 1.3 * f64::from(index))));
            log.sort_by_key(Observation::time);
        }
        let mut whole = Pdr::new(PdrParams::default()).unwrap();
        let expected = solve(&mut whole, &log).unwrap();
        let mut parts = Pdr::new(PdrParams::default()).unwrap();
        let mut solutions = Vec::new();
        for (index, observation) in log.iter().enumerate() {
            if index == split {
                parts = serde_json::from_str(&serde_json::to_string(&parts).unwrap()).unwrap();
            }
            solutions.extend(parts.observe(observation).unwrap());
            solutions.extend(core::iter::from_fn(|| parts.next_due()));
        }
        while let Some(solution) = parts.finish_next().unwrap() {
            solutions.push(solution);
        }
        prop_assert_eq!(solutions, expected);
        prop_assert_eq!(parts.report(), whole.report());
    }

    #[test]
    fn any_observations_are_survived(
        samples in prop::collection::vec(
            (0_u8..4, any::<i64>(), prop::array::uniform6(prop_oneof![-50.0..50.0, any::<f64>()])), 0..120,
        ),
        ordered in any::<bool>(),
    ) {
        let mut log: Vec<Observation> = samples
            .into_iter()
            .map(|(kind, nanos, v)| {
                let time = Time::from_nanos(if ordered { nanos.rem_euclid(20_000_000_000) } else { nanos });
                let (a, b) = (Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5]));
                match kind {
                    0 => Observation::Magnetic(MagneticSample { time, field_ut: a }),
                    1 => Observation::Fix(PositionFix::level(time, a.xy(), v[3].abs(), FixSource::Uwb)),
                    _ => Observation::Imu(ImuSample { time, angular_rate_rad_s: a, specific_force_m_s2: b }),
                }
            })
            .collect();
        if ordered {
            log.sort_by_key(Observation::time);
        }
        let mut method = Pdr::new(PdrParams::default()).unwrap();
        if let Ok(solutions) = solve(&mut method, &log) {
            for solution in solutions {
                prop_assert!(solution.position_m.iter().all(|v| v.is_finite()));
            }
        }
    }
}
