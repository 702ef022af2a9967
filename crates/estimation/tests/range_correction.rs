//! Corrections of ranges, applied.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::time::Time;
use adit_estimation::ranging::correction::{
    Diagnostic, ErrorCurve, ErrorModel, RangeCorrection, RangePolynomial,
};
use adit_observation::{DeviceId, Radio, RangeSample, Reception};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use std::sync::Arc;

fn range(range_m: f64, line_of_sight: Option<f64>, rx_power_dbm: Option<f32>) -> RangeSample {
    let reception = Reception { rx_power_dbm, ..Reception::default() };
    RangeSample {
        time: Time::from_nanos(0),
        anchor: DeviceId::new("a").unwrap(),
        tag: None,
        range_m,
        sigma_m: None,
        line_of_sight,
        in_the_way: None,
        radio: Radio::Uwb,
        reception: Some(Arc::new(reception)),
    }
}

fn metre_too_long() -> RangePolynomial {
    RangePolynomial { coefficients: vec![-1.0, 1.0], learnt_m: [0.0, 50.0], sigma_m: 0.4 }
}

fn curve() -> ErrorCurve {
    ErrorCurve {
        of: Diagnostic::RxPower,
        at: vec![-100.0, -90.0, -80.0],
        too_long_m: vec![0.8, 0.1, 0.0],
        sigma_m: vec![0.5, 0.2, 0.1],
    }
}

fn correction() -> RangeCorrection {
    RangeCorrection {
        anchors: [("a".to_owned(), 0.5)].into(),
        straight: Some(ErrorModel { sigma_m: 0.1, ..ErrorModel::default() }),
        nlos: Some(ErrorModel { polynomial: Some(metre_too_long()), sigma_m: 1.0, curve: None }),
        unjudged: ErrorModel { curve: Some(curve()), sigma_m: 0.6, polynomial: None },
        ..RangeCorrection::of_offset(0.2, 0.6)
    }
}

/// Mean and spread of the errors that two hypotheses draw are those that the blend tells.
#[test]
fn a_blend_tells_its_own_error() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let unit = Normal::new(0.0, 1.0).unwrap();
    for p in [1.0, 0.7, 0.2, 0.0] {
        let told = correction().correct(&range(10.5, Some(p), None));
        let mut moments = [0.0; 2];
        for i in 0..100_000 {
            // Behind a range of 10.5 m stands 10 m when it came straight, 9 m when not.
            let share = (f64::from(i) + 0.5) / 1e5;
            let (mean, sigma) = if share < p { (10.0, 0.1) } else { (9.0, 0.4) };
            let error = told.distance_m - mean - sigma * unit.sample(&mut random);
            moments[0] += error / 1e5;
            moments[1] += error * error / 1e5;
        }
        // 100,000 draws of 0.5 m: three standard deviations are 5 mm, of the spread 3 mm.
        assert!(moments[0].abs() < 0.005, "{p}: {}", moments[0]);
        assert!((moments[1].sqrt() - told.sigma_m).abs() < 0.005, "{p}: {told:?}");
    }
}

#[test]
fn what_the_device_tells_decides_what_is_taken_off() {
    let told = |rx| {
        let corrected = correction().correct(&range(10.5, None, rx));
        (corrected.distance_m, corrected.sigma_m)
    };
    let near = |found: (f64, f64), expected: (f64, f64)| {
        let off = (found.0 - expected.0).abs().max((found.1 - expected.1).abs());
        assert!(off < 1e-12, "{found:?}, expected {expected:?}");
    };
    // Half way between two knots, at one, and beyond both ends.
    near(told(Some(-95.0)), (10.0 - 0.45, 0.35));
    near(told(Some(-90.0)), (10.0 - 0.1, 0.2));
    near(told(Some(-140.0)), (10.0 - 0.8, 0.5));
    near(told(Some(-40.0)), (10.0, 0.1));
    // Not told, or minus infinity: the offset alone.
    near(told(None), (10.0, 0.6));
    near(told(Some(f32::NEG_INFINITY)), (10.0, 0.6));
    let other = RangeSample { anchor: DeviceId::new("b").unwrap(), ..range(10.5, None, None) };
    assert!((correction().correct(&other).distance_m - 10.3).abs() < 1e-12);
}

#[test]
fn diagnostics_are_those_of_the_receiver() {
    let reception = Reception {
        rx_power_dbm: Some(-80.0),
        first_path_power_dbm: Some(-86.0),
        first_path_amplitudes: Some([1000.0, 10_000.0, 500.0]),
        noise_std: Some(10.0),
        preamble_count: Some(1024),
        ..Reception::default()
    };
    let sample = RangeSample { reception: Some(Arc::new(reception)), ..range(10.0, None, None) };
    let bare = RangeSample { reception: None, ..range(10.0, None, None) };
    let expected = [10.0, -80.0, -86.0, 6.0, -60.0, 20.0, 60.0, 1024.0];
    for (diagnostic, expected) in Diagnostic::ALL.into_iter().zip(expected) {
        let found = diagnostic.of(&sample).unwrap();
        assert!((found - expected).abs() < 1e-12, "{diagnostic:?}: {found}");
        assert_eq!(diagnostic.of(&bare).is_some(), diagnostic == Diagnostic::Range);
        assert_eq!(serde_json::to_string(&diagnostic).unwrap(), format!("\"{}\"", diagnostic.name()));
    }
}

#[test]
fn a_correction_that_cannot_be_worked_with_is_told() {
    assert_eq!(correction().fault(), None);
    let mut curve = curve();
    curve.at[1] = -100.0;
    let of_curve = RangeCorrection {
        unjudged: ErrorModel { curve: Some(curve), sigma_m: 0.1, polynomial: None },
        ..correction()
    };
    assert_eq!(of_curve.fault(), Some(("at", "rising knots, one or more")));
    let of_sigma = RangeCorrection { nlos: Some(ErrorModel::default()), ..correction() };
    assert_eq!(of_sigma.fault(), Some(("sigma_m", "a number of metres above 0")));
    let polynomial = RangePolynomial { learnt_m: [3.0, f64::NAN], ..metre_too_long() };
    let of_span = ErrorModel { polynomial: Some(polynomial), sigma_m: 0.1, curve: None };
    let of_span = RangeCorrection { straight: Some(of_span), ..correction() };
    assert_eq!(of_span.fault(), Some(("learnt_m", "the shortest and the longest range, m")));
    assert!(RangeCorrection::of_offset(f64::NAN, 1.0).fault().is_some());
}
