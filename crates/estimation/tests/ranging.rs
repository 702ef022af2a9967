//! Places by ranges: exact data, dilution by hand, independent numbers, degenerate anchors, consistency.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use adit_estimation::radio::AreaPrior;
use adit_estimation::ranging::dilution::{Unknowns, dilution};
use adit_estimation::ranging::fit::{FitParams, fit};
use adit_estimation::ranging::linear::linear;
use adit_estimation::ranging::spheres::three_spheres;
use adit_estimation::ranging::{Height, RangeModel, Ranged};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StudentT};

const EXACT: RangeModel = RangeModel { offset_m: 0.0, scale: 1.0, sigma_m: 0.1 };
const HALL: [(f64, f64, f64); 6] = [
    (0.0, 0.0, 3.2),
    (20.0, 0.0, 1.0),
    (20.0, 14.0, 5.2),
    (0.0, 14.0, 2.0),
    (10.0, -1.0, 0.2),
    (9.0, 15.0, 6.0),
];
const SPACE: Unknowns = Unknowns { height: true, clock: false };

fn known(mean_m: f64) -> Height {
    Height::Near { mean_m, sigma_m: 0.0 }
}

fn at_height(height: Height) -> FitParams {
    FitParams { height, ..FitParams::default() }
}

/// What a tag at this place measures without error.
fn ranged(anchors: &[(f64, f64, f64)], place: Vector3<f64>, model: RangeModel) -> Vec<Ranged> {
    let one = |(x, y, z): &(f64, f64, f64)| {
        let position_m = Vector3::new(*x, *y, *z);
        Ranged { position_m, model, range_m: model.scale * (position_m - place).norm() + model.offset_m }
    };
    anchors.iter().map(one).collect()
}

proptest! {
    #[test]
    fn exact_ranges_give_the_place(
        x in 1.0..19.0_f64, y in 1.0..13.0_f64, z in 0.3..2.5_f64, offset_m in -0.5..0.8_f64, scale in 0.98..1.05_f64
    ) {
        let place = Vector3::new(x, y, z);
        let ranges = ranged(&HALL, place, RangeModel { offset_m, scale, sigma_m: 0.1 });
        for height in [Height::Free, known(z), Height::Near { mean_m: z, sigma_m: 0.3 }] {
            // Roundings of squares of 20 m, grown by the dilution of the height.
            prop_assert!((linear(&ranges, height).unwrap().position_m - place).norm() < 1e-9);
            // Steps below 0.1 mm end the search, and converge quadratically there.
            let found = fit(&ranges, None, &at_height(height)).unwrap();
            prop_assert!((found.position_m - place).norm() < 1e-4, "{height:?}: {found:?}");
        }
    }

    #[test]
    fn the_spheres_meet_at_the_place_and_its_image(
        x in -5.0..25.0_f64, y in -5.0..20.0_f64, z in -4.0..8.0_f64
    ) {
        let place = Vector3::new(x, y, z);
        let ranges = ranged(&HALL[..3], place, EXACT);
        let both = three_spheres(&[ranges[0], ranges[1], ranges[2]]).unwrap();
        // A root of what is nearly zero halves the digits: near the plane of the anchors.
        let nearest = both.map(|one| (one - place).norm()).into_iter().fold(f64::INFINITY, f64::min);
        prop_assert!(nearest < 1e-5, "{both:?}");
        for one in both {
            for range in &ranges {
                prop_assert!(((one - range.position_m).norm() - range.range_m).abs() < 1e-9);
            }
        }
        prop_assert!(both[0].z <= both[1].z);
    }

    #[test]
    fn no_range_and_no_place_breaks_a_solver(
        values in prop::collection::vec((-1e3..1e3_f64, -1e3..1e3_f64, -1e2..1e2_f64, -10.0..1e4_f64), 0..6), odd in 0..4_usize
    ) {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 12.0][odd];
        let mut ranges: Vec<Ranged> = values
            .iter()
            .map(|(x, y, z, range_m)| Ranged { position_m: Vector3::new(*x, *y, *z), model: EXACT, range_m: *range_m })
            .collect();
        if let Some(first) = ranges.first_mut() {
            first.range_m = odd;
        }
        for height in [Height::Free, known(1.0), Height::Near { mean_m: 0.0, sigma_m: 2.0 }] {
            for found in [linear(&ranges, height), fit(&ranges, None, &at_height(height))].into_iter().flatten() {
                prop_assert!(found.position_m.iter().chain(&found.covariance_m2).all(|v| v.is_finite()), "{found:?}");
            }
        }
    }
}

/// Hand: n anchors evenly around a tag in its plane give `HᵀH = n/2 · I`: HDOP = 2/√n (Levanon 2000), with an unknown common offset the
/// same, and TDOP 1/√n.
#[test]
fn a_ring_of_anchors_dilutes_by_two_over_the_root_of_their_number() {
    for n in [3_u32, 4, 5, 12] {
        let anchors = (0..n).map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / f64::from(n);
            Vector3::new(3.0 + 10.0 * angle.cos(), -2.0 + 10.0 * angle.sin(), 1.5)
        });
        let place = Vector3::new(3.0, -2.0, 1.5);
        let level = dilution(anchors.clone(), &place, Unknowns::default()).unwrap();
        let root = f64::from(n).sqrt();
        assert!((level.hdop - 2.0 / root).abs() < 1e-12 && (level.pdop() - level.hdop).abs() < 1e-12);
        let clock = dilution(anchors.clone(), &place, Unknowns { height: false, clock: true }).unwrap();
        assert!((clock.hdop - 2.0 / root).abs() < 1e-12 && (clock.tdop - 1.0 / root).abs() < 1e-12);
        // In its own plane they tell nothing of the height.
        assert!(dilution(anchors, &place, SPACE).is_none());
    }
}

/// Four satellites: the best, a regular tetrahedron, has GDOP √(5/2) = 1.581 (Parkinson & Spilker 1996, ch. 5); one in the zenith and three on the
/// horizon √3 = 1.732, of VDOP² = 4/3, HDOP² = 4/3, TDOP² = 1/3.
#[test]
fn four_satellites_dilute_as_published() {
    let all = Unknowns { height: true, clock: true };
    let tetrahedron = [(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)];
    let best = dilution(tetrahedron.map(|(x, y, z)| Vector3::new(x, y, z)), &Vector3::zeros(), all).unwrap();
    assert!((best.gdop() - 2.5_f64.sqrt()).abs() < 1e-12, "{best:?}");
    let horizon = [0.0_f64, 120.0, 240.0].map(|deg| {
        let angle = deg.to_radians();
        Vector3::new(angle.cos(), angle.sin(), 0.0)
    });
    let sky = horizon.into_iter().chain([Vector3::z()]);
    let zenith = dilution(sky, &Vector3::zeros(), all).unwrap();
    assert!((zenith.gdop() - 3_f64.sqrt()).abs() < 1e-12);
    assert!(
        (zenith.vdop.powi(2) - 4.0 / 3.0).abs() < 1e-12 && (zenith.hdop.powi(2) - 4.0 / 3.0).abs() < 1e-12
    );
    assert!((zenith.tdop.powi(2) - 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn solvers_and_dilution_agree_with_numpy_and_scipy() {
    for line in include_str!("reference/ranging.csv").lines() {
        let values: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
        let model = RangeModel { sigma_m: 0.15, ..EXACT };
        let ranges: Vec<Ranged> = values[1..25]
            .chunks(4)
            .map(|of| Ranged { position_m: Vector3::new(of[0], of[1], of[2]), model, range_m: of[3] })
            .collect();
        let vector = |at: usize| Vector3::new(values[at], values[at + 1], values[at + 2]);
        // Printed to 12 digits; the normal equations square the condition of the rows.
        let straight = linear(&ranges, Height::Free).unwrap().position_m;
        assert!((straight - vector(27)).norm() < 1e-7, "{line}: {straight}");
        let params = at_height(Height::Near { mean_m: values[25], sigma_m: values[26] });
        let found = fit(&ranges, None, &params).unwrap();
        // Steps below 0.1 mm end the search; reweighting converges by a factor an iteration.
        assert!((found.position_m - vector(30)).norm() < 1e-3, "{line}: {found:?}");
        let [xx, xy, xz, yy, yz, zz] = values[33..39] else { unreachable!() };
        let expected = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        if found.other_m.is_none() {
            assert!((found.covariance_m2 - expected).norm() < 2e-3 * expected.norm(), "{line}: {found:?}");
        }
        let anchors = ranges.iter().map(|one| one.position_m);
        let diluted = dilution(anchors, &vector(30), SPACE).unwrap();
        assert!(
            (diluted.hdop / values[39] - 1.0).abs() < 1e-8 && (diluted.vdop / values[40] - 1.0).abs() < 1e-8
        );
    }
}

#[test]
fn one_long_range_spoils_the_linear_fix_and_not_the_robust_one() {
    let place = Vector3::new(7.0, 6.0, 1.2);
    let mut ranges = ranged(&HALL, place, EXACT);
    ranges[2].range_m += 4.0;
    for height in [known(1.2), Height::Near { mean_m: 1.2, sigma_m: 0.3 }] {
        let robust = fit(&ranges, None, &at_height(height)).unwrap().position_m;
        let straight = linear(&ranges, height).unwrap().position_m;
        // 40 standard deviations pull by 5 · 40 / (4 + 1600) = 0.12 of one.
        assert!((robust - place).norm() < 0.05, "{robust}");
        assert!((straight - place).norm() > 1.0, "{straight}");
    }
}

#[test]
fn anchors_at_one_height_leave_the_image_above() {
    let ceiling = [(0.0, 0.0, 3.0), (20.0, 0.0, 3.0), (20.0, 14.0, 3.0), (0.0, 14.0, 3.0)];
    let place = Vector3::new(7.0, 6.0, 1.2);
    let ranges = ranged(&ceiling, place, EXACT);
    assert!(linear(&ranges, Height::Free).is_none());
    let found = fit(&ranges, None, &FitParams::default()).unwrap();
    assert!((found.position_m - place).norm() < 1e-3, "{found:?}");
    let above = found.other_m.unwrap();
    assert!((above - Vector3::new(7.0, 6.0, 4.8)).norm() < 1e-3, "{above}");
    // Half of the square of the 3.6 m between both, and what each is unsure of itself.
    assert!(found.covariance_m2[(2, 2)] > 0.5 * 3.6 * 3.6);
    let told = fit(&ranges, None, &at_height(Height::Near { mean_m: 1.0, sigma_m: 0.3 })).unwrap();
    assert!(told.other_m.is_none() && told.covariance_m2[(2, 2)] <= 0.09, "{told:?}");
}

/// A roadway to the north, its anchors in a row: on which side of the row a tag is nobody can tell.
#[test]
fn anchors_in_a_row_leave_the_image_across() {
    let row = [(0.0, 0.0, 2.0), (0.0, 30.0, 2.0), (0.0, 60.0, 2.0)];
    let place = Vector3::new(6.0, 20.0, 1.2);
    let ranges = ranged(&row, place, EXACT);
    assert!(linear(&ranges, known(1.2)).is_none() && linear(&ranges, Height::Free).is_none());
    let found = fit(&ranges, None, &at_height(known(1.2))).unwrap();
    let image = found.other_m.unwrap();
    assert!((found.position_m.x.abs() - 6.0).abs() < 1e-3 && (found.position_m.y - 20.0).abs() < 1e-3);
    assert!((image.x + found.position_m.x).abs() < 1e-3, "{image}");
    assert!(found.covariance_m2[(0, 0)] > 0.5 * 12.0 * 12.0 && found.covariance_m2[(1, 1)] < 0.1);
    // Knowing on which side people are, one is certain.
    let area =
        AreaPrior { mean_m: Vector2::new(8.0, 30.0), covariance_m2: Matrix2::new(9.0, 0.0, 0.0, 900.0) };
    let told = fit(&ranges, Some(&area), &at_height(known(1.2))).unwrap();
    assert!((told.position_m - place).norm() < 0.01 && told.other_m.is_none(), "{told:?}");
}

#[test]
fn few_ranges_are_as_sure_as_they_can_be() {
    let place = Vector3::new(7.0, 6.0, 1.2);
    let ranges = ranged(&HALL, place, EXACT);
    let params = at_height(known(1.2));
    let free = FitParams::default();
    assert!(fit(&[], None, &free).is_none() && fit(&ranges[..2], None, &free).is_none());
    assert!(fit(&ranges[..1], None, &params).is_none());
    assert!(linear(&[], Height::Free).is_none() && linear(&ranges[..3], Height::Free).is_none());
    // Two circles meet twice; one alone leaves its circle to the area.
    let two = fit(&ranges[..2], None, &params).unwrap();
    let nearer = [two.position_m, two.other_m.unwrap()].map(|one| (one - place).norm());
    assert!(nearer[0].min(nearer[1]) < 1e-3, "{two:?}");
    let area = AreaPrior { mean_m: Vector2::new(10.0, 7.0), covariance_m2: Matrix2::identity() * 36.0 };
    let one = fit(&ranges[..1], Some(&area), &params).unwrap();
    assert!(((one.position_m - ranges[0].position_m).norm() - ranges[0].range_m).abs() < 0.1, "{one:?}");
    // Along the circle the area alone tells, and less than all of its 36 m² to each side.
    let level = one.covariance_m2.fixed_view::<2, 2>(0, 0).trace();
    assert!((10.0..72.0).contains(&level), "{one:?}");
}

/// Errors as the fit believes: the normalised squared error is that of three degrees of freedom, of two where the height is known; and with plain
/// normal-like errors of one standard deviation the linear fix knows its own.
#[test]
fn the_covariances_are_honest() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let tail = StudentT::new(4.0).unwrap();
    let place = Vector3::new(8.0, 6.0, 1.2);
    let anchors: Vec<(f64, f64, f64)> = (0..48)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 48.0;
            (8.0 + 9.0 * angle.cos(), 6.0 + 8.0 * angle.sin(), 1.2 + 5.0 * (2.5 * angle).sin())
        })
        .collect();
    let runs = 2000_u32;
    let (mut space, mut level, mut straight) = (0.0, 0.0, 0.0);
    for _ in 0..runs {
        let mut ranges = ranged(&anchors, place, EXACT);
        for one in &mut ranges {
            one.range_m += 0.1 * tail.sample(&mut random);
        }
        let found = fit(&ranges, None, &FitParams::default()).unwrap();
        let error = found.position_m - place;
        space += error.dot(&(found.covariance_m2.try_inverse().unwrap() * error)) / f64::from(runs);
        let found = fit(&ranges, None, &at_height(known(1.2))).unwrap();
        let error = (found.position_m - place).xy();
        let inverse = found.covariance_m2.fixed_view::<2, 2>(0, 0).try_inverse().unwrap();
        level += error.dot(&(inverse * error)) / f64::from(runs);
        // Variance of Student's t: σ² ν / (ν − 2).
        for one in &mut ranges {
            one.model.sigma_m = 0.1 * 2_f64.sqrt();
        }
        let found = linear(&ranges, Height::Free).unwrap();
        let error = found.position_m - place;
        straight += error.dot(&(found.covariance_m2.try_inverse().unwrap() * error)) / f64::from(runs);
    }
    // Means of χ² over 2000 runs: ±√(2k/2000), 0.055 of 3 and 0.045 of 2, three times that; Tails make the
    // square of the linear fix vary twice as much.
    assert!((2.83..3.17).contains(&space), "{space}");
    assert!((1.86..2.14).contains(&level), "{level}");
    assert!((2.7..3.3).contains(&straight), "{straight}");
}

/// Errors of Student's t on few ranges, the tag among its anchors: the normalised squared error is that of the unknowns, and 95 % of it below the limit of
/// normal errors.
#[test]
fn the_covariance_of_few_ranges_is_honest() {
    let mut random = ChaCha8Rng::seed_from_u64(17);
    let tail = StudentT::new(4.0).unwrap();
    let place = Vector3::new(8.0, 6.0, 1.2);
    let runs = 4000_u32;
    for count in [4_u32, 5, 6, 8, 12] {
        let anchors: Vec<(f64, f64, f64)> = (0..count)
            .map(|k| {
                let angle = (f64::from(k) + 0.3) * std::f64::consts::TAU / f64::from(count);
                (8.0 + 9.0 * angle.cos(), 6.0 + 8.0 * angle.sin(), 1.2 + 2.0 * (2.0 * angle).sin())
            })
            .collect();
        let (mut nees, mut inside) = (0.0, 0.0);
        for _ in 0..runs {
            let mut ranges = ranged(&anchors, place, EXACT);
            for one in &mut ranges {
                one.range_m += 0.1 * tail.sample(&mut random);
            }
            let found = fit(&ranges, None, &at_height(known(1.2))).unwrap();
            let error = (found.position_m - place).xy();
            let inverse = found.covariance_m2.fixed_view::<2, 2>(0, 0).try_inverse().unwrap();
            let square = error.dot(&(inverse * error));
            nees += square / f64::from(runs);
            inside += f64::from(u8::from(square < 5.991)) / f64::from(runs);
        }
        // Means over 4000 runs: ±0.03 of normal errors, twice that of long tails. Between the expansion in p/n and its limit at n = p the covariance is some
        // tenths too large. Shares over 4000 runs: ±0.0035.
        assert!((1.65..2.1).contains(&nees), "{count}: {nees}");
        assert!((0.935..0.965).contains(&inside), "{count}: {inside}");
    }
}
