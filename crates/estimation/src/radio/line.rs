//! Do points stand in a row, and along which line?

use adit_core::nalgebra::{Matrix2, Vector2};

/// Weighted mean and scatter; `None` when there is no weight.
pub fn moments(
    points: impl Iterator<Item = (Vector2<f64>, f64)> + Clone,
) -> Option<(Vector2<f64>, Matrix2<f64>)> {
    let (sum, weight) = points.clone().fold((Vector2::zeros(), 0.0), |(sum, total), (point, weight)| {
        (sum + point * weight, total + weight)
    });
    if !(weight > 0.0 && weight.is_finite()) {
        return None;
    }
    let mean: Vector2<f64> = sum / weight;
    let scatter = points.fold(Matrix2::zeros(), |scatter, (point, weight)| {
        let off = point - mean;
        scatter + off * off.transpose() * weight
    });
    Some((mean, scatter / weight))
}

/// How far a row may be out of line, as a share of its length: one part in twelve, 5 m in 60 m, the width of a roadway.
const STRAIGHT: f64 = 1.0 / 12.0;

/// Unit vector along the row in which the points stand; `None` where they span a plane, or all are at one spot.
pub fn row(points: impl Iterator<Item = Vector2<f64>> + Clone) -> Option<Vector2<f64>> {
    let (_, scatter) = moments(points.map(|point| (point, 1.0)))?;
    let eigen = scatter.symmetric_eigen();
    let (wide, thin) = if eigen.eigenvalues[0] >= eigen.eigenvalues[1] { (0, 1) } else { (1, 0) };
    let (length, width) = (eigen.eigenvalues[wide], eigen.eigenvalues[thin].max(0.0));
    let straight = length > 1e-6 && width <= STRAIGHT * STRAIGHT * length;
    straight.then(|| eigen.eigenvectors.column(wide).into_owned())
}

/// The direction across.
pub fn across(along: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-along.y, along.x)
}
