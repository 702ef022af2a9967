//! Methods compared over many runs: errors, their spread over the seeds, and whether the covariance is honest.
//!
//! One run gives one [`RunErrors`]: the errors of its solutions on a grid of [`GRID_S`], estimate minus truth. All runs of one
//! method give its [`MethodSummary`], all methods a [`Comparison`], shown as JSON, as a table or as one HTML page
//! ([`html`]).
//!
//! | figure | over what |
//! |---|---|
//! | `position_m`, `heading_deg`, `velocity_m_s`, `share_below_2m` | all moments of all runs together |
//! | `over_seeds.*` | one number of each run (its largest error, its RMSE, its error at the end), over the runs |
//! | `consistency.*` | NEES at each moment, mean over the runs; the bounds hold that mean with 95 % when the filter is consistent |
//! | `nis` | mean over all measurements of all runs, with its bounds |
//!
//! Position and velocity are horizontal. NEES of position (2), velocity (2), heading (1), and of the five together; a part
//! whose variances are not all above zero in a solution is left out.
//!
//! Several comparisons make a [`Suite`]: each with its [`Figure`] of merit, one number of a run, and the [`PairedDifference`] of methods over the runs.

mod figure;
mod html;
mod paired;
mod run;
mod style;
mod suite;
mod suite_html;
mod summary;

pub use figure::Figure;
pub use html::html;
pub use paired::PairedDifference;
pub use run::{
    Moments, RunErrors, RunOptions, TrueState, loop_error, path_errors_m, run_errors, run_errors_at_truth,
    run_motion,
};
pub use suite::{Difference, JudgedPart, Merit, Suite, SuitePart, covered_shares};
pub use suite_html::{part_html, suite_html};
pub use summary::{
    Comparison, Consistency, MethodSummary, Nees, NisSummary, OverSeeds, Quantiles, RunOutcome, summarise,
};

/// Time between judged moments, s.
pub const GRID_S: f64 = 0.1;
/// Probability that bounds stand for.
pub const PROBABILITY: f64 = 0.95;
