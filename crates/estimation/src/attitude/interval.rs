//! Sums over one interval between corrections: the work of every sample.

use crate::attitude::state::AttitudeState;
use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// What the samples of an interval say together, in the almost-inertial frame.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Interval {
    /// Length, s.
    pub length_s: f64,
    /// Number of inertial samples.
    pub samples: u32,
    /// `∫ R dt`: what a gyro bias turns, and an accelerometer bias accelerates, s.
    pub rotation_s: Matrix3<f64>,
    /// `∫ R diag(ω) dt`: what a scale factor turns, rad.
    pub turned_rad: Matrix3<f64>,
    /// `∫ R f dt`: specific force, m/s.
    pub force_m_s: Vector3<f64>,
    /// `∫ |ω|² dt`, rad²/s.
    pub rate_squared_rad2_s: f64,
    /// Sums of the readings and of their squares, for the detection of rest.
    pub rate_sum: Vector3<f64>,
    /// Σ |ω|².
    pub rate_squared_sum: f64,
    /// Σ f.
    pub specific_force_sum: Vector3<f64>,
    /// Σ |f|².
    pub specific_force_squared_sum: f64,
    /// Number of magnetometer samples.
    pub fields: u32,
    /// Σ of the field, turned into ENU, µT.
    pub field_sum: Vector3<f64>,
    /// Σ of the rotations that did so.
    pub field_rotation_sum: Matrix3<f64>,
    /// Σ of the derivative of the turned field by the delay, µT/s.
    pub field_delay_sum: Vector3<f64>,
}

impl Interval {
    /// Propagates the attitude over one inertial sample and adds it.
    #[inline]
    pub fn add_inertial(
        &mut self,
        state: &mut AttitudeState,
        reading_rad_s: &Vector3<f64>,
        specific_force_m_s2: &Vector3<f64>,
        interval_s: f64,
    ) {
        let rate = state.rate_rad_s(reading_rad_s);
        let turn = rate * interval_s;
        state.attitude = attitude::turn_body(&state.attitude, &turn);
        let rotation = state.attitude.to_rotation_matrix().into_inner();

        // Samples are means over the interval: the force belongs to its middle, half a turn back.
        let force = specific_force_m_s2 - state.acc_bias_m_s2;
        let force = rotation * (force - turn.cross(&force) * 0.5);
        self.force_m_s += force * interval_s;
        self.rotation_s += rotation * interval_s;
        for axis in 0..3 {
            let change = rotation.column(axis) * (reading_rad_s[axis] * interval_s);
            let mut column = self.turned_rad.column_mut(axis);
            column += change;
        }
        let rate_squared = reading_rad_s.norm_squared();
        self.rate_squared_rad2_s += rate_squared * interval_s;
        self.rate_sum += reading_rad_s;
        self.rate_squared_sum += rate_squared;
        self.specific_force_sum += specific_force_m_s2;
        self.specific_force_squared_sum += specific_force_m_s2.norm_squared();
        self.samples += 1;
        self.length_s += interval_s;
    }

    /// Adds one magnetometer sample, taken `lead_s` after the attitude of the state, with the body turning at `rate_rad_s`.
    #[inline]
    pub fn add_magnetic(
        &mut self,
        state: &AttitudeState,
        rate_rad_s: &Vector3<f64>,
        reading_ut: &Vector3<f64>,
        lead_s: f64,
    ) {
        let back = rate_rad_s * (lead_s - state.delay_s);
        let rotation = (state.attitude * attitude::exp(&back)).to_rotation_matrix().into_inner();
        let field = reading_ut - state.offset_ut;
        self.field_sum += rotation * field;
        self.field_rotation_sum += rotation;
        self.field_delay_sum += rotation * rate_rad_s.cross(&field);
        self.fields += 1;
    }

    /// Mean rate, rad/s, and its spread (root mean square deviation, all axes).
    pub fn mean_rate(&self) -> (Vector3<f64>, f64) {
        spread(&self.rate_sum, self.rate_squared_sum, self.samples)
    }

    /// Mean specific force, m/s², and its spread.
    pub fn mean_force(&self) -> (Vector3<f64>, f64) {
        spread(&self.specific_force_sum, self.specific_force_squared_sum, self.samples)
    }
}

fn spread(sum: &Vector3<f64>, squared: f64, count: u32) -> (Vector3<f64>, f64) {
    let count = f64::from(count.max(1));
    let mean = sum / count;
    (mean, libm::sqrt((squared / count - mean.norm_squared()).max(0.0)))
}
