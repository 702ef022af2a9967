//! Places by differences of arrival: exact data, independent numbers, images, dilution, consistency.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use adit_estimation::radio::AreaPrior;
use adit_estimation::ranging::Height;
use adit_estimation::ranging::dilution::{Unknowns, dilution};
use adit_estimation::ranging::fit::FitParams;
use adit_estimation::ranging::tdoa::{Arrival, closed_form, fit};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

const HALL: [(f64, f64, f64); 6] = [
    (0.0, 0.0, 3.2),
    (20.0, 0.0, 1.0),
    (20.0, 14.0, 5.2),
    (0.0, 14.0, 2.0),
    (10.0, -1.0, 0.2),
    (9.0, 15.0, 6.0),
];

fn arrivals(anchors: &[(f64, f64, f64)], place: Vector3<f64>, sigma_m: f64) -> Vec<Arrival> {
    let anchors: Vec<Vector3<f64>> = anchors.iter().map(|(x, y, z)| Vector3::new(*x, *y, *z)).collect();
    let first = (place - anchors[0]).norm();
    anchors
        .iter()
        .map(|anchor| Arrival { position_m: *anchor, farther_m: (place - anchor).norm() - first, sigma_m })
        .collect()
}

fn params(height: Height) -> FitParams {
    FitParams { height, ..FitParams::default() }
}

const fn known(mean_m: f64) -> Height {
    Height::Near { mean_m, sigma_m: 0.0 }
}

proptest! {
    #[test]
    fn exact_differences_give_the_place(x in 1.0..19.0_f64, y in 1.0..13.0_f64, z in 0.3..2.5_f64) {
        let place = Vector3::new(x, y, z);
        let heard = arrivals(&HALL, place, 0.1);
        for height in [Height::Free, known(z), Height::Near { mean_m: z, sigma_m: 0.3 }] {
            // Roundings of squares of 20 m, grown by the dilution of the height.
            let [closed, ..] = closed_form(&heard, height);
            prop_assert!((closed.unwrap() - place).norm() < 1e-6, "{height:?}: {closed:?}");
            // Steps below 0.1 mm end the search, and converge quadratically there.
            let found = fit(&heard, None, &params(height)).unwrap();
            prop_assert!((found.position_m - place).norm() < 1e-4, "{height:?}: {found:?}");
        }
        // As many differences as coordinates: one of the two places that they leave.
        for (heard, height) in [(&heard[..4], Height::Free), (&heard[..3], known(z))] {
            let both = closed_form(heard, height);
            let nearest = both.iter().flatten().map(|one| (one - place).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(nearest < 1e-5, "{both:?}");
        }
    }

    #[test]
    fn no_difference_and_no_place_breaks_the_solver(
        values in prop::collection::vec((-1e3..1e3_f64, -1e3..1e3_f64, -1e2..1e2_f64, -1e4..1e4_f64), 0..7), odd in 0..5_usize
    ) {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 12.0, 0.0][odd];
        let mut heard: Vec<Arrival> = values
            .iter()
            .map(|(x, y, z, farther_m)| Arrival { position_m: Vector3::new(*x, *y, *z), farther_m: *farther_m, sigma_m: 0.1 })
            .collect();
        if let Some(last) = heard.last_mut() {
            last.farther_m = odd;
            last.sigma_m = odd.min(0.1);
        }
        let area = AreaPrior { mean_m: Vector2::zeros(), covariance_m2: Matrix2::identity() * 1e4 };
        for height in [Height::Free, known(1.0), Height::Near { mean_m: 0.0, sigma_m: 2.0 }] {
            for area in [None, Some(&area)] {
                if let Some(found) = fit(&heard, area, &params(height)) {
                    prop_assert!(found.position_m.iter().chain(&found.covariance_m2).all(|v| v.is_finite()), "{found:?}");
                }
            }
        }
    }
}

#[test]
fn fits_agree_with_scipy_on_correlated_differences() {
    for line in include_str!("reference/tdoa.csv").lines() {
        let values: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
        let heard: Vec<Arrival> = values[1..31]
            .chunks(5)
            .map(|of| Arrival {
                position_m: Vector3::new(of[0], of[1], of[2]),
                farther_m: of[3],
                sigma_m: of[4],
            })
            .collect();
        let vector = |at: usize| Vector3::new(values[at], values[at + 1], values[at + 2]);
        let height = Height::Near { mean_m: values[31], sigma_m: values[32] };
        let plain = fit(&heard, None, &FitParams { dof: 1e9, ..params(height) }).unwrap();
        // Steps below 0.1 mm end the search.
        assert!((plain.position_m - vector(33)).norm() < 1e-3, "{line}: {plain:?}");
        let [xx, xy, xz, yy, yz, zz] = values[36..42] else { unreachable!() };
        let expected = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        if plain.other_m.is_none() {
            // The place to 1 mm turns the gradients by 1 mm in metres.
            assert!((plain.covariance_m2 - expected).norm() < 2e-3 * expected.norm(), "{line}: {plain:?}");
        }
        let robust = fit(&heard, None, &params(height)).unwrap();
        // Reweighting converges by a factor an iteration.
        let images = [Some(robust.position_m), robust.other_m];
        let nearest =
            images.into_iter().flatten().map(|one| (one - vector(42)).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 2e-3, "{line}: {robust:?}");
    }
}

/// Anchors under the roof: below and above it arrivals are the same.
#[test]
fn anchors_in_a_plane_leave_the_image_above() {
    let roof = [(0.0, 0.0, 4.0), (20.0, 0.0, 4.0), (20.0, 14.0, 4.0), (0.0, 14.0, 4.0), (9.0, 6.0, 4.0)];
    let place = Vector3::new(6.0, 8.0, 1.0);
    let found = fit(&arrivals(&roof, place, 0.05), None, &params(Height::Free)).unwrap();
    assert!((found.position_m - place).norm() < 1e-3, "{found:?}");
    let above = found.other_m.unwrap();
    assert!((above - Vector3::new(6.0, 8.0, 7.0)).norm() < 1e-3, "{above}");
    // Half of the square of the 6 m between them.
    assert!(found.covariance_m2[(2, 2)] > 0.5 * 36.0);
    let told = fit(&arrivals(&roof, place, 0.05), None, &params(Height::Near { mean_m: 1.2, sigma_m: 0.4 }))
        .unwrap();
    assert!(told.other_m.is_none() && (told.position_m - place).norm() < 0.3, "{told:?}");
}

/// Anchors along a roadway: on which side of it one is, is not told.
#[test]
fn anchors_in_a_row_leave_the_image_across() {
    let row = [(0.0, 0.0, 2.0), (0.0, 30.0, 2.0), (0.0, 60.0, 2.0), (0.0, 95.0, 2.0)];
    let place = Vector3::new(3.0, 40.0, 2.0);
    let found = fit(&arrivals(&row, place, 0.05), None, &params(known(2.0))).unwrap();
    assert!(
        (found.position_m.x.abs() - 3.0).abs() < 1e-3 && (found.position_m.y - 40.0).abs() < 1e-3,
        "{found:?}"
    );
    assert!((found.other_m.unwrap().x + found.position_m.x).abs() < 1e-3, "{found:?}");
}

/// One echo of five metres: at the reference it is in every difference.
#[test]
fn a_late_arrival_at_any_anchor_is_found() {
    let place = Vector3::new(7.0, 5.0, 1.2);
    for late in 0..HALL.len() {
        let mut heard = arrivals(&HALL, place, 0.1);
        if late == 0 {
            for one in &mut heard[1..] {
                one.farther_m -= 5.0;
            }
        } else {
            heard[late].farther_m += 5.0;
        }
        let robust = fit(&heard, None, &params(known(1.2))).unwrap();
        assert!((robust.position_m - place).norm() < 0.15, "{late}: {robust:?}");
        let plain = fit(&heard, None, &FitParams { dof: 1e9, ..params(known(1.2)) }).unwrap();
        assert!((plain.position_m - place).norm() > 0.4, "{late}: {plain:?}");
    }
}

#[test]
fn the_covariance_is_the_dilution_of_a_common_clock() {
    let place = Vector3::new(7.0, 5.0, 1.2);
    let anchors = || HALL.iter().map(|(x, y, z)| Vector3::new(*x, *y, *z));
    let found =
        fit(&arrivals(&HALL, place, 0.1), None, &FitParams { dof: 1e9, ..params(Height::Free) }).unwrap();
    let clock = dilution(anchors(), &place, Unknowns { height: true, clock: true }).unwrap();
    let sigma = |k: usize| found.covariance_m2[(k, k)];
    assert!(((sigma(0) + sigma(1)).sqrt() / 0.1 - clock.hdop).abs() < 1e-3 * clock.hdop, "{found:?}");
    assert!((sigma(2).sqrt() / 0.1 - clock.vdop).abs() < 1e-3 * clock.vdop, "{found:?}");
}

/// Normal errors at every anchor, the reference's in all differences: the error is as the covariance says.
#[test]
fn the_covariance_is_honest() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let unit = Normal::new(0.0, 1.0).unwrap();
    let place = Vector3::new(7.0, 5.0, 1.2);
    // A reference four times as noisy as the others.
    let sigma = [0.4, 0.1, 0.1, 0.1, 0.1, 0.1];
    let mut nees = 0.0;
    let runs = 2000_u32;
    for _ in 0..runs {
        let mut heard = arrivals(&HALL, place, 0.1);
        let errors = sigma.map(|sigma| sigma * unit.sample(&mut random));
        for (one, (error, sigma_m)) in heard.iter_mut().zip(errors.into_iter().zip(sigma)) {
            one.farther_m += error - errors[0];
            one.sigma_m = sigma_m;
        }
        let found = fit(&heard, None, &FitParams { dof: 1e9, ..params(known(1.2)) }).unwrap();
        let error = (found.position_m - place).xy();
        let inverse = found.covariance_m2.fixed_view::<2, 2>(0, 0).try_inverse().unwrap();
        nees += error.dot(&(inverse * error)) / f64::from(runs);
    }
    // Mean of χ² of 2 over 2000 runs: ±0.045, three times that, and some per cent by curvature.
    assert!((1.85..2.2).contains(&nees), "{nees}");
}

#[test]
fn what_leaves_the_place_open_has_no_fix() {
    let place = Vector3::new(7.0, 5.0, 1.2);
    let heard = arrivals(&HALL, place, 0.1);
    assert!(fit(&[], None, &params(Height::Free)).is_none());
    assert!(fit(&heard[..3], None, &params(Height::Free)).is_none());
    assert!(fit(&heard[..2], None, &params(known(1.2))).is_none());
    let area = AreaPrior { mean_m: Vector2::new(8.0, 6.0), covariance_m2: Matrix2::identity() * 9.0 };
    let one = fit(&heard[..2], Some(&area), &params(known(1.2))).unwrap();
    // On the hyperbola, and no surer along it than the area.
    let off = (one.position_m - heard[1].position_m).norm() - (one.position_m - heard[0].position_m).norm();
    assert!((off - heard[1].farther_m).abs() < 0.05, "{one:?}");
    assert!(one.covariance_m2.fixed_view::<2, 2>(0, 0).trace() > 5.0, "{one:?}");
}
