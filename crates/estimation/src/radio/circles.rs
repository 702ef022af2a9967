//! Centroids of the inner points of three circles, as in system S1 (Lu, Zhao & Xu, eq. 2–4).
//!
//! The three strongest transmitters draw circles by their path loss. Each pair of circles meets in two points; the **inner** one,
//! nearer to the third circle's centre, is kept: D, E, F. The fix is their mean, weighted by
//!
//! ```text
//! plain        1
//! weighted     1 / (r_i + r_j)
//! improved     1 / ((r_i / RSSI_i)² + (r_j / RSSI_j)²)
//! ```
//!
//! The paper gives the improved weight in words; eq. 3 was lost. It does not say what to do when circles do not meet, with fewer than three,
//! or in a row. Here:
//!
//! - two circles apart: the point between them, dividing the gap in half; one inside the other: the same on the far side;
//! - transmitters **in a row** (a roadway), or two: each pair's point is the foot of their common chord on the line between them, so
//!   that the fix stays on the roadway; across it the covariance is that of the roadway;
//! - one: its own place, with the radius of its circle as uncertainty.

use super::line::{across, row};
use super::{Heard, RadioFix};
use adit_core::nalgebra::{Matrix2, Vector2};
use alloc::vec::Vec;

/// How inner points are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InnerWeight {
    /// All the same.
    Equal,
    /// One over the sum of the two radii.
    InverseRange,
    /// The improved weight of S1.
    RangeOverStrength,
}

/// What is taken as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircleParams {
    /// How inner points are weighted.
    pub weight: InnerWeight,
    /// Height of the tag, m.
    pub height_m: f64,
    /// Half the width of a roadway, for transmitters in a row, m.
    pub half_width_m: f64,
}

impl Default for CircleParams {
    fn default() -> Self {
        Self { weight: InnerWeight::RangeOverStrength, height_m: 0.0, half_width_m: 2.5 }
    }
}

#[derive(Debug, Clone, Copy)]
struct Circle {
    centre: Vector2<f64>,
    radius: f64,
    sigma: f64,
    rssi_dbm: f64,
}

/// The fix by the three strongest of those heard; `None` of none.
pub fn inner_points(heard: &[Heard<'_>], params: &CircleParams) -> Option<RadioFix> {
    let mut strongest: Vec<&Heard<'_>> = heard.iter().filter(|one| one.rssi_dbm.is_finite()).collect();
    strongest.sort_by(|a, b| b.rssi_dbm.total_cmp(&a.rssi_dbm));
    let mut circles: Vec<Circle> = Vec::with_capacity(3);
    for one in strongest {
        let centre = one.emitter.position_m.xy();
        // Two radios of one access point draw no new circle.
        if circles.len() < 3 && circles.iter().all(|circle| (circle.centre - centre).norm() > 0.1) {
            let radius = one.level_range_m(params.height_m);
            circles.push(Circle { centre, radius, sigma: one.range_sigma_m(), rssi_dbm: one.rssi_dbm });
        }
    }
    let [first, rest @ ..] = &circles[..] else { return None };
    if rest.is_empty() {
        let spread = first.radius * first.radius + first.sigma * first.sigma;
        return Some(RadioFix {
            position_m: first.centre,
            covariance_m2: Matrix2::identity() * (0.5 * spread),
        });
    }
    let in_row = row(circles.iter().map(|circle| circle.centre));
    let position_m = centre_of_points(&circles, in_row, params.weight);
    let mut covariance_m2 = Matrix2::identity() * 1e-4;
    for index in 0..circles.len() {
        // Half the difference over two standard deviations: a root is steeper at its foot than any derivative tells.
        let moved = |sign: f64| {
            let mut circles = circles.clone();
            circles[index].radius = (circles[index].radius + sign * circles[index].sigma).max(0.0);
            centre_of_points(&circles, in_row, params.weight)
        };
        let half = (moved(1.0) - moved(-1.0)) * 0.5;
        covariance_m2 += half * half.transpose();
    }
    if let Some(along) = in_row {
        let across = across(&along);
        covariance_m2 += across * across.transpose() * (params.half_width_m * params.half_width_m / 3.0);
    }
    Some(RadioFix { position_m, covariance_m2 })
}

fn centre_of_points(circles: &[Circle], in_row: Option<Vector2<f64>>, weight: InnerWeight) -> Vector2<f64> {
    let (mut sum, mut total) = (Vector2::zeros(), 0.0);
    for (i, a) in circles.iter().enumerate() {
        for (j, b) in circles.iter().enumerate().skip(i + 1) {
            let third =
                circles.iter().enumerate().find(|(k, _)| *k != i && *k != j).map(|(_, circle)| circle);
            let point = meeting_point(a, b, third.filter(|_| in_row.is_none()));
            let weight = weigh(a, b, weight);
            sum += point * weight;
            total += weight;
        }
    }
    sum / total
}

fn weigh(a: &Circle, b: &Circle, weight: InnerWeight) -> f64 {
    match weight {
        InnerWeight::Equal => 1.0,
        InnerWeight::InverseRange => 1.0 / (a.radius + b.radius).max(0.1),
        InnerWeight::RangeOverStrength => {
            // No receiver reads within 1 dB of a milliwatt; the bound keeps the ratio finite.
            let ratio = |circle: &Circle| circle.radius.max(0.1) / circle.rssi_dbm.abs().max(1.0);
            1.0 / (ratio(a) * ratio(a) + ratio(b) * ratio(b))
        }
    }
}

/// The inner of the two points where circles meet, the foot of their chord where there is no third, a point between where they
/// do not meet.
fn meeting_point(a: &Circle, b: &Circle, third: Option<&Circle>) -> Vector2<f64> {
    let between = b.centre - a.centre;
    let distance = between.norm();
    let towards = between / distance;
    if distance >= a.radius + b.radius {
        return a.centre + towards * (0.5 * (distance + a.radius - b.radius));
    }
    if distance <= (a.radius - b.radius).abs() {
        let outward = if a.radius >= b.radius { 1.0 } else { -1.0 };
        return (a.centre + b.centre + towards * (outward * (a.radius + b.radius))) * 0.5;
    }
    let along = 0.5 * (distance + (a.radius * a.radius - b.radius * b.radius) / distance);
    let foot = a.centre + towards * along;
    let Some(third) = third else { return foot };
    let height = libm::sqrt((a.radius * a.radius - along * along).max(0.0));
    let away = across(&towards) * height;
    let (left, right) = (foot + away, foot - away);
    if (left - third.centre).norm() <= (right - third.centre).norm() { left } else { right }
}
