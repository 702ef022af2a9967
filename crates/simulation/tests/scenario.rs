//! Scenarios as a user runs them.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::Vector3;
use adit_observation::ImuSample;
use adit_simulation::{FootWalkScenario, ImuErrorModel, Leg, Motion, SimulationError, TruthState, generate};

fn run(scenario: &FootWalkScenario, model: &ImuErrorModel, seed: u64) -> Vec<(ImuSample, TruthState)> {
    generate(scenario, model, seed).unwrap().collect()
}

fn bytes(samples: &[(ImuSample, TruthState)]) -> Vec<u8> {
    let numbers = |s: &ImuSample, t: &TruthState| {
        let vectors = [
            s.angular_rate_rad_s,
            s.specific_force_m_s2,
            t.position_m,
            t.velocity_m_s,
            t.gyro_bias_rad_s,
            t.acc_bias_m_s2,
        ];
        let stamps = [s.time.nanos().to_le_bytes(), t.time.nanos().to_le_bytes()];
        let values = vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]).map(f64::to_le_bytes);
        stamps.into_iter().chain(values).flatten().collect::<Vec<u8>>()
    };
    samples.iter().flat_map(|(s, t)| numbers(s, t)).collect()
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    let scenario = FootWalkScenario::straight(5.0);
    let model = ImuErrorModel::adis16448();
    let first = bytes(&run(&scenario, &model, 1));
    assert_eq!(first, bytes(&run(&scenario, &model, 1)));
    assert_ne!(first, bytes(&run(&scenario, &model, 2)));
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
fn fingerprint(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn the_walk_of_s2_is_bit_for_bit_the_one_the_published_figures_were_measured_on() {
    let samples = run(&FootWalkScenario::demo_walk(), &ImuErrorModel::adis16448_calibrated(), 1);
    // Taken from the first version of the generator, before it knew any magnetometer (commit e45798d).
    assert_eq!((samples.len(), fingerprint(&bytes(&samples))), (30_004, 11_247_757_028_587_376_396));
}

#[test]
fn another_sensor_takes_the_same_walk() {
    let scenario = FootWalkScenario::loops(1);
    let a = run(&scenario, &ImuErrorModel::mpu6050(), 3);
    let b = run(&scenario, &ImuErrorModel::default(), 3);
    assert!(a.iter().zip(&b).all(|((_, s), (_, t))| s.position_m == t.position_m));
    assert_ne!(a[0].0.angular_rate_rad_s, b[0].0.angular_rate_rad_s);
}

#[test]
fn the_demo_walk_stays_in_its_room_and_comes_back() {
    let run = run(&FootWalkScenario::demo_walk(), &ImuErrorModel::adis16448(), 1);
    let (low, high) = run.iter().fold((Vector3::zeros(), Vector3::zeros()), |(l, h), (_, t)| {
        (t.position_m.inf(&l), t.position_m.sup(&h))
    });
    // 52 m × 7.2 m, and the foot swings out by less than 30 cm.
    assert!((high.x - low.x - 52.0).abs() < 0.3, "{}", high.x - low.x);
    assert!((high.y - low.y - 7.2).abs() < 0.3, "{}", high.y - low.y);
    assert!(high.z < 0.15 && low.z > -0.02);
    let (_, end) = run[run.len() - 1];
    // 80 footprints of rounding.
    assert!(end.position_m.norm() < 1e-12);
    assert!((110.0..130.0).contains(&FootWalkScenario::demo_walk().walk(1).unwrap().length_m()));
}

#[test]
fn the_walk_of_s3_is_a_closed_loop_of_80_m_in_15_minutes_on_its_court() {
    let scenario = FootWalkScenario::court_walk();
    let run = run(&scenario, &ImuErrorModel::xsens_mti_g(), 1);
    let walk = scenario.walk(1).unwrap();
    // Rounding; the stride's variation moves footprints along straight legs only.
    assert!((walk.length_m() - 80.0).abs() < 1e-9, "{}", walk.length_m());
    // 128 s of slow strides, 3 % of variation each.
    assert!((walk.duration_s() - 900.0).abs() < 6.0, "{}", walk.duration_s());
    let (low, high) = run.iter().fold((Vector3::zeros(), Vector3::zeros()), |(l, h), (_, t)| {
        (t.position_m.inf(&l), t.position_m.sup(&h))
    });
    assert!(high.x - low.x < 28.0 && high.y - low.y < 15.0, "{low} {high}");
    let (_, end) = run[run.len() - 1];
    assert!(end.position_m.norm() < 1e-12, "80 footprints of rounding");
    assert!(end.attitude.angle_to(&walk.at(0.0).attitude) < 1e-7);
}

#[test]
fn the_sensor_of_s3_does_not_clip_on_its_walk() {
    let model = ImuErrorModel::xsens_mti_g();
    let run = run(&FootWalkScenario::court_walk(), &model, 1);
    let (rate, force) = run.iter().fold((0.0_f64, 0.0_f64), |(rate, force), (sample, _)| {
        (rate.max(sample.angular_rate_rad_s.amax()), force.max(sample.specific_force_m_s2.amax()))
    });
    assert!(rate < 0.9 * model.gyro.range.unwrap() && force < 0.9 * model.accelerometer.range.unwrap());
    // The reason for the gyros of ±1200 °/s: the usual ones would clip.
    assert!(rate > 300.0_f64.to_radians(), "{} °/s", rate.to_degrees());
}

#[test]
fn it_starts_with_a_rest_long_enough_to_align() {
    for scenario in
        [FootWalkScenario::demo_walk(), FootWalkScenario::straight(5.0), FootWalkScenario::loops(1)]
    {
        let still = run(&scenario, &ImuErrorModel::default(), 1).iter().take_while(|(_, t)| t.stance).count();
        assert!(still >= 400, "{still} samples at 200 Hz");
    }
}

#[test]
fn samples_come_evenly_from_the_first_interval_to_the_end() {
    let scenario = FootWalkScenario::straight(5.0);
    let generator = generate(&scenario, &ImuErrorModel::default(), 1).unwrap();
    let duration_s = generator.walk().duration_s();
    let samples: Vec<_> = generator.collect();
    assert_eq!(samples[0].0.time.nanos(), 5_000_000);
    assert!(samples.windows(2).all(|w| (w[1].0.time - w[0].0.time).nanos() == 5_000_000));
    let last_s = samples[samples.len() - 1].1.time.seconds();
    assert!(last_s <= duration_s && last_s > duration_s - 0.005);
}

#[test]
fn a_sample_at_rest_differs_from_the_ideal_one_by_the_bias_of_the_truth() {
    let scenario = FootWalkScenario::straight(5.0);
    let mut model = ImuErrorModel::adis16448();
    model.g_sensitivity = 0.0;
    model.gyro.quantisation = None;
    let ideal = run(&scenario, &ImuErrorModel::default(), 4);
    let real = run(&scenario, &model, 4);
    let rest = 500;
    let difference = real
        .iter()
        .zip(&ideal)
        .take(rest)
        .map(|((s, t), (i, _))| s.angular_rate_rad_s - i.angular_rate_rad_s - t.gyro_bias_rad_s)
        .sum::<Vector3<f64>>()
        / rest as f64;
    // White noise of 2.5 s: N/√2.5 s per axis, 4 σ.
    let sigma = model.gyro.random_walk / libm::sqrt(2.5);
    assert!(difference.amax() < 4.0 * sigma, "{difference}");
}

#[test]
fn truth_is_at_hand_before_the_first_sample() {
    let generator = generate(&FootWalkScenario::straight(5.0), &ImuErrorModel::adis16448(), 1).unwrap();
    let truth = generator.truth();
    assert_eq!(truth.time.nanos(), 0);
    assert_eq!(truth.position_m, Vector3::zeros());
    assert!(truth.stance && truth.gyro_bias_rad_s.norm() > 0.0);
}

#[test]
fn refuses_a_walk_that_cannot_be() {
    let refused = |change: &dyn Fn(&mut FootWalkScenario)| {
        let mut scenario = FootWalkScenario::straight(5.0);
        change(&mut scenario);
        generate(&scenario, &ImuErrorModel::default(), 1).err()
    };
    assert!(refused(&|_| ()).is_none());
    assert!(refused(&|s| s.rate_hz = f64::NAN).is_some());
    assert!(refused(&|s| s.plan.legs.push(Leg::Stand { seconds: -1.0 })).is_some());
    assert!(refused(&|s| s.plan.legs.push(Leg::Straight { length_m: f64::INFINITY })).is_some());
    assert_eq!(
        refused(&|s| s.plan.gait.stride_m = 0.0),
        Some(SimulationError::Parameter { name: "stride_m", found: 0.0, expected: "0.05 to 5 m" })
    );
}
