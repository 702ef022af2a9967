//! What can go wrong when an estimate is judged.

use adit_core::time::{Interval, Time};
use adit_core::trajectory::TrajectoryError;

/// Why an estimate could not be judged; each variant holds what was found and what was expected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EvaluationError {
    /// Too few poses to compare.
    #[error("{what} has {found} poses, at least {expected} are needed")]
    TooFewPoses {
        /// Which side: "the estimate", "the truth" or "the association".
        what: &'static str,
        /// Poses found.
        found: usize,
        /// Poses needed.
        expected: usize,
    },
    /// The estimate is silent for too much of the truth.
    #[error(
        "the estimate ({estimate_start} s to {estimate_end} s) covers {:.1} % of the truth ({truth_start} s to \
         {truth_end} s), at least {:.1} % is asked for", found * 100.0, expected * 100.0
    )]
    CoverageTooLow {
        /// Share of the truth stamps inside the span of the estimate, 0 to 1.
        found: f64,
        /// Share asked for, 0 to 1.
        expected: f64,
        /// First stamp of the estimate.
        estimate_start: Time,
        /// Last stamp of the estimate.
        estimate_end: Time,
        /// First stamp of the truth.
        truth_start: Time,
        /// Last stamp of the truth.
        truth_end: Time,
    },
    /// Marks and poses of a truth differ in number.
    #[error("{found} marks for {expected} poses of the truth")]
    MarksDiffer {
        /// Number of marks.
        found: usize,
        /// Number of poses.
        expected: usize,
    },
    /// No two stamps lie near enough to each other.
    #[error("no stamp of the estimate lies within {max_difference} s of a stamp of the truth")]
    NoMatch {
        /// Largest difference allowed.
        max_difference: Interval,
    },
    /// The rotation of an SE(3) alignment is not determined: the poses lie on a line or in a point.
    #[error(
        "SE(3) alignment needs poses spread in two directions, found a spread of {found:e} of the largest in the \
         second, at least {expected:e} is needed; align by se2, start or none"
    )]
    Degenerate {
        /// Spread that fixes the rotation, relative to the whole spread (0 for a line).
        found: f64,
        /// Smallest one accepted.
        expected: f64,
    },
    /// The name of an alignment is not known.
    #[error("unknown alignment \"{found}\", expected none, start, se2 or se3")]
    UnknownAlignment {
        /// The name found.
        found: String,
    },
    /// A relative error was asked over a delta that the path does not hold.
    #[error("no pair of poses is {delta} apart among {poses} poses over {path_m:.3} m")]
    NoRelativePair {
        /// The delta asked for, with its unit.
        delta: String,
        /// Poses compared.
        poses: usize,
        /// Length of the estimated path, m.
        path_m: f64,
    },
    /// A setting is outside its range.
    #[error("{what} is {found}, expected {expected}")]
    OutOfRange {
        /// The setting.
        what: &'static str,
        /// Its value.
        found: f64,
        /// The range that holds, in words.
        expected: &'static str,
    },
    /// A covariance has no Cholesky factor.
    #[error("covariance {index} ({dimension} x {dimension}) is not positive definite")]
    NotPositiveDefinite {
        /// Index of the sample, from 0.
        index: usize,
        /// Dimension of the matrix.
        dimension: usize,
    },
    /// Runs of a Monte Carlo study differ in length.
    #[error("run {run} has {found} samples, the first has {expected}")]
    RunsDiffer {
        /// Index of the run, from 0.
        run: usize,
        /// Its number of samples.
        found: usize,
        /// Number of samples of the first run.
        expected: usize,
    },
    /// Solutions do not form a trajectory.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// A figure could not be drawn.
    #[error("figure not drawn: {reason}")]
    Plot {
        /// What the drawing library said.
        reason: String,
    },
}
