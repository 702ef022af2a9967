//! The judgement where one side has no positions: associate, align, take attitude errors, report.
//!
//! The definitions are those of [`crate::ape`]; `align` is the turn of [`crate::alignment::align_attitudes`].

use crate::EvaluationError;
use crate::alignment::{Alignment, RigidMotion, align_attitudes};
use crate::ape::{self, AttitudeError, AttitudeStatistics, attitude_error};
use crate::association::{Association, associate};
use crate::consistency::{SolutionNees, solution_nees};
use crate::evaluate::{EvaluationOptions, REPORT_PROBABILITY};
use crate::marks::{Judged, Phase};
use crate::report::{Coverage, attitude_rows, bias_line, head_row, nees_lines};
use adit_core::attitude::Attitude;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_core::trajectory::Trajectory;
use nalgebra::Vector3;
use serde::Serialize;
use std::fmt;

/// Which side has no positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WithoutPosition {
    /// The truth was measured without.
    Truth,
    /// The method estimates attitude alone: all its positions are zero.
    Estimate,
}

/// The judgement, with the series behind its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct AttitudeEvaluation {
    /// Stamps of the truth inside the span of the estimate, judged or not.
    pub times: Vec<Time>,
    /// Errors at these times, the estimate aligned.
    pub errors: Vec<AttitudeError>,
    /// Errors at the times that are judged.
    pub judged_errors: Vec<AttitudeError>,
    /// Phases that are not judged.
    pub unmarked: Vec<Phase>,
    /// The turn that aligned the estimate.
    pub turn: Attitude,
    /// The numbers.
    pub report: AttitudeReport,
}

/// The numbers of a judgement of attitude alone.
///
/// In JSON named as in [`crate::report`], with `judged` = `"attitude"`, and `without_position` = `"truth"` or `"estimate"`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AttitudeReport {
    /// What was judged.
    pub judged: &'static str,
    /// Which side has no positions.
    pub without_position: WithoutPosition,
    /// How poses were paired.
    pub association: Association,
    /// What was taken away before errors were taken.
    pub alignment: AppliedTurn,
    /// Poses of the estimate.
    pub poses_estimate: usize,
    /// Poses of the truth.
    pub poses_truth: usize,
    /// Poses of the truth that it does not mark, left out.
    pub poses_unmarked: usize,
    /// Pairs compared.
    pub poses_compared: usize,
    /// Share of the judged poses of the truth that were compared, 0 to 1.
    pub covered_share: f64,
    /// Time from the first to the last pair, s.
    pub duration_s: f64,
    /// The errors.
    #[serde(flatten)]
    pub attitude: AttitudeStatistics,
    /// Consistency of the covariance, when given: of the attitude alone.
    pub nees: Option<SolutionNees>,
}

/// The alignment asked for and the turn found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AppliedTurn {
    /// Kind of alignment.
    pub method: Alignment,
    /// Angle of the turn, degrees, 0 to 180.
    pub rotation_deg: f64,
    /// Turn about the vertical, counter-clockwise seen from above, degrees.
    pub yaw_deg: f64,
}

/// Judges the attitudes of `estimate` against those of `truth`.
///
/// Of the options `start_distance_m`, `attitude`, `relative` and `selection` do not matter here.
pub fn evaluate_attitude(
    estimate: &Trajectory,
    truth: &Trajectory,
    without_position: WithoutPosition,
    options: &EvaluationOptions,
) -> Result<AttitudeEvaluation, EvaluationError> {
    let judged = Judged::of(truth, options.marked.as_deref())?;
    let associated = associate(estimate, &judged.truth, &options.association)?;
    let turn = align_attitudes(&associated.pairs, options.alignment)?;
    let pairs = associated.pairs.map_estimate(|pose| about_origin(turn).pose(pose));
    let judged_errors = ape::attitude_errors(&pairs);
    let no_pair = EvaluationError::TooFewPoses { what: "the association", found: 0, expected: 2 };
    let all = truth.poses().iter().filter_map(|pose| {
        let estimated = turn * estimate.at(pose.time)?.attitude;
        Some((pose.time, attitude_error(&estimated, &pose.attitude)))
    });
    let (times, errors) = all.unzip();
    let stamps = pairs.truth();
    let report = AttitudeReport {
        judged: "attitude",
        without_position,
        association: options.association,
        alignment: AppliedTurn {
            method: options.alignment,
            rotation_deg: turn.angle().to_degrees(),
            yaw_deg: turn.euler_angles().2.to_degrees(),
        },
        poses_estimate: estimate.len(),
        poses_truth: truth.len(),
        poses_unmarked: judged.left_out,
        poses_compared: pairs.len(),
        covered_share: associated.covered_share,
        duration_s: (stamps[stamps.len() - 1].time - stamps[0].time).seconds(),
        attitude: ape::attitude_summary(&judged_errors).ok_or(no_pair)?,
        nees: None,
    };
    Ok(AttitudeEvaluation { times, errors, judged_errors, unmarked: judged.unmarked, turn, report })
}

impl AttitudeEvaluation {
    /// Adds whether the covariance of these solutions of the same estimate is honest.
    pub fn judge_covariance(
        &mut self,
        solutions: &[Solution],
        truth: &Trajectory,
        options: &EvaluationOptions,
    ) -> Result<(), EvaluationError> {
        let judged = Judged::of(truth, options.marked.as_deref())?;
        let solutions = judged.solutions(solutions);
        let nees = solution_nees(&solutions, truth, &about_origin(self.turn), true, REPORT_PROBABILITY)?;
        self.report.nees = Some(SolutionNees { horizontal: None, position: None, ..nees });
        Ok(())
    }
}

fn about_origin(rotation: Attitude) -> RigidMotion {
    RigidMotion { rotation, from_m: Vector3::zeros(), to_m: Vector3::zeros() }
}

impl fmt::Display for WithoutPosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Truth => "the truth has no positions",
            Self::Estimate => "all positions of the estimate are zero",
        })
    }
}

impl fmt::Display for AppliedTurn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.method {
            Alignment::None => return f.write_str("none"),
            Alignment::Start => "heading of the first 2 s",
            Alignment::Se2 => "heading over the run",
            Alignment::Se3 => "all three angles over the run",
        };
        let turn = if self.method == Alignment::Se3 { self.rotation_deg } else { self.yaw_deg };
        write!(f, "{} ({what}): turned {turn:.2}°", self.method)
    }
}

impl fmt::Display for AttitudeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "judged      attitude alone: {}", self.without_position)?;
        let coverage = Coverage {
            association: &self.association,
            poses_truth: self.poses_truth,
            poses_unmarked: self.poses_unmarked,
            poses_compared: self.poses_compared,
            covered_share: self.covered_share,
            duration_s: self.duration_s,
        };
        write!(f, "{coverage}")?;
        writeln!(f, "aligned     {}\n", self.alignment)?;
        head_row(f)?;
        attitude_rows(f, &self.attitude)?;
        writeln!(f)?;
        bias_line(f, &self.attitude)?;
        self.nees.iter().try_for_each(|nees| nees_lines(f, nees))
    }
}
