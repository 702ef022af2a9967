//! `fused` over whole logs: alone on a foot, with positions at the ends of a walk, and what has no smoother.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::nalgebra::{Vector2, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_estimation::methods::foot_ins::{self, FootInsParams};
use adit_estimation::methods::fused::{FusedParams, smooth};
use adit_estimation::methods::{MethodSettings, MethodWarning, Worn};
use adit_observation::{FixSource, Observation, PositionFix};
use adit_simulation::{FootWalkScenario, ImuErrorModel};
use support::Draws;
use support::strides::Strides;
use support::walk::Walk;

fn on_foot() -> FusedParams {
    FusedParams { worn: Some(Worn::Foot), ..FusedParams::default() }
}

fn streamed(params: FusedParams, log: &[Observation]) -> Vec<Solution> {
    let mut method = params.start().unwrap();
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
    solutions
}

#[test]
fn a_foot_alone_is_smoothed_as_foot_ins_smooths_it() {
    let log = Walk::straight(12.0, 1).unwrap().observations();
    let (alone, _) = foot_ins::smooth(FootInsParams::default(), &log, &mut |_| ()).unwrap();
    let mut told = Vec::new();
    let (fused, report) = smooth(on_foot(), &log, &mut |done| told.push(done)).unwrap();
    assert_eq!(fused, alone);
    assert_eq!(report.solutions, alone.len() as u64);
    assert!(told.is_sorted() && told.iter().all(|done| *done <= 2 * log.len()), "{told:?}");
}

/// A straight walk on a foot, with positions once a second, but for half of its time in the dark.
struct Dark {
    walk: Walk,
    log: Vec<Observation>,
    hidden_s: (f64, f64),
}

const FIX_M: f64 = 0.3;

impl Dark {
    fn new(seed: u64) -> Self {
        let errors = ImuErrorModel::microstrain_gx5_25();
        let walk = Walk::of(&FootWalkScenario::straight(150.0), &errors, seed).unwrap();
        let end_s = walk.samples.last().unwrap().time.seconds();
        let dark_s = (0.3 * end_s, 0.8 * end_s);
        let mut draws = Draws::new(seed);
        let mut log = Vec::new();
        let mut next_s = 5.0;
        // The gyro turns away where nobody sees it: by 0.005 rad/s over the first half of the dark.
        let turn = Vector3::new(0.0, 0.0, 5e-3);
        let turns_s = dark_s.0..0.5 * (dark_s.0 + dark_s.1);
        for (imu, truth) in walk.samples.iter().zip(&walk.truth) {
            let time_s = imu.time.seconds();
            let mut imu = *imu;
            if turns_s.contains(&time_s) {
                imu.angular_rate_rad_s += truth.attitude.inverse_transform_vector(&turn);
            }
            log.push(Observation::Imu(imu));
            if time_s >= next_s {
                next_s += 1.0;
                if time_s < dark_s.0 || time_s > dark_s.1 {
                    let off = Vector2::new(draws.normal(), draws.normal()) * FIX_M;
                    let level_m = truth.position_m.xy() + Vector2::new(400.0, -90.0) + off;
                    log.push(Observation::Fix(PositionFix::level(
                        imu.time,
                        level_m,
                        FIX_M,
                        FixSource::Unknown,
                    )));
                }
            }
        }
        Self { walk, log, hidden_s: dark_s }
    }

    /// Largest errors in the dark and of all, m; how many were judged.
    fn largest_m(&self, solutions: &[Solution]) -> (f64, f64, usize) {
        let (mut dark_m, mut all_m, mut judged): (f64, f64, usize) = (0.0, 0.0, 0);
        let mut truth = self.walk.samples.iter().zip(&self.walk.truth);
        for solution in solutions {
            let Some((_, there)) = truth.find(|(imu, _)| imu.time == solution.time) else { break };
            let place_m = there.position_m.xy() + Vector2::new(400.0, -90.0);
            let off_m = (solution.position_m.xy() - place_m).norm();
            let time_s = solution.time.seconds();
            if time_s > self.hidden_s.0 && time_s < self.hidden_s.1 {
                dark_m = dark_m.max(off_m);
            }
            all_m = all_m.max(off_m);
            judged += 1;
        }
        (dark_m, all_m, judged)
    }
}

#[test]
fn a_dark_between_positions_is_held_from_both_ends() {
    for seed in 1..=3 {
        let dark = Dark::new(seed);
        let mut params = on_foot();
        // As bad as this gyro is: about 0.15 rad in a minute.
        params.foot_noise.heading_walk_rad_sqrt_s = 0.02;
        let before = dark.largest_m(&streamed(params.clone(), &dark.log));
        let (solutions, report) = smooth(params, &dark.log, &mut |_| ()).unwrap();
        let after = dark.largest_m(&solutions);
        assert!(after.0 < 0.5 * before.0, "seed {seed}: in the dark {} m of {} m", after.0, before.0);
        // From the first sample that the carrier tells of on, and no worse before the first position than anywhere.
        assert_eq!(after.2, solutions.len());
        assert!(solutions[0].time < Time::from_seconds(1.0).unwrap());
        assert!(after.1 < 3.0, "seed {seed}: {} m", after.1);
        assert!(report.warnings.is_empty() && report.fixes > 0);
        assert!(solutions.windows(2).all(|pair| pair[0].time < pair[1].time));
        assert!(solutions.iter().any(|solution| solution.quality == Quality::Fixed));
    }
}

#[test]
fn steps_that_nothing_holds_are_streamed_with_a_word() {
    let log = Strides::default().record(1).0;
    let params = FusedParams { worn: Some(Worn::Body), ..FusedParams::default() };
    let (solutions, report) = smooth(params.clone(), &log, &mut |_| ()).unwrap();
    assert_eq!(solutions, streamed(params, &log));
    assert_eq!(report.warnings.last(), Some(&MethodWarning::NotSmoothed));
}
