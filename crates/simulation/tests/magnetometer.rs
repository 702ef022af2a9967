//! One magnetometer: what it does to a field, and how its errors are spread.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_simulation::{Magnetometer, MagnetometerModel, SimulationError, TriadErrors};
use core::f64::consts::{FRAC_PI_2, PI};

const SPAN_S: f64 = 0.01;

fn with(triad: TriadErrors) -> MagnetometerModel {
    MagnetometerModel { triad, ..MagnetometerModel::ideal() }
}

fn readings(model: &MagnetometerModel, seed: u64, field_ut: Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
    let mut sensor = Magnetometer::new(model, seed).unwrap();
    (0..count).map(|_| sensor.apply(&field_ut, SPAN_S)).collect()
}

fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt()
}

#[test]
fn an_ideal_one_reads_the_field() {
    let field = Vector3::new(12.3, -45.6, 7.89);
    assert_eq!(readings(&MagnetometerModel::ideal(), 1, field, 3), [field; 3]);
}

#[test]
fn without_noise_it_reads_a_b_plus_b_as_it_says() {
    let model = MagnetometerModel {
        hard_iron_ut: [20.0, -7.0, 33.0],
        soft_iron: [[1.1, 0.05, -0.02], [0.01, 0.92, 0.03], [-0.04, 0.02, 1.03]],
        axes_turned_rad: [0.02, -0.01, 0.03],
        triad: TriadErrors {
            turn_on_bias: 0.5,
            scale_factor: 0.01,
            misalignment_rad: 0.004,
            ..TriadErrors::default()
        },
        ..MagnetometerModel::ideal()
    };
    let mut sensor = Magnetometer::new(&model, 4).unwrap();
    let (a, b) = (sensor.response(), sensor.offset_ut());
    // Residues of 1 % and 0.5 µT, 5 σ.
    assert!((b - Vector3::from(model.hard_iron_ut)).amax() < 2.5);
    let soft = Matrix3::from_fn(|row, column| model.soft_iron[row][column]);
    assert!((a - soft).amax() < 0.1 && (a - soft).amax() > 1e-4);
    for field in [Vector3::new(0.0, 24.8, -49.4), Vector3::new(-50.0, 10.0, 20.0), Vector3::zeros()] {
        assert!((sensor.apply(&field, SPAN_S) - (a * field + b)).norm() < 1e-12);
    }
}

#[test]
fn turned_axes_see_the_field_turned_back_and_iron_sits_behind_them() {
    let model = MagnetometerModel {
        axes_turned_rad: [0.0, 0.0, FRAC_PI_2],
        soft_iron: [[2.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]],
        hard_iron_ut: [1.0, 2.0, 3.0],
        ..MagnetometerModel::ideal()
    };
    // The IMU's x is against the magnetometer's y; that axis is halved, then the hard iron comes on top.
    let read = readings(&model, 1, Vector3::new(40.0, 0.0, 0.0), 1)[0];
    assert!((read - Vector3::new(1.0, 2.0 - 20.0, 3.0)).norm() < 1e-12, "{read}");
}

#[test]
fn it_clips_at_its_range_and_counts_in_steps() {
    let triad = TriadErrors { range: Some(75.0), quantisation: Some(0.5), ..TriadErrors::default() };
    let read = readings(&with(triad), 1, Vector3::new(100.0, -76.0, 10.3), 1)[0];
    assert_eq!(read, Vector3::new(75.0, -75.0, 10.5));
    // Steel near by saturates a real one too.
    let read = readings(&MagnetometerModel::xsens_mti_g(), 1, Vector3::new(0.0, 0.0, -500.0), 1)[0];
    assert!((read.z + 75.0).abs() < 75.0 / 32_768.0, "{read}");
}

#[test]
fn white_noise_has_the_deviation_of_its_density_at_the_rate() {
    let read = readings(
        &with(TriadErrors { random_walk: 0.02, ..TriadErrors::default() }),
        7,
        Vector3::zeros(),
        50_000,
    );
    for axis in 0..3 {
        // 0.02 µT/√Hz at 100 Hz; 50,000 draws: 0.32 %, 4 σ.
        let found = deviation(read.iter().map(|v| v[axis])) / 0.2;
        assert!((found - 1.0).abs() < 0.013, "axis {axis}: {found} of the parameter");
    }
    // Uncorrelated from sample to sample: 1/√50,000, 4 σ.
    let lagged = read.windows(2).map(|w| w[0].x * w[1].x).sum::<f64>() / 50_000.0 / 0.04;
    assert!(lagged.abs() < 0.018, "{lagged}");
}

#[test]
fn the_noise_of_the_presets_is_that_of_their_sheets_at_the_output() {
    // Deviation at the output, µT, as the presets state it, and the share of independent readings in it.
    let gain = 1.0 - (-2.0 * PI * 10.0 * 0.01_f64).exp();
    let lag = 1.0 - gain;
    let mti_share = (1.0 - lag * lag) / (1.0 + lag * lag);
    for (name, model, sheet_ut, share) in [
        ("MTi-G", MagnetometerModel::xsens_mti_g(), 0.05, mti_share),
        ("HMC5883L", MagnetometerModel::hmc5883l(), 0.2, 1.0),
        ("ADIS16448", MagnetometerModel::adis16448(), 0.24, 1.0),
    ] {
        let quiet = TriadErrors { bias_instability: 0.0, quantisation: None, ..model.triad };
        let model = MagnetometerModel { triad: quiet, ..model };
        let mut sensor = Magnetometer::new(&model, 5).unwrap();
        let field = Vector3::new(20.0, -10.0, 40.0);
        let read: Vec<f64> =
            (0..60_000).map(|_| sensor.apply(&field, 1.0 / model.rate_hz).y).skip(100).collect();
        let found = deviation(read.iter().copied()) / sheet_ut;
        let sampling = 4.0 / (2.0 * share * read.len() as f64).sqrt();
        // One pole at steps of 10 ms in place of a continuous one: √(gain/(2 − gain)/(π/10)) = 0.984.
        let discrete = if share < 1.0 { 0.016 } else { 0.0 };
        assert!((found - 1.0).abs() < sampling + discrete, "{name}: {found} of the sheet");
    }
}

#[test]
fn the_residue_of_a_calibration_differs_from_seed_to_seed_as_stated() {
    let model = MagnetometerModel::hmc5883l();
    let sensors: Vec<_> = (0..400).map(|seed| Magnetometer::new(&model, seed).unwrap()).collect();
    let offsets = sensors.iter().flat_map(|s| s.offset_ut().iter().copied().collect::<Vec<_>>());
    let scales = sensors.iter().flat_map(|s| s.response().diagonal().iter().copied().collect::<Vec<_>>());
    let cross = sensors.iter().flat_map(|s| [s.response()[(0, 1)], s.response()[(2, 0)]]);
    // 1200 and 800 draws: 2 % and 2.5 %, 4 σ.
    assert!((deviation(offsets) / 0.5 - 1.0).abs() < 0.08);
    assert!((deviation(scales) / 0.005 - 1.0).abs() < 0.08);
    assert!((deviation(cross) / 0.25_f64.to_radians() - 1.0).abs() < 0.1);
}

#[test]
fn the_same_seed_gives_the_same_readings_and_one_error_leaves_the_others_alone() {
    let model = MagnetometerModel::xsens_mti_g();
    let field = Vector3::new(5.0, 24.0, -49.0);
    assert_eq!(readings(&model, 3, field, 200), readings(&model, 3, field, 200));
    assert_ne!(readings(&model, 3, field, 1), readings(&model, 4, field, 1));
    let iron = MagnetometerModel { hard_iron_ut: [10.0, 0.0, 0.0], ..model };
    let plain = readings(&model, 3, field, 200);
    let shifted = readings(&iron, 3, field, 200);
    // The same noise: only the steps of the output (2.3 nT) differ.
    assert!(plain.iter().zip(&shifted).all(|(p, s)| (s - p - Vector3::x() * 10.0).amax() < 0.0024));
}

#[test]
fn refuses_what_no_magnetometer_is() {
    for preset in [
        MagnetometerModel::ideal(),
        MagnetometerModel::xsens_mti_g(),
        MagnetometerModel::hmc5883l(),
        MagnetometerModel::adis16448(),
    ] {
        preset.check().unwrap();
    }
    let refused = |change: &dyn Fn(&mut MagnetometerModel)| {
        let mut model = MagnetometerModel::ideal();
        change(&mut model);
        match Magnetometer::new(&model, 1).unwrap_err() {
            SimulationError::Parameter { name, .. } => name,
        }
    };
    assert_eq!(refused(&|m| m.rate_hz = 0.0), "rate_hz");
    assert_eq!(refused(&|m| m.latency_s = -0.1), "latency_s");
    assert_eq!(refused(&|m| m.integration_s = f64::NAN), "integration_s");
    assert_eq!(refused(&|m| m.stamp_jitter_s = -1.0), "stamp_jitter_s");
    assert_eq!(refused(&|m| m.hard_iron_ut[2] = f64::NAN), "hard_iron_ut");
    assert_eq!(refused(&|m| m.soft_iron[1][1] = 0.0), "soft_iron");
    assert_eq!(refused(&|m| m.soft_iron[0][2] = f64::NAN), "soft_iron");
    assert_eq!(refused(&|m| m.axes_turned_rad[0] = 7.0), "axes_turned_rad");
    assert_eq!(refused(&|m| m.triad.range = Some(-1.0)), "range");
}
