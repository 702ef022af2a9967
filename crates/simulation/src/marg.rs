//! IMU and magnetometer together: one stream of samples in order of time.
//!
//! The magnetometer runs at its own rate: sample `k` is stamped `k/rate` (`k = 1, 2, …`), plus jitter, and holds the mean
//! of the field in body axes over the integration time that ended `latency` earlier, at the place where the sensor was
//! then. Samples come in order of their **stamps**; at equal stamps the IMU comes first, as in a row of a CSV log.

use crate::emission::Emission;
use crate::error::SimulationError;
use crate::ideal_imu::quadrature;
use crate::imu_errors::ImuErrorModel;
use crate::magnetic::MagneticWorld;
use crate::magnetometer::{Magnetometer, MagnetometerModel};
use crate::motion::Motion;
use crate::radio::delivery::Stamped;
use crate::scenario::{FootWalkScenario, Generator, generate};
use adit_core::attitude::Attitude;
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_observation::MagneticSample;

/// Truth at the end of a magnetic sample's integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MagneticTruth {
    /// True time at which the integration ended: the stamp less latency and jitter.
    pub time: Time,
    /// Position of the sensor, ENU, m.
    pub position_m: Vector3<f64>,
    /// Sensor to ENU.
    pub attitude: Attitude,
    /// The whole field there, ENU, µT.
    pub field_ut: Vector3<f64>,
    /// What steel and currents add to the Earth's field there, ENU, µT.
    pub disturbance_ut: Vector3<f64>,
}

/// Samples of IMU and magnetometer on a walking foot; [`generate`] with a magnetometer. The IMU's samples are the same.
///
/// ```
/// use adit_simulation::{
///     EarthField, Emission, FootWalkScenario, ImuErrorModel, MagneticWorld, MagnetometerModel, generate_marg,
/// };
/// # fn main() -> Result<(), adit_simulation::SimulationError> {
/// let (walk, world) = (FootWalkScenario::straight(10.0), MagneticWorld::undisturbed(EarthField::harbin()));
/// let (imu, mag) = (ImuErrorModel::xsens_mti_g(), MagnetometerModel::xsens_mti_g());
/// let norms = generate_marg(&walk, &imu, &world, &mag, 1)?.filter_map(|emission| match emission {
///     Emission::Magnetic(sample, _) => Some(sample.field_ut.norm()),
///     _ => None,
/// });
/// assert!(norms.into_iter().all(|norm| (norm - 55.3).abs() < 5.0));
/// # Ok(())
/// # }
/// ```
pub fn generate_marg(
    scenario: &FootWalkScenario,
    errors: &ImuErrorModel,
    world: &MagneticWorld,
    model: &MagnetometerModel,
    seed: u64,
) -> Result<MargGenerator, SimulationError> {
    generate(scenario, errors, seed)?.with_magnetometer(world.clone(), model, seed)
}

impl<M: Motion> Generator<M> {
    /// Adds a magnetometer to this IMU; `seed` fixes its errors (`ChaCha8`, stream 2).
    pub fn with_magnetometer(
        self,
        world: MagneticWorld,
        model: &MagnetometerModel,
        seed: u64,
    ) -> Result<MargGenerator<M>, SimulationError> {
        world.check()?;
        Ok(MargGenerator {
            imu: self,
            world,
            model: *model,
            errors: Magnetometer::new(model, seed)?,
            count: 0,
            before: Time::ZERO,
            next_imu: None,
            next_magnetic: None,
        })
    }
}

/// Iterator of [`generate_marg`]; bounded memory.
#[derive(Debug, Clone)]
pub struct MargGenerator<M = crate::FootWalk> {
    imu: Generator<M>,
    world: MagneticWorld,
    model: MagnetometerModel,
    errors: Magnetometer,
    count: u64,
    before: Time,
    next_imu: Option<Emission>,
    next_magnetic: Option<Emission>,
}

impl<M: Motion> MargGenerator<M> {
    /// The IMU and the motion under way; it may be one sample ahead.
    pub fn imu(&self) -> &Generator<M> {
        &self.imu
    }

    /// The magnetometer as drawn for this run.
    pub fn magnetometer(&self) -> &Magnetometer {
        &self.errors
    }

    fn magnetic(&mut self) -> Option<Emission> {
        let time = Time::from_seconds((self.count + 1) as f64 / self.model.rate_hz)?;
        let motion = self.imu.motion();
        if time.seconds() > motion.duration_s() {
            return None;
        }
        let end_s = time.seconds() - self.model.latency_s;
        let in_body = |time_s: f64| {
            let state = motion.at(time_s);
            state.attitude.inverse_transform_vector(&self.world.field_ut(&state.position_m, time_s))
        };
        let field_ut = if self.model.integration_s > 0.0 {
            quadrature(end_s - self.model.integration_s, end_s)
                .fold(Vector3::zeros(), |sum, (time_s, weight)| sum + in_body(time_s) * weight)
        } else {
            in_body(end_s)
        };
        let state = motion.at(end_s);
        let disturbance_ut = self.world.disturbance_ut(&state.position_m, end_s);
        let truth = MagneticTruth {
            time: Time::from_seconds(end_s)?,
            position_m: state.position_m,
            attitude: state.attitude,
            field_ut: self.world.earth.enu_ut() + disturbance_ut,
            disturbance_ut,
        };
        let span_s = (time - self.before).seconds();
        let field_ut = self.errors.apply(&field_ut, span_s);
        let jitter = Interval::from_seconds(self.errors.jitter_s(span_s)).unwrap_or(Interval::ZERO);
        self.count += 1;
        self.before = time;
        Some(Emission::Magnetic(MagneticSample { time: time + jitter, field_ut }, truth))
    }
}

impl<M: Motion> Iterator for MargGenerator<M> {
    type Item = Emission;

    fn next(&mut self) -> Option<Emission> {
        if self.next_imu.is_none() {
            self.next_imu = self.imu.next().map(|(sample, truth)| Emission::Imu(sample, truth));
        }
        if self.next_magnetic.is_none() {
            self.next_magnetic = self.magnetic();
        }
        let imu_first = match (&self.next_imu, &self.next_magnetic) {
            (Some(imu), Some(magnetic)) => imu.time() <= magnetic.time(),
            (imu, _) => imu.is_some(),
        };
        if imu_first { self.next_imu.take() } else { self.next_magnetic.take() }
    }
}
