//! Covariance of the error state in 3×3 blocks.
//!
//! Error state, six 3-vectors in this order (errors are truth minus estimate, attitude as `q = exp(φ) ∘ q̂`):
//!
//! | block | meaning | frame | unit |
//! |---|---|---|---|
//! | [`ATTITUDE`] | rotation vector `φ` | n | rad |
//! | [`VELOCITY`] | `δv` | n | m/s |
//! | [`POSITION`] | `δp` | n | m |
//! | [`GYRO_BIAS`] | `δb_g` | b | rad/s |
//! | [`ACC_BIAS`] | `δb_a` | b | m/s² |
//! | [`CONTACT`] | `δr`, lever from the point of contact to the sensor | b | m |
//!
//! Transition over an interval `dt` (Groves 2013, eq. 14.63 in local level axes; Solà 2017, eq. 269):
//!
//! ```text
//! φ ← φ − C dt δb_g        δv ← δv − [Δv_n]× φ − C dt δb_a        δp ← δp + dt δv        biases, contact constant
//! ```
//!
//! Only the 21 blocks on and above the diagonal are kept, so that the matrix is symmetric by construction, and only
//! the blocks that the transition touches are computed: 21 products of 3×3 against 2 × 216 for the dense form.

use crate::inertial::strapdown::Step;
use crate::kalman::{Innovation, Linearised};
use adit_core::nalgebra::{Matrix3, SMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// Index of the attitude error.
pub const ATTITUDE: usize = 0;
/// Index of the velocity error.
pub const VELOCITY: usize = 1;
/// Index of the position error.
pub const POSITION: usize = 2;
/// Index of the gyro bias error.
pub const GYRO_BIAS: usize = 3;
/// Index of the accelerometer bias error.
pub const ACC_BIAS: usize = 4;
/// Index of the error of the contact lever.
pub const CONTACT: usize = 5;
/// Number of 3-vectors in the error state.
pub const BLOCKS: usize = 6;
/// Number of scalar error states.
pub const STATES: usize = 3 * BLOCKS;

/// Errors of the six 3-vectors.
pub type ErrorVector = [Vector3<f64>; BLOCKS];

const UPPER: usize = BLOCKS * (BLOCKS + 1) / 2;

/// Place of block (row, column) with `row <= column`.
const fn at(row: usize, column: usize) -> usize {
    row * (2 * BLOCKS - 1 - row) / 2 + column
}

/// How the errors drive each other over one interval: the blocks of `Φ` off its diagonal of ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transition {
    /// Attitude by gyro bias, and velocity by accelerometer bias: `−C dt`.
    pub bias_gain: Matrix3<f64>,
    /// Velocity by attitude: `−[Δv_n]×`, kept as the vector `Δv_n`.
    pub velocity_gained: Vector3<f64>,
    /// Position by velocity, s.
    pub interval_s: f64,
}

impl Transition {
    #[inline]
    pub(super) fn of(step: &Step) -> Self {
        Self {
            bias_gain: step.rotation * -step.interval_s,
            velocity_gained: step.velocity_gained,
            interval_s: step.interval_s,
        }
    }

    /// `−[Δv_n]× M`: nine products fewer than the matrix product.
    #[inline]
    pub fn tilt(&self, m: &Matrix3<f64>) -> Matrix3<f64> {
        let (v, m) = (&self.velocity_gained, m.as_slice());
        let column = |c: usize| {
            let (x, y, z) = (m[3 * c], m[3 * c + 1], m[3 * c + 2]);
            Vector3::new(v.z * y - v.y * z, v.x * z - v.z * x, v.y * x - v.x * y)
        };
        Matrix3::from_columns(&[column(0), column(1), column(2)])
    }
}

/// Process noise added over one interval, as variances (already multiplied by the interval).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProcessNoise {
    /// Attitude, rad², 3×3 in n.
    pub attitude: Matrix3<f64>,
    /// Velocity, (m/s)², per axis.
    pub velocity: f64,
    /// Gyro bias, (rad/s)², per axis.
    pub gyro_bias: f64,
    /// Accelerometer bias, (m/s²)², per axis.
    pub acc_bias: f64,
}

/// Symmetric 18×18 covariance of the error state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Covariance {
    upper: [Matrix3<f64>; UPPER],
}

impl Covariance {
    /// Diagonal covariance from a variance for each axis of each block.
    pub fn from_variances(variances: &ErrorVector) -> Self {
        let mut upper = [Matrix3::zeros(); UPPER];
        for (block, variance) in variances.iter().enumerate() {
            upper[at(block, block)] = Matrix3::from_diagonal(variance);
        }
        Self { upper }
    }

    /// Cross-covariance of two blocks, 3×3.
    #[inline]
    pub fn block(&self, row: usize, column: usize) -> Matrix3<f64> {
        if row <= column { self.upper[at(row, column)] } else { self.upper[at(column, row)].transpose() }
    }

    /// Covariance of one axis of a block with one axis of another.
    #[inline]
    pub fn element(&self, row: usize, row_axis: usize, column: usize, column_axis: usize) -> f64 {
        if row <= column {
            self.upper[at(row, column)][(row_axis, column_axis)]
        } else {
            self.upper[at(column, row)][(column_axis, row_axis)]
        }
    }

    /// Adds to the covariance of one block.
    pub fn inflate(&mut self, block: usize, variance: &Matrix3<f64>) {
        self.upper[at(block, block)] += variance;
    }

    /// Place and heading are the origin from now on: nothing that is still to be learnt corrects what led to them (Nilsson, Zachariah, Skog & Händel 2013).
    pub fn set_origin(&mut self) {
        for other in 0..BLOCKS {
            self.upper[at(POSITION.min(other), POSITION.max(other))] = Matrix3::zeros();
            // The heading is the third axis of the attitude, which is the first block.
            let block = &mut self.upper[at(ATTITUDE, other)];
            block.row_mut(2).fill(0.0);
            if other == ATTITUDE {
                block.column_mut(2).fill(0.0);
            }
        }
    }

    /// All of it, 18×18.
    pub fn to_matrix(&self) -> SMatrix<f64, STATES, STATES> {
        SMatrix::from_fn(|i, j| self.block(i / 3, j / 3)[(i % 3, j % 3)])
    }

    /// `P ← F P Fᵀ + Q` for one strapdown step.
    #[inline]
    pub fn propagate(&mut self, step: &Step, noise: &ProcessNoise) {
        const T: usize = ATTITUDE;
        const V: usize = VELOCITY;
        const P: usize = POSITION;
        const G: usize = GYRO_BIAS;
        const A: usize = ACC_BIAS;
        const C: usize = CONTACT;
        let transition = Transition::of(step);
        let Transition { bias_gain, interval_s: dt, .. } = transition;
        let bias_gain_t = bias_gain.transpose();
        let u = &mut self.upper;

        // Rows of position first, then velocity, then attitude: each uses the old values of those after it.
        let pt_row = u[at(T, P)].transpose() + u[at(T, V)].transpose() * dt;
        let pv_row = u[at(V, P)].transpose() + u[at(V, V)] * dt;
        let pp_row = u[at(P, P)] + u[at(V, P)] * dt;
        let pg = u[at(P, G)] + u[at(V, G)] * dt;
        let pa = u[at(P, A)] + u[at(V, A)] * dt;
        let pc = u[at(P, C)] + u[at(V, C)] * dt;

        let vt_row =
            u[at(T, V)].transpose() + transition.tilt(&u[at(T, T)]) + bias_gain * u[at(T, A)].transpose();
        let vv_row = u[at(V, V)] + transition.tilt(&u[at(T, V)]) + bias_gain * u[at(V, A)].transpose();
        let vg = u[at(V, G)] + transition.tilt(&u[at(T, G)]) + bias_gain * u[at(G, A)].transpose();
        let va = u[at(V, A)] + transition.tilt(&u[at(T, A)]) + bias_gain * u[at(A, A)];
        let vc = u[at(V, C)] + transition.tilt(&u[at(T, C)]) + bias_gain * u[at(A, C)];

        let tt_row = u[at(T, T)] + bias_gain * u[at(T, G)].transpose();
        let tg = u[at(T, G)] + bias_gain * u[at(G, G)];
        let ta = u[at(T, A)] + bias_gain * u[at(G, A)];
        let tc = u[at(T, C)] + bias_gain * u[at(G, C)];

        // Then the columns, the same way.
        u[at(T, T)] = tt_row + tg * bias_gain_t + noise.attitude;
        u[at(T, V)] = (vt_row + vg * bias_gain_t).transpose();
        u[at(T, P)] = (pt_row + pg * bias_gain_t).transpose();
        u[at(T, G)] = tg;
        u[at(T, A)] = ta;
        u[at(T, C)] = tc;
        u[at(V, V)] = vv_row + transition.tilt(&vt_row.transpose()).transpose() + va * bias_gain_t;
        let pv = pv_row + transition.tilt(&pt_row.transpose()).transpose() + pa * bias_gain_t;
        u[at(V, P)] = pv.transpose();
        u[at(V, G)] = vg;
        u[at(V, A)] = va;
        u[at(V, C)] = vc;
        u[at(P, P)] = pp_row + pv_row * dt;
        u[at(P, G)] = pg;
        u[at(P, A)] = pa;
        u[at(P, C)] = pc;
        for axis in 0..3 {
            u[at(V, V)][(axis, axis)] += noise.velocity;
            u[at(G, G)][(axis, axis)] += noise.gyro_bias;
            u[at(A, A)][(axis, axis)] += noise.acc_bias;
        }
    }

    /// Predicted innovation of a measurement: `S = H P Hᵀ + R` and its χ² against the residual.
    ///
    /// `None` when `S` is not invertible (a covariance that is not finite, or a measurement without noise).
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "returns 1 kB by value, which is copied unless the call disappears"
    )]
    pub fn innovation<const N: usize>(&self, measurement: &Linearised<N>) -> Option<(Innovation, Gain)> {
        let cross: [Matrix3<f64>; BLOCKS] = core::array::from_fn(|block| {
            measurement.jacobian.iter().fold(Matrix3::zeros(), |sum, (column, h)| {
                sum + h.right_transposed(&self.block(block, *column))
            })
        });
        let predicted =
            measurement.jacobian.iter().fold(measurement.noise, |sum, (row, h)| sum + h.left(&cross[*row]));
        let inverse = predicted.try_inverse()?;
        let nis = measurement.residual.dot(&(inverse * measurement.residual));
        let innovation =
            Innovation { value: measurement.residual, covariance: predicted, nis, accepted: true };
        let gain = core::array::from_fn(|block| cross[block] * inverse);
        nis.is_finite().then_some((innovation, Gain { cross, gain, inverse }))
    }

    /// Updates the covariance with the gain of [`Self::innovation`] and returns the correction `K v`.
    ///
    /// Joseph's form `(I−KH) P (I−KH)ᵀ + K R Kᵀ = P − K M ᵀ − M Kᵀ + K S Kᵀ` with `M = P Hᵀ` (Bucy & Joseph 1968),
    /// written as `P − (K Nᵀ + N Kᵀ)` with `N = M − K S / 2`: exact for any gain, and symmetric as it stands.
    #[inline]
    pub fn update(&mut self, innovation: &Innovation, gain: &Gain) -> ErrorVector {
        let k = &gain.gain;
        let half = innovation.covariance * 0.5;
        let n: [Matrix3<f64>; BLOCKS] = core::array::from_fn(|block| gain.cross[block] - k[block] * half);
        for row in 0..BLOCKS {
            let product = k[row] * n[row].transpose();
            self.upper[at(row, row)] -= product + product.transpose();
            for column in row + 1..BLOCKS {
                self.upper[at(row, column)] -=
                    k[row] * n[column].transpose() + n[row] * k[column].transpose();
            }
        }
        core::array::from_fn(|block| k[block] * innovation.value)
    }
}

/// What an update needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// `M = P Hᵀ`, six 3×3 blocks.
    pub cross: [Matrix3<f64>; BLOCKS],
    /// Kalman gain `K = P Hᵀ S⁻¹`, six 3×3 blocks.
    pub gain: [Matrix3<f64>; BLOCKS],
    /// `S⁻¹`.
    pub inverse: Matrix3<f64>,
}
