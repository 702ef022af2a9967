//! Corrections of ranges, fitted.

use adit_core::time::Time;
use adit_estimation::ranging::correction::{NlosCorrection, RangeCorrection, RangePolynomial};
use adit_observation::{DeviceId, Radio, RangeSample};
use adit_tuning::ranges::polynomial::{PolynomialParams, RangePair, fit};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal, StudentT};

fn plain(degree: usize) -> PolynomialParams {
    PolynomialParams { degree, dof: f64::INFINITY }
}

fn range(range_m: f64, line_of_sight: Option<f64>) -> RangeSample {
    RangeSample {
        time: Time::from_nanos(0),
        anchor: DeviceId::new("a").unwrap(),
        tag: None,
        range_m,
        sigma_m: None,
        line_of_sight,
        radio: Radio::Uwb,
        reception: None,
    }
}

/// 100 m and k = 5, where normal equations of powers keep no digit.
#[test]
fn a_polynomial_of_degree_five_is_found_again() {
    let truth =
        RangePolynomial { coefficients: vec![-0.4, 1.02, -3e-4, 2e-6, 1e-8, -1e-10], learnt_m: [2.0, 100.0] };
    let pairs: Vec<RangePair> = (0..200)
        .map(|i| {
            let measured_m = 2.0 + 98.0 * f64::from(i) / 199.0;
            RangePair { measured_m, true_m: truth.distance_m(measured_m) }
        })
        .collect();
    let found = fit(&pairs, &plain(5)).unwrap().polynomial;
    assert_eq!(found.learnt_m, [2.0, 100.0]);
    for pair in &pairs {
        // Values of 100 m in doubles, powers with a condition of some 1e6.
        assert!((found.distance_m(pair.measured_m) - pair.true_m).abs() < 1e-8, "{pair:?}");
    }
    // Outside of what was learnt, the error at the end stays.
    let end = 100.0 - truth.distance_m(100.0);
    assert!((found.distance_m(1000.0) - (1000.0 - end)).abs() < 1e-7);
}

/// A tenth of the distances wrong by metres.
#[test]
fn long_tails_spoil_least_squares_only() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let noise = Normal::new(0.0, 0.05).unwrap();
    let pairs: Vec<RangePair> = (0..300)
        .map(|i| {
            let measured_m = 1.0 + 0.1 * f64::from(i);
            let wrong = if i % 10 == 0 { -4.0 } else { 0.0 };
            RangePair { measured_m, true_m: 0.95 * measured_m - 0.3 + wrong + noise.sample(&mut random) }
        })
        .collect();
    let worst = |params: &PolynomialParams| {
        let found = fit(&pairs, params).unwrap().polynomial;
        let off = |measured: f64| (found.distance_m(measured) - (0.95 * measured - 0.3)).abs();
        pairs.iter().map(|pair| off(pair.measured_m)).fold(0.0, f64::max)
    };
    assert!(worst(&plain(2)) > 0.3);
    // 0.05 m / √(300 / 3) is 5 mm; at the ends three times that.
    assert!(worst(&PolynomialParams { degree: 2, dof: 3.0 }) < 0.02);
}

#[test]
fn too_few_or_impossible_pairs_are_refused() {
    let pair = |measured_m| RangePair { measured_m, true_m: 1.0 };
    let said = fit(&[pair(1.0), pair(2.0)], &plain(1)).unwrap_err().to_string();
    assert_eq!(said, "2 readings of the ranges with a known distance, expected 3 or more");
    let said = fit(&[pair(1.0), pair(2.0), pair(f64::NAN)], &plain(1)).unwrap_err().to_string();
    assert_eq!(said, "a range or distance of NaN m, expected a finite number");
    // One distance alone: nothing but its own error is known.
    let found = fit(&[pair(1.5), pair(1.5), pair(1.5)], &plain(1)).unwrap();
    assert!((found.polynomial.distance_m(1.5) - 1.0).abs() < 1e-12);
    assert!((found.polynomial.distance_m(3.0) - 2.5).abs() < 1e-12);
}

/// The mean and the spread told are those of a thousand errors drawn from what is told.
#[test]
fn a_blended_correction_tells_its_own_error() {
    let polynomial = RangePolynomial { coefficients: vec![-1.0, 1.0], learnt_m: [0.0, 50.0] };
    let correction = RangeCorrection {
        offset_m: 0.2,
        anchors: [("a".to_owned(), 0.5)].into(),
        sigma_m: 0.1,
        nlos: Some(NlosCorrection { polynomial, sigma_m: 0.4, share: 0.3 }),
    };
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let unit = Normal::new(0.0, 1.0).unwrap();
    for judged in [Some(1.0), Some(0.7), Some(0.2), Some(0.0), None] {
        let straight = judged.unwrap_or(0.7);
        let told = correction.correct(&range(10.5, judged));
        let mut moments = [0.0; 2];
        for i in 0..100_000 {
            // Truths behind a range of 10.5 m: 10 m when straight, 9 m when not.
            let share = (f64::from(i) + 0.5) / 100_000.0;
            let (mean, sigma) = if share < straight { (10.0, 0.1) } else { (9.0, 0.4) };
            let error = told.distance_m - mean - sigma * unit.sample(&mut random);
            moments[0] += error / 1e5;
            moments[1] += error * error / 1e5;
        }
        // 100,000 draws of 0.5 m: three standard deviations are 5 mm, of the spread 3 mm.
        if judged.is_some() {
            assert!(moments[0].abs() < 0.005, "{judged:?}: {}", moments[0]);
        } else {
            assert!((told.distance_m - 10.0).abs() < 1e-12, "nobody has judged it: nothing is taken off");
        }
        assert!(
            (moments[1].sqrt() - told.sigma_m).abs() < 0.005,
            "{judged:?}: {told:?} {}",
            moments[1].sqrt()
        );
    }
}

/// Standard deviation that a fit tells of errors with long tails is theirs.
#[test]
fn the_standard_deviation_holds_the_tails() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let tails = StudentT::new(5.0).unwrap();
    let pairs: Vec<RangePair> = (0..20_000)
        .map(|i| {
            let measured_m = 1.0 + 0.001 * f64::from(i);
            RangePair { measured_m, true_m: measured_m - 0.5 - 0.3 * tails.sample(&mut random) }
        })
        .collect();
    let found = fit(&pairs, &PolynomialParams { degree: 1, dof: 5.0 }).unwrap();
    // Variance ν/(ν−2); its own scatter over 20,000 draws (kurtosis 9) is 1 %.
    let expected = 0.3 * (5.0_f64 / 3.0).sqrt();
    assert!((found.sigma_m / expected - 1.0).abs() < 0.05, "{}", found.sigma_m);
}
