//! Error-state Kalman filter around the strapdown: predict, update, feed back.

use crate::inertial::covariance::{
    ACC_BIAS, ATTITUDE, CONTACT, Covariance, ErrorVector, GYRO_BIAS, POSITION, ProcessNoise, VELOCITY,
};
use crate::inertial::strapdown::{Increment, NavigationState, Step};
use crate::kalman::{Derivative, Innovation, MeasurementModel};
use crate::settings::{first_unusable, not_negative, positive};
use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_observation::{ImuSample, ImuSpecification};
use serde::{Deserialize, Serialize};

/// Everything that the filter estimates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FilterState {
    /// Attitude, velocity, position, biases.
    pub navigation: NavigationState,
    /// Lever from the point of contact to the sensor, m, body.
    pub contact_m: Vector3<f64>,
}

impl FilterState {
    /// Adds an error vector (truth minus estimate) to the estimate.
    #[inline]
    pub fn correct(&mut self, error: &ErrorVector) {
        let n = &mut self.navigation;
        n.attitude = attitude::turn_navigation(&n.attitude, &error[ATTITUDE]);
        n.velocity_m_s += error[VELOCITY];
        n.position_m += error[POSITION];
        n.gyro_bias_rad_s += error[GYRO_BIAS];
        n.acc_bias_m_s2 += error[ACC_BIAS];
        self.contact_m += error[CONTACT];
    }

    /// Solution with the part of the covariance that belongs to it.
    #[inline]
    pub fn solution(&self, time: Time, covariance: &Covariance, quality: Quality) -> Solution {
        const ORDER: [usize; 3] = [POSITION, VELOCITY, ATTITUDE];
        // Filled in place, element by element: a copy of the finished matrix would wait for every store before it.
        Solution {
            time,
            position_m: self.navigation.position_m,
            velocity_m_s: self.navigation.velocity_m_s,
            attitude: self.navigation.attitude,
            covariance: SolutionCovariance::from_fn(|row, column| {
                covariance.element(ORDER[row / 3], row % 3, ORDER[column / 3], column % 3)
            }),
            quality,
        }
    }
}

/// Error-state filter: the state, its covariance, and the previous increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InertialFilter {
    /// Estimate.
    pub state: FilterState,
    /// Covariance of its error.
    pub covariance: Covariance,
    last: Increment,
    gravity_m_s2: f64,
}

impl InertialFilter {
    /// Starts from a state and the covariance of its error.
    pub fn new(state: FilterState, covariance: Covariance, gravity_m_s2: f64) -> Self {
        Self { state, covariance, last: Increment::default(), gravity_m_s2 }
    }

    /// Carries state and covariance over one sampling interval.
    #[inline]
    pub fn predict(&mut self, imu: &ImuSample, interval_s: f64, noise: &SensorNoise) -> Step {
        let increment = self.state.navigation.increment(imu, interval_s);
        let step = self.state.navigation.propagate(&increment, &self.last, interval_s, self.gravity_m_s2);
        self.last = increment;
        self.covariance.propagate(&step, &noise.over(imu, &step, self.gravity_m_s2));
        step
    }

    /// Updates with a measurement whose normalised innovation squared is at most `gate`; reports it either way.
    ///
    /// What the smoother needs goes to `record`; a recorder that keeps nothing costs nothing.
    /// `None` when the innovation covariance cannot be inverted: the measurement is then left out.
    #[inline]
    pub fn update<const N: usize>(
        &mut self,
        model: &impl MeasurementModel<FilterState, N>,
        gate: f64,
        record: impl FnOnce(Update<N>),
    ) -> Option<Innovation> {
        let measurement = model.linearise(&self.state);
        let (mut innovation, gain) = self.covariance.innovation(&measurement)?;
        innovation.accepted = innovation.nis <= gate;
        if innovation.accepted {
            let correction = self.covariance.update(&innovation, &gain);
            self.state.correct(&correction);
        }
        let jacobian = measurement.jacobian;
        record(Update { innovation, jacobian, gain: gain.gain, inverse: gain.inverse });
        Some(innovation)
    }
}

/// One measurement as the smoother needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct Update<const N: usize> {
    /// Residual, its covariance, and whether it was used.
    pub innovation: Innovation,
    /// `H` in blocks.
    pub jacobian: [(usize, Derivative); N],
    /// `K` in blocks.
    pub gain: [Matrix3<f64>; crate::inertial::covariance::BLOCKS],
    /// `S⁻¹`.
    pub inverse: Matrix3<f64>,
}

/// Noise of an IMU on a moving body.
///
/// A data sheet gives white noise at rest. On a foot the larger part comes from scale factor, misalignment,
/// bandwidth and g-sensitivity, all of which grow with what is measured; they enter as white noise whose density is a
/// share of the rate and of the specific force beyond gravity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorNoise {
    /// Angle random walk at rest, rad/√s.
    pub angle_random_walk_rad_sqrt_s: f64,
    /// Gyro error that grows with the rate, √s: density = share × |ω|.
    pub rate_share_sqrt_s: f64,
    /// Velocity random walk at rest, (m/s)/√s.
    pub velocity_random_walk_m_s_sqrt_s: f64,
    /// Accelerometer error that grows with the force, √s: density = share × | |f| − g |.
    pub force_share_sqrt_s: f64,
    /// Gyro bias random walk, (rad/s)/√s.
    pub gyro_bias_walk_rad_s_sqrt_s: f64,
    /// Accelerometer bias random walk, (m/s²)/√s.
    pub acc_bias_walk_m_s2_sqrt_s: f64,
    /// Full scale of the gyro, rad/s: beyond it the reading is taken as clipped.
    pub gyro_range_rad_s: f64,
    /// Density of the rate error on a clipped axis, rad/√s.
    pub clipped_rate_rad_sqrt_s: f64,
}

impl SensorNoise {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("noise.angle_random_walk_rad_sqrt_s", not_negative(self.angle_random_walk_rad_sqrt_s)),
            ("noise.rate_share_sqrt_s", not_negative(self.rate_share_sqrt_s)),
            ("noise.velocity_random_walk_m_s_sqrt_s", not_negative(self.velocity_random_walk_m_s_sqrt_s)),
            ("noise.force_share_sqrt_s", not_negative(self.force_share_sqrt_s)),
            ("noise.gyro_bias_walk_rad_s_sqrt_s", not_negative(self.gyro_bias_walk_rad_s_sqrt_s)),
            ("noise.acc_bias_walk_m_s2_sqrt_s", not_negative(self.acc_bias_walk_m_s2_sqrt_s)),
            ("noise.gyro_range_rad_s", positive(self.gyro_range_rad_s)),
            ("noise.clipped_rate_rad_sqrt_s", not_negative(self.clipped_rate_rad_sqrt_s)),
        ])
    }

    /// These errors with the noise at rest of a particular sensor.
    #[must_use]
    pub fn with_specification(mut self, specification: &ImuSpecification) -> Self {
        self.angle_random_walk_rad_sqrt_s = specification.angle_random_walk_rad_sqrt_s;
        self.velocity_random_walk_m_s_sqrt_s = specification.velocity_random_walk_m_s_sqrt_s;
        self.gyro_bias_walk_rad_s_sqrt_s = specification.gyro_bias_walk_rad_s_sqrt_s;
        self.acc_bias_walk_m_s2_sqrt_s = specification.acc_bias_walk_m_s2_sqrt_s;
        self
    }

    #[inline]
    pub(super) fn over(&self, imu: &ImuSample, step: &Step, gravity_m_s2: f64) -> ProcessNoise {
        let dt = step.interval_s;
        let square = |x: f64| x * x;
        let rate_variance = square(self.angle_random_walk_rad_sqrt_s)
            + square(self.rate_share_sqrt_s) * imu.angular_rate_rad_s.norm_squared();
        let mut attitude = Matrix3::identity() * (rate_variance * dt);
        for (axis, rate) in imu.angular_rate_rad_s.iter().enumerate() {
            if rate.abs() > self.gyro_range_rad_s {
                let direction = step.rotation.column(axis);
                attitude += direction * direction.transpose() * (square(self.clipped_rate_rad_sqrt_s) * dt);
            }
        }
        let excess = libm::sqrt(imu.specific_force_m_s2.norm_squared()) - gravity_m_s2;
        ProcessNoise {
            attitude,
            velocity: (square(self.velocity_random_walk_m_s_sqrt_s)
                + square(self.force_share_sqrt_s * excess))
                * dt,
            gyro_bias: square(self.gyro_bias_walk_rad_s_sqrt_s) * dt,
            acc_bias: square(self.acc_bias_walk_m_s2_sqrt_s) * dt,
        }
    }
}

impl Default for SensorNoise {
    /// Found on recorded and simulated walks together (`docs/log.md`): larger than any data sheet, since the foot's
    /// own motion, not the sensor at rest, sets the errors.
    fn default() -> Self {
        Self {
            angle_random_walk_rad_sqrt_s: 6e-3,
            rate_share_sqrt_s: 3e-4,
            velocity_random_walk_m_s_sqrt_s: 7.5e-3,
            force_share_sqrt_s: 1.5e-3,
            gyro_bias_walk_rad_s_sqrt_s: 1e-5,
            acc_bias_walk_m_s2_sqrt_s: 1.6e-4,
            // ±500 °/s, the commonest full scale of foot-worn gyros.
            gyro_range_rad_s: 8.7266,
            clipped_rate_rad_sqrt_s: 1.8,
        }
    }
}
