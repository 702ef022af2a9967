//! What `ahrs` refuses, and what it goes on with: no input makes it panic or lie about numbers.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_estimation::methods::ahrs::{AhrsParams, smooth};
use adit_estimation::methods::{MethodError, MethodWarning};
use adit_observation::{ImuSample, MagneticSample, Observation};
use proptest::prelude::*;
use support::turning::{Tag, run, worst_deg};

/// The outcome of the streaming run and of the smoother: they see the same log and must agree on what it is worth.
fn outcomes(log: &[Observation]) -> [Result<Vec<Solution>, MethodError>; 2] {
    [
        run(AhrsParams::default(), log).map(|(solutions, _)| solutions),
        smooth(AhrsParams::default(), log, &mut |_| ()).map(|(solutions, _)| solutions),
    ]
}

/// A rotation, and a covariance that is one: symmetric and positive definite.
fn is_sound(solution: &Solution) -> bool {
    let covariance = solution.covariance.fixed_view::<3, 3>(6, 6).into_owned();
    let skew = (covariance - covariance.transpose()).amax();
    (solution.attitude.norm() - 1.0).abs() < 1e-6
        && skew <= 1e-9 * covariance.amax()
        && covariance.cholesky().is_some()
}

fn log() -> Vec<Observation> {
    Tag { duration_s: 20.0, rest_s: 3.0, ..Tag::default() }.record(1).0
}

/// Number and time of the inertial sample at this index or after it.
fn inertial(log: &mut [Observation], from: usize) -> (usize, &mut ImuSample) {
    let found = log.iter_mut().enumerate().skip(from).find_map(|(index, observation)| match observation {
        Observation::Imu(sample) => Some((index, sample)),
        _ => None,
    });
    found.unwrap()
}

/// During the alignment, just after it, and long after.
const PLACES: [usize; 4] = [0, 11, 45, 5000];

#[test]
fn an_inertial_value_that_is_no_number_is_refused() {
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for at in PLACES {
            for axis in 0..6 {
                let mut log = log();
                let (_, sample) = inertial(&mut log, at);
                let time = sample.time;
                match axis {
                    0..3 => sample.angular_rate_rad_s[axis] = broken,
                    _ => sample.specific_force_m_s2[axis - 3] = broken,
                }
                for outcome in outcomes(&log) {
                    assert_eq!(outcome, Err(MethodError::NoReading { time }));
                }
            }
        }
    }
}

#[test]
fn a_field_that_is_no_number_is_left_out() {
    let whole = log();
    for broken in [f64::NAN, f64::INFINITY] {
        let mut broken_log = whole.clone();
        let mut without = Vec::new();
        for (index, observation) in broken_log.iter_mut().enumerate() {
            match observation {
                Observation::Magnetic(sample) if index % 10 == 1 => sample.field_ut.y = broken,
                _ => without.push(observation.clone()),
            }
        }
        assert_eq!(outcomes(&broken_log), outcomes(&without));
    }
}

#[test]
fn time_that_stands_or_runs_backwards_is_refused() {
    for at in [2, 45, 5000] {
        for back_ns in [0, 1, 700_000_000] {
            let mut log = log();
            let before = inertial(&mut log, at).1.time;
            let (index, _) = inertial(&mut log, at);
            let (_, next) = inertial(&mut log, index + 1);
            next.time = before - Interval::from_nanos(back_ns);
            let found = next.time;
            for outcome in outcomes(&log) {
                assert_eq!(outcome, Err(MethodError::TimeNotRising { found, before }));
            }
        }
    }
}

#[test]
fn a_sensor_without_gravity_at_the_start_is_refused() {
    let with_force = |force: Vector3<f64>| {
        let mut log = log();
        for observation in &mut log {
            if let Observation::Imu(sample) = observation {
                sample.specific_force_m_s2 = force;
                sample.angular_rate_rad_s = Vector3::zeros();
            }
        }
        outcomes(&log)
    };
    for outcome in with_force(Vector3::zeros()) {
        assert_eq!(outcome, Err(MethodError::NoForce));
    }
    // In g instead of m/s².
    for outcome in with_force(Vector3::z()) {
        assert!(matches!(outcome, Err(MethodError::NotGravity { .. })), "{outcome:?}");
    }
}

#[test]
fn a_log_without_inertial_samples_is_told_so() {
    let magnetic = |o: &Observation| matches!(o, Observation::Magnetic(_));
    let fields: Vec<Observation> = log().into_iter().filter(magnetic).collect();
    for nothing in [&[][..], &fields[..10], &fields] {
        for outcome in outcomes(nothing) {
            assert_eq!(outcome, Err(MethodError::Empty), "{} fields", nothing.len());
        }
    }
}

#[test]
fn a_fall_a_blow_a_magnet_and_a_dead_magnetometer_are_survived() {
    let tag = Tag { duration_s: 60.0, ..Tag::default() };
    let (log, truth) = tag.record(2);
    let on_force = |force: Vector3<f64>| {
        move |observation: &mut Observation| {
            if let Observation::Imu(sample) = observation {
                sample.specific_force_m_s2 = force;
            }
        }
    };
    let on_field = |field_ut: Vector3<f64>| {
        move |observation: &mut Observation| {
            if let Observation::Magnetic(sample) = observation {
                sample.field_ut = field_ut;
            }
        }
    };
    let force = |force| Box::new(on_force(force)) as Box<dyn Fn(&mut Observation)>;
    let field = |field| Box::new(on_field(field)) as Box<dyn Fn(&mut Observation)>;
    // A fall, a blow to the end of the range, a magnet beside the tag, a dead magnetometer; for how long, s.
    let cases = [
        ("fall", force(Vector3::zeros()), 0.2),
        ("blow", force(Vector3::repeat(16.0 * 9.81)), 0.02),
        ("magnet", field(Vector3::repeat(4900.0)), 5.0),
        ("dead", field(Vector3::zeros()), 5.0),
    ];
    for (name, spoil, length_s) in cases {
        let mut log = log.clone();
        let spoilt = |o: &&mut Observation| (30.0..30.0 + length_s).contains(&o.time().seconds());
        log.iter_mut().filter(spoilt).for_each(spoil);
        for outcome in outcomes(&log) {
            let solutions = outcome.unwrap();
            assert!(solutions.iter().all(is_sound), "{name}");
            // Twenty seconds later it knows again.
            let (heading, inclination) = worst_deg(&solutions, &truth, 50.0);
            assert!(heading < 2.5 && inclination < 2.0, "{name}: {heading} {inclination}");
        }
    }
}

#[test]
fn covariances_stay_covariances_over_a_long_log() {
    let (log, _) = Tag { duration_s: 300.0, ..Tag::default() }.record(5);
    for outcome in outcomes(&log) {
        let broken = outcome.unwrap().into_iter().find(|solution| !is_sound(solution));
        assert!(broken.is_none(), "{broken:?}");
    }
}

#[test]
fn a_magnetometer_that_starts_first_does_no_harm() {
    let (log, truth) = Tag { duration_s: 60.0, ..Tag::default() }.record(6);
    let late = |o: &&Observation| matches!(o, Observation::Magnetic(_)) || o.time().seconds() > 2.0;
    let log: Vec<Observation> = log.iter().filter(late).cloned().collect();
    let truth = &truth[400..];
    for outcome in outcomes(&log) {
        let solutions = outcome.unwrap();
        assert_eq!(solutions.len(), truth.len());
        let (heading, inclination) = worst_deg(&solutions, truth, 30.0);
        assert!(heading < 2.5 && inclination < 2.0, "{heading} {inclination}");
    }
}

#[test]
fn a_clipped_gyro_is_survived() {
    // Everything at the end of its range for a second: nobody can tell the attitude then, numbers stay numbers.
    let (mut log, _) = Tag { duration_s: 40.0, ..Tag::default() }.record(3);
    for observation in &mut log {
        let time_s = observation.time().seconds();
        if let Observation::Imu(sample) = observation
            && (20.0..21.0).contains(&time_s)
        {
            sample.angular_rate_rad_s = Vector3::new(34.9, -34.9, 34.9);
            sample.specific_force_m_s2 = Vector3::new(156.9, 156.9, -156.9);
        }
    }
    for outcome in outcomes(&log) {
        assert!(outcome.unwrap().iter().all(is_sound));
    }
}

#[test]
fn a_magnetometer_may_come_late_go_away_or_be_on_another_clock() {
    let (log, truth) = Tag { duration_s: 60.0, ..Tag::default() }.record(4);
    let field_between = |from_s: f64, to_s: f64| -> Vec<Observation> {
        let kept = |o: &&Observation| {
            matches!(o, Observation::Imu(_)) || (from_s..to_s).contains(&o.time().seconds())
        };
        log.iter().filter(kept).cloned().collect()
    };
    for (from_s, to_s) in [(20.0, 60.0), (0.0, 20.0), (0.0, 0.05)] {
        for outcome in outcomes(&field_between(from_s, to_s)) {
            let solutions = outcome.unwrap();
            assert_eq!(solutions.len(), truth.len());
            assert!(solutions.iter().all(is_sound), "{from_s} {to_s}");
        }
    }
    for shift_s in [-1e6, -1.0, 1.0, 1e6] {
        let mut log = log.clone();
        for observation in &mut log {
            if let Observation::Magnetic(sample) = observation {
                sample.time = Time::from_seconds(sample.time.seconds() + shift_s).unwrap();
            }
        }
        for outcome in outcomes(&log) {
            assert!(outcome.unwrap().iter().all(is_sound), "{shift_s}");
        }
    }
}

#[test]
fn gaps_one_after_the_other_are_each_told() {
    let mut log = log();
    let shift = |time: Time| {
        time + Interval::from_nanos(
            i64::from(time.seconds() > 5.0) * 2_000_000_000
                + i64::from(time.seconds() > 5.02) * 3_000_000_000
                + i64::from(time.seconds() > 15.0) * 4_000_000_000_000,
        )
    };
    for observation in &mut log {
        *observation = observation.clone().at(shift(observation.time()));
    }
    for (solutions, report) in
        [run(AhrsParams::default(), &log).unwrap(), smooth(AhrsParams::default(), &log, &mut |_| ()).unwrap()]
    {
        assert_eq!(solutions.len(), log.len() / 2);
        assert!(solutions.iter().all(is_sound));
        let gaps = report.warnings.iter().filter(|w| matches!(w, MethodWarning::Gap { .. })).count();
        assert_eq!(gaps, 3, "{:?}", report.warnings);
    }
}

/// Any number a file can hold, ordinary ones more often.
fn number(ordinary: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        20 => -ordinary..ordinary,
        2 => Just(0.0),
        1 => prop::num::f64::ANY,
        1 => -1e6..1e6_f64,
    ]
}

fn vector(ordinary: f64) -> impl Strategy<Value = Vector3<f64>> {
    [number(ordinary), number(ordinary), number(ordinary)].prop_map(Vector3::from)
}

/// An observation, and the nanoseconds since the one before.
fn observation() -> impl Strategy<Value = (i64, Observation)> {
    let step = prop_oneof![
        20 => 1_000_000..20_000_000_i64,
        2 => 1..100_i64,
        1 => 400_000_000..100_000_000_000_i64,
        1 => -10_000_000..1_i64,
    ];
    let imu = (vector(3.0), vector(12.0)).prop_map(|(angular_rate_rad_s, specific_force_m_s2)| {
        Observation::Imu(ImuSample { time: Time::ZERO, angular_rate_rad_s, specific_force_m_s2 })
    });
    let magnetic = vector(50.0)
        .prop_map(|field_ut| Observation::Magnetic(MagneticSample { time: Time::ZERO, field_ut }));
    (step, prop_oneof![2 => imu, 1 => magnetic])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Refused with an error or answered with rotations: nothing else.
    #[test]
    fn any_log_is_refused_or_answered(steps in prop::collection::vec(observation(), 1..400)) {
        let mut time = Time::ZERO;
        let log: Vec<Observation> = steps
            .into_iter()
            .map(|(step_ns, observation)| {
                time = time + Interval::from_nanos(step_ns);
                observation.at(time)
            })
            .collect();
        for solutions in outcomes(&log).into_iter().flatten() {
            prop_assert!(solutions.iter().all(|s| s.attitude.coords.iter().all(|v| v.is_finite())));
        }
    }
}
