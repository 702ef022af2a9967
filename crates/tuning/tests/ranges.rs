//! Distance as a polynomial of the range.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_estimation::ranging::correction::RangePolynomial;
use adit_tuning::ranges::polynomial::{PolynomialParams, RangePair, fit};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal, StudentT};

fn plain(degree: usize) -> PolynomialParams {
    PolynomialParams { degree, dof: f64::INFINITY }
}

/// 100 m and k = 5, where normal equations of powers keep no digit.
#[test]
fn a_polynomial_of_degree_five_is_found_again() {
    let truth = RangePolynomial {
        coefficients: vec![-0.4, 1.02, -3e-4, 2e-6, 1e-8, -1e-10],
        learnt_m: [2.0, 100.0],
        sigma_m: 0.1,
    };
    let pairs: Vec<RangePair> = (0..200)
        .map(|i| {
            let measured_m = 2.0 + 98.0 * f64::from(i) / 199.0;
            RangePair { measured_m, true_m: truth.distance_m(measured_m) }
        })
        .collect();
    let found = fit(&pairs, &plain(5)).unwrap();
    assert_eq!(found.learnt_m.map(f64::to_bits), [2.0, 100.0].map(f64::to_bits));
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
        let found = fit(&pairs, params).unwrap();
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
    assert!((found.distance_m(1.5) - 1.0).abs() < 1e-12);
    assert!((found.distance_m(3.0) - 2.5).abs() < 1e-12);
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
