//! Relative pose error: how much an estimate drifts over a number of frames or metres.
//!
//! For poses `i`, `j` a delta apart, `E = (Q_i⁻¹ Q_j)⁻¹ (P_i⁻¹ P_j)` with truth `Q` and estimate `P` in SE(3) (Sturm et al.
//! 2012, eq. 1); the translation part is `|trans E|`, the angle that of `rot E`. No alignment changes it.
//!
//! Pairs are chosen as evo chooses them (Grupp, *evo*, `metrics.RPE`): consecutive and not overlapping, or all. Metres
//! count along the **estimated** path; with all pairs, the end nearest to the delta counts when within 10 % of it.
//!
//! A truth of positions alone has no `Q` to turn into: [`Frame::Navigation`] compares the displacements themselves, in
//! the frame that both are in after an alignment.

use crate::EvaluationError;
use crate::association::PosePairs;
use adit_core::trajectory::Pose;
use nalgebra::Vector3;
use serde::Serialize;
use std::fmt;

/// Share of the delta by which a pair may miss it when all pairs are taken.
const ALL_PAIRS_TOLERANCE: f64 = 0.1;

/// How far apart the two poses of a pair are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "delta_unit", content = "delta", rename_all = "lowercase")]
pub enum Delta {
    /// So many poses.
    Frames(usize),
    /// So many metres along the estimated path.
    #[serde(rename = "m")]
    Metres(f64),
}

impl fmt::Display for Delta {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frames(1) => f.pad("1 frame"),
            Self::Frames(frames) => f.pad(&format!("{frames} frames")),
            Self::Metres(metres) => f.pad(&format!("{metres} m")),
        }
    }
}

/// Which pairs are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Selection {
    /// One after the other, not overlapping.
    #[default]
    Consecutive,
    /// From every pose.
    All,
}

/// Axes in which displacements are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Frame {
    /// Of the body at the first pose of a pair: needs attitudes on both sides, no alignment.
    #[default]
    Body,
    /// Of navigation: needs an alignment, no attitudes.
    Navigation,
}

/// Relative errors, one for each pair.
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeErrors {
    /// Indices of the first and last pose of each pair.
    pub indices: Vec<(usize, usize)>,
    /// Translation part, m.
    pub translation_m: Vec<f64>,
    /// Rotation angle, rad, 0 to π; zero in [`Frame::Navigation`].
    pub angle_rad: Vec<f64>,
}

/// Relative errors over `delta`.
pub fn relative_errors(
    pairs: &PosePairs,
    delta: Delta,
    selection: Selection,
    frame: Frame,
) -> Result<RelativeErrors, EvaluationError> {
    let estimate = pairs.estimate();
    let indices = match delta {
        Delta::Frames(frames) => by_frames(estimate.len(), frames, selection)?,
        Delta::Metres(metres) => by_metres(estimate, metres, selection)?,
    };
    if indices.is_empty() {
        let path_m = estimate.windows(2).map(|two| step_m(&two[0], &two[1])).sum();
        return Err(EvaluationError::NoRelativePair {
            delta: delta.to_string(),
            poses: estimate.len(),
            path_m,
        });
    }
    let (translation_m, angle_rad) = indices
        .iter()
        .map(|&(i, j)| error((&estimate[i], &estimate[j]), (&pairs.truth()[i], &pairs.truth()[j]), frame))
        .unzip();
    Ok(RelativeErrors { indices, translation_m, angle_rad })
}

/// Translation (m) and angle (rad) of `E` for one pair.
fn error(estimate: (&Pose, &Pose), truth: (&Pose, &Pose), frame: Frame) -> (f64, f64) {
    let displacement = |(first, last): (&Pose, &Pose)| -> Vector3<f64> { last.position_m - first.position_m };
    match frame {
        Frame::Navigation => ((displacement(estimate) - displacement(truth)).norm(), 0.0),
        Frame::Body => {
            let seen = |two: (&Pose, &Pose)| two.0.attitude.inverse() * displacement(two);
            let turned = |(first, last): (&Pose, &Pose)| first.attitude.inverse() * last.attitude;
            let rotation = turned(truth).inverse() * turned(estimate);
            let angle = 2.0 * rotation.imag().norm().atan2(rotation.w.abs());
            ((seen(estimate) - seen(truth)).norm(), angle)
        }
    }
}

fn by_frames(
    poses: usize,
    frames: usize,
    selection: Selection,
) -> Result<Vec<(usize, usize)>, EvaluationError> {
    if frames == 0 {
        return Err(EvaluationError::OutOfRange {
            what: "the delta in frames",
            found: 0.0,
            expected: "1 or more",
        });
    }
    let stride = match selection {
        Selection::Consecutive => frames,
        Selection::All => 1,
    };
    let starts = (0..poses.saturating_sub(frames)).step_by(stride);
    Ok(starts.map(|i| (i, i + frames)).collect())
}

fn by_metres(
    poses: &[Pose],
    metres: f64,
    selection: Selection,
) -> Result<Vec<(usize, usize)>, EvaluationError> {
    if !(metres.is_finite() && metres > 0.0) {
        return Err(EvaluationError::OutOfRange {
            what: "the delta in metres",
            found: metres,
            expected: "a finite number above 0",
        });
    }
    Ok(match selection {
        Selection::Consecutive => consecutive_by_metres(poses, metres),
        Selection::All => all_by_metres(poses, metres),
    })
}

fn consecutive_by_metres(poses: &[Pose], metres: f64) -> Vec<(usize, usize)> {
    let (mut pairs, mut start, mut path_m) = (Vec::new(), 0, 0.0);
    for (i, two) in poses.windows(2).enumerate() {
        path_m += step_m(&two[0], &two[1]);
        if path_m >= metres {
            pairs.push((start, i + 1));
            start = i + 1;
            path_m = 0.0;
        }
    }
    pairs
}

fn all_by_metres(poses: &[Pose], metres: f64) -> Vec<(usize, usize)> {
    let mut travelled_m = vec![0.0; poses.len()];
    for i in 1..poses.len() {
        travelled_m[i] = travelled_m[i - 1] + step_m(&poses[i - 1], &poses[i]);
    }
    let ends = (0..poses.len().saturating_sub(1)).map(|i| {
        let miss = |j: usize| (travelled_m[j] - travelled_m[i] - metres).abs();
        // The path never shrinks: the nearest end is the first at the delta or the one before it.
        let reached = travelled_m.partition_point(|d| d - travelled_m[i] < metres);
        let mut end = reached.clamp(i + 1, poses.len() - 1);
        // Of ends equally near, as at rest, the first.
        while end > i + 1 && miss(end - 1) <= miss(end) {
            end -= 1;
        }
        (i, end, miss(end))
    });
    ends.filter(|(_, _, miss)| *miss <= metres * ALL_PAIRS_TOLERANCE).map(|(i, j, _)| (i, j)).collect()
}

fn step_m(from: &Pose, to: &Pose) -> f64 {
    (to.position_m - from.position_m).norm()
}
