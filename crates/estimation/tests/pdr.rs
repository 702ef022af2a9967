//! `pdr` on walks that are known: the path, what it says of itself, and what fixes make of it.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::attitude;
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_estimation::methods::pdr::walker::{EAST, FACTOR, HEADING, OFFSET, Stretch, Walker};
use adit_estimation::methods::pdr::{Direction, Pdr, PdrNoise, PdrParams};
use adit_estimation::methods::{MethodError, MethodWarning};
use adit_estimation::pedestrian::step_length::StepLength;
use adit_observation::{FixSource, Observation, PositionFix, StartPose};
use core::f64::consts::FRAC_PI_2;
use support::Draws;
use support::strides::Strides;

const START: StartPose = StartPose {
    position_m: [0.0, 0.0],
    position_sigma_m: [0.2, 0.2],
    heading_deg: 0.0,
    pitch_deg: 0.0,
    roll_deg: 0.0,
    attitude_sigma_deg: 2.0,
};

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

/// Steps of exactly this length.
fn known_length(walk: &Strides) -> PdrParams {
    PdrParams {
        length: StepLength::Constant { length_m: walk.step_m },
        direction: Direction::Mounted,
        ..PdrParams::default()
    }
}

fn true_at(truth: &[(Time, Vector2<f64>)], time: Time) -> Vector2<f64> {
    let index = truth.partition_point(|(at, _)| *at < time);
    truth[index.min(truth.len() - 1)].1
}

/// A square with its corners walked around.
fn square() -> Strides {
    let turns = (1..=3).map(|corner| (4.0 + 14.0 * f64::from(corner), 2.0, FRAC_PI_2)).collect();
    Strides { steps: 100, turns, ..Strides::default() }
}

/// Fixes of the true way.
fn fixes(truth: &[(Time, Vector2<f64>)], every: usize, sigma_m: f64, seed: u64) -> Vec<PositionFix> {
    let mut draws = Draws::new(seed);
    let fix = |&(time, position): &(Time, Vector2<f64>)| {
        let off = Vector2::new(draws.normal(), draws.normal()) * sigma_m;
        PositionFix::level(time, position + off, sigma_m, FixSource::Wifi)
    };
    truth.iter().skip(every / 2).step_by(every).map(fix).collect()
}

fn merged(log: &[Observation], fixes: &[PositionFix]) -> Vec<Observation> {
    let mut all: Vec<Observation> = log.to_vec();
    all.extend(fixes.iter().map(|fix| Observation::Fix(*fix)));
    all.sort_by_key(Observation::time);
    all
}

#[test]
fn a_square_closes() {
    for magnetometer in [true, false] {
        let walk = Strides { magnetometer, heading_rad: 0.0, ..square() };
        let (log, truth) = walk.record(1);
        let (solutions, method) = run(known_length(&walk), &log);
        assert_eq!(method.report().steps, 100);
        assert!((method.report().distance_m - 70.0).abs() < 1e-9);
        let start = attitude::heading(&solutions[0].attitude);
        for solution in &solutions {
            // One step is told at its bump, which the middle of the true step is.
            let off = (solution.position_m.xy() - true_at(&truth, solution.time)).norm();
            assert!(off < 1.5, "{off} m off at {} s (heading {start})", solution.time);
            assert!(off < 3.5 * solution.radius_95_m() + 0.5, "{off} m off at {} s", solution.time);
        }
        let last = solutions.last().unwrap();
        assert_eq!(last.time, truth.last().unwrap().0);
        assert_eq!(last.quality, Quality::DeadReckoning);
        assert!(last.velocity_m_s.norm() == 0.0, "standing at the end");
    }
}

#[test]
fn a_tag_mounted_any_way_walks_the_same_path() {
    // Forward is known where the sidecar's rotation has been applied; here the tag leans by up to 40°.
    let straight = Strides { noise: (0.0, 0.0, 0.0), ..square() };
    let (log, _) = straight.record(1);
    let (upright, _) = run(known_length(&straight), &log);
    for lean in [Vector3::new(0.0, 0.6, 0.0), Vector3::new(0.5, 0.0, 0.0), Vector3::new(-0.4, -0.4, 0.0)] {
        let walk = Strides { mounting: attitude::exp(&lean), ..straight.clone() };
        let (log, _) = walk.record(1);
        let (leaning, _) = run(known_length(&walk), &log);
        let (a, b) = (upright.last().unwrap(), leaning.last().unwrap());
        assert!(
            (a.position_m - b.position_m).norm() < 3.0,
            "{lean:?}: {:?} {:?}",
            a.position_m,
            b.position_m
        );
    }
}

#[test]
fn the_sway_of_pelvis_or_arm_averages_out() {
    let calm = Strides { sway_rad: 0.0, noise: (0.0, 0.0, 0.0), ..Strides::default() };
    let end = |walk: &Strides| {
        let (solutions, _) = run(known_length(walk), &walk.record(1).0);
        solutions.last().unwrap().position_m
    };
    let swaying = Strides { sway_rad: 0.6, ..calm.clone() };
    let off = (end(&calm) - end(&swaying)).norm();
    // 40 steps: without the mean over the stride every step would be off by up to 0.6 rad.
    assert!(off < 1.0, "{off} m");
}

#[test]
fn fixes_tell_the_length_of_the_steps_and_the_way_the_tag_is_held() {
    let mut nis = (0.0, 0.0);
    for seed in 0..10 {
        // Steps are longer by a fifth than the model says, and the tag's x axis points 2 rad off forward.
        let held = attitude::exp(&(Vector3::z() * 2.0));
        let turns = (1..=11).map(|bend| (4.0 + 14.0 * f64::from(bend), 2.0, 1.2)).collect();
        let walk = Strides { steps: 300, turns, mounting: held, ..Strides::default() };
        let (log, truth) = walk.record(seed);
        let fixes = fixes(&truth, 500, 1.0, seed);
        let length = StepLength::Constant { length_m: walk.step_m / 1.2 };
        let params = PdrParams { length, ..PdrParams::default() };
        let (solutions, method) = run(params, &merged(&log, &fixes));
        let walker = method.walker();
        let sigma = walker.covariance[(FACTOR, FACTOR)].sqrt();
        assert!(sigma < 0.03, "{sigma}");
        assert!((walker.factor - 1.2).abs() < 4.0 * sigma, "seed {seed}: {} ± {sigma}", walker.factor);
        let offset = (walker.offset_rad - 2.0).sin().asin();
        let sigma = walker.direction_variance().sqrt();
        assert!(offset.abs() < 4.0 * sigma && sigma < 0.15, "seed {seed}: {offset} ± {sigma}");
        let late: Vec<&Solution> = solutions.iter().filter(|s| s.time.seconds() > 60.0).collect();
        let off = |s: &&Solution| (s.position_m.xy() - true_at(&truth, s.time)).norm();
        let mean = late.iter().map(off).sum::<f64>() / late.len() as f64;
        assert!(mean < 1.0, "seed {seed}: {mean} m");
        assert_eq!(late[0].quality, Quality::Fixed);
        let report = method.report();
        nis = (nis.0 + report.nis_sum, nis.1 + 2.0 * report.used_fixes as f64);
        assert_eq!(report.bounded_fixes, 0);
    }
    // χ² over its degrees of freedom (ten runs of some 30 fixes): 1 ± 0.1. A settled walker knows a bit less than he says.
    let ratio = nis.0 / nis.1;
    assert!((0.6..1.2).contains(&ratio), "{ratio}");
}

#[test]
fn the_covariance_of_the_filter_is_that_of_its_model() {
    // Monte Carlo of the model itself: factor, offset, heading and every step drawn as the settings say.
    let noise = PdrNoise::default();
    let (runs, mut sums) = (400_u32, [0.0; 2]);
    for seed in 0..u64::from(runs) {
        let mut draws = Draws::new(seed);
        let mut walker = Walker::new(&noise, 0.1);
        walker.follow(&noise, 0.05 * 0.05, true, 0.5);
        let mut factor = 1.0 + noise.factor_sigma * draws.normal();
        let mut offset = 0.1 * draws.normal();
        let mut error = 0.05 * draws.normal();
        let mut position = Vector2::zeros();
        for step in 0..120 {
            let heading_rad = 0.02 * f64::from(step);
            walker.follow(&noise, 0.05 * 0.05, true, 0.5);
            let kept = (-0.5 / noise.magnetic_time_s).exp();
            error = error * kept + 0.05 * (1.0 - kept * kept).sqrt() * draws.normal();
            let (share_sigma, direction_rad) = (noise.step_share, noise.step_direction_rad);
            walker
                .walk(&noise, &Stretch { length_m: 0.7, share_sigma, heading_rad, direction_rad, part: 1.0 });
            let along = 0.7 * (factor + share_sigma * draws.normal());
            let direction = heading_rad + offset + error + direction_rad * draws.normal();
            position += Vector2::new(direction.sin(), direction.cos()) * along;
            factor += noise.factor_walk_sqrt_m * 0.7_f64.sqrt() * draws.normal();
            offset += noise.direction_walk_rad_sqrt_m * 0.7_f64.sqrt() * draws.normal();
        }
        let miss = position - walker.position_m;
        let block: Matrix2<f64> = walker.covariance.fixed_view::<2, 2>(EAST, EAST).into_owned();
        sums[0] += miss.dot(&block.cholesky().unwrap().solve(&miss)) / 2.0;
        let angle = offset + error;
        sums[1] += angle * angle / walker.direction_variance();
        assert!(walker.covariance[(HEADING, HEADING)] > 0.0 && walker.covariance[(OFFSET, OFFSET)] > 0.0);
    }
    let [position, direction] = sums.map(|sum| sum / f64::from(runs));
    // 400 runs: σ of the mean 0.05 (two degrees of freedom) and 0.07; the bend of the path is of second order.
    assert!((0.85..1.15).contains(&position), "NEES of the position {position}");
    assert!((0.8..1.2).contains(&direction), "of the direction {direction}");
}

#[test]
fn a_start_that_is_told_is_where_the_path_begins() {
    let walk = Strides { magnetometer: false, heading_rad: 1.0, ..Strides::default() };
    let (log, _) = walk.record(3);
    let start = StartPose { position_m: [10.0, -5.0], heading_deg: 57.2958, ..START };
    let (solutions, _) = run(PdrParams { start: Some(start), ..known_length(&walk) }, &log);
    assert!((solutions[0].position_m - Vector3::new(10.0, -5.0, 0.0)).norm() < 1e-12);
    let end = solutions.last().unwrap().position_m.xy();
    let expected = Vector2::new(10.0, -5.0) + Vector2::new(1_f64.sin(), 1_f64.cos()) * 28.0;
    assert!((end - expected).norm() < 1.0, "{end:?}");
}

#[test]
fn a_path_that_fix_after_fix_contradicts_is_sought_anew() {
    // The tag is said to point forward and points left.
    let wrong = attitude::exp(&(Vector3::z() * -1.6));
    let walk = Strides { steps: 200, mounting: wrong, ..square() };
    let (log, truth) = walk.record(5);
    let params = PdrParams { start: Some(START), ..known_length(&walk) };
    let (solutions, method) = run(params, &merged(&log, &fixes(&truth, 300, 0.5, 5)));
    let reopened = |warning: &MethodWarning| matches!(warning, MethodWarning::PathReopened { .. });
    assert_eq!(method.report().warnings.iter().filter(|w| reopened(w)).count(), 1);
    let late = solutions.iter().filter(|s| s.time.seconds() > 80.0);
    for solution in late {
        let off = (solution.position_m.xy() - true_at(&truth, solution.time)).norm();
        assert!(off < 2.0, "{off} m off at {} s", solution.time);
    }
}

#[test]
fn the_principal_axis_tells_forward_but_not_from_backward() {
    for yaw_rad in [-1.2, 0.5, 1.0] {
        let mounting = attitude::exp(&(Vector3::z() * yaw_rad));
        let walk = Strides { mounting, surge_m_s2: 2.0, sway_rad: 0.0, ..square() };
        let (log, _) = walk.record(2);
        let offset_rad = |direction| {
            let (_, method) = run(PdrParams { direction, ..known_length(&walk) }, &log);
            (method.walker().offset_rad, method.walker().direction_variance().sqrt())
        };
        let (held, unknown) = offset_rad(Direction::Held);
        assert!(held.abs() < 1e-9 && unknown > 1.5, "{held} ± {unknown}");
        let (along, known) = offset_rad(Direction::PrincipalAxis);
        assert!((along - yaw_rad).sin().abs() < 0.15, "{yaw_rad}: {along} ± {known}");
        assert!(known < 0.2);
    }
}

#[test]
fn outliers_pull_no_more_than_their_bound() {
    let walk = Strides { steps: 200, ..square() };
    let (log, truth) = walk.record(6);
    let mut fixes = fixes(&truth, 300, 0.5, 6);
    let spoilt = fixes.len() / 2;
    fixes[spoilt].level_m += Vector2::new(40.0, 0.0);
    let (solutions, method) = run(known_length(&walk), &merged(&log, &fixes));
    assert_eq!(method.report().bounded_fixes, 1);
    let last = solutions.last().unwrap();
    assert!((last.position_m.xy() - true_at(&truth, last.time)).norm() < 1.5);
    let at = solutions.iter().find(|s| s.time == fixes[spoilt].time).unwrap();
    assert!((at.position_m.xy() - true_at(&truth, at.time)).norm() < 3.0);
    let off = PdrParams {
        fixes: adit_estimation::methods::pdr::FixParams { used: false, ..Default::default() },
        ..known_length(&walk)
    };
    let (_, without) = run(off, &merged(&log, &fixes));
    assert_eq!((without.report().used_fixes, without.report().fixes), (0, fixes.len() as u64));
}

#[test]
fn a_tag_that_is_turned_over_goes_on_the_same_way() {
    // In the midst of a straight walk the tag is turned up by 80° within 2 s, as from the hand into a pocket.
    let walk =
        Strides { steps: 80, heading_rad: 0.0, noise: (0.0, 0.0, 0.0), sway_rad: 0.0, ..Strides::default() };
    let (log, truth) = walk.record(1);
    let pitch = |t: f64| -1.4 * ((t - 20.0) / 2.0).clamp(0.0, 1.0);
    let turned: Vec<Observation> = log
        .iter()
        .map(|observation| {
            let t = observation.time().seconds();
            let back = attitude::exp(&(Vector3::y() * -pitch(t)));
            match observation {
                Observation::Imu(imu) => {
                    let mut imu = *imu;
                    let rate = if t > 20.0 && t <= 22.0 { -0.7 } else { 0.0 };
                    imu.specific_force_m_s2 = back * imu.specific_force_m_s2;
                    imu.angular_rate_rad_s = back * imu.angular_rate_rad_s + Vector3::y() * rate;
                    Observation::Imu(imu)
                }
                Observation::Magnetic(magnetic) => {
                    let mut magnetic = *magnetic;
                    magnetic.field_ut = back * magnetic.field_ut;
                    Observation::Magnetic(magnetic)
                }
                other => other.clone(),
            }
        })
        .collect();
    let (solutions, method) = run(known_length(&walk), &turned);
    assert_eq!(method.report().turned_over, 1);
    let last = solutions.last().unwrap();
    let off = (last.position_m.xy() - true_at(&truth, last.time)).norm();
    // 28 m after it; the direction may be off by 20°.
    assert!(off < 8.0, "{off} m");
    assert!(off < 2.0 * last.radius_95_m(), "{off} m");
}

#[test]
fn settings_that_cannot_be_used_are_named() {
    let noise = |noise: PdrNoise| PdrParams { noise, ..PdrParams::default() };
    for (params, name) in [
        (noise(PdrNoise { step_share: -1.0, ..PdrNoise::default() }), "noise.step_share"),
        (noise(PdrNoise { magnetic_time_s: 0.0, ..PdrNoise::default() }), "noise.magnetic_time_s"),
        (PdrParams { length: StepLength::Weinberg { k: 0.0 }, ..PdrParams::default() }, "length.weinberg.k"),
        (
            PdrParams { length: StepLength::FrequencyHeight { height_m: 17.5 }, ..PdrParams::default() },
            "length.frequency-height.height_m",
        ),
    ] {
        assert_eq!(Pdr::new(params).unwrap_err(), MethodError::Setting { method: "pdr", name });
    }
    let mut steps = PdrParams::default();
    steps.steps.patience = f64::NAN;
    assert_eq!(Pdr::new(steps).unwrap_err(), MethodError::Setting { method: "pdr", name: "steps.patience" });
    assert_eq!(Pdr::new(PdrParams::default()).unwrap().finish_next().unwrap_err(), MethodError::Empty);
}
