//! Lattices, likelihood maps, nearest fingerprints and walks over them.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{DMatrix, DVector, Vector2, Vector3};
use adit_estimation::radio::map::{Hearing, Storeys};
use adit_estimation::radio::nearest::{Fingerprints, NearestParams};
use adit_estimation::radio::range_fit::RangeModel;
use adit_estimation::radio::walk::{Walk, WalkParams, smooth};
use adit_estimation::radio::{Emitter, Lattice, MapParams, PathLoss, RadioMap, Reading};
use proptest::prelude::*;

fn reading(transmitter: usize, value: f64) -> Reading {
    Reading { transmitter, value }
}

#[test]
fn a_lattice_has_places_near_the_spots_and_nowhere_else() {
    let spots = [(Vector2::new(0.0, 0.0), 1), (Vector2::new(10.0, 0.0), 1), (Vector2::new(10.0, 8.0), 2)];
    let lattice = Lattice::around(&spots, 0.5, 2.0).unwrap();
    assert_eq!(lattice.floors(), [1, 2]);
    for (place, floor) in lattice.iter() {
        let nearest = spots.iter().filter(|(_, on)| *on == floor).map(|(spot, _)| (spot - place).norm());
        // Half a step more, so that every spot has a place.
        assert!(nearest.fold(f64::INFINITY, f64::min) <= 2.25 + 1e-9);
    }
    for (spot, floor) in spots {
        let away = lattice.iter().filter(|(_, on)| *on == floor).map(|(place, _)| (place - spot).norm());
        assert!(away.fold(f64::INFINITY, f64::min) <= 0.5_f64.hypot(0.5) / 2.0 + 1e-9);
    }
    // A circle of 2.25 m holds π·2.25²/0.25 = 63.6 squares of half a metre, three of them; its edge cuts some thirty, of which a quarter may
    // fall to one side.
    assert!((lattice.len() as f64 / 3.0 - 63.6).abs() < 8.0, "{}", lattice.len());
    assert!(Lattice::around(&[], 0.5, 2.0).is_none());
    assert!(Lattice::around(&spots, 0.0, 2.0).is_none() && Lattice::around(&spots, f64::NAN, 2.0).is_none());
    assert!(Lattice::around(&[(Vector2::zeros(), 0), (Vector2::new(1e6, 1e6), 0)], 0.5, 2.0).is_none());
    assert_eq!(Lattice::within(&Vector2::zeros(), &Vector2::new(2.0, 1.0), 0.5).unwrap().len(), 15);
    assert!(Lattice::within(&Vector2::new(1.0, 0.0), &Vector2::zeros(), 0.5).is_none());
}

fn square(step_m: f64, side_m: f64) -> Lattice {
    Lattice::within(&Vector2::zeros(), &Vector2::new(side_m, side_m), step_m).unwrap()
}

fn of_emitters(lattice: Lattice, sigma_db: f64) -> (RadioMap, Vec<Emitter>) {
    let path_loss =
        PathLoss { rssi_at_1m_dbm: -45.0, exponent: 2.5, breakpoint_m: None, exponent_beyond: None };
    let emitters: Vec<Emitter> = [(0.0, 0.0), (20.0, 0.0), (0.0, 20.0), (20.0, 20.0)]
        .map(|(x, y)| Emitter { position_m: Vector3::new(x, y, 2.0), path_loss, sigma_db })
        .into();
    let storeys = Storeys { height_m: 3.0, loss_db: 0.0 };
    let hearing = Hearing { half_dbm: -75.0, width_db: 4.0, unsure: 0.05 };
    let placed: Vec<_> = emitters.iter().map(|emitter| (*emitter, None)).collect();
    (RadioMap::of_emitters(lattice, &placed, 1.0, &storeys, &hearing).unwrap(), emitters)
}

/// The formula of the module, term by term, in double precision, with the offset on a fine grid.
#[test]
fn the_likelihood_is_that_of_the_formula() {
    let (map, emitters) = of_emitters(square(1.0, 20.0), 4.0);
    let readings = [reading(0, -61.0), reading(2, -70.0), reading(3, -80.0)];
    let params = MapParams { dof: 5.0, offset_sigma: 2.0, heard_weight: 0.4, share: 0.7 };
    let hearing = Hearing { half_dbm: -75.0, width_db: 4.0, unsure: 0.05 };
    let mut got = Vec::new();
    map.log_likelihood(&readings, &params, &mut got);
    let wanted = map.lattice().iter().map(|(place, _)| {
        let mean = |k: usize| {
            let d = (emitters[k].position_m - Vector3::new(place.x, place.y, 1.0)).norm();
            -45.0 - 25.0 * d.log10()
        };
        let strengths = |c: f64| {
            let terms = readings.map(|r| {
                let e = (r.value - mean(r.transmitter) - c) / 4.0;
                3.0 * (e * e / 5.0).ln_1p() + 4.0_f64.ln()
            });
            -terms.iter().sum::<f64>() - 0.5 * (c / 2.0).powi(2)
        };
        let best = (-2000..2000).map(|k| strengths(f64::from(k) * 0.005)).fold(f64::NEG_INFINITY, f64::max);
        let heard = |k: usize| hearing.probability(mean(k));
        let silence = [0, 2, 3].map(|k| heard(k).ln()).iter().sum::<f64>() + (1.0 - heard(1)).ln();
        0.7 * (best + 0.4 * silence)
    });
    for (got, wanted) in got.iter().zip(wanted) {
        // Single precision of the map, and an offset that three rounds have brought near its best.
        assert!((got - wanted).abs() < 0.02, "{got} against {wanted}");
    }
}

#[test]
fn the_fix_is_where_the_readings_fit() {
    let (map, emitters) = of_emitters(square(0.5, 20.0), 1.0);
    let truth = Vector2::new(13.0, 6.5);
    let read = |k: usize| {
        let d = (emitters[k].position_m - Vector3::new(truth.x, truth.y, 1.0)).norm();
        reading(k, -45.0 - 25.0 * d.log10())
    };
    let readings = [read(0), read(1), read(2), read(3)];
    let params = MapParams { offset_sigma: 0.0, ..MapParams::SCAN };
    let found = map.fix(&readings, &params).unwrap();
    assert!((found.fix.position_m - truth).norm() < 0.5, "{found:?}");
    assert!((0.5..4.0).contains(&found.fix.radius_95_m()), "{found:?}");
    // What is not known, or no number, is as if it were not there.
    let with_noise = [&readings[..], &[reading(99, -50.0), reading(1, f64::NAN)]].concat();
    assert_eq!(map.fix(&with_noise, &params), Some(found));
    assert_eq!(map.fix(&[reading(99, -50.0)], &params), None);
    assert_eq!(map.fix(&[], &params), None);
}

#[test]
fn ranges_and_floors_have_maps_too() {
    let places = [(0.0, 0.0), (20.0, 0.0), (0.0, 20.0)].map(|(x, y)| Vector3::new(x, y, 2.0));
    let model = RangeModel { offset_m: 1.2, scale: 1.05, sigma_m: 0.4 };
    let devices: Vec<_> = places.iter().map(|place| (*place, model)).collect();
    let map = RadioMap::of_ranges(square(0.5, 20.0), &devices, 1.0).unwrap();
    let truth = Vector3::new(5.0, 9.0, 1.0);
    let readings: Vec<Reading> =
        places.iter().enumerate().map(|(k, p)| reading(k, 1.05 * (p - truth).norm() + 1.2)).collect();
    assert!((map.fix(&readings, &MapParams::RANGES).unwrap().fix.position_m - truth.xy()).norm() < 0.3);

    let spots = [(Vector2::new(5.0, 5.0), 1), (Vector2::new(5.0, 5.0), 2)];
    let path_loss =
        PathLoss { rssi_at_1m_dbm: -40.0, exponent: 2.0, breakpoint_m: None, exponent_beyond: None };
    let on = |floor: i32| {
        (Emitter { position_m: Vector3::new(5.0, 8.0, 2.0), path_loss, sigma_db: 4.0 }, Some(floor))
    };
    let storeys = Storeys { height_m: 3.0, loss_db: 15.0 };
    let hearing = Hearing { half_dbm: -80.0, width_db: 4.0, unsure: 0.1 };
    let lattice = Lattice::around(&spots, 0.5, 2.0).unwrap();
    let map = RadioMap::of_emitters(lattice, &[on(1), on(2)], 1.0, &storeys, &hearing).unwrap();
    let upstairs = map.fix(&[reading(0, -66.0), reading(1, -50.0)], &MapParams::SCAN).unwrap();
    assert_eq!(upstairs.floor, 2);
    assert!(upstairs.floor_share > 0.95);
}

#[test]
fn a_map_comes_back_from_its_file_and_a_broken_one_does_not() {
    let (map, _) = of_emitters(square(1.0, 5.0), 4.0);
    let text = serde_json::to_string(&map).unwrap();
    let back: RadioMap = serde_json::from_str(&text).unwrap();
    let (mut a, mut b) = (Vec::new(), Vec::new());
    let readings = [reading(0, -61.0), reading(2, -70.0)];
    map.log_likelihood(&readings, &MapParams::SCAN, &mut a);
    back.log_likelihood(&readings, &MapParams::SCAN, &mut b);
    // Files have three decimals: half a thousandth of a decibel in each of two readings and four chances of hearing.
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 0.02));
    for (from, to) in [
        ("\"transmitters\":4", "\"transmitters\":3"),
        ("\"step_m\":1.0", "\"step_m\":0.0"),
        ("\"columns\":6", "\"columns\":2"),
        ("\"sigma\":[4.0", "\"sigma\":[-4.0"),
        ("\"heard\":[", "\"heard\":[null,"),
    ] {
        assert!(text.contains(from), "{from}");
        assert!(serde_json::from_str::<RadioMap>(&text.replacen(from, to, 1)).is_err(), "{to}");
    }
}

#[test]
fn the_nearest_fingerprints_are_those_of_a_full_sort() {
    let place = |k: usize| Vector2::new((k * 7 % 23) as f64, (k * 5 % 17) as f64);
    let strength = |k: usize, t: usize| {
        if (k * 3 + t).is_multiple_of(11) { f32::NAN } else { -50.0 - ((k * 13 + t * 29) % 41) as f32 }
    };
    let prints = Fingerprints {
        transmitters: 6,
        spots: (0..60).map(|k| (place(k), 0)).collect(),
        means_dbm: (0..60).flat_map(|k| (0..6).map(move |t| strength(k, t))).collect(),
    };
    let params = NearestParams { neighbours: 4, weighted: false, unheard_dbm: -95.0 };
    for seed in 0..50_usize {
        let readings: Vec<Reading> = (0..6)
            .filter(|t| (seed + t) % 4 != 0)
            .map(|t| reading(t, -50.0 - ((seed * 17 + t * 11) % 43) as f64))
            .collect();
        let scan: Vec<f64> =
            (0..6).map(|t| readings.iter().find(|r| r.transmitter == t).map_or(-95.0, |r| r.value)).collect();
        let mut by_distance: Vec<(f64, usize)> = (0..60)
            .map(|k| {
                let gap = |t: usize| {
                    let mean = f64::from(strength(k, t));
                    (if mean.is_nan() { -95.0 } else { mean }) - scan[t]
                };
                ((0..6).map(|t| gap(t).powi(2)).sum(), k)
            })
            .collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let expected = by_distance[..4].iter().map(|(_, k)| place(*k)).sum::<Vector2<f64>>() / 4.0;
        let found = prints.nearest(&readings, &params).unwrap();
        // Distances in single precision: whole numbers here, so exact.
        assert!((found.fix.position_m - expected).norm() < 1e-9, "seed {seed}");
    }
    assert!(prints.nearest(&[], &params).is_none());
    assert!(Fingerprints::default().nearest(&[reading(0, -50.0)], &params).is_none());
}

/// The transition as a dense matrix: products of differences of the normal distribution, each source brought to one.
fn transition(lattice: &Lattice, sigma: f64) -> DMatrix<f64> {
    let below = |x: f64| 0.5 * libm::erfc(-x / (sigma * std::f64::consts::SQRT_2));
    let half = 0.5 * lattice.step_m();
    let along = |d: f64| {
        // The kernel ends four standard deviations away, at a whole step.
        let reach = (4.0 * sigma / lattice.step_m()).ceil() * lattice.step_m();
        if d.abs() > reach + half { 0.0 } else { below(d + half) - below(d - half) }
    };
    let places: Vec<_> = lattice.iter().collect();
    let mut matrix = DMatrix::from_fn(places.len(), places.len(), |to, from| {
        let ((a, on_a), (b, on_b)) = (places[to], places[from]);
        if on_a == on_b { along(a.x - b.x) * along(a.y - b.y) } else { 0.0 }
    });
    for mut column in matrix.column_iter_mut() {
        let sum = column.sum();
        column /= sum;
    }
    matrix
}

#[test]
fn a_walk_is_the_forward_backward_algorithm() {
    let spots = [(Vector2::new(0.0, 0.0), 0), (Vector2::new(4.0, 1.0), 0), (Vector2::new(4.0, 1.0), 1)];
    let lattice = Lattice::around(&spots, 0.5, 1.5).unwrap();
    let params = WalkParams { wander_m_sqrt_s: 0.9, share: 1.0 };
    let count = lattice.len();
    let log = |epoch: usize| -> Vec<f64> {
        (0..count).map(|k| -(((k * 37 + epoch * 101) % 19) as f64) * 0.3).collect()
    };
    let epochs: Vec<(f64, Vec<f64>)> =
        (0..6).map(|epoch| (if epoch == 0 { 0.0 } else { 0.7 }, log(epoch))).collect();
    let step = transition(&lattice, 0.9 * 0.7_f64.sqrt());
    // Dense, in the words of the textbook.
    let likelihood = |epoch: usize| DVector::from_vec(log(epoch).iter().map(|l| l.exp()).collect());
    let mut forward = vec![DVector::from_element(count, 1.0).component_mul(&likelihood(0))];
    for epoch in 1..6 {
        forward.push((&step * &forward[epoch - 1]).component_mul(&likelihood(epoch)));
    }
    let mut backward = vec![DVector::from_element(count, 1.0); 6];
    for epoch in (0..5).rev() {
        backward[epoch] = step.transpose() * backward[epoch + 1].component_mul(&likelihood(epoch + 1));
    }
    let mean = |weights: &DVector<f64>| {
        // On the likelier floor, as the fix.
        let on = |floor: i32| lattice.iter().zip(weights.iter()).filter(move |((_, at), _)| *at == floor);
        let mass = |floor: i32| on(floor).map(|(_, w)| w).sum::<f64>();
        let floor = i32::from(mass(0) < mass(1));
        on(floor).map(|((place, _), w)| place * *w).sum::<Vector2<f64>>() / mass(floor)
    };
    let mut walk = Walk::new(lattice.clone(), params);
    let smoothed = smooth(&lattice, params, &epochs);
    for (epoch, (interval, log)) in epochs.iter().enumerate() {
        walk.wander(*interval);
        walk.hear(log);
        // One part in a million is kept for "anywhere", of which 4 m make micrometres; single precision in the smoother.
        assert!((walk.fix().unwrap().fix.position_m - mean(&forward[epoch])).norm() < 1e-5);
        let both = forward[epoch].component_mul(&backward[epoch]);
        assert!((smoothed[epoch].unwrap().fix.position_m - mean(&both)).norm() < 1e-5);
    }
}

proptest! {
    #[test]
    fn a_walk_survives_any_readings(logs in prop::collection::vec(prop::num::f64::ANY, 9), interval in prop::num::f64::ANY) {
        let lattice = square(1.0, 2.0);
        let mut walk = Walk::new(lattice, WalkParams::default());
        walk.wander(interval);
        walk.hear(&logs);
        walk.wander(1.0);
        walk.hear(&[0.0, -1.0, -2.0, 0.0, -1.0, -2.0, 0.0, -1.0, -2.0]);
        let fix = walk.fix().unwrap();
        prop_assert!(fix.fix.position_m.iter().all(|v| v.is_finite()), "{fix:?}");
    }
}

/// A tag that stands still is found ever better; one that has been far away is found again.
#[test]
fn a_walk_follows_the_tag() {
    let (map, emitters) = of_emitters(square(0.5, 20.0), 3.0);
    let hear = |place: Vector2<f64>| {
        let read = |k: usize| {
            let d = (emitters[k].position_m - Vector3::new(place.x, place.y, 1.0)).norm();
            reading(k, -45.0 - 25.0 * d.log10())
        };
        let mut log = Vec::new();
        map.log_likelihood(&[read(0), read(1), read(2), read(3)], &MapParams::PACKETS, &mut log);
        log
    };
    let mut walk = Walk::new(map.lattice().clone(), WalkParams::default());
    let (first, second) = (Vector2::new(4.0, 4.0), Vector2::new(16.0, 12.0));
    for _ in 0..20 {
        walk.wander(0.5);
        walk.hear(&hear(first));
    }
    let there = walk.fix().unwrap().fix;
    assert!((there.position_m - first).norm() < 0.5 && there.radius_95_m() < 4.0, "{there:?}");
    for _ in 0..40 {
        walk.wander(0.5);
        walk.hear(&hear(second));
    }
    assert!((walk.fix().unwrap().fix.position_m - second).norm() < 0.5);
}
