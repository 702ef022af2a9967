//! Motions that show too little are refused, and the message says what is missing.
#![expect(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use adit_core::nalgebra::Vector3;
use adit_tuning::TuningError;
use adit_tuning::magnetometer::{KnownField, MagnetometerFit, calibrate};
use support::{Bench, magnetometer};

/// Calibrates from those readings of a long tumble whose true direction is wanted.
fn part(
    bench: &Bench,
    seed: u64,
    keep: impl Fn(&Vector3<f64>) -> bool,
) -> Result<MagnetometerFit, TuningError> {
    let undo = bench.distortion.try_inverse().unwrap();
    let readings = bench.readings(seed).into_iter();
    let kept: Vec<Vector3<f64>> =
        readings.filter(|r| keep(&(undo * (r - bench.offset_ut)).normalize())).collect();
    calibrate(&magnetometer(&kept), &KnownField::default())
}

fn uneven() -> Bench {
    Bench { place: 0.005, samples: 40_000, ..Bench::default() }
}

#[test]
fn the_whole_sphere_is_taken() {
    for seed in 0..10 {
        let fit = part(&uneven(), seed, |_| true).unwrap();
        assert!(fit.coverage.cells_seen > 75 && fit.coverage.worst_error_percent < 0.6, "{:?}", fit.coverage);
    }
}

#[test]
fn a_cap_is_refused_whatever_the_seed() {
    for degrees in [20.0_f64, 40.0, 60.0, 85.0] {
        for seed in 0..10 {
            let result = part(&uneven(), seed, |u| u.z > degrees.to_radians().cos());
            let error =
                result.expect_err(&format!("a cap of {degrees}° was taken with seed {seed}")).to_string();
            assert!(!error.contains('\n'), "{error}");
        }
    }
}

#[test]
fn half_a_sphere_is_refused_with_the_other_half_named() {
    let error = part(&uneven(), 1, |u| u.x < 0.0).unwrap_err();
    let TuningError::Coverage { coverage } = &error else { panic!("{error}") };
    assert_eq!(coverage.missing[0].to_string(), "+x");
    let said = error.to_string();
    assert!(said.contains("Missing is the field along +x"), "{said}");
    assert!(said.contains("down and to the north"), "{said}");
}

#[test]
fn a_turntable_is_refused_with_its_axis() {
    // About z alone, with noise; then wobbling by some degrees, as in a hand that tries to keep level.
    for tilt in [0.0, 0.03, 0.06] {
        let bench = Bench { tilt, place: 0.003, ..Bench::default() };
        let error = calibrate(&magnetometer(&bench.readings(4)), &KnownField::default()).unwrap_err();
        let said = error.to_string();
        match error {
            TuningError::Flat { .. } => {
                assert!(said.contains("normal +z") || said.contains("normal -z"), "{said}");
            }
            TuningError::Coverage { .. } | TuningError::NoEllipsoid { .. } => {}
            other => panic!("{other}"),
        }
    }
}

#[test]
fn a_sensor_at_rest_is_refused() {
    let bench = Bench::default();
    let mut noise = support::Noise::new(1);
    let rest: Vec<Vector3<f64>> =
        (0..5000).map(|_| Vector3::new(20.0, -5.0, 40.0) + noise.vector(0.2)).collect();
    let error = calibrate(&magnetometer(&rest), &KnownField::default()).unwrap_err().to_string();
    assert!(!error.is_empty());
    let frozen = vec![Vector3::new(20.0, -5.0, 40.0); 5000];
    let error = calibrate(&magnetometer(&frozen), &KnownField::default()).unwrap_err().to_string();
    assert!(error.contains("all alike"), "{error}");
    let few = bench.readings(1)[..150].to_vec();
    let error = calibrate(&magnetometer(&few), &KnownField::default()).unwrap_err().to_string();
    assert!(error.contains("150 readings of the magnetometer, expected 200"), "{error}");
}

#[test]
fn readings_that_are_no_field_are_refused() {
    let mut noise = support::Noise::new(1);
    let random: Vec<Vector3<f64>> = (0..5000).map(|_| noise.vector(30.0)).collect();
    assert!(calibrate(&magnetometer(&random), &KnownField::default()).is_err());
}
