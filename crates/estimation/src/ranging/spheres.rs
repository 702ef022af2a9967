//! Trilateration: where three spheres meet.
//!
//! In axes with the first anchor at the origin, the second on x and the third in the plane of x and y (Fang 1986; Manolakis 1996):
//!
//! ```text
//! x = (d₁² − d₂² + a²) / 2a,   y = (d₁² − d₃² + b² + c² − 2 b x) / 2c,   z = ±√(d₁² − x² − y²)
//! ```
//!
//! a: first to second anchor; b, c: the third along and across. The two places are mirror images in the plane of the anchors. Spheres
//! that errors keep from meeting give the foot in the plane, twice.

use super::Ranged;
use adit_core::nalgebra::Vector3;

/// Both places, the lower one first; `None` of anchors in a row.
pub fn three_spheres(ranges: &[Ranged; 3]) -> Option<[Vector3<f64>; 2]> {
    let [first, second, third] = ranges.each_ref().map(|one| one.position_m);
    let [d1, d2, d3] = ranges.each_ref().map(|one| one.distance_m().0);
    let x_axis = (second - first).try_normalize(1e-9)?;
    let (a, b) = ((second - first).norm(), x_axis.dot(&(third - first)));
    let across = third - first - x_axis * b;
    let c = across.norm();
    let y_axis = across.try_normalize(1e-4 * a.max(b.abs()))?;
    let x = (d1 * d1 - d2 * d2 + a * a) / (2.0 * a);
    let y = (d1 * d1 - d3 * d3 + b * b + c * c - 2.0 * b * x) / (2.0 * c);
    let up = x_axis.cross(&y_axis) * libm::sqrt((d1 * d1 - x * x - y * y).max(0.0));
    let foot = first + x_axis * x + y_axis * y;
    let both = if up.z > 0.0 { [foot - up, foot + up] } else { [foot + up, foot - up] };
    both.iter().flatten().all(|value| value.is_finite()).then_some(both)
}
