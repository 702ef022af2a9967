//! Axes of the magnetometer against those of the inertial sensor, by gyro and by gravity.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_tuning::Series;
use adit_tuning::magnetometer::{AlignmentSource, KnownField, calibrate};
use support::{Bench, stamp};

fn turned(degrees: [f64; 3]) -> Matrix3<f64> {
    let vector = Vector3::from(degrees.map(f64::to_radians));
    attitude::exp(&vector).to_rotation_matrix().into_inner()
}

fn off_deg(found: &Matrix3<f64>, truth: &Matrix3<f64>) -> Vector3<f64> {
    let rest = attitude::log(&attitude::from_matrix(&(found * truth.transpose())));
    rest.map(f64::to_degrees)
}

/// Small, large and swapped axes.
fn rotations() -> [Matrix3<f64>; 3] {
    [turned([1.0, -2.0, 3.0]), turned([40.0, 100.0, -20.0]), turned([0.0, 0.0, 180.0])]
}

#[test]
fn the_gyro_tells_the_axes_its_bias_and_its_own_certainty() {
    let bias = Vector3::new(0.08, -0.03, 0.02);
    for rotation in rotations() {
        let (mut chi_square, mut runs) = (0.0, 0.0);
        for seed in 0..15 {
            let bench = Bench { rotation, gyro_bias: bias, ..Bench::default() };
            let fit = calibrate(&bench.tumble(seed), &KnownField::default()).unwrap();
            let found = &fit.alignment;
            assert_eq!(found.source, AlignmentSource::Gyro, "{}", found.reason);
            let off = off_deg(&found.rotation, &rotation);
            chi_square += off.iter().zip(found.sd_deg).map(|(e, sd)| (e / sd).powi(2)).sum::<f64>();
            runs += 3.0;
            let sigmas: Vector3<f64> = (Vector3::from(found.gyro_bias_rad_s) - bias)
                .component_div(&Vector3::from(found.gyro_bias_sd_rad_s));
            assert!(
                sigmas.amax() < 4.0 && found.gyro_bias_sd_rad_s.iter().all(|sd| *sd < 0.005),
                "{found:?}"
            );
            assert!((found.dip_deg.unwrap() - bench.dip_deg).abs() < 0.3, "{found:?}");
            assert!(found.lag_s.abs() < 4.0 * found.lag_sd_s && found.lag_sd_s < 0.003, "{found:?}");
        }
        // 45 normalised squares, mean 1 ± 0.21; intervals share their ends, which makes the stated σ some larger or smaller.
        let mean = chi_square / runs;
        assert!((0.4..1.8).contains(&mean), "{mean}");
    }
}

#[test]
fn without_a_gyro_gravity_tells_the_axes() {
    for rotation in rotations() {
        let bench = Bench { rotation, ..Bench::default() };
        for seed in 0..5 {
            let mut tumble = bench.tumble(seed);
            tumble.angular_rate_rad_s = Series::default();
            let fit = calibrate(&tumble, &KnownField::default()).unwrap();
            let found = &fit.alignment;
            assert_eq!(found.source, AlignmentSource::Gravity, "{}", found.reason);
            let off = off_deg(&found.rotation, &rotation);
            // σ stated for each axis; 4 σ in 45 numbers is one in 350 runs of this test, and its seeds are fixed.
            assert!(off.iter().zip(found.sd_deg).all(|(e, sd)| e.abs() < 4.0 * sd), "{off} {found:?}");
            assert!(found.sd_deg.iter().all(|sd| *sd < 0.5));
        }
    }
}

#[test]
fn a_magnetometer_alone_says_that_its_axes_are_assumed() {
    let bench = Bench { rotation: turned([1.0, -2.0, 3.0]), ..Bench::default() };
    let mut tumble = bench.tumble(1);
    tumble.angular_rate_rad_s = Series::default();
    tumble.specific_force_m_s2 = Series::default();
    let fit = calibrate(&tumble, &KnownField::default()).unwrap();
    assert_eq!(fit.alignment.source, AlignmentSource::Assumed);
    assert!(
        fit.warnings
            .iter()
            .any(|w| w.contains("assumed to be parallel (no gyro in the log; no accelerometer"))
    );
}

#[test]
fn a_late_magnetometer_is_seen() {
    let bench = Bench::default();
    let mut tumble = bench.tumble(1);
    let late = tumble.field_ut.clone();
    tumble.field_ut = Series::default();
    for (i, reading) in late.readings().iter().enumerate() {
        // Three samples, 30 ms.
        tumble.field_ut.push(stamp(i + 3), *reading).unwrap();
    }
    let fit = calibrate(&tumble, &KnownField::default()).unwrap();
    assert!((fit.alignment.lag_s - 0.03).abs() < 4.0 * fit.alignment.lag_sd_s, "{:?}", fit.alignment);
}

#[test]
fn stamps_in_bursts_do_not_spoil_the_axes() {
    let rotation = turned([1.0, -2.0, 3.0]);
    let bench = Bench { rotation, ..Bench::default() };
    let even = bench.tumble(1);
    let mut tumble = even.clone();
    tumble.field_ut = Series::default();
    for (i, reading) in even.field_ut.readings().iter().enumerate() {
        // Twenty samples at once, 1 ms apart, five times a second.
        let time = (i / 20 * 20) as f64 / 100.0 + 0.2 + (i % 20) as f64 * 0.001;
        tumble.field_ut.push(adit_core::time::Time::from_seconds(time).unwrap(), *reading).unwrap();
    }
    let fit = calibrate(&tumble, &KnownField::default()).unwrap();
    assert!(fit.warnings.iter().any(|w| w.contains("magnetometer come in bursts")), "{:?}", fit.warnings);
    let off = off_deg(&fit.alignment.rotation, &rotation);
    assert!(off.amax() < 0.5, "{off}");
}

#[test]
fn a_mirrored_axis_shows_in_the_dip_and_can_be_declared() {
    let bench =
        Bench { distortion: Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0)), ..Bench::default() };
    let tumble = bench.tumble(1);
    let plain = calibrate(&tumble, &KnownField::default()).unwrap();
    assert!((plain.alignment.dip_deg.unwrap() + bench.dip_deg).abs() < 1.0, "{:?}", plain.alignment);
    let known = KnownField { mirrored: true, norm_ut: Some(bench.norm_ut) };
    let declared = calibrate(&tumble, &known).unwrap();
    assert!((declared.alignment.dip_deg.unwrap() - bench.dip_deg).abs() < 0.3, "{:?}", declared.alignment);
    assert!(
        (declared.calibration.matrix() - bench.matrix()).amax() < 0.01,
        "{}",
        declared.calibration.matrix()
    );
}

#[test]
fn gyro_and_accelerometer_of_two_frames_are_found_out() {
    // The z axes of accelerometer and magnetometer turned over, the gyro left as it was: a left-handed log.
    let bench = Bench::default();
    let mut tumble = bench.tumble(1);
    let over = |series: &Series| {
        let mut turned = Series::default();
        for (time, r) in series.times().iter().zip(series.readings()) {
            turned.push(*time, Vector3::new(r.x, r.y, -r.z)).unwrap();
        }
        turned
    };
    tumble.specific_force_m_s2 = over(&tumble.specific_force_m_s2);
    tumble.field_ut = over(&tumble.field_ut);
    let fit = calibrate(&tumble, &KnownField::default()).unwrap();
    assert_eq!(fit.alignment.source, AlignmentSource::Gravity);
    assert!(
        fit.warnings.iter().any(|w| w.contains("not logged in one right-handed frame")),
        "{:?}",
        fit.warnings
    );
    assert!(fit.alignment.angle_deg < 1.5, "{:?}", fit.alignment);
}
