//! What `foot-ins` refuses, and what it warns of and goes on.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution};
use adit_core::time::{Interval, Time};
use adit_estimation::methods::foot_ins::{FixedLag, FootIns, FootInsParams, smooth};
use adit_estimation::methods::{MethodError, MethodWarning};
use adit_observation::{ImuSample, MagneticSample, Observation};
use support::sample;
use support::walk::{Walk, run};

/// Two seconds of rest at 200 Hz.
fn rest() -> Vec<ImuSample> {
    let level = |k: u32| sample(f64::from(k) * 0.005, Vector3::zeros(), Vector3::z() * 9.80665);
    (1..=400).map(level).collect()
}

fn observed(samples: &[ImuSample]) -> Vec<Observation> {
    samples.iter().copied().map(Observation::Imu).collect()
}

fn outcome(samples: &[ImuSample]) -> Result<usize, MethodError> {
    run(FootInsParams::default(), &observed(samples)).map(|(solutions, _)| solutions.len())
}

#[test]
fn rejects_a_value_that_is_no_number() {
    assert_eq!(outcome(&rest()), Ok(400));
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..6 {
            // During alignment, just after it, and long after.
            for at in [3, 130, 380] {
                let mut samples = rest();
                let s = &mut samples[at];
                let time = s.time;
                match axis {
                    0..3 => s.angular_rate_rad_s[axis] = broken,
                    _ => s.specific_force_m_s2[axis - 3] = broken,
                }
                assert_eq!(outcome(&samples), Err(MethodError::NoReading { time }));
            }
        }
    }
}

#[test]
fn rejects_time_that_stands_or_runs_backwards() {
    for at in [3, 130, 380] {
        for back_ns in [0, 1, 5_000_000, 900_000_000] {
            let mut samples = rest();
            let before = samples[at - 1].time;
            samples[at].time = before - Interval::from_nanos(back_ns);
            let found = samples[at].time;
            assert_eq!(outcome(&samples), Err(MethodError::TimeNotRising { found, before }));
        }
    }
}

#[test]
fn a_refused_sample_leaves_the_walker_as_he_was() {
    let walk = Walk::straight(5.0, 1).unwrap();
    let (undisturbed, _) = run(FootInsParams::default(), &walk.observations()).unwrap();
    let mut method = FootIns::new(FootInsParams::default()).unwrap();
    let mut solutions = Vec::new();
    for (k, imu) in walk.samples.iter().enumerate() {
        solutions.extend(method.observe(&Observation::Imu(*imu)).unwrap());
        if k % 50 == 0 {
            let mut lost = *imu;
            assert!(method.observe(&Observation::Imu(lost)).is_err());
            lost.time = imu.time + Interval::from_nanos(1_000);
            lost.angular_rate_rad_s.x = f64::NAN;
            assert!(method.observe(&Observation::Imu(lost)).is_err());
        }
    }
    while let Some(solution) = method.finish_next().unwrap() {
        solutions.push(solution);
    }
    assert_eq!(solutions, undisturbed);
}

#[test]
fn rejects_a_specific_force_in_g() {
    let mut samples = rest();
    for s in &mut samples {
        s.specific_force_m_s2 /= 9.80665;
    }
    let error = outcome(&samples).unwrap_err();
    assert!(matches!(error, MethodError::NotGravity { found, .. } if (found - 1.0).abs() < 1e-12));
    assert!(error.to_string().contains("is it in g"), "{error}");
}

#[test]
fn rejects_free_fall() {
    for force_m_s2 in [0.0, 0.05] {
        let mut samples = rest();
        for s in &mut samples {
            s.specific_force_m_s2 = Vector3::z() * force_m_s2;
        }
        let error = outcome(&samples).unwrap_err();
        assert!(error.to_string().starts_with("mean specific force at the start is"), "{error}");
    }
}

#[test]
fn names_the_setting_that_is_out_of_range() {
    type Change = fn(&mut FootInsParams);
    let changes: [(&str, Change); 9] = [
        ("gravity_m_s2", |p| p.gravity_m_s2 = 0.0),
        ("alignment_s", |p| p.alignment_s = -1.0),
        ("declination_rad", |p| p.declination_rad = f64::NAN),
        ("gap_s", |p| p.gap_s = f64::INFINITY),
        ("stance.acc_scale_m_s2", |p| p.stance.acc_scale_m_s2 = 0.0),
        ("noise.angle_random_walk_rad_sqrt_s", |p| p.noise.angle_random_walk_rad_sqrt_s = f64::NAN),
        ("initial.tilt_rad", |p| p.initial.tilt_rad = -0.1),
        ("zero_velocity.sigma_m_s", |p| p.zero_velocity.sigma_m_s = 0.0),
        ("rest_gravity.sigma_m_s2", |p| p.rest_gravity.sigma_m_s2 = f64::INFINITY),
    ];
    for (setting, change) in changes {
        let mut params = FootInsParams::default();
        change(&mut params);
        let error = FootIns::new(params.clone()).unwrap_err();
        assert_eq!(error, MethodError::Setting { method: "foot-ins", name: setting });
        assert!(error.to_string().contains(setting));
        assert_eq!(FixedLag::new(params.clone(), 1.0).unwrap_err(), error);
        assert_eq!(smooth(params, &[], &mut |_| ()).unwrap_err(), error);
    }
}

#[test]
fn an_empty_log_is_an_error() {
    let magnetic = MagneticSample { time: Time::ZERO, field_ut: Vector3::x() * 40.0 };
    for observations in [vec![], vec![Observation::Magnetic(magnetic)]] {
        assert_eq!(run(FootInsParams::default(), &observations).unwrap_err(), MethodError::Empty);
        let smoothed = smooth(FootInsParams::default(), &observations, &mut |_| ());
        assert_eq!(smoothed.unwrap_err(), MethodError::Empty);
    }
}

#[test]
fn a_log_shorter_than_the_alignment_still_gives_its_solutions() {
    for count in [2, 10, 60] {
        assert_eq!(outcome(&rest()[..count]), Ok(count));
    }
}

#[test]
fn a_walk_that_starts_in_motion_begins_at_its_first_stance() {
    let walk = Walk::straight(20.0, 2).unwrap();
    let moving = walk.truth.iter().position(|t| !t.stance).unwrap() + 40;
    let samples = &walk.samples[moving..];
    let (solutions, report) = run(FootInsParams::default(), &observed(samples)).unwrap();
    assert_eq!(report.warnings, [MethodWarning::NoRestAtStart]);
    assert_eq!(solutions.len(), samples.len());

    let begun = solutions.iter().position(|s| s.quality != Quality::Lost).unwrap();
    let truth = &walk.truth[moving..];
    assert!(truth[begun].velocity_m_s.norm() < 0.1, "{}", truth[begun].velocity_m_s.norm());
    assert!(solutions[..begun].iter().all(|s| s.position_m == Vector3::zeros()));
    let (walked, estimated) = (
        truth[truth.len() - 1].position_m - truth[begun].position_m,
        solutions[solutions.len() - 1].position_m - solutions[begun].position_m,
    );
    assert!(
        (estimated.norm() / walked.norm() - 1.0).abs() < 0.02,
        "{} of {}",
        estimated.norm(),
        walked.norm()
    );

    let (smoothed, _) = smooth(FootInsParams::default(), &observed(samples), &mut |_| ()).unwrap();
    assert!(
        smoothed[..=begun].iter().all(|s| s.position_m.norm() < 1e-9),
        "nothing later moves what was before"
    );
}

/// The walk with the samples of `lost_s` seconds from `from_s` on gone.
fn with_gap(walk: &Walk, from_s: f64, lost_s: f64) -> Vec<ImuSample> {
    let kept = |s: &&ImuSample| !(from_s..from_s + lost_s).contains(&s.time.seconds());
    walk.samples.iter().filter(kept).copied().collect()
}

fn position_sigma_m(solution: &Solution) -> f64 {
    solution.position_covariance().trace().sqrt()
}

#[test]
fn a_gap_is_warned_of_and_survived() {
    let params = FootInsParams::default();
    let walk = Walk::straight(20.0, 3).unwrap();
    let (from_s, lost_s) = (8.3, 4.0 * params.gap_s);
    let samples = with_gap(&walk, from_s, lost_s);
    let (solutions, report) = run(params, &observed(&samples)).unwrap();
    assert!(solutions.iter().map(|s| s.time).eq(samples.iter().map(|s| s.time)));
    let after = solutions.partition_point(|s| s.time.seconds() < from_s + 0.5 * lost_s);
    let expected = (samples[after].time - samples[after - 1].time).seconds();
    let warning = MethodWarning::Gap { time: samples[after].time, length_s: expected };
    assert_eq!(report.warnings, [warning]);
    assert!(report.warnings[0].text().contains("samples are missing"));

    // Walking 1.3 m/s for a second: the uncertainty must own up to at least that.
    assert!(position_sigma_m(&solutions[after - 1]) < 0.5);
    assert!(position_sigma_m(&solutions[after]) > 1.0);
    // And the walker counts as lost until a stance has been believed.
    assert_eq!(solutions[after - 1].quality, Quality::DeadReckoning);
    assert_eq!(solutions[after].quality, Quality::Lost);
    assert_eq!(solutions[solutions.len() - 1].quality, Quality::DeadReckoning);
    assert!(solutions.iter().all(|s| s.position_m.iter().chain(s.covariance.iter()).all(|v| v.is_finite())));
    // The next stance tells the velocity again.
    let speed_sigma = |s: &Solution| s.covariance.fixed_view::<3, 3>(3, 3).trace().sqrt();
    assert!(speed_sigma(&solutions[after]) > 1.0);
    let a_stride_later = solutions.partition_point(|s| s.time.seconds() < from_s + lost_s + 1.2);
    let known = solutions[after..a_stride_later].iter().map(speed_sigma).fold(f64::INFINITY, f64::min);
    assert!(known < 0.3, "{known} m/s");
    let end = &solutions[solutions.len() - 1];
    assert!(end.velocity_m_s.norm() < 0.02, "{} m/s", end.velocity_m_s.norm());
}

#[test]
fn a_few_lost_samples_are_no_gap() {
    let params = FootInsParams::default();
    let walk = Walk::straight(20.0, 3).unwrap();
    let samples = with_gap(&walk, 3.0, 0.5 * params.gap_s);
    assert!(run(params, &observed(&samples)).unwrap().1.warnings.is_empty());
}
