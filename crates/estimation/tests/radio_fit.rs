//! Circles, centroids, trilateration and the robust fits: exact data, degenerate places, independent numbers, consistency.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_estimation::radio::centroid::{CentroidWeight, centroid};
use adit_estimation::radio::circles::{CircleParams, InnerWeight, inner_points};
use adit_estimation::radio::path_loss::{FARTHEST_M, NEAREST_M, distance_m, mean_dbm};
use adit_estimation::radio::range_fit::{RangeFitParams, RangeModel, Ranged, range_fit};
use adit_estimation::radio::signal_fit::{SignalFitParams, signal_fit};
use adit_estimation::radio::trilateration::{linear_ranges, linear_signals};
use adit_estimation::radio::{AreaPrior, Emitter, Heard, PathLoss};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal, StudentT};

const FREE: PathLoss =
    PathLoss { rssi_at_1m_dbm: -40.0, exponent: 2.0, breakpoint_m: None, exponent_beyond: None };

fn emitter(x: f64, y: f64, z: f64) -> Emitter {
    Emitter { position_m: Vector3::new(x, y, z), path_loss: FREE, sigma_db: 4.0 }
}

/// What a tag at this place and height hears without error.
fn exact<'a>(emitters: &'a [Emitter], place: Vector2<f64>, height_m: f64) -> Vec<Heard<'a>> {
    let heard = |emitter: &'a Emitter| {
        let distance = (emitter.position_m - Vector3::new(place.x, place.y, height_m)).norm();
        Heard { emitter, rssi_dbm: mean_dbm(&emitter.path_loss, distance) }
    };
    emitters.iter().map(heard).collect()
}

proptest! {
    #[test]
    fn a_distance_comes_back_from_its_strength(
        at_1m in -70.0..-20.0_f64, n in 1.0..5.0_f64, turn in 2.0..80.0_f64, beyond in 1.0..6.0_f64, d in 0.31..3000.0_f64
    ) {
        let one = PathLoss { rssi_at_1m_dbm: at_1m, exponent: n, breakpoint_m: None, exponent_beyond: None };
        let two = PathLoss { breakpoint_m: Some(turn), exponent_beyond: Some(beyond), ..one };
        for model in [one, two] {
            prop_assert!((distance_m(&model, mean_dbm(&model, d)) / d - 1.0).abs() < 1e-9);
        }
        // Without a jump at the turn, and both slopes as given.
        prop_assert!((mean_dbm(&two, turn) - mean_dbm(&one, turn)).abs() < 1e-9);
        prop_assert!((mean_dbm(&two, turn) - mean_dbm(&two, 10.0 * turn) - 10.0 * beyond).abs() < 1e-9);
    }

    #[test]
    fn no_strength_and_no_place_breaks_a_method(
        values in prop::collection::vec((-1e3..1e3_f64, -1e3..1e3_f64, -250.0..250.0_f64), 0..6), odd in 0..4_usize
    ) {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -60.0][odd];
        let emitters: Vec<Emitter> = values.iter().map(|(x, y, _)| emitter(*x, *y, 0.0)).collect();
        let mut heard: Vec<Heard<'_>> =
            emitters.iter().zip(&values).map(|(emitter, (_, _, rssi_dbm))| Heard { emitter, rssi_dbm: *rssi_dbm }).collect();
        if let Some(first) = heard.first_mut() {
            first.rssi_dbm = odd;
        }
        let fixes = [
            centroid(&heard, CentroidWeight::InverseRange),
            inner_points(&heard, &CircleParams::default()),
            linear_signals(&heard, 0.0),
            signal_fit(&heard, None, &SignalFitParams::default()),
        ];
        for fix in fixes.into_iter().flatten() {
            prop_assert!(fix.position_m.iter().chain(fix.covariance_m2.iter()).all(|v| v.is_finite()), "{fix:?}");
            prop_assert!(fix.radius_95_m() > 0.0);
        }
    }
}

#[test]
fn a_distance_stays_within_what_a_radio_reaches() {
    assert!((distance_m(&FREE, 100.0) - NEAREST_M).abs() < 1e-12);
    assert!((distance_m(&FREE, -1e9) - FARTHEST_M).abs() < 1e-12);
    assert!((distance_m(&FREE, f64::NAN) - FARTHEST_M).abs() < 1e-12);
}

#[test]
fn exact_strengths_give_the_place() {
    let emitters = [emitter(0.0, 0.0, 3.0), emitter(30.0, 2.0, 2.5), emitter(12.0, 25.0, 4.0)];
    let truth = Vector2::new(14.0, 9.0);
    let heard = exact(&emitters, truth, 1.2);
    let params = CircleParams { height_m: 1.2, ..CircleParams::default() };
    for weight in [InnerWeight::Equal, InnerWeight::InverseRange, InnerWeight::RangeOverStrength] {
        let fix = inner_points(&heard, &CircleParams { weight, ..params }).unwrap();
        assert!((fix.position_m - truth).norm() < 1e-9, "{weight:?}: {fix:?}");
    }
    assert!((linear_signals(&heard, 1.2).unwrap().position_m - truth).norm() < 1e-9);
    let fit =
        signal_fit(&heard, None, &SignalFitParams { height_m: 1.2, ..SignalFitParams::default() }).unwrap();
    // The search ends at steps of 2 cm, and converges quadratically there.
    assert!((fit.position_m - truth).norm() < 1e-3, "{fit:?}");
}

/// By hand: three circles about (0, 0), (10, 0), (5, 8) with radii 7, 6, 5 and strengths −60, −55, −50.
#[test]
fn the_improved_weights_are_those_of_the_paper() {
    let centres = [(0.0, 0.0), (10.0, 0.0), (5.0, 8.0)];
    let (radii, rssi): ([f64; 3], [f64; 3]) = ([7.0, 6.0, 5.0], [-60.0, -55.0, -50.0]);
    let emitters: Vec<Emitter> = (0..3)
        .map(|i| {
            let path_loss = PathLoss { rssi_at_1m_dbm: rssi[i] + 20.0 * radii[i].log10(), ..FREE };
            Emitter { position_m: Vector3::new(centres[i].0, centres[i].1, 0.0), path_loss, sigma_db: 4.0 }
        })
        .collect();
    let heard: Vec<Heard<'_>> =
        emitters.iter().zip(rssi).map(|(emitter, rssi_dbm)| Heard { emitter, rssi_dbm }).collect();
    // Both meetings of each pair, by the equations of the circles; the one nearer to the third centre.
    let meet = |i: usize, j: usize, k: usize| {
        let (a, b) = (Vector2::new(centres[i].0, centres[i].1), Vector2::new(centres[j].0, centres[j].1));
        let third = Vector2::new(centres[k].0, centres[k].1);
        let steps = (0..3_600_000).map(|step| {
            let angle = f64::from(step) * std::f64::consts::TAU / 3_600_000.0;
            a + Vector2::new(angle.cos(), angle.sin()) * radii[i]
        });
        let on_both = steps.filter(|p| ((p - b).norm() - radii[j]).abs() < 2e-5);
        on_both.min_by(|p, q| (p - third).norm().total_cmp(&(q - third).norm())).unwrap()
    };
    let weight = |i: usize, j: usize| 1.0 / ((radii[i] / rssi[i]).powi(2) + (radii[j] / rssi[j]).powi(2));
    let points =
        [(meet(0, 1, 2), weight(0, 1)), (meet(0, 2, 1), weight(0, 2)), (meet(1, 2, 0), weight(1, 2))];
    let total: f64 = points.iter().map(|(_, w)| w).sum();
    let expected = points.iter().map(|(p, w)| p * *w).sum::<Vector2<f64>>() / total;
    let fix = inner_points(&heard, &CircleParams::default()).unwrap();
    // The search above is as fine as 2e-5 m.
    assert!((fix.position_m - expected).norm() < 1e-4, "{fix:?} against {expected}");
}

#[test]
fn circles_that_do_not_meet_meet_half_way() {
    // Two apart: 10 m between, radii 2 and 4; the gap from 2 to 6 has its middle at 4.
    let heard_at = |emitter: &Emitter, radius: f64| mean_dbm(&emitter.path_loss, radius);
    let two = [emitter(0.0, 0.0, 0.0), emitter(10.0, 0.0, 0.0)];
    let hear = |radii: [f64; 2]| {
        let heard: Vec<Heard<'_>> = two
            .iter()
            .zip(radii)
            .map(|(emitter, radius)| Heard { emitter, rssi_dbm: heard_at(emitter, radius) })
            .collect();
        inner_points(&heard, &CircleParams::default()).unwrap()
    };
    assert!((hear([2.0, 4.0]).position_m - Vector2::new(4.0, 0.0)).norm() < 1e-9);
    // One inside the other: 20 m about the first, 2 m about the second at 10 m: between 12 and 20.
    assert!((hear([20.0, 2.0]).position_m - Vector2::new(16.0, 0.0)).norm() < 1e-9);
    // The same, told the other way round.
    assert!((hear([2.0, 20.0]).position_m - Vector2::new(-6.0, 0.0)).norm() < 1e-9);
    // Across the row a roadway's width is all that is known.
    let across = hear([5.0, 6.0]).covariance_m2[(1, 1)];
    assert!((across - 2.5 * 2.5 / 3.0).abs() < 1e-3, "{across}");
}

#[test]
fn one_transmitter_alone_is_its_circle() {
    let one = [emitter(3.0, 4.0, 0.0)];
    let heard = exact(&one, Vector2::new(9.0, 4.0), 0.0);
    let fix = inner_points(&heard, &CircleParams::default()).unwrap();
    assert!((fix.position_m - Vector2::new(3.0, 4.0)).norm() < 1e-12);
    // Half the square of 6 m, and of its error, in each direction.
    let sigma = 6.0 * 4.0 / (20.0 / std::f64::consts::LN_10);
    assert!((fix.covariance_m2[(0, 0)] - 0.5 * (36.0 + sigma * sigma)).abs() < 1e-9);
    assert!(inner_points(&[], &CircleParams::default()).is_none());
    assert!(centroid(&[], CentroidWeight::Equal).is_none());
    assert!(signal_fit(&heard, None, &SignalFitParams::default()).is_none());
}

/// A roadway bears 60°: the transmitters stand along it, 60 m apart, none to the side.
#[test]
fn in_a_row_the_fix_stays_on_the_roadway() {
    let along = Vector2::new(60_f64.to_radians().sin(), 60_f64.to_radians().cos());
    let across = Vector2::new(-along.y, along.x);
    let places = [0.0, 60.0, 120.0].map(|s| along * s);
    let emitters = places.map(|p| emitter(p.x, p.y, 0.0));
    for (s, side) in [(10.0, 1.5), (35.0, -1.0), (75.0, 0.5), (110.0, -2.0)] {
        let truth = along * s + across * side;
        let heard = exact(&emitters, truth, 0.0);
        for fix in
            [inner_points(&heard, &CircleParams::default()).unwrap(), linear_signals(&heard, 0.0).unwrap()]
        {
            assert!(fix.position_m.dot(&across).abs() < 1e-9, "{fix:?}");
            // The circles meet over the roadway at the foot of the truth.
            assert!((fix.position_m.dot(&along) - s).abs() < 1e-6, "{s}: {fix:?}");
        }
        // The robust fit finds one of the two sides; the area keeps it near.
        let area = AreaPrior {
            mean_m: along * 60.0,
            covariance_m2: across * across.transpose() * 4.0 + Matrix2::identity() * 1e4,
        };
        let fix = signal_fit(&heard, Some(&area), &SignalFitParams::default()).unwrap();
        assert!((fix.position_m.dot(&along) - s).abs() < 0.5, "{s}: {fix:?}");
    }
}

#[test]
fn the_robust_fit_agrees_with_scipy() {
    let mut elsewhere = 0;
    for line in include_str!("reference/radio_fit.csv").lines() {
        let values: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
        let of = |k: usize| &values[3 + 6 * k..9 + 6 * k];
        let emitters: Vec<Emitter> = (0..6)
            .map(|k| {
                let path_loss = PathLoss { rssi_at_1m_dbm: of(k)[3], exponent: of(k)[4], ..FREE };
                Emitter { position_m: Vector3::new(of(k)[0], of(k)[1], of(k)[2]), path_loss, sigma_db: 4.0 }
            })
            .collect();
        let heard: Vec<Heard<'_>> =
            emitters.iter().enumerate().map(|(k, emitter)| Heard { emitter, rssi_dbm: of(k)[5] }).collect();
        let [mean_x, mean_y, spread, x, y, _] = values[39..45] else { unreachable!() };
        let area = AreaPrior {
            mean_m: Vector2::new(mean_x, mean_y),
            covariance_m2: Matrix2::identity() * spread * spread,
        };
        let params = SignalFitParams {
            height_m: 1.2,
            iterations: 100,
            small_step_m: 1e-4,
            ..SignalFitParams::default()
        };
        let fix = signal_fit(&heard, Some(&area), &params).unwrap();
        // A cost of Student's t can have several minima: scipy was begun at 25 places, the fit
        // at one.
        if (fix.position_m - Vector2::new(x, y)).norm() > 0.002 {
            elsewhere += 1;
        }
    }
    assert!(elsewhere <= 2, "{elsewhere} of 40 ended in another minimum");
}

#[test]
fn one_wrong_strength_does_not_move_the_robust_fit() {
    let places = [(0, 0), (40, 0), (40, 40), (0, 40), (20, -5), (20, 45), (-5, 20), (45, 20)];
    let emitters: Vec<Emitter> = places.map(|(x, y)| emitter(f64::from(x), f64::from(y), 0.0)).into();
    let truth = Vector2::new(23.0, 17.0);
    let mut heard = exact(&emitters, truth, 0.0);
    heard[2].rssi_dbm -= 30.0;
    let params = SignalFitParams::default();
    let robust = signal_fit(&heard, None, &params).unwrap().position_m;
    let plain = signal_fit(&heard, None, &SignalFitParams { dof: 1e6, ..params }).unwrap().position_m;
    // 7.5 standard deviations weigh 5 / (4 + 56) of a good one: the pull of 0.6 deviations on one of eight, at 0.4 dB/m.
    assert!((robust - truth).norm() < 2.0, "{robust}");
    assert!((plain - truth).norm() > 5.0, "{plain}");
}

/// Readings that err as the fit believes, by so little that the path loss is straight over the error: the normalised squared error is that of
/// two degrees of freedom. With errors of 4 dB it is not: the covariance is that of the curvature at one point.
#[test]
fn the_covariance_of_the_robust_fit_is_honest() {
    let emitters: Vec<Emitter> = (0..12)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 12.0;
            Emitter { sigma_db: 0.5, ..emitter(30.0 * angle.cos(), 25.0 * angle.sin(), 0.0) }
        })
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (tail, tag) = (StudentT::new(4.0).unwrap(), Normal::new(0.0, 0.5).unwrap());
    let params = SignalFitParams { offset_sigma_db: 0.5, ..SignalFitParams::default() };
    let runs = 2000;
    let mut nees = 0.0;
    for _ in 0..runs {
        let truth = Vector2::new(6.0, -4.0);
        let mut heard = exact(&emitters, truth, 0.0);
        let offset = tag.sample(&mut random);
        for one in &mut heard {
            one.rssi_dbm += offset + 0.5 * tail.sample(&mut random);
        }
        let fix = signal_fit(&heard, None, &params).unwrap();
        let error = fix.position_m - truth;
        nees += error.dot(&(fix.covariance_m2.try_inverse().unwrap() * error)) / f64::from(runs);
    }
    // 2 with a standard deviation of 2/√2000 = 0.045; the curvature of the logarithm adds some per cent.
    assert!((1.85..2.3).contains(&nees), "{nees}");
}

fn ranged(place: Vector2<f64>, model: RangeModel) -> Vec<Ranged> {
    [(0.0, 0.0), (20.0, 1.0), (9.0, 15.0), (3.0, 12.0), (18.0, 11.0), (10.0, -3.0)]
        .map(|(x, y)| {
            let position_m = Vector3::new(x, y, 2.5);
            let distance = (position_m - Vector3::new(place.x, place.y, 1.0)).norm();
            Ranged { position_m, model, range_m: model.scale * distance + model.offset_m }
        })
        .into()
}

#[test]
fn exact_ranges_give_the_place_through_their_offsets() {
    let truth = Vector2::new(7.0, 6.0);
    let ranges = ranged(truth, RangeModel { offset_m: 1.4, scale: 1.08, sigma_m: 0.5 });
    let params = RangeFitParams { height_m: 1.0, ..RangeFitParams::default() };
    assert!((linear_ranges(&ranges, 1.0).unwrap().position_m - truth).norm() < 1e-9);
    assert!((range_fit(&ranges, None, &params).unwrap().position_m - truth).norm() < 1e-3);
    // One range through two corners, 12 m too long.
    let mut one_long = ranges.clone();
    one_long[1].range_m += 12.0;
    let robust = range_fit(&one_long, None, &params).unwrap().position_m;
    let linear = linear_ranges(&one_long, 1.0).unwrap().position_m;
    assert!((robust - truth).norm() < 0.5 && (linear - truth).norm() > 1.5, "{robust} {linear}");
    assert!(range_fit(&ranges[..2], None, &params).is_none() && range_fit(&[], None, &params).is_none());
}
