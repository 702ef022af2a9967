//! The error model against the statistics that its parameters promise.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_observation::ImuSample;
use adit_simulation::{ImuErrorModel, ImuErrors, Inertial, TriadErrors};

const SPAN: Interval = Interval::from_nanos(5_000_000);
const SPAN_S: f64 = 0.005;

fn at_rest() -> Inertial {
    Inertial { angular_rate_rad_s: Vector3::zeros(), specific_force_m_s2: Vector3::new(0.0, 0.0, 9.8) }
}

fn samples<'a>(errors: &'a mut ImuErrors, ideal: &'a Inertial) -> impl Iterator<Item = ImuSample> + 'a {
    (1..).map(move |i| errors.apply(ideal, Time::ZERO + Interval::from_nanos(i * SPAN.nanos()), SPAN))
}

fn gyro(errors: TriadErrors) -> ImuErrorModel {
    ImuErrorModel { gyro: errors, ..ImuErrorModel::default() }
}

/// Allan deviation of the x values over averages of `length` samples.
fn allan_deviation(values: &[f64], length: usize) -> f64 {
    let means: Vec<f64> =
        values.chunks_exact(length).map(|c| c.iter().sum::<f64>() / length as f64).collect();
    let sum: f64 = means.windows(2).map(|w| (w[1] - w[0]) * (w[1] - w[0])).sum();
    libm::sqrt(0.5 * sum / (means.len() - 1) as f64)
}

fn root_mean_square(values: &[f64]) -> f64 {
    libm::sqrt(values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64)
}

#[test]
fn a_model_without_errors_changes_nothing() {
    let mut errors = ImuErrors::new(&ImuErrorModel::default(), 1).unwrap();
    let ideal = at_rest();
    let sample = errors.apply(&ideal, Time::from_nanos(7), SPAN);
    assert_eq!(sample.time, Time::from_nanos(7));
    assert_eq!(sample.angular_rate_rad_s, ideal.angular_rate_rad_s);
    assert_eq!(sample.specific_force_m_s2, ideal.specific_force_m_s2);
}

#[test]
fn white_noise_averages_down_as_the_random_walk_says() {
    let walk = 2e-4;
    let mut errors =
        ImuErrors::new(&gyro(TriadErrors { random_walk: walk, ..TriadErrors::default() }), 3).unwrap();
    let values: Vec<f64> =
        samples(&mut errors, &at_rest()).take(200_000).map(|s| s.angular_rate_rad_s.x).collect();
    for length in [1_usize, 10, 100] {
        let tau_s = length as f64 * SPAN_S;
        let found = allan_deviation(&values, length) * libm::sqrt(tau_s) / walk;
        // Relative spread of an Allan deviation of m averages: about 0.87/√m; 4 σ.
        let tolerance = 4.0 * 0.87 / libm::sqrt(200_000.0 / length as f64);
        assert!((found - 1.0).abs() < tolerance, "τ {tau_s} s: {found} of the parameter");
    }
}

#[test]
fn velocity_random_walk_is_that_of_the_model() {
    let model = ImuErrorModel::adis16448();
    let only_noise = TriadErrors { random_walk: model.accelerometer.random_walk, ..TriadErrors::default() };
    let model = ImuErrorModel { accelerometer: only_noise, ..ImuErrorModel::default() };
    let mut errors = ImuErrors::new(&model, 4).unwrap();
    let values: Vec<f64> =
        samples(&mut errors, &at_rest()).take(50_000).map(|s| s.specific_force_m_s2.z - 9.8).collect();
    // 0.11 m/s/√h is 0.11/60 m/s/√s; 50,000 draws give the deviation to 0.3 %, 4 σ.
    let expected = 0.11 / 60.0 / libm::sqrt(SPAN_S);
    assert!((root_mean_square(&values) / expected - 1.0).abs() < 0.013);
}

#[test]
fn bias_instability_has_its_deviation_and_forgets_in_its_time() {
    let (sigma, tau_s) = (0.01, 0.5);
    let errors = TriadErrors { bias_instability: sigma, bias_correlation_s: tau_s, ..TriadErrors::default() };
    let mut errors = ImuErrors::new(&gyro(errors), 5).unwrap();
    let values: Vec<f64> =
        samples(&mut errors, &at_rest()).take(400_000).map(|s| s.angular_rate_rad_s.y).collect();
    let lag = 100; // 0.5 s = τ
    let variance = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
    let covariance =
        values.windows(lag + 1).map(|w| w[0] * w[lag]).sum::<f64>() / (values.len() - lag) as f64;
    // 2000 s hold 2000 independent values of τ = 0.5 s (τ/σ² integral 2τ): variance known to 3 %, 4 σ.
    assert!((variance / (sigma * sigma) - 1.0).abs() < 0.13, "{variance}");
    assert!((covariance / variance - libm::exp(-1.0)).abs() < 0.13);
    assert!((values[0] / sigma).abs() > 1e-3, "the process starts stationary, not at zero");
}

#[test]
fn a_bias_random_walk_spreads_with_the_root_of_time() {
    let walk = 1e-3;
    let ends: Vec<f64> = (0..400)
        .map(|seed| {
            let errors = TriadErrors { bias_random_walk: walk, ..TriadErrors::default() };
            let mut errors = ImuErrors::new(&gyro(errors), seed).unwrap();
            let _ = samples(&mut errors, &at_rest()).nth(799);
            errors.gyro_bias_rad_s().z
        })
        .collect();
    // After 4 s: 2 · walk. 400 runs give it to 3.5 %, 4 σ.
    assert!((root_mean_square(&ends) / (2.0 * walk) - 1.0).abs() < 0.14);
}

#[test]
fn turn_on_bias_differs_from_run_to_run_and_stays_in_the_run() {
    let model = gyro(TriadErrors { turn_on_bias: 0.02, ..TriadErrors::default() });
    let mut biases = Vec::new();
    for seed in 0..400 {
        let mut errors = ImuErrors::new(&model, seed).unwrap();
        let ideal = at_rest();
        let mut run = samples(&mut errors, &ideal);
        let first = run.next().unwrap().angular_rate_rad_s;
        assert_eq!(first, run.nth(50).unwrap().angular_rate_rad_s);
        drop(run);
        assert_eq!(first, errors.gyro_bias_rad_s());
        biases.extend(first.iter().copied());
    }
    // 1200 draws: 2 %, 4 σ.
    assert!((root_mean_square(&biases) / 0.02 - 1.0).abs() < 0.08);
}

#[test]
fn scale_and_misalignment_act_on_the_reading_and_force_on_the_gyro() {
    let triad = TriadErrors { scale_factor: 0.01, misalignment_rad: 0.002, ..TriadErrors::default() };
    let model = ImuErrorModel { gyro: triad, g_sensitivity: 1e-4, ..ImuErrorModel::default() };
    let read = |rate: Vector3<f64>, force: Vector3<f64>| {
        let ideal = Inertial { angular_rate_rad_s: rate, specific_force_m_s2: force };
        ImuErrors::new(&model, 9).unwrap().apply(&ideal, Time::from_nanos(1), SPAN).angular_rate_rad_s
    };
    let (rate, force) = (Vector3::new(1.0, -2.0, 0.5), Vector3::new(3.0, 0.0, 9.8));
    let zero = Vector3::zeros();
    let from_rate = read(rate, zero);
    assert!((from_rate - rate).norm() > 1e-4 && (from_rate - rate).norm() < 0.1);
    // Linear: the parts add up and double (rounding only).
    assert!((read(rate, force) - from_rate - read(zero, force)).norm() < 1e-15);
    assert!((read(rate * 2.0, zero) - from_rate * 2.0).norm() < 1e-14);
    assert!(read(zero, force).norm() > 1e-6);
}

#[test]
fn a_reading_is_clipped_and_rounded() {
    let triad = TriadErrors { range: Some(5.0), quantisation: Some(0.02), ..TriadErrors::default() };
    let mut errors = ImuErrors::new(&gyro(triad), 1).unwrap();
    let ideal = Inertial {
        angular_rate_rad_s: Vector3::new(9.0, -6.0, 0.031),
        specific_force_m_s2: Vector3::zeros(),
    };
    let rate = errors.apply(&ideal, Time::from_nanos(1), SPAN).angular_rate_rad_s;
    // A product of two decimals: rounding.
    assert!((rate - Vector3::new(5.0, -5.0, 0.04)).norm() < 1e-14, "{rate}");
}

#[test]
fn the_bandwidth_is_where_the_power_is_half() {
    let bandwidth_hz = 5.0;
    let triad = TriadErrors { bandwidth_hz: Some(bandwidth_hz), ..TriadErrors::default() };
    let mut errors = ImuErrors::new(&gyro(triad), 1).unwrap();
    let mut outputs = Vec::new();
    for i in 0..4000_i32 {
        let t = f64::from(i) * SPAN_S;
        let rate = libm::sin(core::f64::consts::TAU * bandwidth_hz * t);
        let ideal = Inertial {
            angular_rate_rad_s: Vector3::new(rate, 0.0, 0.0),
            specific_force_m_s2: Vector3::zeros(),
        };
        let time = Time::from_seconds(t).unwrap();
        outputs.push(errors.apply(&ideal, time, SPAN).angular_rate_rad_s.x);
    }
    // A sine of RMS 1/√2 leaves with 1/2; the step of 1/40 period shifts that by a few per cent.
    let found = root_mean_square(&outputs[1000..]);
    assert!((found - 0.5).abs() < 0.02, "{found}");
}

#[test]
fn stamps_rise_however_much_they_jitter() {
    let model = ImuErrorModel { stamp_jitter_s: 0.01, ..ImuErrorModel::default() };
    let mut errors = ImuErrors::new(&model, 1).unwrap();
    let stamps: Vec<Time> = samples(&mut errors, &at_rest()).take(10_000).map(|s| s.time).collect();
    assert!(stamps.windows(2).all(|w| w[0] < w[1]));
    assert!(stamps.iter().any(|t| t.nanos() % SPAN.nanos() != 0));
}

#[test]
fn switching_one_error_off_leaves_the_others_as_they_are() {
    let full = ImuErrorModel::mpu6050();
    let mut quiet = full;
    quiet.gyro.bias_instability = 0.0;
    quiet.gyro.quantisation = None;
    let mut with = ImuErrors::new(&full, 8).unwrap();
    let mut without = ImuErrors::new(&quiet, 8).unwrap();
    for _ in 0..50 {
        let a = with.apply(&at_rest(), Time::from_nanos(1), SPAN);
        let b = without.apply(&at_rest(), Time::from_nanos(1), SPAN);
        assert_eq!(a.specific_force_m_s2, b.specific_force_m_s2);
        assert_eq!(a.time, b.time);
    }
}

#[test]
fn refuses_parameters_that_mean_nothing() {
    let refused = |errors: TriadErrors| ImuErrors::new(&gyro(errors), 1).is_err();
    assert!(refused(TriadErrors { random_walk: -1.0, ..TriadErrors::default() }));
    assert!(refused(TriadErrors { turn_on_bias: f64::NAN, ..TriadErrors::default() }));
    assert!(refused(TriadErrors { range: Some(0.0), ..TriadErrors::default() }));
    assert!(refused(TriadErrors { bias_instability: 1.0, ..TriadErrors::default() }));
    let message = ImuErrors::new(&gyro(TriadErrors { random_walk: -1.0, ..TriadErrors::default() }), 1)
        .unwrap_err()
        .to_string();
    assert_eq!(message, "random_walk is -1, expected a number not below 0");
}

#[test]
fn the_presets_hold_the_figures_of_their_data_sheets() {
    for preset in [ImuErrorModel::mpu6050(), ImuErrorModel::adis16448(), ImuErrorModel::microstrain_gx5_25()]
    {
        preset.check().unwrap();
    }
    let adis = ImuErrorModel::adis16448().specification();
    // 0.66 °/√h = 0.66 · 2.909e-4 rad/√s; the four printed digits of the conversion.
    assert!((adis.angle_random_walk_rad_sqrt_s / (0.66 * 2.909e-4) - 1.0).abs() < 2e-4);
    let microstrain = ImuErrorModel::microstrain_gx5_25().specification();
    // 25 µg/√Hz.
    assert!((microstrain.velocity_random_walk_m_s_sqrt_s - 25e-6 * 9.80665).abs() < 1e-18);
}
