//! What the error-quaternion filter observes: the reference attitude `q(ε)`, and the velocity of a standing foot.

use crate::inertial::covariance::{ACC_BIAS, ATTITUDE};
use crate::inertial::error_quaternion::{HARD_IRON, wxyz, xi_navigation};
use crate::inertial::filter::FilterState;
use crate::kalman::{Derivative, Linearised, MeasurementModel};
use crate::pedestrian::zero_velocity::ContactVelocity;
use adit_core::attitude::{self, Attitude, skew};
use adit_core::nalgebra::{Matrix3, Vector3};

/// Attitudes further apart (`cos(θ/2)`, 157°) are taken as this far.
const LEAST_COSINE: f64 = 0.2;

/// Velocity of a standing foot, [`ContactVelocity`], blind to a turn of everything about the vertical.
///
/// Of the two velocities that ought to be equal, that of the state and that of the rolling foot, it is the first that the
/// attitude error turns in the derivative: with the second, their difference would pass for knowledge of the heading.
#[derive(Debug, Clone, Copy)]
pub struct HeldContact(
    /// The measurement.
    pub ContactVelocity,
);

impl MeasurementModel<FilterState, 3> for HeldContact {
    fn linearise(&self, state: &FilterState) -> Linearised<3> {
        let Linearised { residual, jacobian: [_, velocity, contact], noise } = self.0.linearise(state);
        let attitude = (ATTITUDE, Derivative::Matrix(skew(&state.navigation.velocity_m_s)));
        Linearised { residual, jacobian: [attitude, velocity, contact], noise }
    }
}

/// The observation of S3: the gyro's quaternion `q(ω)` against `q(ε)`, the one of accelerometer and magnetometer.
///
/// Of the points on the ray of `q(ε)` the one in the tangent of `q(ω)` is taken, `q(ε)/(q(ω)·q(ε))`: normalising leads from it
/// to `q(ε)` itself, however large the difference, and sign does not matter. To first order it is `q(ε) − q(ω)`.
/// Either part of `q(ε)` may be missing: tilt while the sensor accelerates, heading while the field is disturbed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceAttitude {
    /// `q(ε)`.
    pub attitude: Attitude,
    /// Gravity at the site, m/s².
    pub gravity_m_s2: f64,
    /// Standard deviation of its tilt, rad; `None` when there is none.
    pub tilt_sigma_rad: Option<f64>,
    /// Standard deviation of its heading, rad; `None` when there is none.
    pub heading_sigma_rad: Option<f64>,
    /// Derivative of its heading (counter-clockwise, as `φ`) by the hard iron, rad/µT, body.
    pub heading_by_iron: Vector3<f64>,
}

impl MeasurementModel<FilterState, 3> for ReferenceAttitude {
    fn linearise(&self, state: &FilterState) -> Linearised<3> {
        let estimate = &state.navigation.attitude;
        // q and −q are one attitude: of the two differences only the shorter is an error.
        let (gyro, reference) = (wxyz(estimate), wxyz(&self.attitude));
        let cosine = gyro.dot(&reference);
        let difference = reference
            / if cosine < 0.0 { cosine.min(-LEAST_COSINE) } else { cosine.max(LEAST_COSINE) }
            - gyro;
        let angle = xi_navigation(estimate).transpose() * difference * 2.0;
        let used = |sigma: Option<f64>| f64::from(u8::from(sigma.is_some()));
        let (tilt, heading) = (used(self.tilt_sigma_rad), used(self.heading_sigma_rad));
        let used = Vector3::new(tilt, tilt, heading);
        // The bias tilts the measured vertical: up × z = φ_level − z × (C δb)/g.
        let rotation = estimate.to_rotation_matrix().into_inner();
        let by_bias = skew(&Vector3::z()) * rotation * (-tilt / self.gravity_m_s2);
        let by_iron = Vector3::z() * self.heading_by_iron.transpose() * heading;
        // A row of zeros with any noise carries no information.
        let variance = |sigma: Option<f64>| sigma.map_or(1.0, |sigma| sigma * sigma);
        let (tilt, heading) = (variance(self.tilt_sigma_rad), variance(self.heading_sigma_rad));
        Linearised {
            residual: angle.component_mul(&used),
            jacobian: [
                (ATTITUDE, Derivative::Matrix(Matrix3::from_diagonal(&used))),
                (ACC_BIAS, Derivative::Matrix(by_bias)),
                (HARD_IRON, Derivative::Matrix(by_iron)),
            ],
            noise: Matrix3::from_diagonal(&Vector3::new(tilt, tilt, heading)),
        }
    }
}

/// `q(ε)` near an estimate: its tilt turned so that the specific force points up, and its heading by `heading_offset_rad`
/// clockwise. `None` parts are those of the estimate.
pub fn reference_attitude(
    estimate: &Attitude,
    specific_force: Option<&Vector3<f64>>,
    heading_offset_rad: Option<f64>,
) -> Attitude {
    let levelled = specific_force.map_or(*estimate, |force| {
        let up = estimate * force;
        // Rotation that takes `up` to the vertical: axis up × z, angle from atan2 (no division by a small sine).
        let axis = up.cross(&Vector3::z());
        let sine = libm::sqrt(axis.norm_squared());
        let angle = libm::atan2(sine, up.z);
        let axis = axis.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::zeros);
        attitude::turn_navigation(estimate, &(axis * angle))
    });
    match heading_offset_rad {
        Some(offset) => attitude::turn_navigation(&levelled, &Vector3::new(0.0, 0.0, -offset)),
        None => levelled,
    }
}
