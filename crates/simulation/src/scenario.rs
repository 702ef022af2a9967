//! Scenarios: a walk, a place, a rate; and the stream of samples and truth that they give.
//!
//! Random draws come from `ChaCha8` seeded by the caller's `u64`: stream 0 for the IMU errors (order in
//! [`crate::imu_errors`]), stream 1 for the variation of the walk (length at each inner footprint of a leg, then
//! time and vigour of each stride), stream 2 for the magnetometer ([`crate::magnetometer`]). The same walk can therefore be had with other sensors and the same seed.

use crate::error::{SimulationError, check_within};
use crate::foot_motion::FootWalk;
use crate::gait::{Foot, Gait};
use crate::ideal_imu::IdealImu;
use crate::imu_errors::{ImuErrorModel, ImuErrors};
use crate::motion::{Motion, MotionState};
use crate::walk_plan::{Leg, WalkPlan};
use adit_core::attitude::Attitude;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::ImuSample;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use serde::{Deserialize, Serialize};

/// Everything about a walk but the errors of the sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FootWalkScenario {
    /// Where the walk goes, and how.
    pub plan: WalkPlan,
    /// Where the sensor sits on the foot.
    pub foot: Foot,
    /// Gravity, latitude, sampling.
    pub imu: IdealImu,
    /// Samples per second.
    pub rate_hz: f64,
}

/// Truth at the end of a sample's interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TruthState {
    /// True time, free of the jitter of the stamp.
    pub time: Time,
    /// Position of the sensor, ENU, origin at the sensor in the first stance, m.
    pub position_m: Vector3<f64>,
    /// Velocity, ENU, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Sensor to ENU.
    pub attitude: Attitude,
    /// Gyro bias, sensor axes, rad/s.
    pub gyro_bias_rad_s: Vector3<f64>,
    /// Accelerometer bias, sensor axes, m/s².
    pub acc_bias_m_s2: Vector3<f64>,
    /// The foot is flat on the floor.
    pub stance: bool,
}

impl FootWalkScenario {
    /// A plan walked with the sensor on the instep at 200 Hz.
    pub fn new(gait: Gait, heading_rad: f64, legs: Vec<Leg>) -> Self {
        Self {
            plan: WalkPlan { gait, heading_rad, legs },
            foot: Foot::instep(),
            imu: IdealImu::default(),
            rate_hz: 200.0,
        }
    }

    /// The walk of spec S2, in 52 m × 7.2 m: once around a ring platform back to the start, then along the roadway
    /// to its end and back with three stops: 119 m in 2 ½ minutes, ending at the start.
    pub fn demo_walk() -> Self {
        let stand = |seconds| Leg::Stand { seconds };
        let straight = |length_m| Leg::Straight { length_m };
        Self::new(
            Gait::walk(),
            // East, along the roadway.
            FRAC_PI_2,
            vec![
                stand(5.0),
                Leg::Arc { radius_m: 3.6, turn_rad: TAU },
                stand(3.0),
                straight(20.0),
                stand(10.0),
                straight(15.0),
                Leg::Gait(Gait::slow()),
                straight(13.4),
                stand(8.0),
                Leg::Turn { turn_rad: PI },
                stand(1.0),
                Leg::Gait(Gait::walk()),
                straight(28.4),
                stand(5.0),
                straight(20.0),
                Leg::Turn { turn_rad: PI },
                stand(4.0),
            ],
        )
    }

    /// The walk of spec S3 on a basketball court of 28 m × 15 m: once around 26 m × 14 m, anticlockwise from its
    /// south-west corner, 80 m, standing for most of 15 minutes; a sensor at 100 Hz at 45.776° N.
    pub fn court_walk() -> Self {
        let stand = |seconds| Leg::Stand { seconds };
        let mut legs = vec![stand(60.0)];
        for (half_side_m, last) in [(13.0, false), (7.0, false), (13.0, false), (7.0, true)] {
            let half_side = Leg::Straight { length_m: half_side_m };
            let corner = [Leg::Turn { turn_rad: -FRAC_PI_2 }, stand(if last { 80.0 } else { 90.0 })];
            legs.extend([half_side, stand(90.0), half_side]);
            legs.extend(corner);
        }
        let walk = Self::new(Gait::slow(), FRAC_PI_2, legs);
        let imu = IdealImu { latitude_rad: Some(45.776_f64.to_radians()), ..walk.imu };
        Self { imu, rate_hz: 100.0, ..walk }
    }

    /// Straight east for `length_m`, with a rest before and after.
    pub fn straight(length_m: f64) -> Self {
        Self::new(
            Gait::walk(),
            FRAC_PI_2,
            vec![Leg::Stand { seconds: 3.0 }, Leg::Straight { length_m }, Leg::Stand { seconds: 3.0 }],
        )
    }

    /// `rounds` of a 20 m × 8 m rectangle with rounded corners, always to the right, ending at the start.
    pub fn loops(rounds: u32) -> Self {
        let corner = Leg::Arc { radius_m: 1.0, turn_rad: FRAC_PI_2 };
        let mut legs = vec![Leg::Stand { seconds: 3.0 }];
        for _ in 0..rounds {
            for length_m in [18.0, 6.0, 18.0, 6.0] {
                legs.extend([Leg::Straight { length_m }, corner]);
            }
        }
        legs.push(Leg::Stand { seconds: 3.0 });
        Self::new(Gait::walk(), FRAC_PI_2, legs)
    }

    /// The walk itself, as varied by `seed`.
    pub fn walk(&self, seed: u64) -> Result<FootWalk, SimulationError> {
        FootWalk::new(&self.plan, self.foot, seed)
    }
}

/// Samples and truth of `scenario`, one after the other, from the first interval to the end of the walk.
///
/// ```
/// use adit_simulation::{FootWalkScenario, ImuErrorModel, generate};
/// # fn main() -> Result<(), adit_simulation::SimulationError> {
/// let scenario = FootWalkScenario::straight(10.0);
/// for (sample, truth) in generate(&scenario, &ImuErrorModel::adis16448(), 1)? {
///     assert!((sample.time - truth.time).seconds().abs() < 1e-3);
/// }
/// # Ok(())
/// # }
/// ```
pub fn generate(
    scenario: &FootWalkScenario,
    errors: &ImuErrorModel,
    seed: u64,
) -> Result<Generator, SimulationError> {
    Generator::new(scenario.walk(seed)?, scenario.imu, scenario.rate_hz, errors, seed)
}

/// Iterator of [`generate`], for any motion; holds the motion and the state of the errors, nothing that grows.
#[derive(Debug, Clone)]
pub struct Generator<M = FootWalk> {
    motion: M,
    imu: IdealImu,
    errors: ImuErrors,
    rate_hz: f64,
    count: u64,
    before: Time,
}

impl<M: Motion> Generator<M> {
    /// An IMU on a motion, read `rate_hz` times a second; `seed` fixes its errors.
    pub fn new(
        motion: M,
        imu: IdealImu,
        rate_hz: f64,
        errors: &ImuErrorModel,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        check_within("rate_hz", rate_hz, 10.0, 10_000.0, "10 to 10000 Hz")?;
        imu.check()?;
        let errors = ImuErrors::new(errors, seed)?;
        Ok(Self { motion, imu, errors, rate_hz, count: 0, before: Time::ZERO })
    }

    /// The motion under way.
    pub fn motion(&self) -> &M {
        &self.motion
    }

    /// Truth at the end of the last interval; before the first sample, at time 0 with the biases as turned on.
    pub fn truth(&self) -> TruthState {
        let MotionState { position_m, velocity_m_s, attitude, stance, .. } =
            self.motion.at(self.before.seconds());
        TruthState {
            time: self.before,
            position_m,
            velocity_m_s,
            attitude,
            gyro_bias_rad_s: self.errors.gyro_bias_rad_s(),
            acc_bias_m_s2: self.errors.acc_bias_m_s2(),
            stance,
        }
    }
}

impl Generator {
    /// The walk under way.
    pub fn walk(&self) -> &FootWalk {
        &self.motion
    }
}

impl<M: Motion> Iterator for Generator<M> {
    type Item = (ImuSample, TruthState);

    fn next(&mut self) -> Option<Self::Item> {
        let time = Time::from_seconds((self.count + 1) as f64 / self.rate_hz)?;
        if time.seconds() > self.motion.duration_s() {
            return None;
        }
        let ideal = self.imu.sample(&self.motion, self.before.seconds(), time.seconds());
        let sample = self.errors.apply(&ideal, time, time - self.before);
        self.count += 1;
        self.before = time;
        Some((sample, self.truth()))
    }
}
