//! The smoother against a Rauch–Tung–Striebel smoother of dense matrices.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::attitude;
use adit_core::nalgebra::{Cholesky, SMatrix, SVector};
use adit_core::solution::Solution;
use adit_core::time::Interval;
use adit_estimation::inertial::covariance::{ATTITUDE, POSITION, STATES, VELOCITY};
use adit_estimation::inertial::filter::{FilterState, Update};
use adit_estimation::inertial::smoother::{Adjoint, Corrections, Record};
use adit_estimation::methods::foot_ins::{
    FixedLag, FootFilter, FootIns, FootInsParams, FootInsReport, smooth,
};
use adit_estimation::pedestrian::stance::{Detector, StanceDetector};
use adit_observation::Observation;
use support::walk::{Walk, run};
use support::{Dense, transition};

/// A filter just aligned, not yet moved.
fn aligned(params: &FootInsParams, observations: &[Observation]) -> FootFilter {
    let mut method = FootIns::new(params.clone()).unwrap();
    let mut observations = observations.iter();
    while method.filter().is_none() {
        assert!(method.observe(observations.next().unwrap()).unwrap().is_none());
    }
    method.filter().unwrap().clone()
}

/// What the filter did at one sample, in dense matrices.
struct Sample {
    record: Record,
    transition: Dense,
    predicted: Dense,
    /// Sum of the corrections, in the linear error state.
    correction: SVector<f64, STATES>,
    filtered: Dense,
    state: FilterState,
    solution: Solution,
}

fn corrections(all: &Corrections) -> SVector<f64, STATES> {
    fn of<const N: usize>(update: Option<&Update<N>>) -> SVector<f64, STATES> {
        let Some(update) = update.filter(|update| update.innovation.accepted) else {
            return SVector::zeros();
        };
        SVector::from_fn(|i, _| (update.gain[i / 3] * update.innovation.value)[i % 3])
    }
    of(all.contact.as_ref()) + of(all.rate.as_ref()) + of(all.gravity.as_ref()) + of(all.heading.as_ref())
}

/// Runs the filter over a log, with stances of a detector of its own.
fn forward(params: &FootInsParams, walk: &Walk) -> Vec<Sample> {
    let mut filter = aligned(params, &walk.observations());
    let mut detector = StanceDetector::new(params.stance.clone(), params.gravity_m_s2);
    for sample in &walk.samples {
        detector.push(*sample);
    }
    core::iter::from_fn(|| detector.drain())
        .map(|(imu, stance)| {
            let step = filter.predict(&imu);
            let (state, covariance) = (*filter.state(), filter.covariance().clone());
            let mut all = Corrections::default();
            filter.correct(&imu, &stance, &mut all);
            Sample {
                transition: transition(&step),
                predicted: covariance.to_matrix(),
                correction: corrections(&all),
                filtered: filter.covariance().to_matrix(),
                state: *filter.state(),
                solution: filter.solution(),
                record: Record {
                    time: imu.time,
                    step,
                    state,
                    covariance,
                    corrections: all,
                    quality: filter.quality(),
                    after_gap: false,
                },
            }
        })
        .collect()
}

/// Error of the filtered estimate as known from the whole log, and its covariance, for every sample (Rauch, Tung &
/// Striebel 1965; Särkkä 2013, §8.2).
fn rauch_tung_striebel(steps: &[Sample]) -> Vec<(SVector<f64, STATES>, Dense)> {
    let mut error = SVector::zeros();
    let mut covariance = steps[steps.len() - 1].filtered;
    let mut smoothed = vec![(error, covariance)];
    for pair in steps.windows(2).rev() {
        let (now, next) = (&pair[0], &pair[1]);
        let cross = next.transition * now.filtered;
        let gain = Cholesky::new(next.predicted).unwrap().solve(&cross).transpose();
        error = gain * (error + next.correction);
        covariance = now.filtered + gain * (covariance - next.predicted) * gain.transpose();
        smoothed.push((error, covariance));
    }
    smoothed.reverse();
    smoothed
}

fn backward(steps: &[Sample]) -> Vec<Solution> {
    let mut adjoint = Adjoint::default();
    let mut smoothed: Vec<_> = steps.iter().rev().map(|step| adjoint.step_back(&step.record)).collect();
    smoothed.reverse();
    smoothed
}

/// Position, velocity and attitude of an 18-state covariance, as solutions order them.
fn reported(covariance: &Dense) -> SMatrix<f64, 9, 9> {
    let order = [POSITION, VELOCITY, ATTITUDE];
    SMatrix::from_fn(|i, j| covariance[(3 * order[i / 3] + i % 3, 3 * order[j / 3] + j % 3)])
}

/// Largest differences to Rauch, Tung and Striebel: position, velocity, attitude, and the covariance in units of the
/// filtered standard deviations.
fn differences(steps: &[Sample]) -> [f64; 4] {
    let mut largest = [0.0_f64; 4];
    for ((step, found), (error, covariance)) in
        steps.iter().zip(backward(steps)).zip(rauch_tung_striebel(steps))
    {
        let block = |index: usize| error.fixed_rows::<3>(3 * index).into_owned();
        let n = &step.state.navigation;
        let (expected, scale) = (reported(&covariance), reported(&step.filtered));
        let spread = (0..81).map(|cell| (cell / 9, cell % 9)).map(|(i, j)| {
            (found.covariance[(i, j)] - expected[(i, j)]).abs() / (scale[(i, i)] * scale[(j, j)]).sqrt()
        });
        let here = [
            (found.position_m - n.position_m - block(POSITION)).norm(),
            (found.velocity_m_s - n.velocity_m_s - block(VELOCITY)).norm(),
            (attitude::log(&(found.attitude * n.attitude.inverse())) - block(ATTITUDE)).norm(),
            spread.fold(0.0, f64::max),
        ];
        largest = core::array::from_fn(|i| largest[i].max(here[i]));
    }
    largest
}

/// `differences` over a walk of 30 m: long enough for 24 stances to amplify what grows.
fn differences_over_a_walk(params: &FootInsParams) -> [f64; 4] {
    let steps = forward(params, &Walk::straight(30.0, 1).unwrap());
    let updates = steps.iter().filter(|s| s.record.corrections.contact.is_some()).count();
    assert!(updates > 50 && updates < steps.len(), "{updates} updates in {} samples", steps.len());
    differences(&steps)
}

/// Noises of a filter that believes its stances: what weak updates forgive, strong ones do not.
fn trusting() -> FootInsParams {
    let mut params = FootInsParams::default();
    params.noise.angle_random_walk_rad_sqrt_s = 3e-4;
    params.noise.velocity_random_walk_m_s_sqrt_s = 0.015;
    params.zero_velocity.sigma_m_s = 0.015;
    params.zero_velocity.statistic_sigma_m_s = 0.003;
    params.zero_velocity.interval_s = 0.0;
    params.zero_rate.interval_s = 0.0;
    params.rest_gravity.interval_s = 0.0;
    params
}

#[test]
fn the_smoothed_path_is_that_of_rauch_tung_and_striebel() {
    for params in [FootInsParams::default(), trusting()] {
        let [position, velocity, turned, _] = differences_over_a_walk(&params);
        // Both are linear in the same errors and differ by rounding alone, but for the attitude: a correction of some
        // mrad is composed as rotations here and summed there.
        assert!(position < 1e-9, "{position:e} m");
        assert!(velocity < 1e-9, "{velocity:e} m/s");
        assert!(turned < 1e-5, "{turned:e} rad");
    }
}

#[test]
fn the_smoothed_covariance_is_that_of_rauch_tung_and_striebel() {
    for params in [FootInsParams::default(), trusting()] {
        let [.., spread] = differences_over_a_walk(&params);
        // Inverting P, whose correlations have a condition of 1e6, costs the reference up to 1e-10.
        assert!(spread < 1e-9, "{spread:e} of the filtered variance");
    }
}

#[test]
fn smoothing_never_makes_the_position_less_certain() {
    let params = FootInsParams::default();
    let steps = forward(&params, &Walk::straight(8.0, 2).unwrap());
    let mut gained = 0;
    for (step, smoothed) in steps.iter().zip(backward(&steps)) {
        let before = step.solution.position_covariance().trace();
        let after = smoothed.position_covariance().trace();
        assert!(after <= before * (1.0 + 1e-9), "{after} after {before} m² at {} s", smoothed.time);
        gained += usize::from(after < 0.9 * before);
        assert!(Cholesky::new(smoothed.covariance).is_some(), "not positive definite at {} s", smoothed.time);
    }
    assert!(gained > steps.len() / 4, "only {gained} of {} samples gain by a tenth", steps.len());
}

#[test]
fn smoothing_gives_one_solution_per_sample_and_ends_where_the_filter_ends() {
    let walk = Walk::straight(8.0, 3).unwrap();
    let observations = walk.observations();
    let mut heard = Vec::new();
    let (smoothed, report) =
        smooth(FootInsParams::default(), &observations, &mut |done| heard.push(done)).unwrap();
    let (filtered, filter_report) = run(FootInsParams::default(), &observations).unwrap();
    assert!(smoothed.iter().map(|s| s.time).eq(walk.samples.iter().map(|s| s.time)));
    assert_eq!(report, filter_report);
    assert!(heard.is_sorted() && heard.last() == Some(&(2 * walk.samples.len())));
    let (a, b) = (&smoothed[smoothed.len() - 1], &filtered[filtered.len() - 1]);
    // Nothing is known from later: only the order of a few sums differs, and rotations compose where errors add.
    assert!((a.position_m - b.position_m).norm() < 1e-9);
    assert!((a.velocity_m_s - b.velocity_m_s).norm() < 1e-9);
    assert!(a.attitude.angle_to(&b.attitude) < 1e-9);
    assert!((a.covariance - b.covariance).amax() < 1e-9 * b.covariance.amax());
}

/// Largest step of a path that its own velocity does not explain, m.
fn largest_jump_m(solutions: &[Solution]) -> f64 {
    let jump = |pair: &[Solution]| {
        let (a, b) = (&pair[0], &pair[1]);
        let travel = (a.velocity_m_s + b.velocity_m_s) * (0.5 * (b.time - a.time).seconds());
        (b.position_m - a.position_m - travel).norm()
    };
    solutions.windows(2).map(jump).fold(0.0, f64::max)
}

#[test]
fn smoothing_takes_the_jumps_out_of_the_path() {
    let observations = Walk::straight(20.0, 7).unwrap().observations();
    let (smoothed, _) = smooth(FootInsParams::default(), &observations, &mut |_| ()).unwrap();
    let (filtered, _) = run(FootInsParams::default(), &observations).unwrap();
    let (after, before) = (largest_jump_m(&smoothed), largest_jump_m(&filtered));
    assert!(before > 1e-4, "{before} m: the filter must have something to jump about");
    assert!(after < 0.1 * before, "{after} of {before} m");
}

#[test]
fn a_lag_longer_than_the_log_smooths_like_the_whole_log() {
    let mut observations = Walk::straight(8.0, 4).unwrap().observations();
    // With a gap, of which both must warn.
    observations.drain(900..1_000);
    let (whole, report) = smooth(FootInsParams::default(), &observations, &mut |_| ()).unwrap();
    let (lagged, lagged_report) = lagged(60.0, &observations);
    // The same operations in the same order.
    assert_eq!(report.warnings.len(), 1);
    assert_eq!(lagged, whole);
    assert_eq!(lagged_report, report);
}

#[test]
fn a_fixed_lag_gives_one_solution_per_sample_in_order_and_approaches_the_whole() {
    let walk = Walk::straight(20.0, 5).unwrap();
    let observations = walk.observations();
    let (whole, _) = smooth(FootInsParams::default(), &observations, &mut |_| ()).unwrap();
    let mut mean_m = Vec::new();
    for lag_s in [0.2, 1.0, 4.0] {
        let (found, _) = lagged(lag_s, &observations);
        assert!(found.iter().map(|s| s.time).eq(walk.samples.iter().map(|s| s.time)), "lag {lag_s} s");
        let apart = found.iter().zip(&whole).map(|(a, b)| (a.position_m - b.position_m).norm());
        mean_m.push(apart.sum::<f64>() / whole.len() as f64);
    }
    assert!(mean_m.is_sorted_by(|shorter, longer| shorter > longer), "{mean_m:?}");
}

fn lagged(lag_s: f64, observations: &[Observation]) -> (Vec<Solution>, FootInsReport) {
    let mut method = FixedLag::new(FootInsParams::default(), lag_s).unwrap();
    let mut solutions = Vec::new();
    for observation in observations {
        solutions.extend(method.observe(observation).unwrap());
    }
    solutions.extend(core::iter::from_fn(|| method.finish_next().unwrap()));
    (solutions, method.report().clone())
}

#[test]
fn a_lag_out_of_range_is_refused() {
    for lag_s in [0.0, 0.05, 61.0, f64::NAN] {
        assert!(FixedLag::new(FootInsParams::default(), lag_s).is_err(), "{lag_s} s");
    }
}

#[test]
fn nothing_after_a_gap_changes_what_was_before() {
    let mut params = FootInsParams::default();
    // A detector that does not look over the gap.
    params.stance.detector = Detector::Shoe;
    let mut walk = Walk::straight(8.0, 6).unwrap();
    let pause = Interval::from_nanos(5_000_000_000);
    let before = walk.samples.len() / 2;
    for sample in &mut walk.samples[before..] {
        sample.time = sample.time + pause;
    }
    let observations = walk.observations();
    let (whole, report) = smooth(params.clone(), &observations, &mut |_| ()).unwrap();
    let (alone, _) = smooth(params, &observations[..before], &mut |_| ()).unwrap();
    assert_eq!(report.warnings.len(), 1);
    assert_eq!(whole[..before], alone);
}
