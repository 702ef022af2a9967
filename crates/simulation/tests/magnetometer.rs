//! The magnetometer against its parameters, and its place in the stream of samples.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::Time;
use adit_observation::{ImuSample, MagneticSample};
use adit_simulation::{
    Cable, EarthField, Emission, FootWalkScenario, Generator, IdealImu, ImuErrorModel, Leg, MagneticTruth,
    MagneticWorld, Magnetometer, MagnetometerModel, Swing, TriadErrors, Tumble, generate, generate_marg,
};

const SPAN_S: f64 = 0.01;

fn triad(errors: TriadErrors) -> MagnetometerModel {
    MagnetometerModel { triad: errors, ..MagnetometerModel::ideal() }
}

/// Readings of one field.
fn readings(model: &MagnetometerModel, seed: u64, field_ut: Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
    let mut magnetometer = Magnetometer::new(model, seed).unwrap();
    (0..count).map(|_| magnetometer.apply(&field_ut, SPAN_S)).collect()
}

fn world() -> MagneticWorld {
    MagneticWorld::undisturbed(EarthField::harbin())
}

fn walked(rate_hz: f64, model: &MagnetometerModel, seed: u64) -> Vec<Emission> {
    let mut scenario = FootWalkScenario::straight(5.0);
    scenario.rate_hz = rate_hz;
    generate_marg(&scenario, &ImuErrorModel::xsens_mti_g(), &world(), model, seed).unwrap().collect()
}

fn imu(emissions: &[Emission]) -> Vec<ImuSample> {
    let inertial = emissions.iter().filter_map(|e| match e {
        Emission::Imu(sample, _) => Some(*sample),
        _ => None,
    });
    inertial.collect()
}

fn magnetic(emissions: &[Emission]) -> Vec<(MagneticSample, MagneticTruth)> {
    let magnetic = emissions.iter().filter_map(|e| match e {
        Emission::Magnetic(sample, truth) => Some((*sample, *truth)),
        _ => None,
    });
    magnetic.collect()
}

#[test]
fn a_faultless_magnetometer_reads_the_field_in_its_own_axes() {
    for (sample, truth) in magnetic(&walked(100.0, &MagnetometerModel::ideal(), 1)) {
        assert_eq!(sample.time, truth.time);
        // Rounding of one rotation.
        let expected = truth.attitude.inverse_transform_vector(&EarthField::harbin().enu_ut());
        assert!((sample.field_ut - expected).norm() < 1e-12);
    }
}

#[test]
fn a_compass_on_a_level_foot_shows_the_heading_less_the_declination() {
    let earth = EarthField::harbin();
    // The walk goes east, the foot is level at rest.
    let field = magnetic(&walked(100.0, &MagnetometerModel::ideal(), 1))[0].0.field_ut;
    let magnetic_heading = libm::atan2(field.y, field.x);
    assert!((magnetic_heading - (90.0_f64.to_radians() - earth.declination_rad)).abs() < 1e-12);
}

#[test]
fn noise_is_white_and_as_strong_as_ordered() {
    let density = 0.01;
    let model = triad(TriadErrors { random_walk: density, ..TriadErrors::default() });
    let field = Vector3::new(20.0, -5.0, 40.0);
    let count = 100_000;
    let noise: Vec<Vector3<f64>> =
        readings(&model, 7, field, count).into_iter().map(|reading| reading - field).collect();
    let n = count as f64;
    let sigma = density / libm::sqrt(SPAN_S);
    let mean = noise.iter().sum::<Vector3<f64>>() / n;
    // σ/√n, 4 σ, of three axes.
    assert!(mean.amax() < 4.0 * sigma / libm::sqrt(n), "mean {mean}");
    for axis in 0..3 {
        let lagged = |lag: usize| {
            noise.iter().zip(&noise[lag..]).map(|(a, b)| a[axis] * b[axis]).sum::<f64>() / (n - lag as f64)
        };
        // A variance of n draws is known to √(2/n), a covariance to 1/√n; 4 σ.
        assert!((lagged(0) / (sigma * sigma) - 1.0).abs() < 4.0 * libm::sqrt(2.0 / n));
        for lag in [1, 2, 10] {
            let correlation = lagged(lag) / (sigma * sigma);
            assert!(correlation.abs() < 4.0 / libm::sqrt(n), "lag {lag}: {correlation}");
        }
    }
}

#[test]
fn the_noise_of_each_preset_is_that_of_its_sheet() {
    // Sheets state it at the output: MTi-G 0.5 mG at 10 Hz, HMC5883L 2 mG at 75 Hz, ADIS16448 2.4 mG at 51.2 Hz.
    for (model, sheet_ut) in [
        (MagnetometerModel::xsens_mti_g(), 0.05),
        (MagnetometerModel::hmc5883l(), 0.2),
        (MagnetometerModel::adis16448(), 0.24),
    ] {
        let steps = TriadErrors {
            turn_on_bias: 0.0,
            bias_instability: 0.0,
            bias_correlation_s: 0.0,
            quantisation: None,
            ..model.triad
        };
        let mut magnetometer = Magnetometer::new(&MagnetometerModel { triad: steps, ..model }, 3).unwrap();
        let (count, settling) = (200_000, 100);
        let values: Vec<f64> = (0..settling + count)
            .map(|_| magnetometer.apply(&Vector3::zeros(), 1.0 / model.rate_hz).x)
            .skip(settling)
            .collect();
        let rms = libm::sqrt(values.iter().map(|v| v * v).sum::<f64>() / count as f64);
        // 1.6 % for the one-pole filter stepped at 100 Hz instead of running, 1 % for 4 σ of 200,000 draws of which
        // the filter leaves a third independent.
        assert!((rms / sheet_ut - 1.0).abs() < 0.026, "{rms} for {sheet_ut}");
    }
}

#[test]
fn iron_and_turned_axes_make_a_linear_map_and_an_offset_that_the_run_tells() {
    let soft_iron = [[1.05, 0.04, -0.02], [0.02, 0.94, 0.03], [-0.01, 0.05, 0.9]];
    let model = MagnetometerModel {
        hard_iron_ut: [14.0, -9.0, 6.0],
        soft_iron,
        axes_turned_rad: [0.0, 0.0, core::f64::consts::FRAC_PI_2],
        triad: TriadErrors {
            turn_on_bias: 0.5,
            scale_factor: 0.01,
            misalignment_rad: 0.01,
            bias_random_walk: 0.1,
            ..TriadErrors::default()
        },
        ..MagnetometerModel::ideal()
    };
    let mut magnetometer = Magnetometer::new(&model, 5).unwrap();
    for field in [Vector3::new(20.0, 0.0, 0.0), Vector3::new(-3.0, 30.0, 7.0), Vector3::new(0.0, 1.0, -50.0)]
    {
        let reading = magnetometer.apply(&field, SPAN_S);
        let expected = magnetometer.response() * field + magnetometer.offset_ut();
        // Rounding.
        assert!((reading - expected).norm() < 1e-12);
    }
    // Without what is drawn: the sensor's x axis points along the body's y.
    let known = MagnetometerModel { triad: TriadErrors::default(), ..model };
    let known = Magnetometer::new(&known, 5).unwrap();
    let turned = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let soft = Matrix3::from_fn(|row, column| soft_iron[row][column]);
    assert!((known.response() - soft * turned).norm() < 1e-14);
    assert_eq!(known.offset_ut(), Vector3::new(14.0, -9.0, 6.0));
    assert!((magnetometer.response() - known.response()).norm() > 1e-3, "something was drawn");
}

#[test]
fn a_reading_is_clipped_at_the_range_and_rounded_to_the_step() {
    let model = triad(TriadErrors { range: Some(75.0), quantisation: Some(0.5), ..TriadErrors::default() });
    let reading = readings(&model, 1, Vector3::new(80.3, -200.0, 40.3), 1)[0];
    assert_eq!(reading, Vector3::new(75.0, -75.0, 40.5));
}

#[test]
fn the_same_seed_gives_the_same_samples_and_another_seed_others() {
    let model = MagnetometerModel { stamp_jitter_s: 1e-4, ..MagnetometerModel::hmc5883l() };
    let first = walked(100.0, &model, 1);
    assert_eq!(first, walked(100.0, &model, 1));
    let (a, b) = (magnetic(&first), magnetic(&walked(100.0, &model, 2)));
    assert!(a.iter().zip(&b).filter(|((a, _), (b, _))| a == b).count() < a.len() / 100);
}

#[test]
fn a_magnetometer_changes_no_bit_of_the_imu() {
    let mut scenario = FootWalkScenario::straight(5.0);
    scenario.rate_hz = 100.0;
    let model = ImuErrorModel::xsens_mti_g();
    let alone: Vec<_> = generate(&scenario, &model, 4).unwrap().collect();
    for magnetometer in [MagnetometerModel::xsens_mti_g(), MagnetometerModel::hmc5883l()] {
        let together = generate_marg(&scenario, &model, &world(), &magnetometer, 4).unwrap();
        let inertial = together.filter_map(|emission| match emission {
            Emission::Imu(sample, truth) => Some((sample, truth)),
            _ => None,
        });
        assert!(inertial.eq(alone.iter().copied()));
    }
}

#[test]
fn samples_of_both_come_in_order_of_time_whatever_the_rates() {
    for (imu_hz, magnetic_hz) in [(200.0, 75.0), (100.0, 100.0), (100.0, 51.2), (50.0, 220.0)] {
        let model =
            MagnetometerModel { rate_hz: magnetic_hz, stamp_jitter_s: 2e-3, ..MagnetometerModel::ideal() };
        let emissions = walked(imu_hz, &model, 1);
        let stamps: Vec<Time> = emissions.iter().map(|e| e.observation().time()).collect();
        assert!(stamps.is_sorted(), "{imu_hz} Hz and {magnetic_hz} Hz");
        let (inertial, magnetic) = (imu(&emissions), magnetic(&emissions));
        assert!(magnetic.windows(2).all(|w| w[0].0.time < w[1].0.time));
        // Either stream goes on to the last sample that fits into the walk.
        let whole = |rate_hz: f64, count: usize| count as f64 / rate_hz;
        let (ends_imu, ends_magnetic) = (whole(imu_hz, inertial.len()), whole(magnetic_hz, magnetic.len()));
        assert!((ends_imu - ends_magnetic).abs() < 1.0 / imu_hz.min(magnetic_hz));
    }
}

#[test]
fn of_two_samples_of_one_stamp_the_inertial_comes_first() {
    let mut errors = ImuErrorModel::xsens_mti_g();
    errors.stamp_jitter_s = 0.0;
    let mut scenario = FootWalkScenario::straight(2.0);
    scenario.rate_hz = 100.0;
    let pairs: Vec<Emission> =
        generate_marg(&scenario, &errors, &world(), &MagnetometerModel::ideal(), 1).unwrap().collect();
    for pair in pairs.chunks_exact(2) {
        assert_eq!(pair[0].observation().time(), pair[1].observation().time());
        assert!(matches!(pair, [Emission::Imu(..), Emission::Magnetic(..)]));
    }
}

/// An evenly turning tag, at 0.5 rad/s from 5 s on.
fn turning(model: &MagnetometerModel, world: MagneticWorld) -> Vec<(MagneticSample, MagneticTruth)> {
    let tumble = Tumble { yaw: Swing { rate: 0.5, ..Swing::default() }, ..Tumble::still(2.0, 20.0) };
    let imu = Generator::new(tumble, IdealImu::default(), 100.0, &ImuErrorModel::default(), 1).unwrap();
    let emissions: Vec<Emission> = imu.with_magnetometer(world, model, 1).unwrap().collect();
    magnetic(&emissions)
}

fn compass(field_ut: &Vector3<f64>) -> f64 {
    libm::atan2(field_ut.y, field_ut.x)
}

#[test]
fn a_late_magnetometer_shows_where_the_tag_was() {
    let late = MagnetometerModel { latency_s: 0.04, ..MagnetometerModel::ideal() };
    let (now, late) = (turning(&MagnetometerModel::ideal(), world()), turning(&late, world()));
    for ((now, _), (late, truth)) in now.iter().zip(&late).skip(500).take(800) {
        assert_eq!(now.time, late.time);
        // It turns left at 0.5 rad/s: the compass heading was larger by 0.02 rad. Rounding of stamps, 1 ns.
        let lag = compass(&late.field_ut) - compass(&now.field_ut);
        assert!((lag.rem_euclid(core::f64::consts::TAU) - 0.02).abs() < 1e-8, "{lag}");
        assert_eq!((now.time - truth.time).nanos(), 40_000_000);
    }
}

#[test]
fn integration_over_a_period_of_the_mains_hides_a_cable() {
    let mut world = world();
    let direct = Cable::direct(Vector3::new(0.0, 1.0, 0.0), Vector3::x(), 500.0);
    world.cables.push(Cable { frequency_hz: 50.0, ..direct });
    let largest = |integration_s: f64| {
        let model = MagnetometerModel { integration_s, rate_hz: 73.0, ..MagnetometerModel::ideal() };
        let norm = EarthField::harbin().norm_ut;
        turning(&model, world.clone())
            .iter()
            .map(|(sample, _)| (sample.field_ut.norm() - norm).abs())
            .fold(0.0, f64::max)
    };
    // 100 µT of amplitude at 1 m; averaging leaves what the turning of 0.01 rad in 20 ms lets through, and the quadrature.
    assert!(largest(0.0) > 50.0, "{}", largest(0.0));
    assert!(largest(0.02) < 0.5, "{}", largest(0.02));
}

#[test]
fn a_magnetometer_that_cannot_be_is_refused() {
    let refused = |change: &dyn Fn(&mut MagnetometerModel)| {
        let mut model = MagnetometerModel::xsens_mti_g();
        change(&mut model);
        Magnetometer::new(&model, 1).is_err()
    };
    assert!(!refused(&|_| ()));
    assert!(refused(&|m| m.rate_hz = 0.0));
    assert!(refused(&|m| m.latency_s = -0.1));
    assert!(refused(&|m| m.hard_iron_ut[1] = f64::NAN));
    assert!(refused(&|m| m.soft_iron = [[0.0; 3]; 3]));
    assert!(refused(&|m| m.triad.random_walk = -1.0));
}

#[test]
fn a_walk_without_a_step_still_has_its_samples() {
    let scenario = FootWalkScenario {
        rate_hz: 100.0,
        ..FootWalkScenario::new(adit_simulation::Gait::slow(), 0.0, vec![Leg::Stand { seconds: 1.0 }])
    };
    let run = generate_marg(&scenario, &ImuErrorModel::default(), &world(), &MagnetometerModel::ideal(), 1);
    assert_eq!(run.unwrap().count(), 200);
}
