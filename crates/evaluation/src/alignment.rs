//! The rigid motion that lays an estimate over the truth before errors are taken.
//!
//! Dead reckoning knows neither where nor which way it started; an alignment removes what the method never claimed to
//! know. In order of how much they forgive:
//!
//! | alignment | removes | fits |
//! |---|---|---|
//! | `none` | nothing | absolute positioning |
//! | `start` | start position and heading | end errors of dead reckoning |
//! | `se2` | horizontal position and heading over the whole run; height of the first pose | shape of the path |
//! | `se3` | position and all three angles over the whole run | frames that differ by a mounting |
//!
//! Least-squares motion without scale (Umeyama 1991, eq. 40–41, c = 1): `R, t = argmin Σ |truth − (R estimate + t)|²`
//! with `t = mean(truth) − R mean(estimate)`. The rotation is found in closed form,
//! - in the plane by `θ = atan2(Σ a × b, Σ a · b)` of the centred positions,
//! - in space as the dominant eigenvector of Horn's 4 × 4 matrix (Horn 1987, §4), which has Umeyama's optimum,
//!   needs no case for reflections, and keeps its digits on long thin paths, as galleries are.
//!
//! `start` translates by the mean error of the first 2 s and turns so that the horizontal direction to the first pose
//! of the truth at least a given distance away agrees (the last pose when none is that far).
//! Attitudes turn with positions.
//!
//! **Attitude alone** ([`align_attitudes`]): the same names forgive the same angles, found from the attitudes: `start` the
//! heading of the first 2 s, `se2` the heading over the run, `se3` all three angles. The turn is the average of
//! `q_truth ∘ q_estimate⁻¹` (Markley et al. 2007, eq. 12), for `start` and `se2` among the turns about the vertical.

use crate::EvaluationError;
use crate::ape::{attitude_errors, heading_bias_rad};
use crate::association::PosePairs;
use adit_core::attitude::Attitude;
use adit_core::time::Interval;
use adit_core::trajectory::{Pose, Trajectory};
use nalgebra::{Matrix3, Matrix4, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Positions of this much time from the first pair make the start position, ns.
const START_SPAN: Interval = Interval::from_nanos(2_000_000_000);

/// Smallest relative eigenvalue gap at which a rotation in space counts as determined: rounding leaves 1e-15 on a line.
const SMALLEST_SPREAD: f64 = 1e-13;

/// What an alignment may take away; see the table of the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Alignment {
    /// As estimated.
    None,
    /// Position and heading of the start.
    Start,
    /// Heading and position, least squares over the run.
    #[default]
    Se2,
    /// Rotation and position in space, least squares over the run.
    Se3,
}

impl fmt::Display for Alignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::None => "none",
            Self::Start => "start",
            Self::Se2 => "se2",
            Self::Se3 => "se3",
        })
    }
}

impl FromStr for Alignment {
    type Err = EvaluationError;
    fn from_str(name: &str) -> Result<Self, EvaluationError> {
        match name {
            "none" => Ok(Self::None),
            "start" => Ok(Self::Start),
            "se2" => Ok(Self::Se2),
            "se3" => Ok(Self::Se3),
            _ => Err(EvaluationError::UnknownAlignment { found: name.to_owned() }),
        }
    }
}

/// Rotation about one point followed by a move of that point: `x ↦ R (x − from) + to`.
///
/// Kept in this form so that grid coordinates of thousands of kilometres lose no digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    /// Rotation `R`, frame of the estimate to frame of the truth.
    pub rotation: Attitude,
    /// Point of the estimate that the rotation leaves in place, m.
    pub from_m: Vector3<f64>,
    /// Where that point goes, m.
    pub to_m: Vector3<f64>,
}

impl RigidMotion {
    /// The motion that leaves everything in place.
    pub fn identity() -> Self {
        Self { rotation: Attitude::identity(), from_m: Vector3::zeros(), to_m: Vector3::zeros() }
    }

    /// The image of a position, m.
    pub fn position(&self, position_m: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * (position_m - self.from_m) + self.to_m
    }

    /// The image of a pose: the attitude turns with the position.
    pub fn pose(&self, pose: &Pose) -> Pose {
        Pose {
            time: pose.time,
            position_m: self.position(&pose.position_m),
            attitude: self.rotation * pose.attitude,
        }
    }

    /// The image of a whole trajectory.
    pub fn trajectory(&self, trajectory: &Trajectory) -> Result<Trajectory, EvaluationError> {
        Ok(Trajectory::new(trajectory.poses().iter().map(|pose| self.pose(pose)).collect())?)
    }

    /// Translation `t` of the form `x ↦ R x + t`, m.
    pub fn translation_m(&self) -> Vector3<f64> {
        self.to_m - self.rotation * self.from_m
    }
}

/// The motion of the estimate that `alignment` asks for. `start_distance_m` matters to [`Alignment::Start`] only.
pub fn align(
    pairs: &PosePairs,
    alignment: Alignment,
    start_distance_m: f64,
) -> Result<RigidMotion, EvaluationError> {
    match alignment {
        Alignment::None => Ok(RigidMotion::identity()),
        Alignment::Start => start(pairs, start_distance_m),
        Alignment::Se2 => Ok(se2(pairs)),
        Alignment::Se3 => se3(pairs),
    }
}

/// The turn of the estimate that `alignment` asks for where attitude alone is judged.
pub fn align_attitudes(pairs: &PosePairs, alignment: Alignment) -> Result<Attitude, EvaluationError> {
    let errors = || attitude_errors(pairs);
    match alignment {
        Alignment::None => Ok(Attitude::identity()),
        Alignment::Start => Ok(about_vertical(heading_bias_rad(&errors()[..start_poses(pairs.truth())]))),
        Alignment::Se2 => Ok(about_vertical(heading_bias_rad(&errors()))),
        Alignment::Se3 => mean_turn(pairs),
    }
}

/// Dominant eigenvector of `Σ e eᵀ` of the errors `e` as quaternions, which does not ask for their sign.
fn mean_turn(pairs: &PosePairs) -> Result<Attitude, EvaluationError> {
    let mut moments = Matrix4::zeros();
    for (estimate, truth) in pairs.iter() {
        let e = (truth.attitude * estimate.attitude.inverse()).coords;
        moments += e * e.transpose();
    }
    let undetermined = || EvaluationError::Degenerate { found: f64::NAN, expected: SMALLEST_SPREAD };
    let eigen = SymmetricEigen::try_new(moments, f64::EPSILON, 1000).ok_or_else(undetermined)?;
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    Ok(UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2])))
}

/// Number of poses that make the start, one at least.
fn start_poses(truth: &[Pose]) -> usize {
    let until = truth[0].time + START_SPAN;
    truth.iter().take_while(|pose| pose.time <= until).count()
}

fn start(pairs: &PosePairs, distance_m: f64) -> Result<RigidMotion, EvaluationError> {
    if !(distance_m.is_finite() && distance_m >= 0.0) {
        return Err(EvaluationError::OutOfRange {
            what: "the start distance",
            found: distance_m,
            expected: "a finite number of metres, 0 or more",
        });
    }
    let (estimate, truth) = (pairs.estimate(), pairs.truth());
    let first = start_poses(truth);
    let (from_m, to_m) = (mean(&estimate[..first]), mean(&truth[..first]));
    let away = |pose: &Pose| (pose.position_m - to_m).xy().norm() >= distance_m;
    let far = truth.iter().position(away).unwrap_or(truth.len() - 1);
    let walked = estimate[far].position_m - from_m;
    let true_walk = truth[far].position_m - to_m;
    let turn = true_walk.y.atan2(true_walk.x) - walked.y.atan2(walked.x);
    Ok(RigidMotion { rotation: about_vertical(turn), from_m, to_m })
}

fn se2(pairs: &PosePairs) -> RigidMotion {
    let (mut from_m, mut to_m) = (mean(pairs.estimate()), mean(pairs.truth()));
    let (mut cross, mut dot) = (0.0, 0.0);
    for (estimate, truth) in pairs.iter() {
        let (a, b) = (estimate.position_m - from_m, truth.position_m - to_m);
        cross += a.x * b.y - a.y * b.x;
        dot += a.x * b.x + a.y * b.y;
    }
    // Heights agree at the first pose: a barometer or an integrated height drifts, it does not tilt.
    from_m.z = pairs.estimate()[0].position_m.z;
    to_m.z = pairs.truth()[0].position_m.z;
    RigidMotion { rotation: about_vertical(cross.atan2(dot)), from_m, to_m }
}

fn se3(pairs: &PosePairs) -> Result<RigidMotion, EvaluationError> {
    let (from_m, to_m) = (mean(pairs.estimate()), mean(pairs.truth()));
    let moments: Matrix3<f64> =
        pairs.iter().map(|(e, t)| (e.position_m - from_m) * (t.position_m - to_m).transpose()).sum();
    Ok(RigidMotion { rotation: horn(&moments)?, from_m, to_m })
}

/// Rotation that maximises `Σ b · R a` from `moments = Σ a bᵀ` (Horn 1987, §4.A).
fn horn(moments: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, EvaluationError> {
    let degenerate = |found| EvaluationError::Degenerate { found, expected: SMALLEST_SPREAD };
    // The largest entry becomes 1, so that nothing over- or underflows.
    let largest = moments.amax();
    if !(largest.is_normal() && moments.iter().all(|m| m.is_finite())) {
        return Err(degenerate(0.0));
    }
    let s = moments / largest;
    let symmetric = s + s.transpose();
    let axis = Vector3::new(s.m23 - s.m32, s.m31 - s.m13, s.m12 - s.m21);
    let mut n = Matrix4::zeros();
    n[(0, 0)] = s.trace();
    n.fixed_view_mut::<3, 1>(1, 0).copy_from(&axis);
    n.fixed_view_mut::<1, 3>(0, 1).copy_from(&axis.transpose());
    n.fixed_view_mut::<3, 3>(1, 1).copy_from(&(symmetric - Matrix3::identity() * s.trace()));

    let eigen = SymmetricEigen::try_new(n, f64::EPSILON, 1000).ok_or_else(|| degenerate(f64::NAN))?;
    let best = eigen.eigenvalues.imax();
    let values = &eigen.eigenvalues;
    let second = (0..4).filter(|i| *i != best).map(|i| values[i]).fold(f64::MIN, f64::max);
    // The gap is twice the sum of the two smaller singular values of the moments: 0 on a line.
    let spread = (values[best] - second) / values.amax();
    if spread < SMALLEST_SPREAD || spread.is_nan() {
        return Err(degenerate(spread));
    }
    let q = eigen.eigenvectors.column(best);
    Ok(UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3])))
}

fn about_vertical(angle_rad: f64) -> Attitude {
    let (sin, cos) = (0.5 * angle_rad).sin_cos();
    UnitQuaternion::new_unchecked(Quaternion::new(cos, 0.0, 0.0, sin))
}

/// Mean position, m. Summed from the first one, so that grid coordinates lose no digits.
fn mean(poses: &[Pose]) -> Vector3<f64> {
    let Some(first) = poses.first().map(|pose| pose.position_m) else { return Vector3::zeros() };
    let sum: Vector3<f64> = poses.iter().map(|pose| pose.position_m - first).sum();
    first + sum / poses.len() as f64
}
