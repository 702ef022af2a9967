//! Smoothing of the place filter: against the posterior of all at once, through a blackout, and how honest its covariance is.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector3};
use adit_estimation::place::bank::{Bank, BankParams};
use adit_estimation::place::state::{
    BAROMETER, COMMON, DRIFT, EAST, FACTOR, HEADING, HeadingError, IRON, MISSED, NORTH, STATES, Seen, State,
    Stretch, TURN, UP, Vector,
};
use support::Draws;

/// Nothing is an outlier.
const ALL: f64 = f64::INFINITY;

fn without_roadways() -> Bank {
    let mut bank = Bank::new(BankParams::default(), None);
    bank.record();
    bank
}

/// The smoothed states, the first first.
fn smoothed(bank: &mut Bank) -> Vec<State> {
    let segments = bank.finish();
    let mut states = Vec::new();
    for segment in segments.iter().rev() {
        segment.smooth(|_, state| states.push(state));
    }
    states.reverse();
    states
}

/// Steps of the linear problem, and its states at all times.
const STEPS: usize = 8;
const ALL_STATES: usize = STATES * (STEPS + 1);

/// Nobody walks, so that nothing is linearised: the error of the place, of the barometer, of heading and drift go on by themselves.
fn standing() -> Stretch {
    Stretch {
        drifting: 2.0,
        turned_rad: 1.5,
        drift2: 2e-4,
        iron_rad2: 5e-3,
        about_m2: 0.09,
        up_m2: 0.04,
        heading: HeadingError::Gyro { walk_rad2: 1e-3 },
        turn_rad2: 2e-3,
        factor2: 1e-4,
        ..Stretch::jump(0.01)
    }
}

/// What is measured after each step: everything mixes with everything.
fn measured(draws: &mut Draws) -> (SMatrix<f64, 2, STATES>, SVector<f64, 2>) {
    (SMatrix::from_fn(|_, _| draws.normal()), SVector::from_fn(|_, _| draws.normal()))
}

#[test]
fn smoothing_is_the_posterior_of_all_states_given_all_measurements() {
    let mut draws = Draws::new(7);
    let mut variances = Vector::from_fn(|_, _| 0.05 + draws.normal().powi(2));
    // A factor stays between 0.3 and 3.
    variances[FACTOR] = 0.01;
    let noise = Matrix2::new(0.3, 0.1, 0.1, 0.2);
    let measurements: Vec<_> = (0..STEPS).map(|_| measured(&mut draws)).collect();

    let mut bank = without_roadways();
    bank.start(State::new(&variances));
    let origin = coordinates(&State::new(&variances));
    for (step, (jacobian, value)) in measurements.iter().enumerate() {
        bank.at(step + 1);
        bank.walk(&standing());
        let see = |state: &State| Seen {
            residual: value - jacobian * (coordinates(state) - origin),
            jacobian: *jacobian,
            noise,
        };
        bank.take(see, ALL).unwrap();
    }
    let states = smoothed(&mut bank);
    assert_eq!(states.len(), STEPS + 1);

    // The joint prior of the states at all times: cov(x_i, x_j) = F^(i−j) P_j.
    let mut transition = SMatrix::<f64, STATES, STATES>::identity();
    transition[(HEADING, DRIFT)] = 2.0;
    transition[(HEADING, MISSED)] = 1.5;
    let mut driven = Vector::zeros();
    for (index, variance) in [
        (EAST, 0.09),
        (NORTH, 0.09),
        (UP, 0.04),
        (HEADING, 1e-3),
        (TURN, 2e-3),
        (DRIFT, 2e-4),
        (IRON, 5e-3),
        (IRON + 1, 5e-3),
        (FACTOR, 1e-4),
        (BAROMETER, 0.01),
    ] {
        driven[index] = variance;
    }
    let mut prior = Box::new(SMatrix::<f64, ALL_STATES, ALL_STATES>::zeros());
    let mut p = SMatrix::from_diagonal(&variances);
    for j in 0..=STEPS {
        let mut block = p;
        for i in j..=STEPS {
            prior.fixed_view_mut::<STATES, STATES>(STATES * i, STATES * j).copy_from(&block);
            prior.fixed_view_mut::<STATES, STATES>(STATES * j, STATES * i).copy_from(&block.transpose());
            block = transition * block;
        }
        p = transition * p * transition.transpose() + SMatrix::from_diagonal(&driven);
    }
    let mut seen = Box::new(SMatrix::<f64, { 2 * STEPS }, ALL_STATES>::zeros());
    let mut values = SVector::<f64, { 2 * STEPS }>::zeros();
    let mut noises = SMatrix::<f64, { 2 * STEPS }, { 2 * STEPS }>::zeros();
    for (step, (jacobian, value)) in measurements.iter().enumerate() {
        seen.fixed_view_mut::<2, STATES>(2 * step, STATES * (step + 1)).copy_from(jacobian);
        values.fixed_rows_mut::<2>(2 * step).copy_from(value);
        noises.fixed_view_mut::<2, 2>(2 * step, 2 * step).copy_from(&noise);
    }
    let cross = Box::new(*prior * seen.transpose());
    let innovation = (*seen * *cross + noises).cholesky().unwrap();
    let mean = *cross * innovation.solve(&values);
    let covariance = Box::new(*prior - *cross * innovation.solve(&cross.transpose()));

    for (step, state) in states.iter().enumerate() {
        let apart = coordinates(state) - origin - mean.fixed_rows::<STATES>(STATES * step);
        // States of about one, some hundred operations on matrices with conditions up to a thousand.
        assert!(apart.amax() < 1e-10, "step {step}: {apart}");
        let block = covariance.fixed_view::<STATES, STATES>(STATES * step, STATES * step);
        let apart = (state.covariance - block).amax();
        assert!(apart < 1e-10, "step {step}: {apart:e}");
    }
}

/// The estimate in the order of the error.
fn coordinates(state: &State) -> Vector {
    let mut vector = Vector::zeros();
    vector.fixed_rows_mut::<3>(EAST).copy_from(&state.position_m);
    vector[TURN] = state.turn_rad - state.heading_rad;
    vector[HEADING] = state.heading_rad;
    vector[DRIFT] = state.drift_rad;
    vector[FACTOR] = state.factor;
    vector[BAROMETER] = state.barometer_m;
    vector[COMMON] = state.common_m;
    vector[9] = state.clock_s;
    vector[10] = state.hearing_db;
    vector.fixed_rows_mut::<2>(IRON).copy_from(&state.iron_rad);
    vector[MISSED] = state.missed;
    vector
}

/// A walk about a block whose carrier turns away, with positions at its beginning and end only.
struct Blackout {
    drift_rad_s: f64,
    turn_rad: f64,
    factor: f64,
    walk_rad_sqrt_s: f64,
    white_m_sqrt_m: f64,
}

const WHOLE_S: usize = 600;
const DARK_S: core::ops::Range<usize> = 120..480;
const FIX_M: f64 = 0.5;

struct Judged {
    /// Largest error in the dark, streamed and smoothed, m.
    streamed_m: f64,
    smoothed_m: f64,
    /// Normalised error squared of the smoothed place in the middle of the dark.
    nees: f64,
}

/// One step a second, 1.2 m long; a corner each 100 s.
fn true_step(second: usize) -> Vector3<f64> {
    let heading = core::f64::consts::FRAC_PI_2 * (second / 100) as f64;
    Vector3::new(1.2 * heading.sin(), 1.2 * heading.cos(), 0.0)
}

fn turned(way: &Vector3<f64>, clockwise: f64) -> Vector3<f64> {
    let (sin, cos) = clockwise.sin_cos();
    Vector3::new(cos * way.x + sin * way.y, cos * way.y - sin * way.x, way.z)
}

impl Blackout {
    fn run(&self, start: State, seed: u64) -> Judged {
        let mut draws = Draws::new(seed);
        let mut bank = without_roadways();
        bank.start(start);
        let (mut place, mut off, mut truth) = (Vector3::zeros(), self.turn_rad, vec![Vector3::zeros()]);
        let mut streamed_m: f64 = 0.0;
        for second in 0..WHOLE_S {
            let step = true_step(second);
            place += step;
            truth.push(place);
            // step = κ R(off) way + noise
            let white = draws.vector(self.white_m_sqrt_m * 1.2_f64.sqrt());
            let way = turned(&(step - white), -off) / self.factor;
            off += self.drift_rad_s + self.walk_rad_sqrt_s * draws.normal();
            bank.at(second + 1);
            let white_m2 = self.white_m_sqrt_m * self.white_m_sqrt_m * 1.2;
            bank.walk(&Stretch {
                way_m: Vector3::new(way.x, way.y, 0.0),
                drifting: 1.0,
                along_m2: white_m2,
                across_m2: white_m2,
                heading: HeadingError::Gyro { walk_rad2: self.walk_rad_sqrt_s * self.walk_rad_sqrt_s },
                ..Stretch::jump(0.0)
            });
            let fix = place.xy() + Vector2::new(draws.normal(), draws.normal()) * FIX_M;
            if DARK_S.contains(&second) {
                let off_m = (bank.estimate().unwrap().position_m - place).xy().norm();
                streamed_m = streamed_m.max(off_m);
            } else {
                let noise = Matrix2::identity() * (FIX_M * FIX_M);
                bank.take(|state| state.see_place(&fix, &noise, &Vector3::zeros()), ALL).unwrap();
            }
        }
        let states = smoothed(&mut bank);
        assert_eq!(states.len(), truth.len());
        let dark = DARK_S.map(|second| (states[second + 1].position_m - truth[second + 1]).xy());
        let smoothed_m = dark.map(|off| off.norm()).fold(0.0, f64::max);
        let middle = usize::midpoint(DARK_S.start, DARK_S.end);
        let off = (states[middle].position_m - truth[middle]).xy();
        let p = states[middle].covariance.fixed_view::<2, 2>(EAST, EAST).into_owned();
        Judged { streamed_m, smoothed_m, nees: off.dot(&p.cholesky().unwrap().solve(&off)) }
    }
}

/// Nothing is known but about where it starts.
fn unsure(turn: f64, drift: f64, factor: f64) -> State {
    let mut variances = Vector::zeros();
    variances[EAST] = 1.0;
    variances[NORTH] = 1.0;
    variances[TURN] = turn * turn;
    variances[DRIFT] = drift * drift;
    variances[FACTOR] = factor * factor;
    State::new(&variances)
}

#[test]
fn what_comes_after_the_dark_halves_the_error_in_it() {
    for (seed, drift_rad_s) in [(1, 4e-4), (2, -4e-4), (3, 6e-4)] {
        let walk = Blackout {
            drift_rad_s,
            turn_rad: 0.1,
            factor: 1.02,
            walk_rad_sqrt_s: 1e-4,
            white_m_sqrt_m: 0.02,
        };
        let judged = walk.run(unsure(0.2, 5e-4, 0.03), seed);
        let (streamed_m, smoothed_m) = (judged.streamed_m, judged.smoothed_m);
        assert!(smoothed_m < 0.5 * streamed_m, "seed {seed}: {smoothed_m} m of {streamed_m} m");
    }
}

#[test]
fn smoothed_covariances_are_honest() {
    const RUNS: u64 = 300;
    let (turn, drift, factor) = (0.05, 2e-4, 0.02);
    let mut sum = 0.0;
    for seed in 0..RUNS {
        let mut draws = Draws::new(1000 + seed);
        let walk = Blackout {
            drift_rad_s: drift * draws.normal(),
            turn_rad: turn * draws.normal(),
            factor: 1.0 + factor * draws.normal(),
            walk_rad_sqrt_s: 5e-4,
            white_m_sqrt_m: 0.02,
        };
        let mut start = unsure(turn, drift, factor);
        start.position_m += Vector3::new(draws.normal(), draws.normal(), 0.0);
        sum += walk.run(start, seed).nees;
    }
    // χ² of 2 · 300 degrees of freedom over 300: mean 2, standard deviation 2/√300; three of them.
    let mean = sum / RUNS as f64;
    assert!((mean - 2.0).abs() < 3.0 * 2.0 / (RUNS as f64).sqrt(), "{mean}");
}

#[test]
fn a_segment_ends_where_the_bank_begins_anew() {
    let mut bank = without_roadways();
    let stretch = Stretch { way_m: Vector3::new(0.0, 1.0, 0.0), drifting: 1.0, ..Stretch::jump(0.0) };
    bank.start(unsure(0.1, 0.0, 0.01));
    for instant in 1..=10_000 {
        bank.at(instant);
        bank.walk(&stretch);
    }
    bank.start(unsure(0.1, 0.0, 0.01));
    bank.at(10_001);
    bank.walk(&stretch);
    let segments = bank.finish();
    let begun: Vec<usize> = segments.iter().map(|segment| segment.begun).collect();
    assert_eq!(begun, [0, 10_000]);
    let mut instants = Vec::new();
    // Nothing was learnt: smoothed is what was streamed.
    segments[0].smooth(|at, state| {
        assert!((state.position_m.y - at as f64).abs() < 1e-6, "{at}: {}", state.position_m);
        instants.push(at);
    });
    assert!(instants.iter().rev().copied().eq(0..=10_000));
}
