//! Linear least squares on circles.
//!
//! Subtracting the equation of one circle from the others leaves straight lines (as in system S4, Jia et al. 2024, eq. 1–5):
//!
//! ```text
//! 2 (p_i − p_1)ᵀ p = ‖p_i‖² − ‖p_1‖² − r_i² + r_1²
//! ```
//!
//! The first is the nearest. Each equation weighs one over the variance `4 r_i² σ_i²` that its own radius gives it: without that, far transmitters, whose
//! radii are worst, would count most. The error of the first circle is in all equations all the same. In a row of transmitters the lines
//! are parallel: the solution along the roadway is taken then.

use super::line::{across, row};
use super::range_fit::Ranged;
use super::{Heard, RadioFix};
use adit_core::nalgebra::{Matrix2, Vector2};
use alloc::vec::Vec;

/// A circle: centre, radius and its standard deviation, m.
type Circle = (Vector2<f64>, f64, f64);

/// The fix by signal strengths through their path loss; `None` of fewer than two places.
pub fn linear_signals(heard: &[Heard<'_>], height_m: f64) -> Option<RadioFix> {
    let circles = heard
        .iter()
        .map(|one| (one.emitter.position_m.xy(), one.level_range_m(height_m), one.range_sigma_m()));
    solve(circles.collect())
}

/// The fix by ranges; `None` of fewer than two places.
pub fn linear_ranges(ranges: &[Ranged], height_m: f64) -> Option<RadioFix> {
    let circles = ranges
        .iter()
        .map(|one| (one.position_m.xy(), one.level_range_m(height_m), one.model.sigma_m / one.model.scale));
    solve(circles.collect())
}

fn solve(mut circles: Vec<Circle>) -> Option<RadioFix> {
    circles.sort_by(|a, b| a.1.total_cmp(&b.1));
    let in_row = row(circles.iter().map(|circle| circle.0));
    let (first, rest) = circles.split_first()?;
    // Errors of each circle, the first last, carried through the equations to the place.
    let mut normal = Matrix2::zeros();
    let mut right = Vector2::zeros();
    let axis = |away: Vector2<f64>| match in_row {
        Some(along) => along * along.dot(&away),
        None => away,
    };
    let lines = |circle: &Circle| {
        let (centre, radius, _) = *circle;
        let line = axis(centre - first.0) * 2.0;
        let value = (centre - first.0).norm_squared() - radius * radius + first.1 * first.1;
        (line, value)
    };
    let weight = |circle: &Circle| {
        let own = 2.0 * circle.1 * circle.2;
        1.0 / (own * own).max(1e-6)
    };
    for circle in rest {
        let (line, value) = lines(circle);
        normal += line * line.transpose() * weight(circle);
        right += line * (value * weight(circle));
    }
    if let Some(along) = in_row {
        // Across the row nothing is known but the nearest radius.
        let across = across(&along);
        normal += across * across.transpose() * normal.trace();
    }
    let solved = normal.cholesky()?;
    let condition = normal.symmetric_eigenvalues();
    if condition.min() < 1e-6 * condition.max() {
        return None;
    }
    let position_m = first.0 + solved.solve(&right);
    let mut covariance_m2 = Matrix2::zeros();
    let mut by_first = Vector2::zeros();
    for circle in rest {
        let gain = solved.solve(&lines(circle).0) * weight(circle);
        let by_this = gain * (-2.0 * circle.1 * circle.2);
        covariance_m2 += by_this * by_this.transpose();
        by_first += gain * (2.0 * first.1 * first.2);
    }
    covariance_m2 += by_first * by_first.transpose();
    if let Some(along) = in_row {
        let across = across(&along);
        covariance_m2 += across * across.transpose() * (first.1 * first.1 + first.2 * first.2);
    }
    // Equations without an error to them (radii of zero) still leave one of centimetres.
    covariance_m2 += Matrix2::identity() * 1e-4;
    position_m.iter().all(|value| value.is_finite()).then_some(RadioFix { position_m, covariance_m2 })
}
