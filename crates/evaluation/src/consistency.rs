//! Is the stated uncertainty honest? NEES, NIS and their χ² bounds.
//!
//! `NEES = eᵀ P⁻¹ e` of a state error `e` with covariance `P`, `NIS = νᵀ S⁻¹ ν` of an innovation. When the filter is
//! consistent and errors are Gaussian, both follow χ² with the dimension as degrees of freedom; the mean over `N`
//! independent runs times `N` follows χ²(`N d`) (Bar-Shalom, Li & Kirubarajan 2001, §5.4.2), so the mean lies within
//! `[χ²_{N d}(α/2), χ²_{N d}(1 − α/2)] / N` with probability `1 − α`.
//!
//! Samples of **one** run are correlated in time: their mean has no such bound, and is reported beside the bounds of a
//! single sample and the share of samples inside them.
//!
//! State errors are truth minus estimate, the attitude part as the rotation vector `φ` with
//! `q_truth = exp(φ) ∘ q_estimate`, in the navigation frame, as [`adit_core::solution::Solution`] states its covariance.

use crate::EvaluationError;
use crate::alignment::RigidMotion;
use adit_core::attitude;
use adit_core::solution::Solution;
use adit_core::trajectory::{Pose, Trajectory};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// `eᵀ P⁻¹ e`: normalised squared error of a state (NEES) or of an innovation (NIS); error when `P` has no Cholesky factor.
///
/// ```
/// use adit_core::nalgebra::{Matrix2, Vector2};
/// let squared = adit_evaluation::consistency::normalised_squared_error(
///     &Vector2::new(2.0, 3.0), &Matrix2::new(4.0, 0.0, 0.0, 9.0));
/// assert_eq!(squared, Ok(2.0));
/// ```
pub fn normalised_squared_error<const N: usize>(
    error: &SVector<f64, N>,
    covariance: &SMatrix<f64, N, N>,
) -> Result<f64, EvaluationError> {
    let factor = covariance.cholesky();
    let factor = factor.ok_or(EvaluationError::NotPositiveDefinite { index: 0, dimension: N })?;
    Ok(error.dot(&factor.solve(error)))
}

/// Two-sided bounds of a χ² variable or of a mean of some.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bounds {
    /// Lower bound.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
}

impl Bounds {
    /// True when `value` lies between the bounds, ends included.
    pub fn contain(&self, value: f64) -> bool {
        (self.lower..=self.upper).contains(&value)
    }
}

/// Bounds that hold the mean NEES (or NIS) of `runs` independent runs with `probability` when the filter is consistent.
///
/// One run gives the bounds of a single sample.
pub fn average_nees_bounds(
    dimension: usize,
    runs: usize,
    probability: f64,
) -> Result<Bounds, EvaluationError> {
    let out_of_range = |what, found, expected| EvaluationError::OutOfRange { what, found, expected };
    if !(probability > 0.0 && probability < 1.0) {
        return Err(out_of_range("the probability", probability, "between 0 and 1, both excluded"));
    }
    let freedoms = dimension as f64 * runs as f64;
    let distribution = ChiSquared::new(freedoms)
        .map_err(|_| out_of_range("the degrees of freedom (dimension x runs)", freedoms, "1 or more"))?;
    let tail = 0.5 * (1.0 - probability);
    let mean_at = |share: f64| distribution.inverse_cdf(share) / runs as f64;
    Ok(Bounds { lower: mean_at(tail), upper: mean_at(1.0 - tail) })
}

/// Mean NEES over independent runs, sample by sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AverageNees {
    /// Dimension of the error.
    pub dimension: usize,
    /// Number of runs.
    pub runs: usize,
    /// Mean over runs and samples: ideally the dimension.
    pub mean: f64,
    /// Mean over the runs at each sample.
    pub per_sample: Vec<f64>,
    /// Bounds of the mean over the runs at one sample.
    pub bounds: Bounds,
    /// Share of samples whose mean lies inside the bounds: ideally the probability.
    pub share_inside: f64,
}

impl AverageNees {
    /// From one series of NEES per run; all runs have the same number of samples, one at least.
    pub fn over_runs(dimension: usize, runs: &[Vec<f64>], probability: f64) -> Result<Self, EvaluationError> {
        let bounds = average_nees_bounds(dimension, runs.len(), probability)?;
        let samples = runs.first().map_or(0, Vec::len);
        if samples == 0 {
            return Err(EvaluationError::TooFewPoses { what: "the first run", found: 0, expected: 1 });
        }
        if let Some((run, other)) = runs.iter().enumerate().find(|(_, other)| other.len() != samples) {
            return Err(EvaluationError::RunsDiffer { run, found: other.len(), expected: samples });
        }
        let mean_at = |sample: usize| runs.iter().map(|run| run[sample]).sum::<f64>() / runs.len() as f64;
        let per_sample: Vec<f64> = (0..samples).map(mean_at).collect();
        let inside = per_sample.iter().filter(|mean| bounds.contain(**mean)).count();
        Ok(Self {
            dimension,
            runs: runs.len(),
            mean: per_sample.iter().sum::<f64>() / samples as f64,
            per_sample,
            bounds,
            share_inside: inside as f64 / samples as f64,
        })
    }
}

/// NEES of one run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RunNees {
    /// Dimension of the error.
    pub dimension: usize,
    /// Number of samples.
    pub samples: usize,
    /// Mean over the run: ideally the dimension.
    pub mean: f64,
    /// Bounds of a single sample.
    #[serde(flatten)]
    pub bounds: Bounds,
    /// Probability that the bounds stand for.
    pub probability: f64,
    /// Share of samples inside the bounds: ideally the probability.
    pub share_inside: f64,
}

impl RunNees {
    /// Summary of the NEES samples of one run.
    pub fn of(dimension: usize, samples: &[f64], probability: f64) -> Result<Self, EvaluationError> {
        if samples.is_empty() {
            return Err(EvaluationError::TooFewPoses { what: "the run", found: 0, expected: 1 });
        }
        let bounds = average_nees_bounds(dimension, 1, probability)?;
        let inside = samples.iter().filter(|nees| bounds.contain(**nees)).count();
        Ok(Self {
            dimension,
            samples: samples.len(),
            mean: samples.iter().sum::<f64>() / samples.len() as f64,
            bounds,
            probability,
            share_inside: inside as f64 / samples.len() as f64,
        })
    }
}

/// Error `[position (m), velocity (m/s), attitude (rad)]` of a solution, truth minus estimate, blocks as its covariance.
pub fn solution_error(
    solution: &Solution,
    truth: &Pose,
    true_velocity_m_s: &Vector3<f64>,
) -> SVector<f64, 9> {
    let mut error = SVector::<f64, 9>::zeros();
    error.fixed_rows_mut::<3>(0).copy_from(&(truth.position_m - solution.position_m));
    error.fixed_rows_mut::<3>(3).copy_from(&(true_velocity_m_s - solution.velocity_m_s));
    error.fixed_rows_mut::<3>(6).copy_from(&attitude::log(&(truth.attitude * solution.attitude.inverse())));
    error
}

/// NEES of the solutions of one run against the truth; a part whose covariance is not given is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SolutionNees {
    /// Horizontal position, dimension 2.
    pub horizontal: Option<RunNees>,
    /// Position, dimension 3.
    pub position: Option<RunNees>,
    /// Attitude, dimension 3.
    pub attitude: Option<RunNees>,
}

/// NEES of every solution inside the span of `truth`, after the estimate and its covariance have followed `motion`.
///
/// A part counts as given when all its variances are above zero in all solutions; a given part that has no Cholesky
/// factor is an error.
pub fn solution_nees(
    solutions: &[Solution],
    truth: &Trajectory,
    motion: &RigidMotion,
    with_attitude: bool,
    probability: f64,
) -> Result<SolutionNees, EvaluationError> {
    let turn = motion.rotation.to_rotation_matrix();
    let (mut positions, mut attitudes) = (Vec::new(), Vec::new());
    for solution in solutions {
        let Some(truth) = truth.at(solution.time) else { continue };
        let turned = |row| -> Matrix3<f64> {
            turn * solution.covariance.fixed_view::<3, 3>(row, row) * turn.transpose()
        };
        let rotation = truth.attitude * (motion.rotation * solution.attitude).inverse();
        positions.push((truth.position_m - motion.position(&solution.position_m), turned(0)));
        attitudes.push((attitude::log(&rotation), turned(6)));
    }
    let horizontal: Vec<_> =
        positions.iter().map(|(e, p)| (e.xy(), p.fixed_view::<2, 2>(0, 0).into_owned())).collect();
    Ok(SolutionNees {
        horizontal: run_nees(&horizontal, probability)?,
        position: run_nees(&positions, probability)?,
        attitude: if with_attitude { run_nees(&attitudes, probability)? } else { None },
    })
}

fn run_nees<const N: usize>(
    samples: &[(SVector<f64, N>, SMatrix<f64, N, N>)],
    probability: f64,
) -> Result<Option<RunNees>, EvaluationError> {
    let given = samples.iter().all(|(_, covariance)| covariance.diagonal().iter().all(|v| *v > 0.0));
    if samples.is_empty() || !given {
        return Ok(None);
    }
    let nees: Vec<f64> = samples
        .iter()
        .enumerate()
        .map(|(index, (error, covariance))| {
            normalised_squared_error(error, covariance)
                .map_err(|_| EvaluationError::NotPositiveDefinite { index, dimension: N })
        })
        .collect::<Result<_, _>>()?;
    RunNees::of(N, &nees, probability).map(Some)
}
