//! A way along given points with its corners rounded, as a function of the length along the points.
//!
//! Straight pieces have a direction `d` of unit horizontal length, slope included. Within `T` of a corner the direction goes from
//! `d₁` to `d₂` by the quintic step `S(u) = 6u⁵ − 15u⁴ + 10u³`, `u = (σ − σ_corner + T) / 2T`:
//!
//! `P′(σ) = d₁ + (d₂ − d₁) S(u)`, `P(σ) = P_corner + T (2u − 1) d₁ + 2T I(u) (d₂ − d₁)`, `I = ∫S = u⁶ − 3u⁵ + 5u⁴/2`
//!
//! so that `P` is C³ and keeps inside the triangle of the corner. At most half of either neighbouring piece is used. What moves
//! evenly in `σ` slows down in a corner, to `cos(θ/2)` of its speed in the middle of one of angle `θ`.
//! The radius there is `0.533 T cos²(θ/2) / sin(θ/2)`: 0.38 `T` in a right angle.
//!
//! Frame: mine grid, z the floor; m.

use adit_core::nalgebra::Vector3;

/// Points nearer than this are one, m.
const SAME_M: f64 = 1e-3;

/// A way with rounded corners.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Path {
    points: Vec<Vector3<f64>>,
    /// Horizontal length up to each point, m.
    along_m: Vec<f64>,
    /// Direction of each piece, horizontal part of unit length.
    directions: Vec<Vector3<f64>>,
    /// Half of the length over which each corner is rounded, m; 0 at the ends.
    round_m: Vec<f64>,
}

/// A place on a path and its derivatives by the length along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OnPath {
    pub place: Vector3<f64>,
    pub first: Vector3<f64>,
    pub second: Vector3<f64>,
    pub third: Vector3<f64>,
}

impl Path {
    /// Through `points`, corners rounded over `round_m` before and after them where there is room; `None` when no two points
    /// are apart in plan.
    pub fn new(points: impl IntoIterator<Item = Vector3<f64>>, round_m: f64) -> Option<Self> {
        let mut kept: Vec<Vector3<f64>> = Vec::new();
        for point in points {
            if kept.last().is_none_or(|last| (point - last).xy().norm() > SAME_M) {
                kept.push(point);
            }
        }
        let mut along_m = vec![0.0];
        let mut directions = Vec::new();
        let mut end_m = 0.0;
        for pair in kept.windows(2) {
            let length_m = (pair[1] - pair[0]).xy().norm();
            directions.push((pair[1] - pair[0]) / length_m);
            end_m += length_m;
            along_m.push(end_m);
        }
        if directions.is_empty() {
            return None;
        }
        let rounds = (0..kept.len()).map(|corner| {
            if corner == 0 || corner + 1 == kept.len() {
                return 0.0;
            }
            let before = along_m[corner] - along_m[corner - 1];
            let after = along_m[corner + 1] - along_m[corner];
            round_m.min(0.5 * before).min(0.5 * after)
        });
        let round_m = rounds.collect();
        Some(Self { points: kept, along_m, directions, round_m })
    }

    /// Length along its points in plan, m.
    pub fn length_m(&self) -> f64 {
        self.along_m.last().copied().unwrap_or_default()
    }

    /// The piece in which a length lies.
    fn piece(&self, sigma_m: f64) -> usize {
        self.along_m
            .partition_point(|along| *along <= sigma_m)
            .saturating_sub(1)
            .min(self.directions.len() - 1)
    }

    /// The place this far along, ends beyond the ends.
    pub fn at(&self, sigma_m: f64) -> OnPath {
        let sigma = sigma_m.clamp(0.0, self.length_m());
        let piece = self.piece(sigma);
        let here = self.directions[piece];
        for corner in [piece, piece + 1] {
            let round = self.round_m[corner];
            let off = sigma - self.along_m[corner];
            if off.abs() < round {
                let (before, after) = (self.directions[corner - 1], self.directions[corner]);
                return rounded(&self.points[corner], &before, &after, round, off);
            }
        }
        let place = self.points[piece] + here * (sigma - self.along_m[piece]);
        OnPath { place, first: here, second: Vector3::zeros(), third: Vector3::zeros() }
    }

    /// Height of the floor this far along: that of the points, not rounded, m.
    pub fn floor_m(&self, sigma_m: f64) -> f64 {
        let sigma = sigma_m.clamp(0.0, self.length_m());
        let piece = self.piece(sigma);
        self.points[piece].z + self.directions[piece].z * (sigma - self.along_m[piece])
    }
}

/// In the corner at `point`, `off` from it.
fn rounded(
    point: &Vector3<f64>,
    before: &Vector3<f64>,
    after: &Vector3<f64>,
    round: f64,
    off: f64,
) -> OnPath {
    let u = 0.5 * (off + round) / round;
    let turn = after - before;
    let (square, rest) = (u * u, 1.0 - u);
    let integral = square * square * (2.5 + u * (u - 3.0));
    let step = square * u * (10.0 + u * (6.0 * u - 15.0));
    let (rate, bend) = (30.0 * square * rest * rest, 60.0 * u * rest * (1.0 - 2.0 * u));
    let width = 2.0 * round;
    OnPath {
        place: point + before * off + turn * (width * integral),
        first: before + turn * step,
        second: turn * (rate / width),
        third: turn * (bend / (width * width)),
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn bend() -> Path {
        let points = [[0.0, 0.0, 0.0], [10.0, 0.0, 1.0], [10.0, 0.0, 1.0], [10.0, 8.0, 1.0], [2.0, 8.0, 0.0]];
        Path::new(points.map(Vector3::from), 2.0).unwrap()
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (path, h) = (bend(), 1e-4);
        for i in 1..2590 {
            let sigma = 0.01 * f64::from(i) + 0.003;
            let (before, here, after) = (path.at(sigma - h), path.at(sigma), path.at(sigma + h));
            // Central differences: h²/6 of the next but one derivative, which stays below 30 /m⁴.
            assert!(((after.place - before.place) / (2.0 * h) - here.first).norm() < 1e-7);
            assert!(((after.first - before.first) / (2.0 * h) - here.second).norm() < 1e-6);
            assert!(((after.second - before.second) / (2.0 * h) - here.third).norm() < 1e-3, "at {sigma}");
        }
    }

    #[test]
    fn the_middle_of_a_right_angle_has_the_radius_that_the_head_promises() {
        let path = bend();
        let on = path.at(10.0);
        let radius_m = on.first.xy().norm().powi(3) / on.first.xy().perp(&on.second.xy()).abs();
        // T cos²(45°) / (15/8 sin(45°)), T = 2 m; rounding only.
        assert!((radius_m - 2.0 * 8.0 / 15.0 * core::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12, "{radius_m}");
    }

    #[test]
    fn a_path_without_length_is_none() {
        assert!(Path::new([Vector3::zeros(), Vector3::z()], 1.0).is_none());
    }
}
