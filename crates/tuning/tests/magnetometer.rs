//! The ellipsoid against truth: exact readings, noise at the Cramér–Rao bound, outliers, an uneven place.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_tuning::magnetometer::{KnownField, MagnetometerFit, calibrate};
use support::{Bench, Noise, magnetometer};

fn known(bench: &Bench) -> KnownField {
    KnownField { norm_ut: Some(bench.norm_ut), mirrored: false }
}

fn fit(bench: &Bench, readings: &[Vector3<f64>]) -> MagnetometerFit {
    calibrate(&magnetometer(readings), &known(bench)).unwrap()
}

/// Offset and symmetric matrix, found minus true.
fn errors(bench: &Bench, fit: &MagnetometerFit) -> [f64; 9] {
    let (offset, matrix) = (fit.calibration.offset_ut() - bench.offset_ut, fit.soft_iron - bench.matrix());
    let m = |r, c| matrix[(r, c)];
    [offset.x, offset.y, offset.z, m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)]
}

#[test]
fn readings_without_noise_give_the_truth() {
    let bench = Bench { noise_ut: 0.0, ..Bench::default() };
    let fit = fit(&bench, &bench.readings(1));
    // Rounding of 6000 products, and a fit that stops when the cost no longer falls.
    assert!(errors(&bench, &fit).iter().all(|e| e.abs() < 1e-8), "{:?}", errors(&bench, &fit));
    assert!(fit.after.sd_percent < 1e-7 && fit.outliers == 0);
    assert!(fit.before.sd_percent > 20.0);
}

#[test]
fn strong_iron_is_found_too() {
    let distortion = Matrix3::new(1.6, 0.2, -0.1, 0.2, 0.8, 0.15, -0.1, 0.15, 1.1);
    let bench =
        Bench { distortion, offset_ut: Vector3::new(300.0, -150.0, 90.0), noise_ut: 0.0, ..Bench::default() };
    let fit = fit(&bench, &bench.readings(1));
    assert!(errors(&bench, &fit).iter().all(|e| e.abs() < 1e-7), "{:?}", errors(&bench, &fit));
}

#[test]
fn without_a_given_strength_the_sensors_own_scale_stands() {
    let bench = Bench { noise_ut: 0.0, ..Bench::default() };
    let fit = calibrate(&magnetometer(&bench.readings(1)), &KnownField::default()).unwrap();
    assert!((fit.soft_iron.determinant() - 1.0).abs() < 1e-12);
    let scale = bench.distortion.determinant().cbrt();
    assert!((fit.norm_ut - bench.norm_ut * scale).abs() < 1e-7, "{}", fit.norm_ut);
    assert!(!fit.norm_given);
}

/// Seeds of the Monte Carlo runs.
const SEEDS: u64 = 100;

#[test]
fn white_noise_is_filtered_to_the_stated_covariance() {
    // A distortion near 1, so that white noise of the readings is white noise of the length.
    let bench = Bench { distortion: Matrix3::identity(), noise_ut: 0.5, samples: 3000, ..Bench::default() };
    let (mut nees, mut held_out, mut worst) = (0.0, 0.0, 0.0_f64);
    for seed in 0..SEEDS {
        let fit = fit(&bench, &bench.readings(seed));
        let error = adit_core::nalgebra::SVector::<f64, 9>::from(errors(&bench, &fit));
        nees += error.dot(&(fit.covariance.try_inverse().unwrap() * error));
        held_out += fit.held_out.unwrap().sd_percent;
        worst = worst.max((fit.noise_percent - 1.0).abs());
    }
    // χ² of 900 degrees of freedom: mean 9, σ of the mean of 100 runs 0.42. The residual's second order in the noise and the
    // place that is estimated from none shift it by less than that: within 3 σ.
    let mean = nees / SEEDS as f64;
    println!("NEES {mean:.2} of 9");
    assert!((mean - 9.0).abs() < 1.3, "NEES {mean}, expected 9");
    // 0.5 µT of 50 µT; 3000 samples determine it within 1.3 % (1 σ), a hundred times.
    assert!(worst < 0.06, "noise off by {worst} %");
    let held_out = held_out / SEEDS as f64;
    assert!((held_out - 1.0).abs() < 0.02, "held out {held_out} %, expected 1 %");
}

#[test]
fn four_times_the_samples_halve_the_error() {
    let rms = |samples: usize| {
        let bench = Bench { noise_ut: 0.5, samples, ..Bench::default() };
        let square = |seed| {
            errors(&bench, &fit(&bench, &bench.readings(seed)))[..3].iter().map(|e| e * e).sum::<f64>()
        };
        ((0..40).map(square).sum::<f64>() / 40.0).sqrt()
    };
    // Both over motions that cover the sphere; 120 squares each are within 9 % (1 σ of the root: 6.5 %).
    let ratio = rms(4000) / rms(16000);
    assert!((1.6..2.5).contains(&ratio), "{ratio}");
}

#[test]
fn an_uneven_place_is_told_from_noise_and_the_covariance_knows() {
    let bench = Bench { place: 0.008, noise_ut: 0.2, samples: 12_000, ..Bench::default() };
    let (mut nees, mut place) = (0.0, 0.0);
    for seed in 0..SEEDS {
        let fit = fit(&bench, &bench.readings(seed));
        let error = adit_core::nalgebra::SVector::<f64, 9>::from(errors(&bench, &fit));
        nees += error.dot(&(fit.covariance.try_inverse().unwrap() * error)) / 9.0;
        place += fit.place_percent;
    }
    let (nees, place) = (nees / SEEDS as f64, place / SEEDS as f64);
    // The place changes steadily, not from visit to visit: a visit averages it, neighbours share it. With plain least squares as
    // if all 12,000 samples were independent this figure is above 100.
    println!("NEES over its degrees {nees:.2}");
    assert!((0.5..2.0).contains(&nees), "NEES over its degrees {nees}, expected about 1");
    assert!((0.5..0.9).contains(&place), "{place} %, simulated 0.8 %");
}

#[test]
fn outliers_do_not_move_it() {
    let bench = Bench::default();
    let mut noise = Noise::new(7);
    let clean = bench.readings(1);
    let mut spoilt = clean.clone();
    // One reading in ten is a spike, and for 6 s of the minute a steel tool lies beside the sensor.
    for (i, reading) in spoilt.iter_mut().enumerate() {
        if i % 10 == 3 {
            *reading += noise.vector(60.0);
        }
        if (2000..2600).contains(&i) {
            *reading += Vector3::new(25.0, -10.0, 15.0);
        }
    }
    let (clean, spoilt) = (fit(&bench, &clean), fit(&bench, &spoilt));
    assert!((900..1250).contains(&spoilt.outliers), "{}", spoilt.outliers);
    let size = |fit: &MagnetometerFit| errors(&bench, fit)[..3].iter().map(|e| e * e).sum::<f64>().sqrt();
    // A sixth of the samples is gone, and with the tool some directions: up to three times the error of the clean fit.
    println!("offset off by {:.3} µT, without outliers by {:.3} µT", size(&spoilt), size(&clean));
    assert!(size(&spoilt) < 3.0 * size(&clean).max(0.02), "{} against {}", size(&spoilt), size(&clean));
    assert!(spoilt.warnings.iter().any(|w| w.contains("outliers")), "{:?}", spoilt.warnings);
    assert!(spoilt.after.robust_sd_percent < 0.6, "{:?}", spoilt.after);
}

#[test]
fn a_long_rest_within_the_tumble_does_not_rule_it() {
    let bench = Bench { place: 0.01, ..Bench::default() };
    let mut readings = bench.readings(3);
    let at_rest = readings[1234];
    let mut noise = Noise::new(5);
    // Ten times as many readings at one place, whose field is 2 % too long.
    let extra =
        (0..60_000).map(|_| at_rest + (at_rest - bench.offset_ut) * 0.02 + noise.vector(bench.noise_ut));
    readings.splice(1234..1234, extra);
    let fit = fit(&bench, &readings);
    let size = errors(&bench, &fit)[..3].iter().map(|e| e * e).sum::<f64>().sqrt();
    // One visit of about a hundred, 1 µT off: plain least squares is 1 µT off with it.
    println!("offset off by {size:.3} µT");
    assert!(size < 0.5, "{size} µT");
}

#[test]
fn the_same_log_gives_the_same_calibration() {
    let bench = Bench::default();
    let readings = bench.readings(2);
    assert_eq!(fit(&bench, &readings), fit(&bench, &readings));
}
