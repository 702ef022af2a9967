//! One run of one method against its truth.

use super::GRID_S;
use crate::EvaluationError;
use crate::alignment::{Alignment, RigidMotion, align};
use crate::association::{Association, associate};
use crate::attitude_only::{WithoutPosition, evaluate_attitude};
use crate::consistency::normalised_squared_error;
use crate::evaluate::{EvaluationOptions, evaluate, trajectory};
use crate::marks::Judged;
use adit_core::solution::Solution;
use adit_core::time::{Interval, Time};
use adit_core::trajectory::{Pose, Trajectory};
use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector1, Vector3};

/// Number of NEES parts: position, velocity, heading, all.
pub(super) const PARTS: usize = 4;
/// Dimension of each.
pub(super) const DIMENSIONS: [usize; PARTS] = [2, 2, 1, 5];

/// Truth at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueState {
    /// Pose of the body.
    pub pose: Pose,
    /// Velocity, m/s, where it is known.
    pub velocity_m_s: Option<Vector3<f64>>,
}

/// Which moments of a run are judged: the solutions nearest after the points of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// From this time after the first truth on, s.
    pub from_s: f64,
    /// Time between two of them, s.
    pub every_s: f64,
    /// Only while the truth moves faster than this horizontally, m/s: over a second, so that one step does not count.
    pub above_m_s: f64,
}

impl Default for Moments {
    /// All of them, every [`GRID_S`].
    fn default() -> Self {
        Self { from_s: 0.0, every_s: GRID_S, above_m_s: 0.0 }
    }
}

/// How a run is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunOptions {
    /// What is taken away before errors are taken.
    pub alignment: Alignment,
    /// Which moments are judged.
    pub moments: Moments,
    /// The method estimates positions and velocities, not attitude alone.
    pub positions: bool,
    /// The truth has heights.
    pub heights: bool,
    /// The truth has attitudes.
    pub attitudes: bool,
}

/// Errors of one run at its judged moments, estimate minus truth. Single precision: it is the errors that are kept.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunErrors {
    /// Time since the first truth, s.
    pub time_s: Vec<f32>,
    /// East and north, m; empty without positions.
    pub level_m: Vec<[f32; 2]>,
    /// Heading, deg; empty without attitudes.
    pub heading_deg: Vec<f32>,
    /// Horizontal velocity, m/s; empty where the truth has none.
    pub velocity_m_s: Vec<f32>,
    /// Height, m; empty without positions, or where the truth has no heights.
    pub up_m: Vec<f32>,
    /// The whole angle between attitudes, deg; empty without attitudes.
    pub attitude_deg: Vec<f32>,
    /// NEES of position, velocity, heading, all; NaN where it is not given.
    pub nees: Vec<[f32; PARTS]>,
}

/// Judges the solutions of a run.
pub fn run_errors(
    solutions: &[Solution],
    truth: &[TrueState],
    options: &RunOptions,
) -> Result<RunErrors, EvaluationError> {
    let path = Trajectory::new(truth.iter().map(|state| state.pose).collect())?;
    let motion = run_motion(solutions, &path, options)?;
    let mut errors = RunErrors::default();
    for (index, since_s, pose) in judged(solutions.iter().map(|s| s.time), &path, options.moments) {
        let solution = &solutions[index];
        errors.push(since_s, solution, &pose, velocity_at(truth, solution.time), &motion, options);
    }
    if errors.time_s.is_empty() {
        return Err(NOTHING_JUDGED);
    }
    Ok(errors)
}

/// What aligns the solutions of a run with its truth.
pub fn run_motion(
    solutions: &[Solution],
    truth: &Trajectory,
    options: &RunOptions,
) -> Result<RigidMotion, EvaluationError> {
    if !options.positions || options.alignment == Alignment::None {
        return Ok(RigidMotion::identity());
    }
    motion(&trajectory(solutions)?, truth, options.alignment)
}

/// Judges the solutions of a run at the stamps of its truth that are marked (all, where it marks none), as [`crate::evaluate()`] does: for a truth
/// that is a list of places and says nothing between them. The moments of the options do not matter; errors have no NEES.
pub fn run_errors_at_truth(
    solutions: &[Solution],
    truth: &Trajectory,
    marked: Option<&[bool]>,
    options: &RunOptions,
) -> Result<RunErrors, EvaluationError> {
    let estimate = trajectory(solutions)?;
    let how = EvaluationOptions {
        alignment: options.alignment,
        attitude: options.attitudes,
        marked: marked.map(<[bool]>::to_vec),
        relative: Vec::new(),
        ..EvaluationOptions::default()
    };
    let mut errors = RunErrors::default();
    let first = truth.poses().first().map(|pose| pose.time);
    let since = |time: Time| first.map_or(0.0, |first| (time - first).seconds());
    let attitudes = if options.positions {
        let judged = evaluate(&estimate, truth, &how)?;
        let positions = &judged.position_errors;
        errors.time_s = positions.times().iter().map(|time| single(since(*time))).collect();
        errors.level_m = positions.errors_m().iter().map(|e| [single(e.x), single(e.y)]).collect();
        if options.heights {
            errors.up_m = positions.errors_m().iter().map(|e| single(e.z)).collect();
        }
        judged.attitude_errors
    } else {
        let judged = evaluate_attitude(&estimate, truth, WithoutPosition::Truth, &how)?.judged_errors;
        let scored = Judged::of(truth, marked)?.truth;
        let covered = |time: Time| estimate.at(time).is_some();
        let times = scored.poses().iter().map(|pose| pose.time).filter(|time| covered(*time));
        errors.time_s = times.map(|time| single(since(time))).collect();
        judged
    };
    errors.heading_deg = attitudes.iter().map(|e| single(e.signed_heading_rad.to_degrees())).collect();
    errors.attitude_deg = attitudes.iter().map(|e| single(e.total_rad.to_degrees())).collect();
    Ok(errors)
}

/// Judges a run of which nothing is known but that it ended where it began: one error, of its last position against its first.
pub fn loop_error(solutions: &[Solution]) -> Result<RunErrors, EvaluationError> {
    let (Some(first), Some(last)) = (solutions.first(), solutions.last()) else { return Err(NOTHING_JUDGED) };
    let error = last.position_m - first.position_m;
    Ok(RunErrors {
        time_s: vec![single((last.time - first.time).seconds())],
        level_m: vec![[single(error.x), single(error.y)]],
        up_m: vec![single(error.z)],
        ..RunErrors::default()
    })
}

/// Horizontal position errors of a path, m, at the moments at which [`run_errors`] judges it.
pub fn path_errors_m(
    estimate: &Trajectory,
    truth: &Trajectory,
    alignment: Alignment,
    moments: Moments,
) -> Result<Vec<f64>, EvaluationError> {
    let motion = motion(estimate, truth, alignment)?;
    let poses = estimate.poses();
    let error = |(index, _, pose): (usize, f64, Pose)| {
        (motion.position(&poses[index].position_m) - pose.position_m).xy().norm()
    };
    let errors: Vec<f64> = judged(poses.iter().map(|pose| pose.time), truth, moments).map(error).collect();
    if errors.is_empty() { Err(NOTHING_JUDGED) } else { Ok(errors) }
}

/// No moment of the run could be judged.
const NOTHING_JUDGED: EvaluationError =
    EvaluationError::TooFewPoses { what: "the judged part of the run", found: 0, expected: 1 };

/// Of these times those that are judged: number, time since the first truth, s, and the truth then.
fn judged(
    times: impl Iterator<Item = Time>,
    truth: &Trajectory,
    moments: Moments,
) -> impl Iterator<Item = (usize, f64, Pose)> {
    let Moments { from_s, every_s, above_m_s } = moments;
    let first = truth.poses().first().map(|pose| pose.time);
    let mut next_s = from_s;
    times.enumerate().filter_map(move |(index, time)| {
        let since_s = (time - first?).seconds();
        // Half a microsecond, for a grid that is no multiple of the sampling interval.
        if since_s < next_s - 5e-7 {
            return None;
        }
        let pose = truth.at(time)?;
        next_s += every_s * (1.0 + ((since_s - next_s) / every_s).max(0.0).floor());
        let moves = above_m_s <= 0.0 || speed_m_s(truth, time).is_some_and(|speed| speed > above_m_s);
        moves.then_some((index, since_s, pose))
    })
}

/// Horizontal speed of the truth over the second around a time, m/s; `None` at its ends.
fn speed_m_s(truth: &Trajectory, time: Time) -> Option<f64> {
    let half = Interval::from_nanos(500_000_000);
    let (before, after) = (truth.at(time - half)?, truth.at(time + half)?);
    Some((after.position_m - before.position_m).xy().norm())
}

fn motion(
    estimate: &Trajectory,
    truth: &Trajectory,
    alignment: Alignment,
) -> Result<RigidMotion, EvaluationError> {
    if alignment == Alignment::None {
        return Ok(RigidMotion::identity());
    }
    let pairs = associate(estimate, truth, &Association::default())?.pairs;
    align(&pairs, alignment, 1.0)
}

/// Velocity of the truth, linear between its states.
fn velocity_at(truth: &[TrueState], time: Time) -> Option<Vector3<f64>> {
    let after = truth.partition_point(|state| state.pose.time < time);
    let next = truth.get(after)?;
    if next.pose.time == time {
        return next.velocity_m_s;
    }
    let previous = truth.get(after.checked_sub(1)?)?;
    let share = (time - previous.pose.time).seconds() / (next.pose.time - previous.pose.time).seconds();
    Some(previous.velocity_m_s?.lerp(&next.velocity_m_s?, share))
}

impl RunErrors {
    fn push(
        &mut self,
        since_s: f64,
        solution: &Solution,
        truth: &Pose,
        velocity_m_s: Option<Vector3<f64>>,
        motion: &RigidMotion,
        options: &RunOptions,
    ) {
        let turn = motion.rotation.to_rotation_matrix().into_inner();
        let position = motion.position(&solution.position_m) - truth.position_m;
        let (up, position) = (position.z, position.xy());
        let velocity = velocity_m_s.map(|v| (turn * solution.velocity_m_s - v).xy());
        let off = (motion.rotation * solution.attitude) * truth.attitude.inverse();
        // Compass heading: clockwise.
        let heading = -2.0 * f64::atan(off.k / off.w);
        let none = f32::NAN;
        let mut nees = [none; PARTS];
        self.time_s.push(single(since_s));
        if options.positions {
            self.level_m.push([single(position.x), single(position.y)]);
            if options.heights {
                self.up_m.push(single(up));
            }
            if let Some(velocity) = velocity {
                self.velocity_m_s.push(single(velocity.norm()));
            }
        }
        if options.attitudes {
            self.heading_deg.push(single(heading.to_degrees()));
            self.attitude_deg.push(single(off.angle().to_degrees()));
        }
        let joint = joint_covariance(solution, &turn);
        let level = |row: usize| -> Matrix2<f64> { joint.fixed_view::<2, 2>(row, row).into_owned() };
        if options.positions {
            nees[0] = normalised(&position, &level(0));
        }
        if let Some(velocity) = velocity.filter(|_| options.positions) {
            nees[1] = normalised(&velocity, &level(2));
            if options.attitudes {
                let error = SVector::<f64, 5>::new(position.x, position.y, velocity.x, velocity.y, -heading);
                nees[3] = normalised(&error, &joint);
            }
        }
        if options.attitudes {
            nees[2] = normalised(&Vector1::new(heading), &SMatrix::<f64, 1, 1>::new(joint[(4, 4)]));
        }
        self.nees.push(nees);
    }

    /// Horizontal distances, m.
    pub fn horizontal_m(&self) -> impl Iterator<Item = f64> + '_ {
        self.level_m.iter().map(|[east, north]| f64::from(east.hypot(*north)))
    }

    /// Distances in space, m; none without heights.
    pub fn spatial_m(&self) -> impl Iterator<Item = f64> + '_ {
        self.horizontal_m().zip(&self.up_m).map(|(level, up)| level.hypot(f64::from(*up)))
    }
}

/// Covariance of east, north, their velocities and the turn about the vertical.
fn joint_covariance(solution: &Solution, turn: &Matrix3<f64>) -> SMatrix<f64, 5, 5> {
    let mut turns = SMatrix::<f64, 9, 9>::zeros();
    for block in [0, 3, 6] {
        turns.fixed_view_mut::<3, 3>(block, block).copy_from(turn);
    }
    let turned = turns * solution.covariance * turns.transpose();
    let at = [0, 1, 3, 4, 8];
    SMatrix::from_fn(|row, column| turned[(at[row], at[column])])
}

/// NEES, or NaN where the covariance is not given or cannot be inverted.
fn normalised<const N: usize>(error: &SVector<f64, N>, covariance: &SMatrix<f64, N, N>) -> f32 {
    if !covariance.diagonal().iter().all(|variance| *variance > 0.0) {
        return f32::NAN;
    }
    normalised_squared_error(error, covariance).map_or(f32::NAN, single)
}

#[expect(clippy::cast_possible_truncation, reason = "errors are kept in single precision")]
fn single(value: f64) -> f32 {
    value as f32
}
