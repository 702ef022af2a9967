//! What comes by radio may be late, early and out of order: no method steps back, errs or bends its path for it.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[expect(dead_code, reason = "every test binary compiles this module and uses its own part")]
#[path = "support/roadway.rs"]
mod roadway;
mod support;

use adit_core::nalgebra::Vector2;
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_estimation::methods::ahrs::AhrsParams;
use adit_estimation::methods::foot_ins::FootInsParams;
use adit_estimation::methods::ins_wifi::{FullInsWifiParams, InsWifiReport, Reduced, ReducedInsWifiParams};
use adit_estimation::methods::marg_ins::MargInsParams;
use adit_estimation::methods::{MethodReport, MethodSettings};
use adit_observation::{
    DeviceId, FixSource, Observation, PositionFix, PressureSample, Radio, RangeSample, Sighting,
    SignalStrength,
};
use roadway::{params, s0, solve};
use support::walk::Walk;

fn run<S: MethodSettings>(settings: S, log: &[Observation]) -> (Vec<Solution>, S::Report) {
    let mut method = settings.start().unwrap();
    let mut solutions = Vec::new();
    for observation in log {
        let mut solution = method.observe(observation).unwrap();
        while let Some(now) = solution {
            solutions.push(now);
            solution = method.next_due().unwrap();
        }
    }
    while let Some(last) = method.finish_next().unwrap() {
        solutions.push(last);
    }
    (solutions, method.report().clone())
}

/// One observation of every kind but the tag's inertial and magnetic sensors, and but a fix.
fn heard(time: Time) -> [Observation; 4] {
    let device = DeviceId::new("a0").unwrap();
    [
        Observation::Pressure(PressureSample { time, pressure_pa: 1e5 }),
        Observation::Signal(SignalStrength {
            time,
            transmitter: device.clone(),
            rssi_dbm: -70.0,
            radio: Radio::Wifi,
        }),
        Observation::Range(RangeSample {
            time,
            anchor: device.clone(),
            tag: None,
            range_m: 3.0,
            sigma_m: None,
            line_of_sight: None,
            in_the_way: None,
            radio: Radio::Uwb,
            reception: None,
        }),
        Observation::Sighting(Sighting { time, reader: device }),
    ]
}

fn fix(time: Time) -> Observation {
    Observation::Fix(PositionFix::level(time, Vector2::new(500.0, -500.0), 0.1, FixSource::Uwb))
}

/// The log with something late or early after every observation: `told` makes it for a time.
fn with_chaff<const N: usize>(
    log: &[Observation],
    told: impl Fn(Time) -> [Observation; N],
) -> Vec<Observation> {
    let shifts_s = [-40.0, -0.003, 0.0, 0.003, -1e4, 1e4];
    let chaff = |(index, observation): (usize, &Observation)| {
        let shift = Interval::from_seconds(shifts_s[index % shifts_s.len()]).unwrap();
        [observation.clone()].into_iter().chain(told(observation.time() + shift))
    };
    log.iter().enumerate().flat_map(chaff).collect()
}

#[test]
fn methods_of_the_tags_own_sensors_give_the_same_bits() {
    let log = Walk::straight(10.0, 3).unwrap().observations();
    let chaff = with_chaff(&log, |time| {
        let [pressure, signal, range, sighting] = heard(time);
        [pressure, signal, range, sighting, fix(time)]
    });
    assert!(run(FootInsParams::default(), &log).0 == run(FootInsParams::default(), &chaff).0);
    assert!(run(MargInsParams::default(), &log).0 == run(MargInsParams::default(), &chaff).0);
    assert!(run(AhrsParams::default(), &log).0 == run(AhrsParams::default(), &chaff).0);
    let smooth = |log| FootInsParams::default().smooth(log, &mut |_| ()).unwrap().0;
    assert!(smooth(&log) == smooth(&chaff));
    let smooth = |log| AhrsParams::default().smooth(log, &mut |_| ()).unwrap().0;
    assert!(smooth(&log) == smooth(&chaff));
}

#[test]
fn methods_with_fixes_give_the_same_bits_without_the_late_ones() {
    let mut told = s0(6);
    told.log.truncate(1500);
    let settings = params(&told);
    let chaff = with_chaff(&told.log, heard);
    // A late fix after every other observation, and one from before the first sample.
    let late = |(index, observation): (usize, &Observation)| {
        let late = (index % 2 == 1).then(|| fix(observation.time() - Interval::from_nanos(60_000_000)));
        [observation.clone()].into_iter().chain(late)
    };
    let first = fix(told.log[0].time() - Interval::from_nanos(1));
    let stale: Vec<_> = [first].into_iter().chain(told.log.iter().enumerate().flat_map(late)).collect();
    let late = (stale.len() - told.log.len()) as u64;
    let check = |plain: (Vec<Solution>, InsWifiReport),
                 chaff: Vec<Solution>,
                 stale: (Vec<Solution>, InsWifiReport)| {
        assert!(plain.1.used_fixes > 5 && plain.1.late_fixes == 0);
        assert!(plain.0 == chaff && plain.0 == stale.0);
        assert_eq!((stale.1.late_fixes, stale.1.used_fixes), (late, plain.1.used_fixes));
        assert!(stale.1.warnings().is_empty());
    };
    let reduced = |log| run(ReducedInsWifiParams(settings.clone()), log);
    check(reduced(&told.log), reduced(&chaff).0, reduced(&stale));
    let full = |log| run(FullInsWifiParams(settings.clone()), log);
    check(full(&told.log), full(&chaff).0, full(&stale));
}

#[test]
fn fixes_that_wait_for_their_time_are_taken_in_order_of_time() {
    let run = s0(7);
    // Between two samples each, so that every fix waits; and then each pair the wrong way round, up to 20 s early.
    let fixes: Vec<Observation> = run
        .log
        .iter()
        .filter(|observation| matches!(observation, Observation::Fix(_)))
        .map(|fix| fix.clone().at(fix.time() + Interval::from_nanos(40_000_000)))
        .collect();
    let inertial =
        || run.log.iter().filter(|observation| matches!(observation, Observation::Imu(_))).cloned();
    let merged = |mut fixes: Vec<Observation>, wait: Interval| {
        let mut log = Vec::new();
        for sample in inertial() {
            while let Some(first) = fixes.first().filter(|fix| fix.time() - wait < sample.time()).cloned() {
                fixes.remove(0);
                log.push(first);
            }
            log.push(sample);
        }
        roadway::Run { log, truth: run.truth.clone(), told: run.told }
    };
    let in_order = merged(fixes.clone(), Interval::ZERO);
    let mut swapped = fixes;
    swapped.chunks_exact_mut(2).for_each(|pair| pair.swap(0, 1));
    let swapped = merged(swapped, Interval::from_nanos(21_000_000_000));
    let (expected, method) = solve::<Reduced, 10>(&in_order, params(&in_order)).unwrap();
    assert!(method.report().used_fixes > 40);
    let (found, method) = solve::<Reduced, 10>(&swapped, params(&swapped)).unwrap();
    assert_eq!(method.report().late_fixes, 0);
    assert!(expected == found);
}
