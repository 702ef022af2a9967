//! The faultless IMU against gravity, the Earth's rotation, and an integrator that knows nothing of the model.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::attitude;
use adit_core::geodesy::EARTH_RATE_RAD_S;
use adit_core::nalgebra::Vector3;
use adit_simulation::{
    FootWalk, FootWalkScenario, Gait, IdealImu, Inertial, Leg, Motion, MotionState, STANDARD_GRAVITY_M_S2,
    Sampling,
};

#[test]
fn a_still_foot_reads_gravity_and_the_rotation_of_the_earth() {
    let scenario = FootWalkScenario::straight(5.0);
    let walk = scenario.walk(1).unwrap();
    let latitude = 0.6;
    let imu = IdealImu { gravity_m_s2: 9.8, latitude_rad: Some(latitude), sampling: Sampling::Averaged };
    let reading = imu.sample(&walk, 1.0, 1.005);
    // The foot points east: north is to its left, y.
    let earth = EARTH_RATE_RAD_S * Vector3::new(0.0, libm::cos(latitude), libm::sin(latitude));
    // Rounding of a sum of four.
    assert!((reading.specific_force_m_s2 - Vector3::new(0.0, 0.0, 9.8)).norm() < 1e-13);
    assert!((reading.angular_rate_rad_s - earth).norm() < 1e-18);
}

#[test]
fn a_sensor_mounted_upside_down_reads_gravity_on_minus_z() {
    let mut scenario = FootWalkScenario::straight(5.0);
    scenario.foot.mounting = attitude::exp(&(Vector3::x() * core::f64::consts::PI));
    let walk = scenario.walk(1).unwrap();
    let force = IdealImu::default().sample(&walk, 1.0, 1.005).specific_force_m_s2;
    // Rounding: π as a float turns by 1e-16 short of a half turn.
    assert!((force + Vector3::z() * STANDARD_GRAVITY_M_S2).norm() < 1e-13, "{force}");
}

#[test]
fn an_earth_at_rest_turns_nothing() {
    let walk = FootWalkScenario::straight(5.0).walk(1).unwrap();
    let imu = IdealImu { latitude_rad: None, ..IdealImu::default() };
    assert_eq!(imu.sample(&walk, 1.0, 1.01).angular_rate_rad_s, Vector3::zeros());
}

#[test]
fn a_mean_over_an_interval_is_the_mean_of_the_means_of_its_halves() {
    for gait in [Gait::walk(), Gait::run()] {
        let mut scenario = FootWalkScenario::straight(20.0);
        scenario.plan.gait = gait;
        let walk = scenario.walk(2).unwrap();
        let imu = scenario.imu;
        let mut worst = (0.0_f64, 0.0_f64);
        for i in 0..3000 {
            let (start, end) = (f64::from(i) * 0.005, f64::from(i + 1) * 0.005);
            let middle = 0.5 * (start + end);
            let whole = imu.sample(&walk, start, end);
            let (first, second) = (imu.sample(&walk, start, middle), imu.sample(&walk, middle, end));
            let rate = 0.5 * (first.angular_rate_rad_s + second.angular_rate_rad_s);
            let force = 0.5 * (first.specific_force_m_s2 + second.specific_force_m_s2);
            worst.0 = worst.0.max((whole.angular_rate_rad_s - rate).norm());
            worst.1 = worst.1.max((whole.specific_force_m_s2 - force).norm());
        }
        // The error of the quadrature that the module head states.
        assert!(worst.0 < 1e-5 && worst.1 < 1e-3, "rate {:e}, force {:e}", worst.0, worst.1);
    }
}

/// Strapdown in increments with the two-sample coning and sculling terms of Savage (1998), in ENU on a turning Earth.
struct Strapdown {
    state: MotionState,
    turn_before: Vector3<f64>,
    push_before: Vector3<f64>,
}

impl Strapdown {
    fn from(state: MotionState) -> Self {
        Self { state, turn_before: Vector3::zeros(), push_before: Vector3::zeros() }
    }

    fn step(&mut self, reading: &Inertial, imu: &IdealImu, span_s: f64) {
        let turn = reading.angular_rate_rad_s * span_s;
        let push = reading.specific_force_m_s2 * span_s;
        let earth = imu.earth_rate_rad_s();
        let coning = self.turn_before.cross(&turn) / 12.0;
        let sculling = (self.turn_before.cross(&push) + self.push_before.cross(&turn)) / 12.0;
        let pushed = push + turn.cross(&(0.5 * push + turn.cross(&push) / 6.0)) + sculling;
        let s = &mut self.state;
        let gravity = Vector3::new(0.0, 0.0, -imu.gravity_m_s2);
        let before = s.velocity_m_s;
        s.velocity_m_s += s.attitude * pushed + (gravity - 2.0 * earth.cross(&before)) * span_s;
        s.position_m += 0.5 * (before + s.velocity_m_s) * span_s;
        s.attitude = attitude::exp(&(earth * -span_s)) * s.attitude * attitude::exp(&(turn + coning));
        (self.turn_before, self.push_before) = (turn, push);
    }
}

/// Errors of position (m) and attitude (rad) after integrating the whole walk at `rate_hz`.
fn errors_at_the_end(walk: &FootWalk, imu: &IdealImu, rate_hz: f64) -> (f64, f64) {
    let mut strapdown = Strapdown::from(walk.at(0.0));
    let samples = (0..).take_while(|i| f64::from(i + 1) / rate_hz <= walk.duration_s());
    let mut end = 0.0;
    for i in samples {
        let start = f64::from(i) / rate_hz;
        end = f64::from(i + 1) / rate_hz;
        strapdown.step(&imu.sample(walk, start, end), imu, 1.0 / rate_hz);
    }
    let truth = walk.at(end);
    (
        (strapdown.state.position_m - truth.position_m).norm(),
        strapdown.state.attitude.angle_to(&truth.attitude),
    )
}

#[test]
fn integrating_the_samples_leads_back_to_the_truth() {
    let legs = vec![
        Leg::Stand { seconds: 2.0 },
        Leg::Straight { length_m: 10.0 },
        Leg::Arc { radius_m: 2.0, turn_rad: 2.0 },
        Leg::Gait(Gait::stairs()),
        Leg::Stairs { risers: 6, rise_m: 0.17, tread_m: 0.29 },
        Leg::Stand { seconds: 1.0 },
    ];
    let scenario = FootWalkScenario::new(Gait::walk(), 0.5, legs);
    let walk = scenario.walk(4).unwrap();
    // 20 s of walking and climbing with no aiding; what is left is the integrator's own error, which falls with the step.
    for (rate_hz, metres, radians) in [(200.0, 5e-3, 1e-5), (1000.0, 1e-4, 1e-7)] {
        let (position_m, attitude_rad) = errors_at_the_end(&walk, &scenario.imu, rate_hz);
        assert!(position_m < metres, "{position_m:e} m at {rate_hz} Hz");
        assert!(attitude_rad < radians, "{attitude_rad:e} rad at {rate_hz} Hz");
    }
}

#[test]
fn without_the_rotation_of_the_earth_in_the_samples_the_integrator_misses() {
    let scenario = FootWalkScenario::straight(20.0);
    let walk = scenario.walk(4).unwrap();
    let turning = scenario.imu;
    let resting = IdealImu { latitude_rad: None, ..turning };
    let mut strapdown = Strapdown::from(walk.at(0.0));
    for i in 0..10_000 {
        let (start, end) = (f64::from(i) * 1e-3, f64::from(i + 1) * 1e-3);
        strapdown.step(&turning.sample(&walk, start, end), &resting, 1e-3);
    }
    let angle = strapdown.state.attitude.angle_to(&walk.at(10.0).attitude);
    // Ω · 10 s, whatever the foot does.
    assert!((angle - EARTH_RATE_RAD_S * 10.0).abs() < 2e-5, "{angle:e} rad");
}

#[test]
fn refuses_another_planet() {
    assert!(IdealImu { gravity_m_s2: 1.62, ..IdealImu::default() }.check().is_err());
    assert!(IdealImu { latitude_rad: Some(f64::NAN), ..IdealImu::default() }.check().is_err());
    assert!(IdealImu::default().check().is_ok());
}
