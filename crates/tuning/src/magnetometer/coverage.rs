//! Did the motion show the sensor enough directions of the field?
//!
//! The sphere of directions is cut into 82 cells of one size. Each cell that was seen counts as one observation of the
//! ellipsoid, whatever the number of its samples, with an error of its own (1 % or what the residuals show, if
//! more). Their normal matrix then tells how wrong the calibrated field may be in any direction, seen or not:
//! `σ²(u) = j(u)ᵀ (Σ j jᵀ)⁻¹ j(u)`. Seen evenly, the best any motion can do, this is `√(9/82) = 0.33` of a cell's error
//! everywhere (Kiefer & Wolfowitz 1960); it grows without bounds where all samples lie on a plane.
//!
//! This is a statement on the design of the motion, not on the noise: a narrow cap seen a million times determines the
//! ellipsoid as far as its formal covariance goes, and is still worthless, since nothing real is an exact ellipsoid.

use super::ellipsoid::{Ellipsoid, PARAMETERS};
use super::refine::ParameterMatrix;
use adit_core::nalgebra::{Cholesky, SVector, Vector3};
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use std::fmt;

/// Cells of each ring from the south pole of the sensor's z axis to the north: near squares of one area.
const RINGS: [usize; 8] = [3, 9, 13, 16, 16, 13, 9, 3];
/// Cells of the sphere of directions.
pub const CELLS: usize = 82;
/// Samples with which a cell counts as seen: a stray reading shows nothing.
const FEWEST_IN_A_CELL: u32 = 3;
/// What the field of an ordinary room differs by from place to place, at least, as a share.
pub const PLACE_ERROR: f64 = 0.01;
/// Largest error of the calibrated field allowed in any direction, as a share: 1.1° of direction, at a dip of 67° 2.9° of heading.
pub const LARGEST_ERROR: f64 = 0.02;
/// Directions looked at.
const LOOKED_AT: usize = 800;
/// Directions named to the user are at least this far apart, cosine of 60°.
const APART_COS: f64 = 0.5;
/// Directions named at most.
const NAMED: usize = 3;

/// Which directions of the field the motion showed, and what follows for the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coverage {
    /// Cells seen, of [`CELLS`].
    pub cells_seen: usize,
    /// All cells.
    pub cells: usize,
    /// Largest error of the calibrated field to be expected in any direction, % of the field.
    pub worst_error_percent: f64,
    /// Directions of the field, sensor axes, in which the error is too large, worst first, 60° apart.
    pub missing: Vec<Direction>,
}

impl Coverage {
    /// Coverage by the directions (unit vectors) of samples, whose places differ by `place` (share of the field).
    pub fn of(directions: impl Iterator<Item = Vector3<f64>>, place: f64) -> Self {
        let mut cells = [(0_u32, Vector3::<f64>::zeros()); CELLS];
        for direction in directions {
            let (count, sum) = &mut cells[cell(&direction)];
            *count = count.saturating_add(1);
            *sum += direction;
        }
        let seen = || cells.iter().filter(|(count, _)| *count >= FEWEST_IN_A_CELL);
        let mut information = ParameterMatrix::zeros();
        for (_, sum) in seen() {
            let slope = slope(&sum.normalize());
            information.ger(1.0, &slope, &slope, 1.0);
        }
        let error = place.max(PLACE_ERROR);
        let mut errors: Vec<(f64, Vector3<f64>)> = directions_everywhere()
            .map(|u| (Cholesky::new(information).map_or(f64::INFINITY, |a| amplification(&a, &u)) * error, u))
            .collect();
        errors.sort_by(|a, b| b.0.total_cmp(&a.0));
        let worst_error_percent = 100.0 * errors.first().map_or(f64::INFINITY, |(worst, _)| *worst);
        let mut missing: Vec<Direction> = Vec::new();
        for (_, u) in errors.iter().take_while(|(error, _)| *error > LARGEST_ERROR) {
            if missing.len() < NAMED && missing.iter().all(|named| named.0.dot(u) < APART_COS) {
                missing.push(Direction(*u));
            }
        }
        Self { cells_seen: seen().count(), cells: CELLS, worst_error_percent, missing }
    }

    /// True when the calibration will hold in every direction.
    pub fn is_enough(&self) -> bool {
        self.worst_error_percent <= 100.0 * LARGEST_ERROR
    }
}

/// Directions of the samples that count.
pub fn directions<'a>(
    points: &'a [Vector3<f64>],
    ellipsoid: &'a Ellipsoid,
    limit: f64,
) -> impl Iterator<Item = Vector3<f64>> + use<'a> {
    points.iter().filter_map(move |point| {
        let on_sphere = ellipsoid.on_sphere(point);
        let length = on_sphere.norm();
        ((length - 1.0).abs() <= limit).then(|| on_sphere / length)
    })
}

/// Derivative of the length of the calibrated field with regard to offset and matrix.
fn slope(u: &Vector3<f64>) -> SVector<f64, PARAMETERS> {
    let [x, y, z] = (*u).into();
    SVector::from([x, y, z, x * x, y * y, z * z, 2.0 * y * z, 2.0 * x * z, 2.0 * x * y])
}

/// Largest σ of the length of the calibrated field in any direction that a covariance of offset (µT) and matrix stands for, µT,
/// for a matrix near 1.
pub fn largest_sd(covariance: &ParameterMatrix) -> f64 {
    let sd = |u: Vector3<f64>| {
        let mut slope = slope(&u);
        // A larger offset is a smaller field along it.
        slope.fixed_rows_mut::<3>(0).neg_mut();
        slope.dot(&(covariance * slope)).max(0.0).sqrt()
    };
    directions_everywhere().map(sd).fold(0.0, f64::max)
}

fn amplification(
    information: &Cholesky<f64, adit_core::nalgebra::Const<PARAMETERS>>,
    u: &Vector3<f64>,
) -> f64 {
    let slope = slope(u);
    let variance = slope.dot(&information.solve(&slope));
    if variance.is_finite() && variance > 0.0 { variance.sqrt() } else { f64::INFINITY }
}

/// The cell of a unit vector (Lambert's equal-area cylinder, cut into rings).
fn cell(u: &Vector3<f64>) -> usize {
    let turn = (u.y.atan2(u.x) + PI) / TAU;
    let mut below = 0;
    for count in RINGS {
        let top = 2.0 * (below + count) as f64 / CELLS as f64 - 1.0;
        if u.z <= top || below + count == CELLS {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to the count of the ring"
            )]
            let along = ((turn * count as f64) as usize).min(count - 1);
            return below + along;
        }
        below += count;
    }
    CELLS - 1
}

/// Directions spread evenly over the sphere (the spiral of Fibonacci; Swinbank & Purser 2006).
fn directions_everywhere() -> impl Iterator<Item = Vector3<f64>> {
    let golden_angle = PI * (3.0 - 5_f64.sqrt());
    (0..LOOKED_AT).map(move |i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / LOOKED_AT as f64;
        let (sin, cos) = (golden_angle * i as f64).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        Vector3::new(radius * cos, radius * sin, z)
    })
}

/// A direction in the sensor, named by its axes: `+x`, `-y+z`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Direction(pub Vector3<f64>);

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // An axis that is less than 67° away takes part.
        for (name, along) in ["x", "y", "z"].iter().zip(self.0.iter()) {
            if along.abs() > 0.4 {
                write!(f, "{}{name}", if *along > 0.0 { '+' } else { '-' })?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(keep: impl Fn(&Vector3<f64>) -> bool) -> Coverage {
        // Three of each of 800 directions: ten in every cell.
        let all = directions_everywhere().filter(|u| keep(u)).flat_map(|u| [u; 3]);
        Coverage::of(all, 0.0)
    }

    #[test]
    fn an_even_sphere_reaches_the_bound_of_kiefer_and_wolfowitz() {
        let coverage = seen(|_| true);
        assert_eq!(coverage.cells_seen, CELLS);
        // The bound is √(9/82) %; cells are not points, which costs some percent.
        let bound = 100.0 * PLACE_ERROR * (9.0 / CELLS as f64).sqrt();
        assert!((1.0..1.1).contains(&(coverage.worst_error_percent / bound)), "{coverage:?}");
        assert!(coverage.is_enough() && coverage.missing.is_empty());
    }

    /// The table of `docs/methods/calibration.md`, to its digits.
    #[test]
    fn motions_of_the_page_are_judged_as_it_says() {
        let cos = |degrees: f64| degrees.to_radians().cos();
        let all_but_a_cap = seen(|u| u.z < cos(60.0)).worst_error_percent;
        let half = seen(|u| u.z > 0.0).worst_error_percent;
        let band = |degrees: f64| seen(|u| u.z.abs() < degrees.to_radians().sin()).worst_error_percent;
        let cap = seen(|u| u.z > cos(60.0)).worst_error_percent;
        let table = [all_but_a_cap, half, band(30.0), band(10.0), cap].map(|percent| format!("{percent:.1}"));
        assert_eq!(table, ["0.9", "6.1", "1.5", "96.9", "46.1"]);
    }

    #[test]
    fn half_a_sphere_is_not_enough_and_the_other_half_is_named() {
        let coverage = seen(|u| u.z > 0.0);
        assert!(!coverage.is_enough(), "{coverage:?}");
        assert_eq!(coverage.missing[0].to_string(), "-z");
    }

    #[test]
    fn two_thirds_of_a_sphere_are_enough() {
        assert!(seen(|u| u.z > -0.4).is_enough());
    }

    #[test]
    fn a_turntable_is_not_enough() {
        let coverage = seen(|u| u.z.abs() < 0.1);
        assert!(!coverage.is_enough(), "{coverage:?}");
        assert!(coverage.missing.iter().any(|d| d.to_string() == "+z"), "{:?}", coverage.missing);
        assert!(coverage.missing.iter().any(|d| d.to_string() == "-z"), "{:?}", coverage.missing);
    }

    #[test]
    fn cells_have_one_size() {
        let mut counts = [0_u32; CELLS];
        let many = 82_000;
        let golden_angle = PI * (3.0 - 5_f64.sqrt());
        for i in 0..many {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(many);
            let (sin, cos) = (golden_angle * f64::from(i)).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            counts[cell(&Vector3::new(radius * cos, radius * sin, z))] += 1;
        }
        // A thousand each, but for the points that a border cuts off.
        assert!(counts.iter().all(|n| (960..1040).contains(n)), "{counts:?}");
    }
}
