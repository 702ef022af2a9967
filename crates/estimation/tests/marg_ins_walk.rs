//! `marg-ins` on simulated walks: heading, disturbance, recovery, refusals, exact replay.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution};
use adit_core::time::Interval;
use adit_estimation::magnetic::gate::ReferenceField;
use adit_estimation::methods::marg_ins::{GateKind, MargIns, MargInsParams, MargInsReport};
use adit_estimation::methods::{Method, MethodError, MethodSettings, MethodWarning};
use adit_observation::{MagneticSample, Observation};
use adit_simulation::Leg;
use support::Draws;
use support::walk::{Walk, path_length_m};

const NORM_UT: f64 = 50.0;
const DIP_RAD: f64 = 1.15;
const DECLINATION_RAD: f64 = 0.12;

fn earth() -> Vector3<f64> {
    let horizontal = NORM_UT * DIP_RAD.cos();
    let north = Vector3::new(DECLINATION_RAD.sin(), DECLINATION_RAD.cos(), 0.0);
    north * horizontal - Vector3::z() * (NORM_UT * DIP_RAD.sin())
}

/// A walk with a magnetometer at half the rate, noise 0.3 µT, and a disturbance by time and true position.
fn with_field(walk: &Walk, disturbance: impl Fn(f64, &Vector3<f64>) -> Vector3<f64>) -> Vec<Observation> {
    let mut draws = Draws::new(9);
    let mut observations = Vec::new();
    for (k, (imu, truth)) in walk.samples.iter().zip(&walk.truth).enumerate() {
        observations.push(Observation::Imu(*imu));
        if k % 2 == 0 {
            let field = earth() + disturbance(imu.time.seconds(), &truth.position_m);
            let field_ut = truth.attitude.inverse_transform_vector(&field) + draws.vector(0.3);
            observations.push(Observation::Magnetic(MagneticSample { time: imu.time, field_ut }));
        }
    }
    observations
}

fn undisturbed(_: f64, _: &Vector3<f64>) -> Vector3<f64> {
    Vector3::zeros()
}

fn told() -> MargInsParams {
    MargInsParams { declination_rad: DECLINATION_RAD, ..MargInsParams::default() }
}

fn naive() -> MargInsParams {
    MargInsParams { magnetic_gate: GateKind::None, ..told() }
}

fn run(
    params: MargInsParams,
    observations: &[Observation],
) -> Result<(Vec<Solution>, MargInsReport), MethodError> {
    let mut method = params.start()?;
    let mut solutions = Vec::new();
    for observation in observations {
        let mut due = method.observe(observation)?;
        while let Some(solution) = due {
            solutions.push(solution);
            due = method.next_due()?;
        }
    }
    while let Some(solution) = method.finish_next()? {
        solutions.push(solution);
    }
    Ok((solutions, method.report().clone()))
}

fn heading_errors_deg<'a>(walk: &'a Walk, solutions: &'a [Solution]) -> impl Iterator<Item = f64> + 'a {
    let error = |(s, t): (&Solution, &adit_simulation::TruthState)| {
        attitude::log(&(s.attitude * t.attitude.inverse())).z
    };
    solutions.iter().zip(&walk.truth).map(error).map(f64::to_degrees)
}

fn largest_heading_error_deg(walk: &Walk, solutions: &[Solution]) -> f64 {
    heading_errors_deg(walk, solutions).map(f64::abs).fold(0.0, f64::max)
}

fn two_legs() -> Walk {
    Walk::with_turn(20.0, Leg::Turn { turn_rad: 1.5 }, 4).unwrap()
}

#[test]
fn the_heading_is_that_of_true_north_and_the_path_lies_in_it() {
    let walk = two_legs();
    let (solutions, report) = run(told(), &with_field(&walk, undisturbed)).unwrap();
    assert_eq!(solutions.len(), walk.samples.len());
    assert!(report.magnetic_heading && report.warnings.is_empty(), "{report:?}");
    assert_eq!(report.headings.disturbed + report.headings.disagreed, 0, "{report:?}");
    // 0.3 µT of noise over 50 readings at the start, and a tilt error of some 0.1° times the tangent of the dip (2.2).
    let largest = largest_heading_error_deg(&walk, &solutions);
    assert!(largest < 1.0, "{largest}");
    // No alignment: east is east.
    let end = solutions.last().unwrap().position_m - walk.truth.last().unwrap().position_m
        + walk.truth[0].position_m;
    assert!(end.norm() < 0.01 * walk.length_m(), "{end}");
    let declined = MargInsParams::default();
    let (magnetic, _) = run(declined, &with_field(&walk, undisturbed)).unwrap();
    let turned = attitude::log(&(solutions[900].attitude * magnetic[900].attitude.inverse())).z;
    assert!((turned + DECLINATION_RAD).abs() < 0.01, "without a declination, magnetic north: {turned}");
}

#[test]
fn a_passing_disturbance_drags_the_naive_heading_and_not_the_gated_one() {
    let walk = two_legs();
    // 30 µT to the north-east for 8 s, rising and falling over 2 s, as a car that comes by.
    let car = |time_s: f64, _: &Vector3<f64>| {
        let near = (1.0 - (time_s - 12.0).abs() / 6.0).clamp(0.0, 1.0 / 3.0) * 3.0;
        Vector3::new(20.0, 20.0, 10.0) * near
    };
    let observations = with_field(&walk, car);
    let (gated, report) = run(told(), &observations).unwrap();
    let (dragged, _) = run(naive(), &observations).unwrap();
    assert!(report.headings.disturbed > 5, "{report:?}");
    let (gated, dragged) =
        (largest_heading_error_deg(&walk, &gated), largest_heading_error_deg(&walk, &dragged));
    assert!(gated < 1.5, "{gated}");
    assert!(dragged > 10.0, "{dragged}");
}

#[test]
fn a_start_beside_steel_is_known_by_a_given_field_and_mended_when_it_is_left() {
    let walk = Walk::straight(40.0, 6).unwrap();
    let steel = |_: f64, position: &Vector3<f64>| {
        let off = (position - walk.truth[0].position_m).norm();
        Vector3::new(18.0, -4.0, 9.0) * (1.0 - off / 6.0).clamp(0.0, 1.0)
    };
    let observations = with_field(&walk, steel);
    let mut params = told();
    params.heading.reference = Some(ReferenceField { norm_ut: NORM_UT, dip_rad: DIP_RAD });
    let (solutions, report) = run(params, &observations).unwrap();
    assert!(matches!(report.warnings[..], [MethodWarning::DisturbedAtStart { .. }]), "{:?}", report.warnings);
    let errors: Vec<f64> = heading_errors_deg(&walk, &solutions).collect();
    let said = |s: &Solution| s.covariance[(8, 8)].sqrt().to_degrees();
    assert!(
        errors[400].abs() > 15.0 && said(&solutions[400]) > errors[400].abs(),
        "{} ± {}",
        errors[400],
        said(&solutions[400])
    );
    // The last edge of the steel, within the limits, is off by 16°; the places after it outvote it.
    let last = *errors.last().unwrap();
    assert!(last.abs() < 4.0 && said(solutions.last().unwrap()) < 4.0, "{last}");

    // Without the field of the site nobody can tell at the start; the walk tells, and the log says so.
    let (solutions, report) = run(told(), &observations).unwrap();
    let opened = |warning: &MethodWarning| matches!(warning, MethodWarning::HeadingOpened { .. });
    assert_eq!(report.warnings.iter().filter(|w| opened(w)).count(), 1, "{:?}", report.warnings);
    let last = heading_errors_deg(&walk, &solutions).last().unwrap();
    assert!(last.abs() < 3.0, "{last}");
}

#[test]
fn without_a_magnetometer_it_is_an_inertial_navigator_and_says_so() {
    let walk = two_legs();
    let (solutions, report) = run(told(), &walk.observations()).unwrap();
    assert_eq!(report.warnings, [MethodWarning::NoMagnetometer]);
    assert!(walk.end_error_m(&solutions) < 0.01 * walk.length_m());
}

#[test]
fn a_magnetometer_that_wakes_up_late_turns_the_path_to_north() {
    let walk = two_legs();
    let late = |o: &Observation| matches!(o, Observation::Imu(_)) || o.time().seconds() > 8.0;
    let observations: Vec<_> = with_field(&walk, undisturbed).into_iter().filter(late).collect();
    let (solutions, _) = run(told(), &observations).unwrap();
    let last = heading_errors_deg(&walk, &solutions).last().unwrap();
    assert!(last.abs() < 3.0, "{last}");
}

#[test]
fn the_mounting_of_the_sensor_does_not_matter() {
    let walk = two_legs();
    let observations = with_field(&walk, undisturbed);
    let (plain, _) = run(told(), &observations).unwrap();
    for turn in [Vector3::new(3.1, 0.0, 0.0), Vector3::new(0.0, -1.5, 0.0), Vector3::new(0.4, 1.1, -2.0)] {
        let mounting = attitude::exp(&turn);
        let turned: Vec<Observation> = observations
            .iter()
            .map(|observation| match observation.clone() {
                Observation::Imu(mut s) => {
                    s.angular_rate_rad_s = mounting.inverse_transform_vector(&s.angular_rate_rad_s);
                    s.specific_force_m_s2 = mounting.inverse_transform_vector(&s.specific_force_m_s2);
                    Observation::Imu(s)
                }
                Observation::Magnetic(mut s) => {
                    s.field_ut = mounting.inverse_transform_vector(&s.field_ut);
                    Observation::Magnetic(s)
                }
                other => other,
            })
            .collect();
        let (solutions, _) = run(told(), &turned).unwrap();
        let (a, b) = (plain.last().unwrap(), solutions.last().unwrap());
        // Rounding of the readings alone: the path is the same to a millimetre, and so is the attitude of the body.
        assert!((a.position_m - b.position_m).norm() < 1e-3, "{turn}");
        assert!(a.attitude.angle_to(&(b.attitude * mounting.inverse())) < 1e-4, "{turn}");
    }
}

#[test]
fn a_walk_that_starts_in_motion_begins_at_its_first_stance_with_the_heading_of_the_field() {
    let walk = two_legs();
    let first = walk.truth.iter().position(|t| t.velocity_m_s.norm() > 2.0).unwrap();
    let cut = Walk { samples: walk.samples[first..].to_vec(), truth: walk.truth[first..].to_vec() };
    let (solutions, report) = run(told(), &with_field(&cut, undisturbed)).unwrap();
    assert_eq!(report.warnings[0], MethodWarning::NoRestAtStart);
    assert_eq!(solutions[0].quality, Quality::Lost);
    let last = heading_errors_deg(&cut, &solutions).last().unwrap();
    assert!(last.abs() < 3.0, "{last}");
}

#[test]
fn what_is_no_sample_is_refused_and_leaves_the_walker_as_he_was() {
    let walk = Walk::straight(4.0, 1).unwrap();
    let observations = with_field(&walk, undisturbed);
    let (undisturbed, _) = run(told(), &observations).unwrap();
    let mut method = MargIns::new(told()).unwrap();
    let mut solutions = Vec::new();
    for observation in &observations {
        solutions.extend(method.observe(observation).unwrap());
        match observation.clone() {
            Observation::Imu(mut imu) => {
                let again = method.observe(&Observation::Imu(imu)).unwrap_err();
                assert_eq!(again, MethodError::TimeNotRising { found: imu.time, before: imu.time });
                imu.time = imu.time + Interval::from_nanos(1000);
                imu.specific_force_m_s2.y = f64::NAN;
                let lost = method.observe(&Observation::Imu(imu)).unwrap_err();
                assert_eq!(lost, MethodError::NoReading { time: imu.time });
            }
            Observation::Magnetic(mut magnetic) => {
                magnetic.field_ut.x = f64::INFINITY;
                assert_eq!(method.observe(&Observation::Magnetic(magnetic)), Ok(None));
            }
            _ => {}
        }
    }
    while let Some(solution) = method.finish_next().unwrap() {
        solutions.push(solution);
    }
    assert!(solutions == undisturbed);
}

#[test]
fn a_log_without_samples_and_a_setting_out_of_range_are_errors() {
    type Change = fn(&mut MargInsParams);
    assert_eq!(run(told(), &[]).unwrap_err(), MethodError::Empty);
    let changes: [(&str, Change); 7] = [
        ("drift_correlation_s", |p| p.drift_correlation_s = 0.0),
        ("initial.drift_rad_s", |p| p.initial.drift_rad_s = f64::NAN),
        ("heading.field_sigma_ut", |p| p.heading.field_sigma_ut = 0.0),
        ("heading.reference.norm_ut", |p| {
            p.heading.reference = Some(ReferenceField { norm_ut: -1.0, dip_rad: 0.0 });
        }),
        ("heading.disturbance.relearn_m", |p| p.heading.disturbance.relearn_m = f64::INFINITY),
        ("stance.gain", |p| p.stance.gain = -1.0),
        ("zero_velocity.sigma_m_s", |p| p.zero_velocity.sigma_m_s = 0.0),
    ];
    for (name, change) in changes {
        let mut params = told();
        change(&mut params);
        let error = MargIns::new(params).unwrap_err();
        assert_eq!(error, MethodError::Setting { method: "marg-ins", name });
    }
}

#[test]
fn a_method_without_a_smoother_says_so() {
    const { assert!(!MargInsParams::FIXED_LAG && !MargInsParams::WHOLE_LOG) };
    assert!(matches!(told().start_fixed_lag(1.0), Err(MethodError::NoSmoother { method: "marg-ins", .. })));
    assert!(matches!(told().smooth(&[], &mut |_| ()), Err(MethodError::NoSmoother { .. })));
}

#[test]
fn a_run_split_by_a_snapshot_equals_the_whole_run_bit_for_bit() {
    let walk = Walk::straight(6.0, 2).unwrap();
    let observations = with_field(&walk, |time_s, _| Vector3::x() * if time_s > 5.0 { 25.0 } else { 0.0 });
    let (whole, whole_report) = run(told(), &observations).unwrap();
    for split in [0, 30, 155, 700, 1_503, observations.len()] {
        let mut method = MargIns::new(told()).unwrap();
        let mut solutions = Vec::new();
        for observation in &observations[..split] {
            solutions.extend(method.observe(observation).unwrap());
        }
        let snapshot = serde_json::to_string(&method).unwrap();
        let mut method: MargIns = serde_json::from_str(&snapshot).unwrap();
        for observation in &observations[split..] {
            solutions.extend(method.observe(observation).unwrap());
        }
        while let Some(solution) = method.finish_next().unwrap() {
            solutions.push(solution);
        }
        // Equality of floating-point numbers, of which none is NaN: every bit but the sign of zero.
        assert!(solutions == whole, "split at {split}");
        assert_eq!(*method.report(), whole_report);
    }
}

#[test]
fn memory_does_not_grow_with_the_log() {
    let walk = Walk::straight(30.0, 3).unwrap();
    let mut method = MargIns::new(told()).unwrap();
    let mut largest = [0, 0];
    let observations = with_field(&walk, undisturbed);
    for (k, observation) in observations.iter().enumerate() {
        method.observe(observation).unwrap();
        let half = usize::from(k > observations.len() / 2);
        largest[half] = largest[half].max(method.state_bytes());
    }
    assert!(largest[1] <= largest[0] && largest[1] < 64 * 1024, "{largest:?}");
    assert!(path_length_m(walk.truth.iter().map(|t| t.position_m)) > 29.0);
}

#[test]
fn the_covariance_of_the_heading_is_honest_about_the_start() {
    let walk = two_legs();
    let (solutions, _) = run(told(), &with_field(&walk, undisturbed)).unwrap();
    let sigma_deg = |s: &Solution| s.covariance[(8, 8)].sqrt().to_degrees();
    // 1 µT across 20.4 µT of horizontal field, and 0.04 rad of tilt times 2.2: 5.8°; in the end the 2.8° of the field alone,
    // less what several places average.
    assert!((sigma_deg(&solutions[0]) - 5.8).abs() < 0.3, "{}", sigma_deg(&solutions[0]));
    let last = sigma_deg(solutions.last().unwrap());
    assert!((0.8..3.5).contains(&last), "{last}");
}

#[test]
fn hard_iron_that_the_calibration_left_is_learnt_when_the_walker_turns_round() {
    let walk = Walk::with_turn(20.0, Leg::Turn { turn_rad: 3.0 }, 4).unwrap();
    let iron = Vector3::new(0.5, -0.7, 0.4);
    let observations: Vec<Observation> = with_field(&walk, undisturbed)
        .into_iter()
        .map(|observation| match observation {
            Observation::Magnetic(mut magnetic) => {
                magnetic.field_ut += iron;
                Observation::Magnetic(magnetic)
            }
            other => other,
        })
        .collect();
    let mut params = told();
    (params.heading.field_sigma_ut, params.heading.place_m) = (0.2, 1.0);
    let track = |params: MargInsParams| {
        let mut method = MargIns::new(params).unwrap();
        let mut solutions = Vec::new();
        for observation in &observations {
            solutions.extend(method.observe(observation).unwrap());
        }
        while let Some(solution) = method.finish_next().unwrap() {
            solutions.push(solution);
        }
        let last = heading_errors_deg(&walk, &solutions).last().unwrap();
        (method.filter().unwrap().filter().hard_iron_ut, last.abs())
    };
    let (found, error_deg) = track(params.clone());
    // What is level tells of itself: most of it in one turn.
    assert!((found - iron).xy().norm() < 0.5 * iron.xy().norm(), "{found}");
    params.heading.hard_iron_ut = 0.0;
    let (none, without_deg) = track(params);
    assert!(none == Vector3::zeros() && error_deg < 0.7 * without_deg, "{error_deg} {without_deg}");
}
