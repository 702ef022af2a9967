//! IMU and magnetometer together: order, timing, random streams.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::Vector3;
use adit_observation::{ImuSample, MagneticSample};
use adit_simulation::{
    Course, EarthField, Emission, FootWalkScenario, Generator, IdealImu, ImuErrorModel, MagneticTruth,
    MagneticWorld, MagnetometerModel, Motion, SteelBody, TriadErrors, Tumble, generate, generate_marg,
};

const COURT: EarthField = EarthField::harbin();

fn world() -> MagneticWorld {
    let mut car =
        SteelBody::new(Course::standing(Vector3::new(3.0, 1.5, 0.5)), Vector3::new(9.0, 5.0, -30.0));
    car.induced_m3 = 1.0;
    MagneticWorld { steel: vec![car], ..MagneticWorld::undisturbed(COURT) }
}

fn walk(imu: &ImuErrorModel, model: &MagnetometerModel, seed: u64) -> Vec<Emission> {
    generate_marg(&FootWalkScenario::straight(8.0), imu, &world(), model, seed).unwrap().collect()
}

fn tumbled(tumble: &Tumble, model: &MagnetometerModel) -> Vec<(MagneticSample, MagneticTruth)> {
    let imu = Generator::new(*tumble, IdealImu::default(), 100.0, &ImuErrorModel::default(), 1).unwrap();
    let both = imu.with_magnetometer(world(), model, 1).unwrap();
    both.filter_map(|emission| match emission {
        Emission::Magnetic(sample, truth) => Some((sample, truth)),
        _ => None,
    })
    .collect()
}

fn inertial(emissions: &[Emission]) -> Vec<ImuSample> {
    let sample = |e: &Emission| if let Emission::Imu(sample, _) = e { Some(*sample) } else { None };
    emissions.iter().filter_map(sample).collect()
}

fn magnetic(emissions: &[Emission]) -> Vec<MagneticSample> {
    let sample = |e: &Emission| if let Emission::Magnetic(sample, _) = e { Some(*sample) } else { None };
    emissions.iter().filter_map(sample).collect()
}

#[test]
fn stamps_of_both_sensors_rise_together_however_much_they_jitter() {
    let imu = ImuErrorModel { stamp_jitter_s: 0.003, ..ImuErrorModel::xsens_mti_g() };
    for rate_hz in [75.0, 200.0, 333.3, 1.0] {
        let model = MagnetometerModel { rate_hz, stamp_jitter_s: 0.002, ..MagnetometerModel::hmc5883l() };
        let all = walk(&imu, &model, 2);
        let stamps: Vec<_> = all.iter().map(|e| e.observation().time()).collect();
        assert!(stamps.windows(2).all(|w| w[0] <= w[1]), "{rate_hz} Hz");
        let own: Vec<_> = magnetic(&all).iter().map(|s| s.time).collect();
        assert!(own.windows(2).all(|w| w[0] < w[1]), "{rate_hz} Hz");
        let seconds = FootWalkScenario::straight(8.0).walk(2).unwrap().duration_s();
        // Every sample that the time has room for, to the end of the walk.
        assert!((own.len() as f64 - seconds * rate_hz).abs() <= 1.0, "{} in {seconds} s", own.len());
        assert!((inertial(&all).len() as f64 - seconds * 200.0).abs() <= 1.0);
    }
}

#[test]
fn at_equal_stamps_the_imu_comes_first() {
    let model = MagnetometerModel { rate_hz: 200.0, ..MagnetometerModel::ideal() };
    let all = walk(&ImuErrorModel::default(), &model, 1);
    assert!(all.chunks_exact(2).all(|pair| {
        matches!(pair, [Emission::Imu(imu, _), Emission::Magnetic(magnetic, _)] if imu.time == magnetic.time)
    }));
}

#[test]
fn each_sensor_has_its_own_random_numbers() {
    let (imu, model) = (ImuErrorModel::xsens_mti_g(), MagnetometerModel::xsens_mti_g());
    let both = walk(&imu, &model, 6);
    assert_eq!(both, walk(&imu, &model, 6), "the same seed, the same samples");
    assert_ne!(magnetic(&both), magnetic(&walk(&imu, &model, 7)));

    // No magnetometer, another one: the same inertial samples.
    let alone: Vec<ImuSample> =
        generate(&FootWalkScenario::straight(8.0), &imu, 6).unwrap().map(|(sample, _)| sample).collect();
    assert_eq!(inertial(&both), alone);
    assert_eq!(inertial(&walk(&imu, &MagnetometerModel::hmc5883l(), 6)), alone);
    // Another IMU: the same magnetic samples.
    assert_eq!(magnetic(&walk(&ImuErrorModel::mpu6050(), &model, 6)), magnetic(&both));

    // The noise of the two is not the same numbers in other units: correlation within 4/√n.
    let level = |v: &[f64]| {
        let mean = v.iter().sum::<f64>() / v.len() as f64;
        v.iter().map(|x| x - mean).collect::<Vec<f64>>()
    };
    let quiet = |random_walk| TriadErrors { random_walk, ..TriadErrors::default() };
    let imu = ImuErrorModel { gyro: quiet(0.01), ..ImuErrorModel::default() };
    let model = MagnetometerModel { rate_hz: 200.0, triad: quiet(0.1), ..MagnetometerModel::ideal() };
    let still = Generator::new(Tumble::still(50.0, 1.0), IdealImu::default(), 200.0, &imu, 9).unwrap();
    let all: Vec<_> = still.with_magnetometer(world(), &model, 9).unwrap().collect();
    let gyro = level(&inertial(&all).iter().map(|s| s.angular_rate_rad_s.x).collect::<Vec<_>>());
    let field = level(&magnetic(&all).iter().map(|s| s.field_ut.x).collect::<Vec<_>>());
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let correlation = dot(&gyro, &field) / (dot(&gyro, &gyro) * dot(&field, &field)).sqrt();
    assert!(correlation.abs() < 4.0 / (gyro.len() as f64).sqrt(), "{correlation}");
}

#[test]
fn an_ideal_sample_is_the_field_of_the_world_in_the_axes_of_the_sensor() {
    let tumble = Tumble::over_the_sphere(20.0);
    for (sample, truth) in tumbled(&tumble, &MagnetometerModel::ideal()) {
        let state = tumble.at(sample.time.seconds());
        let expected = world().field_ut(&state.position_m, sample.time.seconds());
        assert_eq!((truth.time, truth.field_ut), (sample.time, expected));
        assert!((truth.attitude * sample.field_ut - expected).norm() < 1e-12);
        assert_eq!(truth.disturbance_ut, world().disturbance_ut(&state.position_m, sample.time.seconds()));
    }
}

#[test]
fn a_late_sensor_shows_what_was() {
    let (tumble, late_s) = (Tumble::waist(10.0), 0.037);
    let model = MagnetometerModel { latency_s: late_s, ..MagnetometerModel::ideal() };
    for (sample, truth) in tumbled(&tumble, &model) {
        assert!((sample.time.seconds() - truth.time.seconds() - late_s).abs() < 1e-9);
        let state = tumble.at(truth.time.seconds());
        let then = state.attitude.inverse_transform_vector(&world().field_ut(&state.position_m, 0.0));
        // A stamp is a whole nanosecond: 1e-9 s of 300 µT/s.
        assert!((sample.field_ut - then).norm() < 1e-6);
    }
}

#[test]
fn an_integrating_sensor_shows_the_mean() {
    let tumble = Tumble::over_the_sphere(10.0);
    let model = MagnetometerModel { rate_hz: 10.0, integration_s: 0.04, ..MagnetometerModel::ideal() };
    let slices = 400_i32;
    for (sample, _) in tumbled(&tumble, &model) {
        let sum: Vector3<f64> = (0..slices)
            .map(|i| {
                let before_s = (f64::from(i) + 0.5) / f64::from(slices) * 0.04;
                let state = tumble.at(sample.time.seconds() - before_s);
                state.attitude.inverse_transform_vector(&world().field_ut(&state.position_m, 0.0))
            })
            .sum();
        // Midpoints of 0.1 ms: h²/24 of a second derivative below 200 µT/s².
        assert!((sample.field_ut - sum / f64::from(slices)).norm() < 1e-6);
    }
}

#[test]
fn a_level_tag_shows_its_magnetic_heading() {
    let imu =
        Generator::new(Tumble::still(1.0, 1.0), IdealImu::default(), 100.0, &ImuErrorModel::default(), 1)
            .unwrap();
    let court = MagneticWorld::undisturbed(COURT);
    let mut both = imu.with_magnetometer(court, &MagnetometerModel::ideal(), 1).unwrap();
    let field =
        both.find_map(|e| if let Emission::Magnetic(s, _) = e { Some(s.field_ut) } else { None }).unwrap();
    // It faces true east; magnetic north lies 10.61° west of true north, so the compass shows 100.61°.
    let shown = field.y.atan2(field.x).to_degrees();
    assert!((shown - 100.61).abs() < 1e-9, "{shown}");
}
