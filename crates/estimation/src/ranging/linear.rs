//! Linear least squares of system S4 (Jia et al. 2024, eq. 1–5), in the plane and in space.
//!
//! The equation of the last sphere, subtracted from the others, leaves planes (eq. 2, 3), solved by equal weights (eq. 4, 5):
//!
//! ```text
//! 2 (p_i − p_n)ᵀ p = (d_n² − ‖p_n‖²) − (d_i² − ‖p_i‖²),   p = (Aᵀ A)⁻¹ Aᵀ b
//! ```
//!
//! The paper's equations are those of the plane, though its anchors hang at two heights. Where the height h of the tag is told, what is in the
//! plane here are the level distances `d_i² − (z_i − h)²`, the paper's own where all heights are one; where it is free, its third coordinate is
//! unknown too. The covariance carries the errors of all distances, that of the last being in every row, and of the height to first order; the paper has
//! none. Far anchors count most (an error of d is one of `2 d` in its square), and one wrong range spoils the fix: [`fit`](super::fit) is
//! the remedy of both.

use super::{Height, Ranged, RangingFix};
use adit_core::nalgebra::{Matrix3, Vector3};

/// Spread of the anchors across over that along, squared, below which a row or a plane is no more than that.
const FLAT: f64 = 1e-8;

/// The fix; `None` of fewer ranges than unknowns and one, or of anchors in a row (of one plane, where the height is free).
pub fn linear(ranges: &[Ranged], height: Height) -> Option<RangingFix> {
    let (last, others) = ranges.split_last()?;
    let known = match height {
        Height::Free => None,
        Height::Near { mean_m, sigma_m } => Some((mean_m, sigma_m)),
    };
    let place = |one: &Ranged| known.map_or(one.position_m, |_| one.position_m.xy().push(0.0));
    let drop = |one: &Ranged| known.map_or(0.0, |(mean_m, _)| one.position_m.z - mean_m);
    // About the last anchor: nothing is lost to coordinates of kilometres.
    let row = |one: &Ranged| (place(one) - place(last)) * 2.0;
    let square = |one: &Ranged| {
        let ((distance, _), drop) = (one.distance_m(), drop(one));
        distance * distance - drop * drop - (place(one) - place(last)).norm_squared()
    };
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for one in others {
        normal += row(one) * row(one).transpose();
        right += row(one) * (square(last) - square(one));
    }
    if known.is_some() {
        // The third unknown has no equation but zero.
        normal[(2, 2)] = 0.5 * normal.trace();
    }
    if !normal.iter().all(|value| value.is_finite()) {
        return None;
    }
    let spread = normal.symmetric_eigenvalues();
    if spread.min() <= FLAT * spread.max() {
        return None;
    }
    let solved = normal.cholesky()?;
    let mut position_m = place(last) + solved.solve(&right);
    let (mut covariance_m2, mut by_last, mut by_height) =
        (Matrix3::zeros(), Vector3::zeros(), Vector3::zeros());
    let (last_distance, last_sigma) = last.distance_m();
    for one in others {
        let ((distance, sigma), gain) = (one.distance_m(), solved.solve(&row(one)));
        let by_this = gain * (2.0 * distance * sigma);
        covariance_m2 += by_this * by_this.transpose();
        by_last += gain * (2.0 * last_distance * last_sigma);
        by_height += gain * (2.0 * (drop(last) - drop(one)));
    }
    covariance_m2 += by_last * by_last.transpose();
    if let Some((mean_m, sigma_m)) = known {
        position_m.z = mean_m;
        by_height = (by_height + Vector3::z()) * sigma_m;
        covariance_m2 += by_height * by_height.transpose();
    }
    let finite = position_m.iter().chain(&covariance_m2).all(|value| value.is_finite());
    finite.then_some(RangingFix { position_m, covariance_m2, other_m: None })
}
