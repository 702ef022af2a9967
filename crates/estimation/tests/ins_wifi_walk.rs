//! `reduced-ins-wifi` and `full-ins-wifi` on the walk of system S0: limits over a few seeds, growth without fixes, what is
//! observed and what is not.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "support/roadway.rs"]
mod roadway;

use adit_core::geodesy::EARTH_RATE_RAD_S;
use adit_core::nalgebra::{SMatrix, Vector2};
use adit_estimation::methods::ins_wifi::{Full, InsWifiParams, Mechanisation, Reduced, ReducedInsWifi};
use adit_observation::Observation;
use adit_simulation::{ImuErrorModel, StartErrors};
use roadway::{Run, errors, params, run, s0, sensor, solve};

const SEEDS: std::ops::Range<u64> = 2015..2031;

/// After the third fix.
const JUDGED_FROM_S: f64 = 60.05;

#[test]
fn the_reduced_filter_keeps_the_limits_of_s0() {
    let (mut nis, mut fixes, mut within) = (0.0, 0.0, 0);
    for seed in SEEDS {
        let run = s0(seed);
        let (solutions, method) = solve::<Reduced, 10>(&run, params(&run)).unwrap();
        nis += method.report().nis_sum;
        fixes += (method.report().used_fixes - method.report().bounded_fixes) as f64;
        let judged: Vec<_> =
            errors(&run, &solutions).into_iter().filter(|e| e.time_s > JUDGED_FROM_S).collect();
        let largest = |of: &dyn Fn(&roadway::Errors) -> f64| judged.iter().map(of).fold(0.0, f64::max);
        let east = largest(&|e| e.position_m.x.abs());
        let heading = largest(&|e| e.turn_rad.abs().to_degrees());
        let velocity = largest(&|e| e.velocity_m_s.xy().norm());
        // Limits of system S0; 95 % of the seeds have to keep them.
        within += u32::from(east <= 0.5 && heading <= 1.0 && velocity <= 0.1);
    }
    assert!(within >= 15, "{within} of 16 seeds within the limits");
    // χ² with 2 · 800 degrees of freedom: the mean of 800 is within 3 σ = 0.21 of 2.
    assert!((nis / fixes - 2.0).abs() < 0.21, "NIS {}", nis / fixes);
}

#[test]
fn the_reduced_filter_loses_nothing_against_the_full_one() {
    let rmse = |of: &dyn Fn(&Run) -> Vec<f64>| {
        let squares: Vec<f64> = (2015..2023).flat_map(|seed| of(&s0(seed))).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let squares = |run: &Run, solutions: &[_]| -> Vec<f64> {
        let judged = errors(run, solutions).into_iter().filter(|e| e.time_s > JUDGED_FROM_S);
        judged.map(|e| e.position_m.xy().norm_squared()).collect()
    };
    let reduced = rmse(&|run| squares(run, &solve::<Reduced, 10>(run, params(run)).unwrap().0));
    let full = rmse(&|run| squares(run, &solve::<Full, 18>(run, params(run)).unwrap().0));
    assert!(reduced < 1.1 * full, "10 states {reduced} m, 18 states {full} m");
    assert!(full < 0.25, "18 states {full} m");
}

/// Without fixes and without errors, what is left is the sampling at 10 Hz.
#[test]
fn a_faultless_sensor_walks_alone_for_a_thousand_seconds() {
    let run = run(&ImuErrorModel::default(), &StartErrors::default(), 7);
    let alone = InsWifiParams { use_fixes: false, ..params(&run) };
    // ω × ḟ dt³/12 in each corner, some 1e-4 m/s, kept for up to 1000 s.
    let reduced = (solve::<Reduced, 10>(&run, alone.clone()).unwrap().0, 0.5);
    // The Earth's rate seen from a body that turns is a cone: 2e-8 rad in a sample of a corner, a tilt of some 2e-7 rad in all, and
    // g/2 t² of it.
    let full = (solve::<Full, 18>(&run, alone).unwrap().0, 3.0);
    for (solutions, most_m) in [reduced, full] {
        let last = errors(&run, &solutions).pop().unwrap();
        assert!(last.position_m.norm() < most_m, "{}", last.position_m);
        assert!(last.turn_rad.abs() < 1e-6, "{:e}", last.turn_rad);
    }
}

/// Of estimate minus truth: `δv̇ = ψ(t) ẑ × a + C ∇ − 2 ω_ie sin L ẑ × δv`, `ψ = ψ₀ + (ω_ie cos L ψe₀ + ε) t`, from the draws and the true path alone: the growth law
/// of the errors of an INS without fixes.
#[test]
fn without_fixes_errors_grow_as_the_law_says() {
    for seed in 2015..2020 {
        let run = s0(seed);
        let alone = InsWifiParams { use_fixes: false, ..params(&run) };
        let (solutions, _) = solve::<Reduced, 10>(&run, alone).unwrap();
        let last = errors(&run, &solutions).pop().unwrap();

        let first = run.truth[0];
        let told = adit_core::attitude::log(&(run.told.attitude * first.attitude.inverse()));
        let latitude = roadway::origin().latitude_rad;
        let drift = first.gyro_bias_rad_s.z + EARTH_RATE_RAD_S * latitude.cos() * told.x;
        let mut velocity = Vector2::zeros();
        let mut shift = run.told.position_m - first.position_m.xy();
        let turn_rate = -2.0 * EARTH_RATE_RAD_S * latitude.sin();
        for pair in run.truth.windows(2) {
            let span_s = (pair[1].time - pair[0].time).seconds();
            let middle_s = 0.5 * (pair[0].time.seconds() + pair[1].time.seconds());
            let heading = told.z + drift * middle_s;
            let gained = (pair[1].velocity_m_s - pair[0].velocity_m_s).xy();
            let bias = (pair[0].attitude * pair[0].acc_bias_m_s2).xy() * span_s;
            let left = |v: Vector2<f64>| Vector2::new(-v.y, v.x);
            velocity += left(gained) * heading + bias + left(velocity) * (turn_rate * span_s);
            shift += velocity * span_s;
        }
        // White noise of 50 µg/√Hz adds 4.9e-4 √(1000³/3) = 9 m (1 σ) that the law does not know, 3 σ are allowed.
        let off = (last.position_m.xy() - shift).norm();
        assert!(off < 27.0, "seed {seed}: {} m, the law says {shift} m", last.position_m);
        assert!(
            shift.norm() > 2.0 * off,
            "seed {seed}: the law explains the error, {shift} m, off by {off} m"
        );
        let heading = told.z + drift * 1000.0;
        // Angle random walk of 0.01 °/√h over 1000 s: 9e-5 rad (1 σ).
        assert!((last.turn_rad - heading).abs() < 3e-4, "{} rad, the law says {heading} rad", last.turn_rad);
    }
}

/// Standard deviations at the end over those at the start.
fn learnt<M: Mechanisation<N>, const N: usize>(seed: u64) -> Vec<f64> {
    let run = s0(seed);
    let (_, method) = solve::<M, N>(&run, params(&run)).unwrap();
    let start = adit_estimation::methods::ins_wifi::InsWifi::<M, N>::new(params(&run)).unwrap();
    (0..N).map(|i| (method.covariance()[(i, i)] / start.covariance()[(i, i)]).sqrt()).collect()
}

#[test]
fn tilt_is_not_observed_by_two_level_accelerometers() {
    let reduced = learnt::<Reduced, 10>(2015);
    // φe and φn keep all that was unknown of them, to the part that the Earth's rate (through the heading) shows.
    assert!(reduced[0] > 0.9 && reduced[1] > 0.99, "{reduced:?}");
    // Heading, biases of the accelerometers, position: learnt.
    for (state, most) in [(2, 0.25), (5, 0.01), (6, 0.01), (8, 0.1), (9, 0.1)] {
        assert!(reduced[state] < most, "state {state}: {}", reduced[state]);
    }
    // Six axes and gravity observe the tilt.
    let full = learnt::<Full, 18>(2015);
    assert!(full[0] < 0.15 && full[1] < 0.15, "{full:?}");
}

/// Singular values of the observability Gramian over the walk, in units of what is known at the start: `√λ` of
/// `S (Σ Φᵀ Hᵀ R⁻¹ H Φ) S`. Above 1: the fixes say more than the start did.
fn singular_values(run: &Run) -> Vec<f64> {
    let mut method = ReducedInsWifi::new(params(run)).unwrap();
    let start = method.covariance().diagonal().map(f64::sqrt);
    let mut transition = SMatrix::<f64, 10, 10>::identity();
    let mut gramian = SMatrix::<f64, 10, 10>::zeros();
    let mut state = method.mechanisation().clone();
    let mut before = None;
    for observation in &run.log {
        match observation {
            Observation::Imu(imu) => {
                if let Some(before) = before.replace(imu.time) {
                    let step = state.step(imu, (imu.time - before).seconds());
                    for mut column in transition.column_iter_mut() {
                        let carried = Reduced::carry(&step, &column.clone_owned());
                        column.copy_from(&carried);
                    }
                }
                method.observe(observation).unwrap();
                // Along the estimated walk, as the filter sees it.
                state = method.mechanisation().clone();
            }
            Observation::Fix(_) => {
                let metres = [6.37e6, 4.46e6];
                for (row, per_rad) in [(Reduced::LATITUDE, metres[0]), (Reduced::LONGITUDE, metres[1])] {
                    let seen = transition.row(row) * (per_rad / 0.0608);
                    gramian += seen.transpose() * seen;
                }
                method.observe(observation).unwrap();
                state = method.mechanisation().clone();
            }
            _ => {}
        }
    }
    let scale = SMatrix::<f64, 10, 10>::from_diagonal(&start);
    let mut values: Vec<f64> =
        (scale * gramian * scale).symmetric_eigenvalues().iter().map(|v| v.max(0.0).sqrt()).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

#[test]
fn two_of_ten_directions_are_not_observed() {
    // Around the true start: at a tilted estimate the linearisation itself is off level.
    let values = singular_values(&run(&sensor(), &StartErrors::default(), 2015));
    // Positions, accelerometer biases, heading, velocities: seven directions that the fixes know far better than the start.
    assert!(values[6] > 5.0, "{values:?}");
    // What the gyro and the east tilt do to the heading together, ω_ie cos L φe − ε: as well as the start knew it.
    assert!((0.3..3.0).contains(&values[7]), "{values:?}");
    // The north tilt, and the gyro against the east tilt: not at all.
    assert!(values[8] < 0.05, "{values:?}");
}

#[test]
fn a_run_in_two_parts_is_the_run_in_one() {
    let run = s0(3);
    let mut whole = ReducedInsWifi::new(params(&run)).unwrap();
    let mut parted = whole.clone();
    for (index, observation) in run.log.iter().enumerate().take(3000) {
        let expected = whole.observe(observation).unwrap();
        if index % 501 == 0 {
            let text = serde_json::to_string(&parted).unwrap();
            parted = serde_json::from_str(&text).unwrap();
        }
        assert_eq!(parted.observe(observation).unwrap(), expected);
    }
    assert_eq!(parted.covariance(), whole.covariance());
}
