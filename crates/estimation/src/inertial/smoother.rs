//! Smoothing by the modified Bryson–Frazier recursion.
//!
//! The filter runs forward and keeps what it did; an adjoint vector `λ` and matrix `Λ` then run backward
//! (Bierman 1973, *Fixed interval smoothing with discrete measurements*; Bierman 1977, ch. X):
//!
//! ```text
//! through an update:       λ ← −Hᵀ S⁻¹ v + (I − K H)ᵀ λ        Λ ← Hᵀ S⁻¹ H + (I − K H)ᵀ Λ (I − K H)
//! through a prediction:    λ ← Φᵀ λ                            Λ ← Φᵀ Λ Φ
//! smoothed, before update: x_s = x̂ − P λ                       P_s = P − P Λ P
//! ```
//!
//! Unlike the Rauch–Tung–Striebel form no 18×18 matrix is inverted. Being linear in the error state, it is exact as
//! far as the corrections are small; the filter's own linearisation is of the same order.

use crate::inertial::covariance::{
    ACC_BIAS, ATTITUDE, BLOCKS, Covariance, ErrorVector, GYRO_BIAS, POSITION, STATES, VELOCITY,
};
use crate::inertial::filter::{FilterState, Update};
use crate::inertial::strapdown::Step;
use adit_core::attitude::skew;
use adit_core::nalgebra::{Matrix3, SMatrix, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;

type Dense = SMatrix<f64, STATES, STATES>;

/// What the filter did with one sample: the prediction, then the updates in their order.
#[derive(Debug, Clone)]
pub struct Record {
    /// Time of the sample.
    pub time: Time,
    /// Prediction that led to it.
    pub step: Step,
    /// Predicted state, before the updates.
    pub state: FilterState,
    /// Its covariance.
    pub covariance: Covariance,
    /// Updates, in their order.
    pub corrections: Corrections,
    /// Quality reported by the filter.
    pub quality: Quality,
    /// True when samples are missing before this one: what comes later says nothing of what was before.
    pub after_gap: bool,
}

/// The updates that one sample can bring, in the order in which they are applied.
#[derive(Debug, Clone, Default)]
pub struct Corrections {
    /// Velocity of the contact.
    pub contact: Option<Update<3>>,
    /// Angular rate at rest.
    pub rate: Option<Update<1>>,
    /// Gravity at rest.
    pub gravity: Option<Update<2>>,
    /// Heading of a straight leg.
    pub heading: Option<Update<1>>,
}

/// Adjoint of the error state, running backward in time.
#[derive(Debug, Clone)]
pub struct Adjoint {
    vector: ErrorVector,
    matrix: Dense,
}

impl Default for Adjoint {
    /// At the end of the log nothing is known from later.
    fn default() -> Self {
        Self { vector: [Vector3::zeros(); BLOCKS], matrix: Dense::zeros() }
    }
}

impl Adjoint {
    /// Carries the adjoint back over one sample and returns the smoothed solution of that sample.
    pub fn step_back(&mut self, record: &Record) -> Solution {
        if let Some(update) = &record.corrections.heading {
            self.through_update(update);
        }
        if let Some(update) = &record.corrections.gravity {
            self.through_update(update);
        }
        if let Some(update) = &record.corrections.rate {
            self.through_update(update);
        }
        if let Some(update) = &record.corrections.contact {
            self.through_update(update);
        }
        let solution = self.smoothed(record);
        if record.after_gap {
            *self = Self::default();
        } else {
            self.through_prediction(&record.step);
        }
        solution
    }

    fn through_update<const N: usize>(&mut self, update: &Update<N>) {
        if !update.innovation.accepted {
            return;
        }
        // Kᵀλ + S⁻¹v is what reaches the measured blocks, with the sign of −Hᵀ.
        let pulled = update
            .gain
            .iter()
            .zip(&self.vector)
            .fold(update.inverse * update.innovation.value, |sum, (gain, adjoint)| {
                sum + gain.transpose() * adjoint
            });
        for (block, jacobian) in &update.jacobian {
            self.vector[*block] -= jacobian.transpose() * pulled;
        }

        let mut jacobian = SMatrix::<f64, 3, STATES>::zeros();
        for (block, h) in &update.jacobian {
            jacobian.fixed_view_mut::<3, 3>(0, 3 * block).copy_from(h);
        }
        let mut gain = SMatrix::<f64, STATES, 3>::zeros();
        for (block, k) in update.gain.iter().enumerate() {
            gain.fixed_view_mut::<3, 3>(3 * block, 0).copy_from(k);
        }
        // (I−KH)ᵀ Λ (I−KH) + Hᵀ S⁻¹ H, with rank-3 products only.
        let seen = self.matrix * gain;
        let cross = seen * jacobian;
        let core = gain.transpose() * seen + update.inverse;
        self.matrix += jacobian.transpose() * core * jacobian - cross - cross.transpose();
    }

    fn smoothed(&self, record: &Record) -> Solution {
        let mut correction: ErrorVector = [Vector3::zeros(); BLOCKS];
        for (row, out) in correction.iter_mut().enumerate() {
            for (column, adjoint) in self.vector.iter().enumerate() {
                *out -= record.covariance.block(row, column) * adjoint;
            }
        }
        let mut state = record.state;
        state.correct(&correction);
        let mut solution = state.solution(record.time, &record.covariance, record.quality);

        let covariance = record.covariance.to_matrix();
        let mut rows = SMatrix::<f64, 9, STATES>::zeros();
        for (i, block) in [POSITION, VELOCITY, ATTITUDE].into_iter().enumerate() {
            rows.fixed_rows_mut::<3>(3 * i).copy_from(&covariance.fixed_rows::<3>(3 * block));
        }
        let gained: SolutionCovariance = rows * self.matrix * rows.transpose();
        solution.covariance -= (gained + gained.transpose()) * 0.5;
        solution
    }

    /// `Φᵀ`: every block receives from those it drives.
    fn through_prediction(&mut self, step: &Step) {
        let dt = step.interval_s;
        let bias_gain: Matrix3<f64> = step.rotation * -dt;
        let tilt_gain = skew(&-step.velocity_gained);

        let [attitude, velocity, position, ..] = self.vector;
        self.vector[ATTITUDE] += tilt_gain.transpose() * velocity;
        self.vector[VELOCITY] += position * dt;
        self.vector[GYRO_BIAS] += bias_gain.transpose() * attitude;
        self.vector[ACC_BIAS] += bias_gain.transpose() * velocity;

        let mut transition = Dense::identity();
        transition.fixed_view_mut::<3, 3>(3 * ATTITUDE, 3 * GYRO_BIAS).copy_from(&bias_gain);
        transition.fixed_view_mut::<3, 3>(3 * VELOCITY, 3 * ATTITUDE).copy_from(&tilt_gain);
        transition.fixed_view_mut::<3, 3>(3 * VELOCITY, 3 * ACC_BIAS).copy_from(&bias_gain);
        transition.fixed_view_mut::<3, 3>(3 * POSITION, 3 * VELOCITY).copy_from(&(Matrix3::identity() * dt));
        self.matrix = transition.transpose() * self.matrix * transition;
    }
}
