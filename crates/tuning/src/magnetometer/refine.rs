//! The ellipsoid of least squares in the length of the field (Renaudin, Afzal & Lachapelle 2010, section 4: the adjusted
//! maximum likelihood estimate), by Levenberg–Marquardt, robust or with given weights.
//!
//! Residual `r = |S (x − c)| − 1`, parameters c and the six of the symmetric S. With `y = x − c`, `u = S y / |S y|`:
//! `∂r/∂c = −S u`, `∂r/∂Sᵢᵢ = uᵢ yᵢ`, `∂r/∂Sᵢⱼ = uᵢ yⱼ + uⱼ yᵢ`. To first order in the noise this residual is the distance to the
//! ellipsoid, where the algebraic one is biased.

use super::ellipsoid::{Ellipsoid, PARAMETERS};
use crate::robust::{self, BIWEIGHT_CUT};
use adit_core::nalgebra::{Cholesky, Matrix3, SMatrix, SVector, Vector3};

/// A square matrix over the parameters: c, then S as xx, yy, zz, yz, xz, xy.
pub type ParameterMatrix = SMatrix<f64, PARAMETERS, PARAMETERS>;
type Parameters = SVector<f64, PARAMETERS>;

/// Passes over the points at most, for one choice of weights.
const MOST_STEPS: usize = 40;
/// A step that changes the cost by less, relatively, is the last.
const CONVERGED: f64 = 1e-12;
/// Times the scale of the residuals is taken anew.
const RESCALES: usize = 4;
/// Scale below which residuals are rounding.
const FINEST_SCALE: f64 = 1e-9;

/// Residual of a point and its derivatives.
#[inline]
pub fn derivatives(ellipsoid: &Ellipsoid, point: &Vector3<f64>) -> (f64, Parameters) {
    let y = point - ellipsoid.centre;
    let z = ellipsoid.shape * y;
    let length = z.norm();
    let u = z / length;
    let c = -(ellipsoid.shape * u);
    let gradient = Parameters::from([
        c.x,
        c.y,
        c.z,
        u.x * y.x,
        u.y * y.y,
        u.z * y.z,
        u.y * y.z + u.z * y.y,
        u.x * y.z + u.z * y.x,
        u.x * y.y + u.y * y.x,
    ]);
    (length - 1.0, gradient)
}

/// What one pass over the points gives.
struct Pass {
    information: ParameterMatrix,
    gradient: Parameters,
    cost: f64,
}

/// Sums over points; `judge` turns a point's number and residual into weight and cost.
fn pass(points: &[Vector3<f64>], ellipsoid: &Ellipsoid, judge: &impl Fn(usize, f64) -> (f64, f64)) -> Pass {
    let (mut information, mut gradient, mut cost) = (ParameterMatrix::zeros(), Parameters::zeros(), 0.0);
    for (index, point) in points.iter().enumerate() {
        let (residual, slope) = derivatives(ellipsoid, point);
        let (weight, own_cost) = judge(index, residual);
        cost += own_cost;
        if weight > 0.0 {
            let weighted = slope * weight;
            // The lower triangle only.
            for column in 0..PARAMETERS {
                for row in column..PARAMETERS {
                    information[(row, column)] += weighted[row] * slope[column];
                }
            }
            gradient += weighted * residual;
        }
    }
    information.fill_upper_triangle_with_lower_triangle();
    Pass { information, gradient, cost }
}

fn moved(ellipsoid: &Ellipsoid, step: &Parameters) -> Ellipsoid {
    let [cx, cy, cz, xx, yy, zz, yz, xz, xy] = (*step).into();
    Ellipsoid {
        centre: ellipsoid.centre + Vector3::new(cx, cy, cz),
        shape: ellipsoid.shape + Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}

fn is_ellipsoid(ellipsoid: &Ellipsoid) -> bool {
    ellipsoid.centre.iter().all(|v| v.is_finite()) && Cholesky::new(ellipsoid.shape).is_some()
}

/// Levenberg–Marquardt (Marquardt 1963) from `start` to the nearest least cost; `None` where the points do not hold it.
fn minimise(
    points: &[Vector3<f64>],
    start: Ellipsoid,
    judge: impl Fn(usize, f64) -> (f64, f64),
) -> Option<Ellipsoid> {
    let mut at = start;
    let mut here = pass(points, &at, &judge);
    let mut damping = 1e-4;
    for _ in 0..MOST_STEPS {
        let damped =
            here.information + ParameterMatrix::from_diagonal(&(here.information.diagonal() * damping));
        let step = -Cholesky::new(damped)?.solve(&here.gradient);
        let there = moved(&at, &step);
        let beyond = if is_ellipsoid(&there) { Some(pass(points, &there, &judge)) } else { None };
        match beyond {
            Some(beyond) if beyond.cost <= here.cost => {
                let converged = here.cost - beyond.cost <= CONVERGED * here.cost;
                (at, here) = (there, beyond);
                if converged {
                    return Some(at);
                }
                damping = (damping * 0.1).max(1e-12);
            }
            _ if damping > 1e8 => return Some(at),
            _ => damping *= 10.0,
        }
    }
    Some(at)
}

/// The robust fit: Tukey's biweight, its scale taken anew from the residuals until it stays. Also gives the scale.
pub fn robust(points: &[Vector3<f64>], start: Ellipsoid) -> Option<(Ellipsoid, f64)> {
    let mut at = start;
    let mut scale = residual_scale(points, &at)?;
    for _ in 0..RESCALES {
        let cut = BIWEIGHT_CUT * scale;
        at = minimise(points, at, |_, residual| {
            (robust::biweight(residual / cut), cut * cut * robust::biweight_cost(residual / cut) / 3.0)
        })?;
        let before = scale;
        scale = residual_scale(points, &at)?;
        if (scale - before).abs() < 0.01 * before {
            break;
        }
    }
    Some((at, scale))
}

/// Least squares with a weight for each point.
pub fn weighted(
    points: &[Vector3<f64>],
    start: Ellipsoid,
    weight: impl Fn(usize) -> f64,
) -> Option<Ellipsoid> {
    minimise(points, start, |index, residual| {
        let weight = weight(index);
        (weight, weight * residual * residual)
    })
}

fn residual_scale(points: &[Vector3<f64>], ellipsoid: &Ellipsoid) -> Option<f64> {
    let scale = robust::spread_about(points.iter().map(|p| ellipsoid.residual(p)), 0.0)?;
    Some(scale.max(FINEST_SCALE))
}
