//! Covariance and adjoint of an error state made of `B` 3-vectors, kept in 3×3 blocks.
//!
//! A transition touches few blocks ([`Coupling`]) and a measurement depends on few ([`Linearised`]); everything else is
//! left alone. The smoother is the modified Bryson–Frazier recursion (Bierman 1977, ch. X; the equations stand in
//! [`crate::inertial::smoother`]).

use crate::kalman::{Innovation, Linearised};
use adit_core::nalgebra::{Matrix3, Vector3};
use core::array::from_fn;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Error state, by blocks.
pub type BlockVector<const B: usize> = [Vector3<f64>; B];

/// One block of a transition matrix beside the identity: `x[to] += matrix · x[from]`.
///
/// Couplings take effect in their order: one that reads a block stands before those that write it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// Block that changes.
    pub to: usize,
    /// Block that it depends on.
    pub from: usize,
    /// How.
    pub matrix: Matrix3<f64>,
}

/// Symmetric covariance in 3×3 blocks; both halves are kept, equal bit for bit.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockCovariance<const B: usize> {
    blocks: [[Matrix3<f64>; B]; B],
}

/// What an update did, for feedback and smoother.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockUpdate<const B: usize, const N: usize> {
    /// The measurement as it was used.
    pub linearised: Linearised<N>,
    /// `S⁻¹`.
    pub inverse: Matrix3<f64>,
    /// Kalman gain, by blocks.
    pub gain: BlockVectorGain<B>,
    /// What became of it.
    pub innovation: Innovation,
}

/// Kalman gain: one 3×3 block for each block of the state.
pub type BlockVectorGain<const B: usize> = [Matrix3<f64>; B];

impl<const B: usize> BlockCovariance<B> {
    /// Independent errors with these variances.
    pub fn from_variances(variances: &BlockVector<B>) -> Self {
        let mut blocks = [[Matrix3::zeros(); B]; B];
        for (index, variance) in variances.iter().enumerate() {
            blocks[index][index] = Matrix3::from_diagonal(variance);
        }
        Self { blocks }
    }

    /// Cross-covariance of two blocks.
    #[inline]
    pub fn block(&self, row: usize, column: usize) -> &Matrix3<f64> {
        &self.blocks[row][column]
    }

    /// Adds variance to one block.
    #[inline]
    pub fn inflate(&mut self, block: usize, variance: &Matrix3<f64>) {
        self.blocks[block][block] += variance;
    }

    /// Forgets what was known of some components of a block: their variance is `variance`, their correlations are none.
    pub fn forget(&mut self, block: usize, components: &[usize], variance: f64) {
        for &component in components {
            for other in 0..B {
                self.blocks[block][other].row_mut(component).fill(0.0);
                self.blocks[other][block].column_mut(component).fill(0.0);
            }
            self.blocks[block][block][(component, component)] = variance;
        }
    }

    /// Turns the axes in which one block is given.
    pub fn turn(&mut self, block: usize, rotation: &Matrix3<f64>) {
        for other in 0..B {
            self.blocks[block][other] = rotation * self.blocks[block][other];
        }
        for other in 0..B {
            self.blocks[other][block] *= rotation.transpose();
        }
        self.mirror(block);
    }

    /// `P ← F P Fᵀ` for `F = Π (I + coupling)`.
    #[inline]
    pub fn propagate<const C: usize>(&mut self, couplings: &[Coupling; C]) {
        for Coupling { to, from, matrix } in couplings {
            for column in 0..B {
                let change = matrix * self.blocks[*from][column];
                self.blocks[*to][column] += change;
            }
        }
        // Every row that was written is now final but for its own columns among the written ones.
        let written = |block: usize| couplings.iter().any(|coupling| coupling.to == block);
        for row in (0..B).filter(|row| written(*row)) {
            for Coupling { to, from, matrix } in couplings {
                let change = self.blocks[row][*from] * matrix.transpose();
                self.blocks[row][*to] += change;
            }
        }
        for row in (0..B).filter(|row| written(*row)) {
            self.mirror(row);
        }
    }

    /// Makes a column the transpose of its row.
    #[inline]
    fn mirror(&mut self, row: usize) {
        for column in 0..B {
            if column != row {
                self.blocks[column][row] = self.blocks[row][column].transpose();
            }
        }
        let diagonal = self.blocks[row][row];
        self.blocks[row][row] = (diagonal + diagonal.transpose()) * 0.5;
    }

    /// Normalised innovation squared that a measurement would have; infinite where its covariance cannot be inverted.
    pub fn nis<const N: usize>(&self, linearised: &Linearised<N>) -> f64 {
        let mut covariance = linearised.noise;
        for (row, left) in &linearised.jacobian {
            for (column, right) in &linearised.jacobian {
                covariance += left.left(&right.right_transposed(&self.blocks[*row][*column]));
            }
        }
        let value = linearised.residual;
        covariance.try_inverse().map_or(f64::INFINITY, |inverse| value.dot(&(inverse * value)))
    }

    /// Kalman update with a measurement; its noise grows where the normalised innovation squared exceeds `bound`
    /// (Huber's weight, with three degrees of freedom), so that an outlier pulls no more than a value at the bound.
    ///
    /// Returns `None` when the innovation covariance cannot be inverted.
    #[inline]
    #[expect(
        clippy::needless_range_loop,
        reason = "row and column index gain, covariance and its mirror at once"
    )]
    pub fn update<const N: usize>(
        &mut self,
        mut linearised: Linearised<N>,
        bound: f64,
    ) -> Option<BlockUpdate<B, N>> {
        let mut seen: BlockVectorGain<B> = [Matrix3::zeros(); B];
        for (block, derivative) in &linearised.jacobian {
            for (row, seen) in seen.iter_mut().enumerate() {
                *seen += derivative.right_transposed(&self.blocks[row][*block]);
            }
        }
        let predicted = linearised
            .jacobian
            .iter()
            .fold(Matrix3::zeros(), |sum, (block, derivative)| sum + derivative.left(&seen[*block]));
        let value = linearised.residual;
        let inverse = (predicted + linearised.noise).try_inverse()?;
        let nis = value.dot(&(inverse * value));
        let inverse = if nis > bound {
            linearised.noise += (predicted + linearised.noise) * (nis / bound - 1.0);
            (predicted + linearised.noise).try_inverse()?
        } else {
            inverse
        };
        let covariance = predicted + linearised.noise;
        let gain: BlockVectorGain<B> = from_fn(|row| seen[row] * inverse);
        for row in 0..B {
            for column in row..B {
                let change = gain[row] * seen[column].transpose();
                self.blocks[row][column] -= change;
                if column > row {
                    self.blocks[column][row] = self.blocks[row][column].transpose();
                }
            }
            let diagonal = self.blocks[row][row];
            self.blocks[row][row] = (diagonal + diagonal.transpose()) * 0.5;
        }
        let innovation = Innovation { value, covariance, nis, accepted: nis <= bound };
        Some(BlockUpdate { linearised, inverse, gain, innovation })
    }
}

impl<const B: usize, const N: usize> BlockUpdate<B, N> {
    /// What the measurement says of the error state.
    #[inline]
    pub fn correction(&self) -> BlockVector<B> {
        from_fn(|block| self.gain[block] * self.innovation.value)
    }
}

/// Adjoint of the error state, running backward in time: what later measurements say.
#[derive(Debug, Clone)]
pub struct BlockAdjoint<const B: usize> {
    vector: BlockVector<B>,
    matrix: [[Matrix3<f64>; B]; B],
}

impl<const B: usize> Default for BlockAdjoint<B> {
    /// At the end of the log nothing is known from later.
    fn default() -> Self {
        Self { vector: [Vector3::zeros(); B], matrix: [[Matrix3::zeros(); B]; B] }
    }
}

impl<const B: usize> BlockAdjoint<B> {
    /// Back through an update: `λ ← (I − KH)ᵀλ − HᵀS⁻¹v`, `Λ ← (I − KH)ᵀΛ(I − KH) + HᵀS⁻¹H`.
    #[expect(clippy::needless_range_loop, reason = "row and column index the matrix and its mirror at once")]
    pub fn through_update<const N: usize>(&mut self, update: &BlockUpdate<B, N>) {
        let pulled = update
            .gain
            .iter()
            .zip(&self.vector)
            .fold(update.inverse * update.innovation.value, |sum, (gain, adjoint)| {
                sum + gain.transpose() * adjoint
            });
        let jacobian = update.linearised.jacobian.map(|(block, derivative)| (block, derivative.matrix()));
        for (block, h) in &jacobian {
            self.vector[*block] -= h.transpose() * pulled;
        }
        let seen: [Matrix3<f64>; B] =
            from_fn(|row| (0..B).fold(Matrix3::zeros(), |sum, k| sum + self.matrix[row][k] * update.gain[k]));
        let inner = (0..B).fold(update.inverse, |sum, k| sum + update.gain[k].transpose() * seen[k]);
        for (block, h) in &jacobian {
            for row in 0..B {
                let change = seen[row] * h;
                self.matrix[row][*block] -= change;
                self.matrix[*block][row] -= change.transpose();
            }
        }
        for (row, left) in &jacobian {
            for (column, right) in &jacobian {
                self.matrix[*row][*column] += left.transpose() * inner * right;
            }
        }
        self.symmetrise();
    }

    /// The update above is right only for a symmetric matrix: rounding that is not would grow at every update.
    fn symmetrise(&mut self) {
        for row in 0..B {
            let diagonal = self.matrix[row][row];
            self.matrix[row][row] = (diagonal + diagonal.transpose()) * 0.5;
            for column in row + 1..B {
                let mean = (self.matrix[row][column] + self.matrix[column][row].transpose()) * 0.5;
                self.matrix[row][column] = mean;
                self.matrix[column][row] = mean.transpose();
            }
        }
    }

    /// Back through a prediction: `λ ← Fᵀλ`, `Λ ← FᵀΛF`.
    pub fn through_prediction<const C: usize>(&mut self, couplings: &[Coupling; C]) {
        for Coupling { to, from, matrix } in couplings.iter().rev() {
            let transposed = matrix.transpose();
            let change = transposed * self.vector[*to];
            self.vector[*from] += change;
            for column in 0..B {
                let change = transposed * self.matrix[*to][column];
                self.matrix[*from][column] += change;
            }
            for row in 0..B {
                let change = self.matrix[row][*to] * matrix;
                self.matrix[row][*from] += change;
            }
        }
    }

    /// Back through [`BlockCovariance::forget`]: what comes later says nothing of these components before.
    pub fn through_forgetting(&mut self, block: usize, components: &[usize]) {
        for &component in components {
            self.vector[block][component] = 0.0;
            for other in 0..B {
                self.matrix[block][other].row_mut(component).fill(0.0);
                self.matrix[other][block].column_mut(component).fill(0.0);
            }
        }
    }

    /// Back through [`BlockCovariance::turn`].
    pub fn through_turn(&mut self, block: usize, rotation: &Matrix3<f64>) {
        self.vector[block] = rotation.transpose() * self.vector[block];
        for other in 0..B {
            self.matrix[block][other] = rotation.transpose() * self.matrix[block][other];
        }
        for other in 0..B {
            self.matrix[other][block] *= rotation;
        }
    }

    /// What the smoother adds to one block of a state with this covariance: `−P λ`.
    pub fn correction(&self, covariance: &BlockCovariance<B>, block: usize) -> Vector3<f64> {
        -(0..B).fold(Vector3::zeros(), |sum, k| sum + covariance.blocks[block][k] * self.vector[k])
    }

    /// Smoothed covariance of one block: `P − P Λ P`.
    pub fn smoothed(&self, covariance: &BlockCovariance<B>, block: usize) -> Matrix3<f64> {
        let reduction = (0..B).fold(Matrix3::zeros(), |sum, row| {
            let inner = (0..B).fold(Matrix3::zeros(), |sum, column| {
                sum + self.matrix[row][column] * covariance.blocks[column][block]
            });
            sum + covariance.blocks[block][row] * inner
        });
        covariance.blocks[block][block] - reduction
    }
}

impl<const B: usize> Serialize for BlockCovariance<B> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.blocks.iter().flatten())
    }
}

impl<'de, const B: usize> Deserialize<'de> for BlockCovariance<B> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let flat = alloc::vec::Vec::<Matrix3<f64>>::deserialize(deserializer)?;
        if flat.len() != B * B {
            return Err(serde::de::Error::invalid_length(flat.len(), &"a square of 3×3 blocks"));
        }
        Ok(Self { blocks: from_fn(|row| from_fn(|column| flat[row * B + column])) })
    }
}
