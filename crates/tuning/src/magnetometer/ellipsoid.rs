//! Ellipsoids, and the one that a few points lie on.
//!
//! A magnetometer turned in a constant field reads points `x` of an ellipsoid: `|S (x − c)| = 1`. The start of the fit is the
//! ellipsoid-specific least squares of Li & Griffiths (*Least squares ellipsoid specific fitting*, GMP 2004): algebraic
//! distance, under the constraint `4J − I² = 1` that admits nothing but ellipsoids, also from points on a part of one. It
//! leans towards small ellipsoids where there is noise; `super::refine` takes that away.

use adit_core::nalgebra::{Cholesky, Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

/// Fewest points that determine an ellipsoid.
pub const PARAMETERS: usize = 9;
/// Keeps the scatter matrix of points without noise invertible; relative to its trace.
const RIDGE: f64 = 1e-13;

/// The points `x` with `|shape (x − centre)| = 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// Its middle.
    pub centre: Vector3<f64>,
    /// Symmetric and positive: turns the ellipsoid into the unit sphere.
    pub shape: Matrix3<f64>,
}

impl Ellipsoid {
    /// What becomes of a point: on the unit sphere if it lies on the ellipsoid.
    #[inline]
    pub fn on_sphere(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.shape * (point - self.centre)
    }

    /// `|shape (x − centre)| − 1`.
    #[inline]
    pub fn residual(&self, point: &Vector3<f64>) -> f64 {
        self.on_sphere(point).norm() - 1.0
    }

    /// Longest over shortest axis.
    pub fn ratio(&self) -> f64 {
        let axes = self.shape.symmetric_eigenvalues();
        axes.max() / axes.min()
    }

    /// The ellipsoid of points before they were made `(x − origin) / scale`.
    pub fn unscaled(&self, origin: &Vector3<f64>, scale: f64) -> Self {
        Self { centre: origin + self.centre * scale, shape: self.shape / scale }
    }

    /// Least squares over points (Li & Griffiths 2004, eq. 11–15); `None` where these do not span an ellipsoid.
    pub fn through<'p>(points: impl Iterator<Item = &'p Vector3<f64>>) -> Option<Self> {
        let mut squares = SMatrix::<f64, 6, 6>::zeros();
        let mut mixed = SMatrix::<f64, 6, 4>::zeros();
        let mut linear = SMatrix::<f64, 4, 4>::zeros();
        for p in points {
            let quadratic = SVector::from([
                p.x * p.x,
                p.y * p.y,
                p.z * p.z,
                2.0 * p.y * p.z,
                2.0 * p.x * p.z,
                2.0 * p.x * p.y,
            ]);
            let rest = SVector::from([2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0]);
            squares += quadratic * quadratic.transpose();
            mixed += quadratic * rest.transpose();
            linear += rest * rest.transpose();
        }
        let eliminated = Cholesky::new(linear)?.solve(&mixed.transpose());
        let scatter = squares - mixed * eliminated;
        let ridge = SMatrix::<f64, 6, 6>::identity() * (scatter.trace() * RIDGE);
        let factor = Cholesky::new(scatter + ridge)?.l();
        // The constraint has one positive eigenvalue, and so has the pencil: its eigenvector is the ellipsoid.
        let half = factor.solve_lower_triangular(&constraint())?;
        let pencil = factor.solve_lower_triangular(&half.transpose())?;
        let eigen = SymmetricEigen::new(0.5 * (pencil + pencil.transpose()));
        let coefficients = factor
            .transpose()
            .solve_upper_triangular(&eigen.eigenvectors.column(eigen.eigenvalues.imax()))?;
        Self::from_quadric(&coefficients, &-(eliminated * coefficients))
    }

    /// From `xᵀ A x + 2 bᵀ x + d = 0`: A as xx, yy, zz, yz, xz, xy; then b and d.
    fn from_quadric(quadratic: &SVector<f64, 6>, linear: &SVector<f64, 4>) -> Option<Self> {
        let [xx, yy, zz, yz, xz, xy] = (*quadratic).into();
        let matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let b = Vector3::new(linear[0], linear[1], linear[2]);
        let centre = -(matrix.try_inverse()? * b);
        let size = -linear[3] - b.dot(&centre);
        let eigen = SymmetricEigen::new(matrix / size);
        let positive = eigen.eigenvalues.iter().all(|v| v.is_finite() && *v > 0.0);
        let root = Matrix3::from_diagonal(&eigen.eigenvalues.map(|v| v.max(0.0).sqrt()));
        let shape = eigen.eigenvectors * root * eigen.eigenvectors.transpose();
        (positive && centre.iter().all(|v| v.is_finite())).then_some(Self { centre, shape })
    }
}

/// `4J − I²` as a quadratic form of the six coefficients (Li & Griffiths 2004, eq. 7, k = 4).
fn constraint() -> SMatrix<f64, 6, 6> {
    SMatrix::from_fn(|row, column| match (row, column) {
        (r, c) if r >= 3 || c >= 3 => {
            if r == c {
                -4.0
            } else {
                0.0
            }
        }
        (r, c) if r == c => -1.0,
        _ => 1.0,
    })
}
