//! Robust least squares for a place in the plane and one offset that all readings share.
//!
//! Minimises `Σ (ν+1)/2 ln(1 + e²/ν) + prior`, the negative log-likelihood of Student's t with ν degrees of freedom, by Levenberg's
//! and Marquardt's damped steps on reweighted squares (weight `(ν+1)/(ν+e²)`; Lange, Little & Taylor 1989). The cost needs
//! one logarithm an iteration, of the product of all `1 + e²/ν`.

use super::AreaPrior;
use adit_core::nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// A residual over its standard deviation, and what it changes by: per metre east, per metre north, per unit of the offset.
#[derive(Debug, Clone, Copy)]
pub struct Residual {
    pub value: f64,
    pub gradient: Vector3<f64>,
}

/// What the fit keeps to.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    /// Degrees of freedom ν.
    pub dof: f64,
    /// Standard deviation of the shared offset; 0 keeps it at zero.
    pub offset_sigma: f64,
    /// Where the tag may be.
    pub prior: Option<&'a AreaPrior>,
    /// Iterations at most.
    pub iterations: usize,
}

/// A minimum.
#[derive(Debug, Clone, Copy)]
pub struct Minimum {
    pub position_m: Vector2<f64>,
    pub covariance_m2: Matrix2<f64>,
    pub cost: f64,
}

/// Steps shorter than this end the search, m.
const SMALL_STEP_M: f64 = 0.005;
/// Weight of the prior where there is none: 1000 km.
const NO_PRIOR_M2: f64 = 1e12;
/// A product of this size is turned into its logarithm.
const LARGE: f64 = 1e200;

struct Normal {
    matrix: Matrix3<f64>,
    right: Vector3<f64>,
    cost: f64,
}

/// The minimum next to `start_m`; `None` where the equations have no solution.
///
/// `residual` gives the one of reading `index` at a place and offset.
#[inline]
pub fn solve(
    count: usize,
    residual: impl Fn(usize, &Vector2<f64>, f64) -> Residual,
    start_m: Vector2<f64>,
    problem: &Problem<'_>,
) -> Option<Minimum> {
    let prior = problem.prior.map(|prior| Some((prior.mean_m, prior.covariance_m2.try_inverse()?)));
    let (mean_m, information) = match prior {
        Some(known) => known?,
        None => (start_m, Matrix2::identity() / NO_PRIOR_M2),
    };
    let offset_information = 1.0 / (problem.offset_sigma * problem.offset_sigma).max(1e-12);
    let normal_at = |position: &Vector2<f64>, offset: f64| {
        let mut matrix = Matrix3::zeros();
        matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&information);
        matrix[(2, 2)] = offset_information;
        let pull = information * (mean_m - position);
        let mut right = Vector3::new(pull.x, pull.y, -offset * offset_information);
        let mut cost = 0.5 * (pull.dot(&(mean_m - position)) + offset * offset * offset_information);
        let mut product = 1.0_f64;
        for index in 0..count {
            let Residual { value, gradient } = residual(index, position, offset);
            let square = value * value;
            let weight = (problem.dof + 1.0) / (problem.dof + square);
            // Only the lower triangle is needed and kept.
            for row in 0..3 {
                let scaled = gradient[row] * weight;
                right[row] -= scaled * value;
                for column in 0..=row {
                    matrix[(row, column)] += scaled * gradient[column];
                }
            }
            product *= 1.0 + square / problem.dof;
            if product > LARGE {
                cost += 0.5 * (problem.dof + 1.0) * libm::log(product);
                product = 1.0;
            }
        }
        cost += 0.5 * (problem.dof + 1.0) * libm::log(product);
        Normal { matrix, right, cost }
    };
    let (mut position, mut offset) = (start_m, 0.0);
    let mut here = normal_at(&position, offset);
    let mut damping = 1e-3;
    for _ in 0..problem.iterations {
        let mut damped = here.matrix;
        for axis in 0..3 {
            damped[(axis, axis)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&here.right);
        let next = (position + step.xy(), offset + step.z);
        let there = normal_at(&next.0, next.1);
        // A cost that is not a number is no progress.
        if there.cost <= here.cost {
            (position, offset) = next;
            here = there;
            damping *= 0.1;
            if step.xy().norm() < SMALL_STEP_M {
                break;
            }
        } else {
            damping = (damping * 10.0).max(0.1);
            if damping > 1e6 {
                break;
            }
        }
    }
    // Information of a reading whose errors have long tails, in the mean (Lange, Little & Taylor 1989, appendix B): the weights of this one
    // sample would make good luck look like certainty. The offset's uncertainty is in the block of the place.
    let mut information_here = Matrix3::zeros();
    information_here.fixed_view_mut::<2, 2>(0, 0).copy_from(&information);
    information_here[(2, 2)] = offset_information;
    let expected = (problem.dof + 1.0) / (problem.dof + 3.0);
    for index in 0..count {
        let Residual { gradient, .. } = residual(index, &position, offset);
        information_here += gradient * gradient.transpose() * expected;
    }
    let covariance = information_here.cholesky()?.inverse();
    let finite = position.iter().all(|value| value.is_finite()) && here.cost.is_finite();
    finite.then(|| Minimum {
        position_m: position,
        covariance_m2: covariance.fixed_view::<2, 2>(0, 0).into_owned(),
        cost: here.cost,
    })
}
