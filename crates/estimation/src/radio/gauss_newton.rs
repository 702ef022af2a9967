//! Robust least squares for a place in the plane and one further unknown, called offset: what all readings share, or a height.
//!
//! Minimises `Σ (ν+1)/2 ln(1 + e²/ν) + prior`, the negative log-likelihood of Student's t with ν degrees of freedom, by Levenberg's
//! and Marquardt's damped steps on reweighted squares (weight `(ν+1)/(ν+e²)`; Lange, Little & Taylor 1989). The cost needs
//! one logarithm an iteration, of the product of all `1 + e²/ν`.

use super::AreaPrior;
use adit_core::nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// Readings that are worked on together: the processor adds and multiplies several numbers at once where they stand side by side.
pub const LANES: usize = 4;
/// One number of each.
pub type Lane = [f64; LANES];

/// Residuals over their standard deviation, and what they change by: per metre east, per metre north, per unit of the offset. All zero
/// where there is no reading.
#[derive(Debug, Clone, Copy, Default)]
pub struct Residuals {
    pub value: Lane,
    pub east: Lane,
    pub north: Lane,
    pub offset: Lane,
}

/// What the fit keeps to.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    /// Degrees of freedom ν.
    pub dof: f64,
    /// Standard deviation of the offset about zero; 0 keeps it at zero.
    pub offset_sigma: f64,
    /// Steps of the offset shorter than this end the search, in its own unit.
    pub small_offset: f64,
    /// Where the tag may be.
    pub prior: Option<&'a AreaPrior>,
    /// Iterations at most.
    pub iterations: usize,
    /// Steps shorter than this end the search, m.
    pub small_step_m: f64,
}

/// A minimum.
#[derive(Debug, Clone, Copy)]
pub struct Minimum {
    pub position_m: Vector2<f64>,
    pub offset: f64,
    /// Of east, north and offset, as of many readings.
    pub covariance: Matrix3<f64>,
    /// `Σ g gᵀ` of the gradients over σ, unweighted, in the same order.
    pub information: Matrix3<f64>,
    /// Information of place and offset beside the readings.
    pub prior: Matrix3<f64>,
    pub cost: f64,
}

/// Weight of the prior where there is none: 1000 km.
const NO_PRIOR_M2: f64 = 1e12;
/// A product of this size is turned into its logarithm.
const LARGE: f64 = 1e200;

struct Normal {
    matrix: Matrix3<f64>,
    /// `Σ g gᵀ`, unweighted.
    information: Matrix3<f64>,
    right: Vector3<f64>,
    cost: f64,
}

/// Solution of the normal equations with their diagonal stretched, by `L D Lᵀ` without roots; `None` where they are not positive definite.
#[inline]
fn damped_step(normal: &Normal, stretch: f64) -> Option<Vector3<f64>> {
    let (m, r) = (&normal.matrix, &normal.right);
    let d0 = m[(0, 0)] * stretch;
    let (l10, l20) = (m[(1, 0)] / d0, m[(2, 0)] / d0);
    let d1 = m[(1, 1)] * stretch - l10 * m[(1, 0)];
    let below = m[(2, 1)] - l10 * m[(2, 0)];
    let l21 = below / d1;
    let d2 = m[(2, 2)] * stretch - l20 * m[(2, 0)] - l21 * below;
    if !(d0 > 0.0 && d1 > 0.0 && d2 > 0.0) {
        return None;
    }
    let y1 = r.y - l10 * r.x;
    let y2 = r.z - l20 * r.x - l21 * y1;
    let z = y2 / d2;
    let y = y1 / d1 - l21 * z;
    Some(Vector3::new(r.x / d0 - l10 * y - l20 * z, y, z))
}

/// Sums over groups of readings, each lane for itself; `w = 1 / (ν + e²)`.
#[derive(Default)]
struct Sums {
    /// `Σ w g gᵀ`: east², east·north, east·offset, north², north·offset, offset².
    weighted: [Lane; 6],
    /// The same without weights.
    plain: [Lane; 6],
    /// `Σ w g e`.
    errors: [Lane; 3],
    /// `Π (1 + e²/ν)`.
    product: Lane,
}

impl Sums {
    #[inline]
    fn add(&mut self, residuals: &Residuals, dof: f64) {
        let Residuals { value, east, north, offset } = residuals;
        let mut weight = [0.0; LANES];
        for k in 0..LANES {
            let spread = dof + value[k] * value[k];
            weight[k] = 1.0 / spread;
            self.product[k] *= spread / dof;
        }
        let pairs =
            [(east, east), (east, north), (east, offset), (north, north), (north, offset), (offset, offset)];
        for ((weighted, plain), (a, b)) in self.weighted.iter_mut().zip(&mut self.plain).zip(pairs) {
            for k in 0..LANES {
                let square = a[k] * b[k];
                plain[k] += square;
                weighted[k] += square * weight[k];
            }
        }
        for (errors, gradient) in self.errors.iter_mut().zip([east, north, offset]) {
            for k in 0..LANES {
                errors[k] += gradient[k] * value[k] * weight[k];
            }
        }
    }

    /// Half of ν + 1 logarithms of what was multiplied so far, which begins anew.
    fn logarithm(&mut self, dof_plus_one: f64) -> f64 {
        // Each factor is below 1e200: the product of two and two stays finite.
        let [a, b, c, d] = core::mem::replace(&mut self.product, [1.0; LANES]);
        let large = [a, b, c, d].iter().any(|product| *product > 1e75);
        let log = if large {
            [a, b, c, d].iter().map(|product| libm::log(*product)).sum()
        } else {
            libm::log(a * b * c * d)
        };
        0.5 * dof_plus_one * log
    }

    fn right(&self, dof_plus_one: f64) -> Vector3<f64> {
        let [east, north, offset] = self.errors.map(|lane| dof_plus_one * total(&lane));
        Vector3::new(east, north, offset)
    }
}

fn total(lane: &Lane) -> f64 {
    lane.iter().sum()
}

/// From east², east·north, east·offset, north², north·offset, offset².
fn symmetric([ee, en, eo, nn, no, oo]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(*ee, *en, *eo, *en, *nn, *no, *eo, *no, *oo)
}

/// The minimum next to the start; `None` where the equations have no solution.
///
/// `residuals` gives those of the readings from `LANES · group` on at a place and offset.
#[inline]
pub fn solve(
    groups: usize,
    residuals: impl Fn(usize, &Vector2<f64>, f64) -> Residuals,
    (start_m, start_offset): (Vector2<f64>, f64),
    problem: &Problem<'_>,
) -> Option<Minimum> {
    let prior = problem.prior.map(|prior| Some((prior.mean_m, prior.covariance_m2.try_inverse()?)));
    let (mean_m, information) = match prior {
        Some(known) => known?,
        None => (start_m, Matrix2::identity() / NO_PRIOR_M2),
    };
    let offset_information = 1.0 / (problem.offset_sigma * problem.offset_sigma).max(1e-12);
    let mut prior_matrix = Matrix3::zeros();
    prior_matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&information);
    prior_matrix[(2, 2)] = offset_information;
    let dof_plus_one = problem.dof + 1.0;
    let normal_at = |position: &Vector2<f64>, offset: f64| {
        let pull = information * (mean_m - position);
        let mut cost = 0.5 * (pull.dot(&(mean_m - position)) + offset * offset * offset_information);
        let mut sums = Sums { product: [1.0; LANES], ..Sums::default() };
        for group in 0..groups {
            sums.add(&residuals(group, position, offset), problem.dof);
            if sums.product.iter().any(|product| *product > LARGE) {
                cost += sums.logarithm(dof_plus_one);
            }
        }
        cost += sums.logarithm(dof_plus_one);
        let right = Vector3::new(pull.x, pull.y, -offset * offset_information) - sums.right(dof_plus_one);
        let matrix = sums.weighted.map(|lane| dof_plus_one * total(&lane));
        let information = sums.plain.map(|lane| total(&lane));
        Normal {
            matrix: symmetric(&matrix) + prior_matrix,
            information: symmetric(&information),
            right,
            cost,
        }
    };
    let (mut position, mut offset) = (start_m, start_offset);
    let mut here = normal_at(&position, offset);
    let mut damping = 1e-3;
    for _ in 0..problem.iterations {
        let step = damped_step(&here, 1.0 + damping)?;
        let next = (position + step.xy(), offset + step.z);
        let there = normal_at(&next.0, next.1);
        // A cost that is not a number is no progress.
        if there.cost <= here.cost {
            (position, offset) = next;
            here = there;
            damping *= 0.1;
            if step.xy().norm() < problem.small_step_m && step.z.abs() < problem.small_offset {
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
    let expected = dof_plus_one / (problem.dof + 3.0);
    let covariance = (here.information * expected + prior_matrix).cholesky()?.inverse();
    let finite = position.iter().chain([&offset, &here.cost]).all(|value| value.is_finite());
    finite.then_some(Minimum {
        position_m: position,
        offset,
        covariance,
        information: here.information,
        prior: prior_matrix,
        cost: here.cost,
    })
}

impl Minimum {
    /// Of the place alone, m².
    pub fn level_covariance_m2(&self) -> Matrix2<f64> {
        self.covariance.fixed_view::<2, 2>(0, 0).into_owned()
    }
}
