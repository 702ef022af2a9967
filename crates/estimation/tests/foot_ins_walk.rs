//! `foot-ins` over simulated walks: how far it ends from the truth.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_estimation::methods::foot_ins::{FootInsParams, HeadingAid};
use adit_estimation::pedestrian::stance::{Detector, StanceParams};
use adit_observation::{MagneticSample, Observation};
use adit_simulation::Leg;
use core::f64::consts::{FRAC_PI_2, PI};
use support::Draws;
use support::walk::{Walk, path_length_m, run};

fn end(solutions: &[Solution]) -> &Solution {
    &solutions[solutions.len() - 1]
}

#[test]
fn a_straight_walk_of_50_m_ends_within_1_percent() {
    for seed in 1..=3 {
        let walk = Walk::straight(50.0, seed).unwrap();
        let (solutions, _) = run(FootInsParams::default(), &walk.observations()).unwrap();
        let error = walk.end_error_m(&solutions);
        assert!(error < 0.5, "seed {seed}: {error} m");
        let length = path_length_m(solutions.iter().map(|s| s.position_m));
        let share = length / walk.length_m();
        assert!((share - 1.0).abs() < 0.02, "seed {seed}: {share} of the true path");
    }
}

#[test]
fn any_mounting_walks_the_same_path_up_to_the_heading() {
    let walk = Walk::straight(12.0, 4).unwrap();
    let (as_worn, _) = run(FootInsParams::default(), &walk.observations()).unwrap();
    let mut draws = Draws::new(1);
    let mut mountings = vec![attitude::exp(&(Vector3::x() * PI)), attitude::exp(&(Vector3::y() * FRAC_PI_2))];
    mountings.extend((0..3).map(|_| draws.attitude()));
    for mounting in mountings {
        let (solutions, _) = run(FootInsParams::default(), &walk.mounted(&mounting)).unwrap();
        // Both are level: what differs is a turn about the vertical.
        let turn = as_worn[0].attitude * mounting * solutions[0].attitude.inverse();
        assert!((turn * Vector3::z() - Vector3::z()).norm() < 1e-9);
        for (a, b) in solutions.iter().zip(&as_worn) {
            // Nothing in the method prefers an axis of the body: rounding, through a filter of 50 corrections a stride.
            let apart = (turn * a.position_m - b.position_m).norm();
            assert!(apart < 1e-7, "{apart:e} m at {} s", a.time);
        }
    }
}

/// A compass beside the IMU, at 50 Hz, in a field that points `declination_rad` east of north and steeply down.
fn with_magnetometer(walk: &Walk, declination_rad: f64) -> Vec<Observation> {
    let (east, north) = declination_rad.sin_cos();
    let field = Vector3::new(28.0 * east, 28.0 * north, -42.0);
    let mut observations = Vec::new();
    for (k, (imu, truth)) in walk.samples.iter().zip(&walk.truth).enumerate() {
        if k % 4 == 0 {
            let field_ut = truth.attitude.inverse_transform_vector(&field);
            observations.push(Observation::Magnetic(MagneticSample { time: imu.time, field_ut }));
        }
        observations.push(Observation::Imu(*imu));
    }
    observations
}

#[test]
fn a_magnetometer_sets_the_heading_and_declination_shifts_it() {
    let walk = Walk::straight(12.0, 5).unwrap();
    let true_heading = attitude::heading(&walk.truth[0].attitude);
    let start = |declination_of_field: f64, declination_rad: f64| {
        let params = FootInsParams { declination_rad, ..FootInsParams::default() };
        let observations = with_magnetometer(&walk, declination_of_field);
        let (solutions, report) = run(params, &observations).unwrap();
        assert!(report.magnetic_heading);
        (attitude::angle_difference(attitude::heading(&solutions[0].attitude), true_heading), solutions)
    };
    // Tilt errors of 1 mrad (accelerometer bias of 1 mg) under a dip of 56°.
    let tolerance = 0.003;
    assert!(start(0.0, 0.0).0.abs() < tolerance);
    assert!((start(0.1, 0.0).0 + 0.1).abs() < tolerance);
    assert!((start(0.0, 0.1).0 - 0.1).abs() < tolerance);
    let (error, solutions) = start(-0.12, -0.12);
    assert!(error.abs() < tolerance);
    // No turning into the true heading here: east is east.
    assert!((end(&solutions).position_m - walk.truth[walk.truth.len() - 1].position_m).norm() < 0.15);
    let (_, report) = run(FootInsParams::default(), &walk.observations()).unwrap();
    assert!(!report.magnetic_heading);
}

/// A gyro whose bias about the vertical appears when the walk begins, so that no rest can reveal it.
fn with_drifting_heading(mut walk: Walk, bias_rad_s: f64) -> Walk {
    let start = walk.truth.iter().position(|t| !t.stance).unwrap();
    let up = walk.truth[0].attitude.inverse_transform_vector(&Vector3::z());
    for sample in &mut walk.samples[start..] {
        sample.angular_rate_rad_s += up * bias_rad_s;
    }
    walk
}

/// With zero-rate updates off, nothing but the aid sees the heading.
fn blind_to_heading(heading_aid: HeadingAid) -> FootInsParams {
    let mut params = FootInsParams { heading_aid, ..FootInsParams::default() };
    params.zero_rate.statistic = 0.0;
    params
}

#[test]
fn the_heading_aid_keeps_a_straight_walk_straight() {
    for seed in 6..9 {
        let walk = with_drifting_heading(Walk::straight(50.0, seed).unwrap(), 0.005);
        let cross_track = |aid| {
            let (solutions, _) = run(blind_to_heading(aid), &walk.observations()).unwrap();
            // East, as the simulated walk goes.
            walk.in_true_heading(&solutions)[solutions.len() - 1].y.abs()
        };
        let (with, without) = (cross_track(HeadingAid::StraightLegs), cross_track(HeadingAid::None));
        // 0.29 °/s over 40 s.
        assert!(without > 1.0, "{without} m");
        assert!(with < 0.95 * without, "seed {seed}: {with} of {without} m");
    }
}

#[test]
fn the_heading_aid_leaves_a_turn_alone() {
    for turn in [Leg::Turn { turn_rad: FRAC_PI_2 }, Leg::Arc { radius_m: 1.0, turn_rad: FRAC_PI_2 }] {
        let walk = Walk::with_turn(15.0, turn, 7).unwrap();
        let params = FootInsParams { heading_aid: HeadingAid::StraightLegs, ..FootInsParams::default() };
        let (solutions, _) = run(params, &walk.observations()).unwrap();
        let turned = (end(&solutions).attitude * solutions[0].attitude.inverse()).angle();
        assert!((turned - FRAC_PI_2).abs() < 0.02, "{turned} rad");
        let error = walk.end_error_m(&solutions);
        assert!(error < 0.01 * walk.length_m(), "{error} of {} m", walk.length_m());
    }
}

#[test]
fn every_detector_follows_the_walk() {
    let walk = Walk::with_turn(15.0, Leg::Turn { turn_rad: FRAC_PI_2 }, 8).unwrap();
    let fixed = |detector, threshold| StanceParams {
        detector,
        threshold,
        window_s: 0.05,
        acc_scale_m_s2: 0.15,
        gyro_scale_rad_s: 0.1,
        ..StanceParams::default()
    };
    let detectors = [
        // |ω| below 0.45 rad/s and |f| within 0.67 m/s² of gravity.
        fixed(Detector::Magnitude, 20.0),
        fixed(Detector::MovingVariance, 5.0),
        fixed(Detector::Ared, 10.0),
        fixed(Detector::Shoe, 20.0),
        StanceParams::default(),
    ];
    for stance in detectors {
        let detector = stance.detector;
        let params = FootInsParams { stance, ..FootInsParams::default() };
        let (solutions, report) = run(params, &walk.observations()).unwrap();
        let share = walk.end_error_m(&solutions) / walk.length_m();
        assert!(share < 0.05, "{detector:?}: {share} of the distance");
        let still = report.still_samples as f64 / report.samples as f64;
        assert!((0.1..0.9).contains(&still), "{detector:?}: {still} of the time still");
    }
}

#[test]
fn a_walker_who_stands_still_stays_where_he_is() {
    let walk = Walk::straight(1.5, 9).unwrap();
    let still = walk.truth.iter().position(|t| !t.stance).unwrap();
    let observations = &walk.observations()[..still];
    let (solutions, _) = run(FootInsParams::default(), observations).unwrap();
    assert!(solutions.iter().all(|s| s.position_m.norm() < 0.01));
    assert!(end(&solutions).attitude.angle_to(&level_truth(&walk, &solutions)) < 0.01);
}

/// True attitude of the first sample, seen in the heading of the estimate.
fn level_truth(walk: &Walk, solutions: &[Solution]) -> Attitude {
    let (truth, estimate) = (&walk.truth[0].attitude, &solutions[0].attitude);
    let turn = attitude::heading(truth) - attitude::heading(estimate);
    attitude::exp(&(Vector3::z() * turn)) * truth
}

#[test]
fn a_blow_to_the_sensor_costs_two_stances_not_the_walk() {
    let mut walk = Walk::straight(40.0, 4).unwrap();
    // 5 m/s² too much for 0.4 s in mid-walk: 2 m/s that no error model explains.
    for sample in &mut walk.samples[2_600..2_680] {
        sample.specific_force_m_s2.x += 5.0;
    }
    let (solutions, report) = run(FootInsParams::default(), &walk.observations()).unwrap();
    assert!(report.rejected_updates > 0, "the gate did not close: the blow proves nothing");
    let refused_for = solutions.windows(2).filter(|pair| pair[1].velocity_m_s.norm() > 6.0).count();
    assert_eq!(refused_for, 0, "a foot does not run away");
    // Two strides at 2 m/s, and what the attitude suffers.
    assert!(walk.end_error_m(&solutions) < 6.0, "{} m", walk.end_error_m(&solutions));
}
