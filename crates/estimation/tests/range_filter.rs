//! The filter on ranges: independent numbers, offsets, honesty over seeds, weights, dead reckoning.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/ranges.rs"]
mod ranges;

use adit_core::nalgebra::{Matrix3, Vector2, Vector3};
use adit_estimation::ranging::filter::gate::{GateKind, GateParams};
use adit_estimation::ranging::filter::weighting::{Weighting, WeightingKind};
use adit_estimation::ranging::filter::{
    ErrorParams, FilterParams, HeightParams, MotionParams, RangeFilter, ReckoningParams, StartParams,
};
use adit_estimation::ranging::listener::Link;
use proptest::prelude::*;
use ranges::{LAB, Normal, at_height, filter, link, of_kind, place, round, seconds};

/// Dense matrices, matrix exponentials and Joseph's form: `reference/range_filter.py`.
#[test]
fn the_filter_agrees_with_numpy_and_scipy() {
    let params = FilterParams {
        motion: MotionParams { speed_m_s: 1.2, steady_s: 3.0 },
        height: HeightParams { climb_m_s: 0.4, ..at_height(1.1, 0.5) },
        errors: ErrorParams {
            least_sigma_m: 0.01,
            passing_sigma_m: 0.08,
            correlation_s: 1.2,
            anchor_offset_sigma_m: 0.05,
            offset_s: 900.0,
            common_offset_sigma_m: 0.3,
        },
        gate: GateParams { kind: GateKind::Plain, bound: 8.0, ..GateParams::default() },
        ..FilterParams::default()
    };
    let start = || {
        let spread = Matrix3::from_diagonal(&Vector3::new(0.25, 0.25, 0.09));
        [WeightingKind::Equal, WeightingKind::Igg3].map(|kind| {
            let weighting = Weighting { full: 1.5, none: 6.0, ..of_kind(kind) };
            let mut filter = RangeFilter::new(params, weighting).unwrap();
            filter.start_at(seconds(0.0), Vector3::new(5.0, 4.0, 1.3), &spread);
            filter
        })
    };
    let mut filters = start();
    for line in include_str!("reference/range_filter.csv").lines() {
        let values: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
        let [kind, anchor] = [values[0], values[2]].map(|value| if value < 0.5 { 0 } else { value as usize });
        let filter = &mut filters[kind];
        let taken = filter.observe(&link(&LAB, anchor, values[1], values[3], 0.1), 0).unwrap();
        // Printed to 12 digits; the curvature there is a difference over 0.1 mm, good to eight digits.
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-7 * (1.0 + expected.abs());
        assert!(
            near(taken.innovation_m, values[4]) && near(taken.variance_m2, values[5]),
            "{line}: {taken:?}"
        );
        assert!(near(taken.weight, values[6]), "{line}: {taken:?}");
        let found = filter.solution().unwrap();
        assert!((found.position_m - Vector3::new(values[7], values[8], values[9])).norm() < 1e-7, "{line}");
        let [xx, xy, xz, yy, yz, zz] = values[10..16] else { unreachable!() };
        let expected = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        assert!(
            (found.position_covariance() - expected).norm() < 1e-7 * expected.norm(),
            "{line}: {found:?}"
        );
        let common = filter.common_offset().unwrap();
        assert!(near(common.offset_m, values[16]) && near(common.sigma_m, values[17]), "{line}: {common:?}");
    }
}

#[test]
fn offsets_are_found_with_the_place() {
    let params = FilterParams { height: at_height(1.1, 0.05), ..FilterParams::default() };
    let (mut filter, mut noise) = (filter(params, WeightingKind::Igg3), Normal::new(1));
    let offsets = [0.45, 0.38, 0.42, 0.35];
    let (mut worst, mut squares): (f64, f64) = (0.0, 0.0);
    for tick in 0..4800_u32 {
        let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
        let distance = (round(time_s) - place(LAB[anchor])).norm();
        filter.observe(&link(&LAB, anchor, time_s, distance + offsets[anchor] + noise.draw(0.05), 0.08), 0);
        if time_s > 60.0 {
            let found = filter.solution().unwrap();
            let (off, told) =
                ((found.position_m - round(time_s)).xy(), found.covariance.fixed_view::<2, 2>(0, 0));
            squares += off.norm_squared();
            worst = worst.max(off.dot(&told.cholesky().unwrap().solve(&off)));
        }
    }
    // χ² with two degrees of freedom: 99.99 % are below 18.4; noise of 5 cm is taken for 4 cm and for 7 cm that passes.
    assert!(worst < 18.4 && (squares / 2400.0).sqrt() < 0.08, "{worst} {squares}");
    let found: Vec<_> = filter.offsets().collect();
    assert_eq!(found.len(), 4);
    for (anchor, _, found) in found {
        let off = found.offset_m - offsets[anchor];
        assert!(off.abs() < 3.0 * found.sigma_m && off.abs() < 0.03, "{anchor}: {found:?}");
    }
}

/// Runs of a world that is as the settings say: the normalised squared error of the place at the end of each is χ² with three degrees of freedom.
#[test]
fn the_covariance_is_honest() {
    const SEEDS: u32 = 200;
    let params = FilterParams { height: at_height(1.1, 0.3), ..FilterParams::default() };
    let FilterParams { motion, height, errors, .. } = params;
    let dt = 0.025;
    let (mut sum, mut nis, mut nis_count) = (0.0, 0.0, 0_u64);
    for seed in 0..u64::from(SEEDS) {
        let mut draw = Normal::new(seed);
        let mut at = Vector3::new(12.0, 8.0, 1.1 + draw.draw(0.3));
        let mut velocity = Vector3::new(
            draw.draw(motion.speed_m_s),
            draw.draw(motion.speed_m_s),
            draw.draw(height.climb_m_s),
        );
        let common = draw.draw(errors.common_offset_sigma_m);
        let constant = [0; 4].map(|_| draw.draw(errors.anchor_offset_sigma_m));
        let mut passing = [0; 4].map(|_| draw.draw(errors.passing_sigma_m));
        let mut filter = filter(params, WeightingKind::Equal);
        let spread = Matrix3::from_diagonal(&Vector3::new(0.25, 0.25, 0.09));
        let told = at + Vector3::new(draw.draw(0.5), draw.draw(0.5), 0.0);
        filter.start_at(seconds(0.0), told.xy().push(1.1), &spread);
        let rate = height.climb_m_s / 0.3;
        for tick in 1..=800_u32 {
            // Steps a hundredth of the shortest time of the model: the integration's own error is far below the filter's.
            for _ in 0..10 {
                let h = dt / 10.0;
                for axis in 0..2 {
                    at[axis] += h * velocity[axis];
                    velocity[axis] += -h * velocity[axis] / motion.steady_s
                        + draw.draw(motion.speed_m_s * (2.0 * h / motion.steady_s).sqrt());
                }
                at.z += h * velocity.z;
                velocity.z += h * (-rate * rate * (at.z - 1.1) - 2.0 * rate * velocity.z)
                    + draw.draw(height.climb_m_s * (4.0 * rate * h).sqrt());
            }
            let left = (-dt / errors.correlation_s).exp();
            for error in &mut passing {
                *error = left * *error + draw.draw(errors.passing_sigma_m * (1.0 - left * left).sqrt());
            }
            let anchor = (tick % 4) as usize;
            let error = common + constant[anchor] + passing[anchor] + draw.draw(0.04);
            let range_m = (at - place(LAB[anchor])).norm() + error;
            let sigma_m = errors.passing_sigma_m.hypot(0.04);
            filter.observe(&link(&LAB, anchor, dt * f64::from(tick), range_m, sigma_m), 0);
        }
        let solution = filter.solution().unwrap();
        let off = at - solution.position_m;
        sum += off.dot(&solution.position_covariance().cholesky().unwrap().solve(&off));
        nis += filter.report().nis_sum;
        nis_count += filter.report().nis_count;
    }
    // χ² with 600 degrees of freedom over 200: 99.9 % lie within 2.46 to 3.60. The walk leaves the laboratory in some runs, where curvature is small: no other reason to be off.
    let mean = sum / f64::from(SEEDS);
    assert!((2.46..3.60).contains(&mean), "{mean}");
    // Innovations of one run are white: 160,000 of them have their mean within 1.2 % (99.9 %); what the model leaves out of curvature is less.
    let mean = nis / nis_count as f64;
    assert!((mean - 1.0).abs() < 0.02, "{mean}");
}

#[test]
fn dead_reckoning_carries_the_place_and_ranges_turn_it_right() {
    let params = FilterParams {
        height: at_height(1.1, 0.05),
        reckoning: ReckoningParams { heading_sigma_deg: 15.0, ..ReckoningParams::default() },
        ..FilterParams::default()
    };
    let (mut filter, mut noise) = (filter(params, WeightingKind::Igg3), Normal::new(9));
    filter.start_at(seconds(0.0), round(0.0), &(Matrix3::identity() * 0.01));
    let (turn, scale) = (0.2_f64, 0.9);
    let reckoned = |time_s: f64| {
        // What is reckoned is turned by −δ and shorter by 1/k.
        let (sin, cos) = (-turn).sin_cos();
        let way = round(time_s) - round(0.0);
        Vector2::new(cos * way.x - sin * way.y, sin * way.x + cos * way.y) * scale
    };
    let step = 0.6;
    let mut last = reckoned(0.0);
    for k in 1..=150_u32 {
        let time_s = step * f64::from(k);
        let now = reckoned(time_s);
        filter.propagate_by(&(now - last), seconds(time_s));
        last = now;
        // Ranges until 60 s, then steps alone.
        for anchor in (0..4).filter(|_| time_s < 60.0) {
            let distance = (round(time_s) - place(LAB[anchor])).norm();
            filter.observe(&link(&LAB, anchor, time_s, distance + noise.draw(0.05), 0.08), 0);
        }
        if (59.0..59.6).contains(&time_s) {
            // Turned and stretched as the ranges say: the next 30 s, 25 m, by steps alone must not go astray by 11° and 10 %.
            let off = filter.solution().unwrap().position_m - round(time_s);
            assert!(off.xy().norm() < 0.1, "{off}");
        }
    }
    let last = filter.solution().unwrap();
    let off = (last.position_m - round(90.0)).xy();
    let expected = (last.covariance[(0, 0)] + last.covariance[(1, 1)]).sqrt();
    assert!(off.norm() < 1.0 && off.norm() < 3.0 * expected, "{off} {expected}");
}

#[test]
fn a_step_that_is_sure_adds_nothing_uncertain() {
    let params = FilterParams {
        reckoning: ReckoningParams {
            heading_sigma_deg: 0.0,
            scale_sigma: 0.0,
            way_share: 0.0,
            standing_m_sqrt_s: 0.0,
            heading_walk_deg_sqrt_s: 0.0,
        },
        ..FilterParams::default()
    };
    let mut filter = filter(params, WeightingKind::Equal);
    filter.start_at(seconds(0.0), Vector3::new(1.0, 2.0, 3.0), &Matrix3::identity());
    filter.propagate_by(&Vector2::new(2.0, 0.0), seconds(0.5));
    let there = filter.solution().unwrap();
    assert!((there.position_m - Vector3::new(3.0, 2.0, 3.0)).norm() < 1e-12, "{}", there.position_m);
    assert!((there.covariance[(0, 0)] - 1.0).abs() < 1e-12 && (there.covariance[(1, 1)] - 1.0).abs() < 1e-12);
}

#[test]
fn weights_fall_from_one_to_none_without_a_jump() {
    let igg = Weighting { full: 1.5, none: 4.0, ..of_kind(WeightingKind::Igg3) };
    let huber = Weighting { full: 1.5, ..of_kind(WeightingKind::Huber) };
    let mut before = [1.0, 1.0];
    for k in 0..=600_u32 {
        let e = 0.01 * f64::from(k);
        let now = [igg.weight(e), huber.weight(-e)];
        for (now, before) in now.iter().zip(before) {
            // Slope at k₀ is −(1/k₀ + 2/(k₁ − k₀)): 1.5 % over 0.01.
            assert!(*now <= before && before - now < 0.02, "{e}: {now} {before}");
        }
        before = now;
    }
    assert_eq!([igg.weight(1.5), igg.weight(4.0), huber.weight(3.0)], [1.0, 0.0, 0.5]);
    // Yang, Song & Xu's formula by hand: 1.5/2.5 · (1.5/2.5)².
    assert!((igg.weight(2.5) - 0.216).abs() < 1e-12);
}

/// Noise that is five times what is told is found; so is noise that is told right.
#[test]
fn an_adaptive_filter_learns_how_bad_the_ranges_are() {
    let params = FilterParams {
        height: at_height(1.1, 0.05),
        errors: ErrorParams { passing_sigma_m: 0.001, ..ErrorParams::default() },
        gate: GateParams { kind: GateKind::Open, ..GateParams::default() },
        ..FilterParams::default()
    };
    let spread_of = |kind, sigma_m: f64| {
        let (mut filter, mut noise) = (filter(params, kind), Normal::new(11));
        let (mut squares, mut variance, mut count) = (0.0, 0.0, 0.0);
        for tick in 0..4800_u32 {
            let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
            let distance = (round(time_s) - place(LAB[anchor])).norm();
            filter.observe(&link(&LAB, anchor, time_s, distance + noise.draw(sigma_m), 0.08), 0);
            if let Some(solution) = filter.solution().filter(|_| time_s > 20.0) {
                squares += (solution.position_m - round(time_s)).xy().norm_squared();
                variance += solution.covariance[(0, 0)] + solution.covariance[(1, 1)];
                count += 1.0;
            }
        }
        ((squares / count as f64).sqrt(), (variance / count as f64).sqrt())
    };
    let (plain_error, plain_told) = spread_of(WeightingKind::Equal, 0.4);
    let (error, told) = spread_of(WeightingKind::Adaptive, 0.4);
    assert!(plain_told < 0.6 * plain_error, "{plain_error} {plain_told}");
    // Honest within a third: the walk on a circle is not the model's.
    assert!(error < plain_error && (0.67..1.5).contains(&(told / error)), "{error} {told} {plain_error}");
}

#[test]
fn a_run_in_two_halves_is_the_whole_run() {
    let params = FilterParams { height: at_height(1.1, 0.2), ..FilterParams::default() };
    let ranges: Vec<Link> = (0..400_u32)
        .map(|tick| {
            let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
            let wrong = if tick % 7 == 3 { 2.0 } else { 0.0 };
            link(&LAB, anchor, time_s, (round(time_s) - place(LAB[anchor])).norm() + wrong, 0.08)
        })
        .collect();
    for kind in [WeightingKind::Igg3, WeightingKind::Adaptive] {
        let mut whole = filter(params, kind);
        let mut first = filter(params, kind);
        ranges.iter().for_each(|one| {
            whole.observe(one, 0);
        });
        ranges[..133].iter().for_each(|one| {
            first.observe(one, 0);
        });
        let mut second: RangeFilter = serde_json::from_str(&serde_json::to_string(&first).unwrap()).unwrap();
        ranges[133..].iter().for_each(|one| {
            second.observe(one, 0);
        });
        assert_eq!(whole, second);
    }
}

#[test]
fn settings_that_cannot_be_used_are_named() {
    let start = StartParams { window_s: 0.0, ..StartParams::default() };
    let params = FilterParams { start, ..FilterParams::default() };
    assert_eq!(RangeFilter::new(params, Weighting::default()).unwrap_err(), "filter.start.window_s");
    let weighting = Weighting { none: 0.5, ..Weighting::default() };
    assert_eq!(RangeFilter::new(FilterParams::default(), weighting).unwrap_err(), "weighting.none");
}

proptest! {
    #[test]
    fn no_range_breaks_the_filter(
        ranges in prop::collection::vec((0.0..2.0_f64, -1e3..1e6_f64, 1e-6..1e3_f64, 0..20_usize), 1..200),
        odd in 0..4_usize,
        kind in 0..4_usize,
    ) {
        let kind = [WeightingKind::Equal, WeightingKind::Huber, WeightingKind::Igg3, WeightingKind::Adaptive][kind];
        let anchors: Vec<[f64; 3]> =
            (0..20).map(|k| [f64::from(k * 7 % 20), f64::from(k * 3 % 11), f64::from(k % 4)]).collect();
        let mut filter = filter(FilterParams::default(), kind);
        let mut time_s = 0.0;
        for (k, (after_s, range_m, sigma_m, anchor)) in ranges.iter().enumerate() {
            // Now and then back in time, and now and then what is no number.
            time_s += if k % 9 == 8 { -after_s } else { *after_s };
            let range_m = if k % 31 == 30 { [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 3.0][odd] } else { *range_m };
            filter.observe(&link(&anchors, *anchor, time_s.max(0.0), range_m, *sigma_m), k % 2);
            if let Some(solution) = filter.solution() {
                prop_assert!(solution.position_m.iter().chain(&solution.covariance).all(|value| value.is_finite()));
                prop_assert!(solution.covariance.diagonal().iter().all(|value| *value >= 0.0));
            }
        }
    }
}
