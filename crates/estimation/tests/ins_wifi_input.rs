//! Odd input to `reduced-ins-wifi`: refused or answered, never a panic.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "support/roadway.rs"]
mod roadway;

use adit_core::nalgebra::Vector2;
use adit_core::time::Time;
use adit_estimation::methods::ins_wifi::{
    FullInsWifiParams, InsWifiParams, Reduced, ReducedInsWifi, ReducedInsWifiParams,
};
use adit_estimation::methods::{Known, MethodError, MethodSettings, MethodWarning};
use adit_observation::{FixSource, Observation, PositionFix};
use proptest::prelude::*;
use roadway::{errors, params, s0, solve};

#[test]
fn it_does_not_start_without_knowing_where_it_is() {
    let run = s0(1);
    let whole = params(&run);
    for (params, name) in [
        (InsWifiParams { site: None, ..whole.clone() }, "site"),
        (InsWifiParams { start: None, ..whole.clone() }, "start"),
        (InsWifiParams { gap_s: -1.0, ..whole.clone() }, "gap_s"),
        (InsWifiParams { fix_nis_bound: f64::NAN, ..whole.clone() }, "fix_nis_bound"),
    ] {
        let error = ReducedInsWifi::new(params).unwrap_err();
        assert_eq!(error, MethodError::Setting { method: "reduced-ins-wifi", name });
    }
    let known = Known { site: whole.site, start: whole.start, ..Known::default() };
    ReducedInsWifiParams::default().knowing(&known).start().unwrap();
    let mut full = FullInsWifiParams::default().knowing(&known).start().unwrap();
    assert_eq!(full.finish_next().unwrap_err(), MethodError::Empty);
}

#[test]
fn a_fix_between_two_samples_is_taken_at_its_own_time() {
    let run = s0(5);
    // The fixes of 40 s on come 0.04 s late in time and place; a walker at 1.5 m/s is 6 cm on by then.
    let shifted: Vec<Observation> = run
        .log
        .iter()
        .map(|observation| match observation {
            Observation::Fix(fix) => {
                let time = Time::from_nanos(fix.time.nanos() + 40_000_000);
                let index = run.truth.partition_point(|state| state.time < fix.time);
                let velocity = run.truth[index].velocity_m_s.xy();
                Observation::Fix(PositionFix { time, level_m: fix.level_m + velocity * 0.04, ..*fix })
            }
            other => other.clone(),
        })
        .collect();
    let between = roadway::Run { log: shifted, truth: run.truth.clone(), told: run.told };
    let (there, _) = solve::<Reduced, 10>(&run, params(&run)).unwrap();
    let (here, method) = solve::<Reduced, 10>(&between, params(&between)).unwrap();
    // The last one has no sample after it.
    assert_eq!(method.report().used_fixes, 49);
    let (there, here) = (errors(&run, &there), errors(&between, &here));
    for index in (1000..9990).step_by(97) {
        let apart = (there[index].position_m - here[index].position_m).norm();
        // Between two fixes both have the same knowledge; a walker accelerates by 0.7 m/s² at most: 0.6 mm in 0.04 s.
        let since_fix_s = there[index].time_s % 20.0;
        assert!(since_fix_s < 0.2 || apart < 0.01, "{apart} m at {} s", there[index].time_s);
    }
}

#[test]
fn an_outlier_pulls_no_more_than_a_fix_at_the_bound() {
    let mut run = s0(8);
    let index =
        run.log.iter().rposition(|o| matches!(o, Observation::Fix(fix) if fix.time.seconds() < 505.0));
    if let Some(Observation::Fix(fix)) = index.map(|index| &mut run.log[index]) {
        fix.level_m += Vector2::new(40.0, -30.0);
    }
    let (solutions, method) = solve::<Reduced, 10>(&run, params(&run)).unwrap();
    assert_eq!(method.report().bounded_fixes, 1);
    let worst = errors(&run, &solutions)
        .iter()
        .filter(|e| e.time_s > 505.0)
        .map(|e| e.position_m.xy().norm())
        .fold(0.0, f64::max);
    let last = errors(&run, &solutions).pop().unwrap();
    assert!(last.turn_rad.abs() < 0.01 && last.velocity_m_s.norm() < 0.05, "an outlier is forgotten");
    // 4 σ of the prediction, 0.5 m, at once; and for the 20 s to the next fix the velocity that goes with it.
    assert!(worst < 1.5, "{worst} m after an outlier of 50 m");
}

#[test]
fn a_gap_is_bridged_and_told() {
    let run = s0(9);
    let whole = run.log.iter().filter(|o| !(300.0..308.0).contains(&o.time().seconds()));
    let gapped = roadway::Run { log: whole.cloned().collect(), truth: run.truth.clone(), told: run.told };
    let (solutions, method) = solve::<Reduced, 10>(&gapped, params(&gapped)).unwrap();
    assert!(matches!(method.report().warnings[..], [MethodWarning::Gap { length_s, .. }] if length_s > 7.9));
    let before = solutions.iter().rfind(|s| s.time.seconds() < 300.0).unwrap().radius_95_m();
    let after = solutions.iter().find(|s| s.time.seconds() > 307.9).unwrap().radius_95_m();
    // Eight seconds at 1 m/s, 1 σ.
    assert!(after > 15.0 && before < 1.0, "{before} m before, {after} m after");
    let (last, truth) = (solutions.last().unwrap(), run.truth.last().unwrap());
    assert!((last.position_m - truth.position_m).xy().norm() < 1.0);
}

#[test]
fn late_fixes_are_counted_and_left() {
    let mut run = s0(2);
    run.log.truncate(500);
    let old = PositionFix::level(Time::from_nanos(1), Vector2::new(500.0, 500.0), 0.1, FixSource::Wifi);
    run.log.push(Observation::Fix(old));
    let (_, method) = solve::<Reduced, 10>(&run, params(&run)).unwrap();
    assert_eq!(method.report().late_fixes, 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nothing_makes_it_panic(
        wild in prop::collection::vec((0_usize..400, any::<f64>(), -1e7..1e7_f64, any::<i64>()), 1..20),
    ) {
        let mut run = s0(4);
        run.log.truncate(400);
        for (at, value, number, nanos) in wild {
            let index = at % run.log.len();
            match &mut run.log[index] {
                Observation::Imu(imu) if at % 3 == 0 => imu.specific_force_m_s2.x = value,
                Observation::Imu(imu) if at % 3 == 1 => imu.angular_rate_rad_s.z = number,
                Observation::Imu(imu) => imu.time = Time::from_nanos(nanos),
                Observation::Fix(fix) => fix.level_m.x = value,
                _ => {}
            }
            let fix = PositionFix::level(Time::from_nanos(nanos), Vector2::new(number, value), 0.1, FixSource::Uwb);
            run.log.insert(at % run.log.len(), Observation::Fix(fix));
        }
        let settings = params(&run);
        if let Ok((solutions, _)) = solve::<Reduced, 10>(&run, settings) {
            for solution in solutions {
                prop_assert!(solution.position_m.iter().all(|v| v.is_finite()));
            }
        }
    }
}
