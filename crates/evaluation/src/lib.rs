//! Estimate against truth: how far off a trajectory is, and whether its stated uncertainty is honest.
//!
//! The steps are those of the field, in this order, each usable alone:
//!
//! | step | module | in → out |
//! |---|---|---|
//! | choose | [`marks`] | rows of the truth → those that count |
//! | associate | [`association`] | two trajectories → pairs of poses at the same time |
//! | align | [`alignment`] | pairs → rigid motion (none, start, SE(2), SE(3)) |
//! | absolute errors | [`ape`] | aligned pairs → position and attitude error series |
//! | relative errors | [`rpe`] | pairs → drift over frames or metres |
//! | distance | [`travel`] | positions → path length, end error |
//! | summarise | [`statistics`] | error series → RMSE, percentiles, distribution |
//! | consistency | [`consistency`] | errors and covariances → NEES, NIS and their χ² bounds |
//! | compare | [`compare`] | many runs of several methods → spread over the seeds, HTML |
//! | show | [`report`], [`plot`] | JSON, table, SVG |
//!
//! [`evaluate()`] runs them all, [`evaluate_attitude`] those that need no positions. Nothing here reads or writes files: trajectories come in as
//! [`adit_core::trajectory::Trajectory`], plots and reports go out as text.
//!
//! ```
//! use adit_core::{attitude::Attitude, nalgebra::Vector3, time::Time, trajectory::{Pose, Trajectory}};
//! use adit_evaluation::{EvaluationOptions, evaluate};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let walk = |stretch: f64| {
//!     Trajectory::new((0..100).map(|i| Pose {
//!         time: Time::from_nanos(i * 100_000_000),
//!         position_m: Vector3::new(i as f64 * 0.1 * stretch, (i as f64 * 0.1).sin(), 0.0),
//!         attitude: Attitude::identity(),
//!     }).collect())
//! };
//! let (estimate, truth) = (walk(1.01)?, walk(1.0)?);
//! let evaluation = evaluate(&estimate, &truth, &EvaluationOptions { attitude: false, ..Default::default() })?;
//! assert!(evaluation.report.position.horizontal_m.rmse < 0.05);
//! # Ok(())
//! # }
//! ```

pub mod alignment;
pub mod ape;
pub mod association;
pub mod attitude_only;
pub mod compare;
pub mod consistency;
mod error;
pub mod evaluate;
pub mod marks;
pub mod plot;
pub mod report;
pub mod rpe;
pub mod statistics;
pub mod travel;

pub use attitude_only::{AttitudeEvaluation, WithoutPosition, evaluate_attitude};
pub use error::EvaluationError;
pub use evaluate::{Evaluation, EvaluationOptions, evaluate, evaluate_solutions};
