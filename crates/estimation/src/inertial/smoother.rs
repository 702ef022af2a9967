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
    ACC_BIAS, ATTITUDE, BLOCKS, Covariance, ErrorVector, GYRO_BIAS, POSITION, Transition, VELOCITY,
};
use crate::inertial::filter::{FilterState, Update};
use crate::inertial::strapdown::Step;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;

type Blocks = [[Matrix3<f64>; BLOCKS]; BLOCKS];

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

/// Takes what the updates did, for a smoother; the unit type keeps nothing.
pub trait Recorder {
    /// Takes an update with the velocity of the contact.
    fn contact(&mut self, _update: Update<3>) {}
    /// Takes an update with the angular rate at rest.
    fn rate(&mut self, _update: Update<1>) {}
    /// Takes an update with gravity at rest.
    fn gravity(&mut self, _update: Update<2>) {}
    /// Takes an update with the heading of a straight leg.
    fn heading(&mut self, _update: Update<1>) {}
}

impl Recorder for () {}

impl Recorder for Corrections {
    fn contact(&mut self, update: Update<3>) {
        self.contact = Some(update);
    }

    fn rate(&mut self, update: Update<1>) {
        self.rate = Some(update);
    }

    fn gravity(&mut self, update: Update<2>) {
        self.gravity = Some(update);
    }

    fn heading(&mut self, update: Update<1>) {
        self.heading = Some(update);
    }
}

/// Adjoint of the error state, running backward in time.
#[derive(Debug, Clone)]
pub struct Adjoint {
    vector: ErrorVector,
    /// Symmetric, in 3×3 blocks, both halves kept.
    matrix: Blocks,
}

impl Default for Adjoint {
    /// At the end of the log nothing is known from later.
    fn default() -> Self {
        Self { vector: [Vector3::zeros(); BLOCKS], matrix: [[Matrix3::zeros(); BLOCKS]; BLOCKS] }
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
        let jacobian = update.jacobian.map(|(block, derivative)| (block, derivative.matrix()));
        for (block, jacobian) in &jacobian {
            self.vector[*block] -= jacobian.transpose() * pulled;
        }

        // (I−KH)ᵀ Λ (I−KH) + Hᵀ S⁻¹ H: only the rows and columns of the measured blocks change.
        let seen: [Matrix3<f64>; BLOCKS] =
            core::array::from_fn(|row| sum(|k| self.matrix[row][k] * update.gain[k]));
        let inner = sum(|k| update.gain[k].transpose() * seen[k]) + update.inverse;
        for (block, jacobian) in &jacobian {
            for (row, seen) in seen.iter().enumerate() {
                let cross = seen * jacobian;
                self.matrix[row][*block] -= cross;
                self.matrix[*block][row] -= cross.transpose();
            }
        }
        for (row, left) in &jacobian {
            for (column, right) in &jacobian {
                self.matrix[*row][*column] += left.transpose() * inner * right;
            }
        }
        self.symmetrise();
    }

    /// The update above is right only for a symmetric matrix: rounding that is not would double at every update.
    fn symmetrise(&mut self) {
        for row in 0..BLOCKS {
            for column in row..BLOCKS {
                let mean = (self.matrix[row][column] + self.matrix[column][row].transpose()) * 0.5;
                self.matrix[row][column] = mean;
                self.matrix[column][row] = mean.transpose();
            }
        }
    }

    /// `x̂ − P λ` and `P − P Λ P`, the latter for what a solution reports.
    fn smoothed(&self, record: &Record) -> Solution {
        const REPORTED: [usize; 3] = [POSITION, VELOCITY, ATTITUDE];
        let p = |row, column| record.covariance.block(row, column);
        let correction: ErrorVector = core::array::from_fn(|row| {
            self.vector
                .iter()
                .enumerate()
                .fold(Vector3::zeros(), |sum, (k, adjoint)| sum - p(row, k) * adjoint)
        });
        let mut state = record.state;
        state.correct(&correction);
        let mut solution = state.solution(record.time, &record.covariance, record.quality);
        for (i, row) in REPORTED.into_iter().enumerate() {
            let gain: [Matrix3<f64>; BLOCKS] =
                core::array::from_fn(|column| sum(|k| p(row, k) * self.matrix[k][column]));
            for (j, column) in REPORTED.into_iter().enumerate().skip(i) {
                let gained = sum(|k| gain[k] * p(k, column));
                let gained = if i == j { (gained + gained.transpose()) * 0.5 } else { gained };
                let mut reported = solution.covariance.fixed_view_mut::<3, 3>(3 * i, 3 * j);
                reported -= gained;
                if i != j {
                    let mut mirrored = solution.covariance.fixed_view_mut::<3, 3>(3 * j, 3 * i);
                    mirrored -= gained.transpose();
                }
            }
        }
        solution
    }

    /// `Φᵀ λ` and `Φᵀ Λ Φ`: every block receives from those it drives.
    fn through_prediction(&mut self, step: &Step) {
        let transition = Transition::of(step);
        let Transition { bias_gain, interval_s, .. } = transition;
        let bias_gain_t = bias_gain.transpose();
        let tilt_gain = transition.tilt(&Matrix3::identity());
        let tilt_gain_t = tilt_gain.transpose();

        let [attitude, velocity, position, ..] = self.vector;
        self.vector[ATTITUDE] += tilt_gain_t * velocity;
        self.vector[VELOCITY] += position * interval_s;
        self.vector[GYRO_BIAS] += bias_gain_t * attitude;
        self.vector[ACC_BIAS] += bias_gain_t * velocity;

        for row in &mut self.matrix {
            let [attitude, velocity, position, ..] = *row;
            row[ATTITUDE] += velocity * tilt_gain;
            row[VELOCITY] += position * interval_s;
            row[GYRO_BIAS] += attitude * bias_gain;
            row[ACC_BIAS] += velocity * bias_gain;
        }
        let [attitude, velocity, position, ..] = self.matrix;
        for column in 0..BLOCKS {
            self.matrix[ATTITUDE][column] += tilt_gain_t * velocity[column];
            self.matrix[VELOCITY][column] += position[column] * interval_s;
            self.matrix[GYRO_BIAS][column] += bias_gain_t * attitude[column];
            self.matrix[ACC_BIAS][column] += bias_gain_t * velocity[column];
        }
    }
}

/// Sum of a product of blocks over all blocks.
#[inline]
fn sum(term: impl Fn(usize) -> Matrix3<f64>) -> Matrix3<f64> {
    (1..BLOCKS).fold(term(0), |sum, k| sum + term(k))
}
