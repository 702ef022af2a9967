//! The whole judgement in one call: associate, align, take errors, report.

use crate::EvaluationError;
use crate::alignment::{Alignment, RigidMotion, align};
use crate::ape::{self, AttitudeError, PositionErrors, circular_error_probable_m};
use crate::association::{Association, PosePairs, associate};
use crate::consistency::{SolutionNees, solution_nees};
use crate::marks::{Judged, Phase};
use crate::report::{AppliedAlignment, EvaluationReport, RelativeReport};
use crate::rpe::{Delta, Frame, Selection, relative_errors};
use crate::statistics::{Distribution, Statistics};
use crate::travel::{FinalError, Travel};
use adit_core::solution::Solution;
use adit_core::trajectory::{Pose, Trajectory};
use nalgebra::Vector3;

/// Probability that the χ² bounds of a report stand for.
pub(crate) const REPORT_PROBABILITY: f64 = 0.95;

/// What to compare, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationOptions {
    /// How poses are paired.
    pub association: Association,
    /// What is taken away before absolute errors are taken.
    pub alignment: Alignment,
    /// For [`Alignment::Start`]: the direction to the first true pose this far from the start gives the heading, m.
    pub start_distance_m: f64,
    /// The truth has attitudes: judge them too. Off for a truth of positions alone.
    pub attitude: bool,
    /// For each pose of the truth, whether it counts; see [`crate::marks`]. All do where this is none.
    pub marked: Option<Vec<bool>>,
    /// Deltas of the relative errors.
    pub relative: Vec<Delta>,
    /// Which pairs the relative errors take.
    pub selection: Selection,
}

impl Default for EvaluationOptions {
    /// Interpolation over 95 % of the truth, SE(2), attitudes judged, every pose counts, relative errors over 1 m and 10 m.
    fn default() -> Self {
        Self {
            association: Association::default(),
            alignment: Alignment::default(),
            start_distance_m: 1.0,
            attitude: true,
            marked: None,
            relative: vec![Delta::Metres(1.0), Delta::Metres(10.0)],
            selection: Selection::default(),
        }
    }
}

/// The judgement, with the series behind its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Paired poses, the estimate aligned.
    pub pairs: PosePairs,
    /// The motion that aligned the estimate.
    pub motion: RigidMotion,
    /// The whole estimate at its own rate, aligned.
    pub estimate: Trajectory,
    /// The whole truth.
    pub truth: Trajectory,
    /// Position errors over time.
    pub position_errors: PositionErrors,
    /// Attitude errors at the same times, empty when not judged.
    pub attitude_errors: Vec<AttitudeError>,
    /// Phases that are not judged.
    pub unmarked: Vec<Phase>,
    /// The numbers.
    pub report: EvaluationReport,
}

/// Judges `estimate` against `truth`.
pub fn evaluate(
    estimate: &Trajectory,
    truth: &Trajectory,
    options: &EvaluationOptions,
) -> Result<Evaluation, EvaluationError> {
    let judged = Judged::of(truth, options.marked.as_deref())?;
    let associated = associate(estimate, &judged.truth, &options.association)?;
    let motion = align(&associated.pairs, options.alignment, options.start_distance_m)?;
    let pairs = associated.pairs.map_estimate(|pose| motion.pose(pose));

    let position_errors = PositionErrors::of(&pairs);
    let attitude_errors = if options.attitude { ape::attitude_errors(&pairs) } else { Vec::new() };
    let relative = options.relative.iter().map(|delta| relative_report(&pairs, *delta, options));

    let no_pair = EvaluationError::TooFewPoses { what: "the association", found: 0, expected: 2 };
    let horizontal = Distribution::of(&position_errors.horizontal_m()).ok_or_else(|| no_pair.clone())?;
    let travel = Travel::of(&positions(pairs.estimate()), &positions(pairs.truth()));
    let last_error = position_errors.errors_m()[pairs.len() - 1];
    let times = position_errors.times();
    let report = EvaluationReport {
        association: options.association,
        alignment: AppliedAlignment::new(options.alignment, options.start_distance_m, &motion),
        poses_estimate: estimate.len(),
        poses_truth: truth.len(),
        poses_unmarked: judged.left_out,
        poses_compared: pairs.len(),
        covered_share: associated.covered_share,
        duration_s: (times[times.len() - 1] - times[0]).seconds(),
        position: position_errors.summary().ok_or(no_pair)?,
        cep50_m: circular_error_probable_m(&horizontal, 0.5),
        cep95_m: circular_error_probable_m(&horizontal, 0.95),
        attitude: ape::attitude_summary(&attitude_errors),
        end: FinalError::of(&last_error, travel.path_truth_m),
        travel,
        relative: relative.collect::<Result<_, _>>()?,
        nees: None,
    };
    Ok(Evaluation {
        estimate: motion.trajectory(estimate)?,
        truth: truth.clone(),
        pairs,
        motion,
        position_errors,
        attitude_errors,
        unmarked: judged.unmarked,
        report,
    })
}

impl Evaluation {
    /// Adds whether the covariance of these solutions of the same estimate is honest.
    pub fn judge_covariance(
        &mut self,
        solutions: &[Solution],
        options: &EvaluationOptions,
    ) -> Result<(), EvaluationError> {
        let solutions = Judged::of(&self.truth, options.marked.as_deref())?.solutions(solutions);
        let nees =
            solution_nees(&solutions, &self.truth, &self.motion, options.attitude, REPORT_PROBABILITY)?;
        self.report.nees = Some(nees);
        Ok(())
    }
}

/// Judges solutions with covariance: as [`evaluate`], and whether the covariance is honest.
pub fn evaluate_solutions(
    solutions: &[Solution],
    truth: &Trajectory,
    options: &EvaluationOptions,
) -> Result<Evaluation, EvaluationError> {
    let mut evaluation = evaluate(&trajectory(solutions)?, truth, options)?;
    evaluation.judge_covariance(solutions, options)?;
    let given =
        |nees: &SolutionNees| [nees.horizontal, nees.position, nees.attitude].iter().any(Option::is_some);
    evaluation.report.nees = evaluation.report.nees.filter(given);
    Ok(evaluation)
}

/// Poses of solutions; error when their times do not rise.
pub fn trajectory(solutions: &[Solution]) -> Result<Trajectory, EvaluationError> {
    let pose = |s: &Solution| Pose { time: s.time, position_m: s.position_m, attitude: s.attitude };
    Ok(Trajectory::new(solutions.iter().map(pose).collect())?)
}

fn positions(poses: &[Pose]) -> Vec<Vector3<f64>> {
    poses.iter().map(|pose| pose.position_m).collect()
}

/// A path too short for the delta is reported with no pair, not refused: it is one line among many.
fn relative_report(
    pairs: &PosePairs,
    delta: Delta,
    options: &EvaluationOptions,
) -> Result<RelativeReport, EvaluationError> {
    let frame = if options.attitude { Frame::Body } else { Frame::Navigation };
    let selection = options.selection;
    let (pairs, translation_m, angle_deg) = match relative_errors(pairs, delta, selection, frame) {
        Ok(errors) => {
            let degrees: Vec<f64> = errors.angle_rad.iter().map(|angle| angle.to_degrees()).collect();
            let angle = if options.attitude { Statistics::of(&degrees) } else { None };
            (errors.indices.len(), Statistics::of(&errors.translation_m), angle)
        }
        Err(EvaluationError::NoRelativePair { .. }) => (0, None, None),
        Err(error) => return Err(error),
    };
    Ok(RelativeReport { delta, selection, frame, pairs, translation_m, angle_deg })
}
