//! Which pose of the estimate is compared with which pose of the truth.
//!
//! Two ways, because they answer different questions:
//! - [`Association::Interpolate`]: the estimate is read at the stamps of the truth (linear in position, shortest arc
//!   in attitude), inside its own span. Nothing is lost to unequal rates, and the share of the truth that the
//!   estimate covers is stated; below a minimum the comparison is refused.
//! - [`Association::Nearest`]: each pose of the sparser trajectory takes the pose of the denser one that is nearest in
//!   time, if within a maximum difference. This is what evo does (Grupp, *evo*, `sync.associate_trajectories`, method
//!   `nearest_time`), and is here so that figures can be compared with published ones.

use crate::EvaluationError;
use adit_core::time::{Interval, Time};
use adit_core::trajectory::{Pose, Trajectory};
use serde::Serialize;

/// How poses are paired; written into every result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "method", rename_all = "kebab-case")]
pub enum Association {
    /// Estimate interpolated at the stamps of the truth.
    Interpolate {
        /// Smallest share of truth stamps that the estimate must cover, 0 to 1.
        minimum_covered_share: f64,
    },
    /// Nearest stamps, as evo does.
    Nearest {
        /// Largest difference of two paired stamps.
        #[serde(rename = "max_difference_ns")]
        max_difference: Interval,
    },
}

impl Default for Association {
    /// Interpolation with at least 95 % of the truth covered.
    fn default() -> Self {
        Self::Interpolate { minimum_covered_share: 0.95 }
    }
}

/// Poses of estimate and truth that belong together: two lists of equal length, two poses at least, in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePairs {
    estimate: Vec<Pose>,
    truth: Vec<Pose>,
}

impl PosePairs {
    /// Pairs the poses of two lists by index; the shorter list sets the length.
    pub fn new(mut estimate: Vec<Pose>, mut truth: Vec<Pose>) -> Result<Self, EvaluationError> {
        let length = estimate.len().min(truth.len());
        if length < 2 {
            return Err(EvaluationError::TooFewPoses { what: "the association", found: length, expected: 2 });
        }
        estimate.truncate(length);
        truth.truncate(length);
        Ok(Self { estimate, truth })
    }

    /// Poses of the estimate.
    pub fn estimate(&self) -> &[Pose] {
        &self.estimate
    }

    /// Poses of the truth.
    pub fn truth(&self) -> &[Pose] {
        &self.truth
    }

    /// Estimate and truth, pair by pair.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&Pose, &Pose)> {
        self.estimate.iter().zip(&self.truth)
    }

    /// Number of pairs, at least two.
    #[expect(clippy::len_without_is_empty, reason = "never empty, by construction")]
    pub fn len(&self) -> usize {
        self.truth.len()
    }

    /// The same pairs with every estimated pose passed through `turn`.
    #[must_use]
    pub fn map_estimate(&self, turn: impl Fn(&Pose) -> Pose) -> Self {
        Self { estimate: self.estimate.iter().map(turn).collect(), truth: self.truth.clone() }
    }
}

/// Paired poses, and how much of the truth they stand for.
#[derive(Debug, Clone, PartialEq)]
pub struct Associated {
    /// The pairs.
    pub pairs: PosePairs,
    /// Share of the poses of the truth that found a partner, 0 to 1.
    pub covered_share: f64,
}

/// Pairs the poses of `estimate` and `truth`.
pub fn associate(
    estimate: &Trajectory,
    truth: &Trajectory,
    how: &Association,
) -> Result<Associated, EvaluationError> {
    for (what, trajectory) in [("the estimate", estimate), ("the truth", truth)] {
        if trajectory.len() < 2 {
            return Err(EvaluationError::TooFewPoses { what, found: trajectory.len(), expected: 2 });
        }
    }
    match how {
        Association::Interpolate { minimum_covered_share } => {
            interpolate(estimate, truth, *minimum_covered_share)
        }
        Association::Nearest { max_difference } => nearest(estimate, truth, *max_difference),
    }
}

fn interpolate(
    estimate: &Trajectory,
    truth: &Trajectory,
    minimum_share: f64,
) -> Result<Associated, EvaluationError> {
    if !(0.0..=1.0).contains(&minimum_share) {
        return Err(EvaluationError::OutOfRange {
            what: "the minimum share of truth to cover",
            found: minimum_share,
            expected: "0 to 1",
        });
    }
    let (estimated, covered): (Vec<Pose>, Vec<Pose>) =
        truth.poses().iter().filter_map(|pose| Some((estimate.at(pose.time)?, *pose))).unzip();
    let covered_share = covered.len() as f64 / truth.len() as f64;
    if covered_share < minimum_share {
        let (estimate_start, estimate_end) = span(estimate);
        let (truth_start, truth_end) = span(truth);
        return Err(EvaluationError::CoverageTooLow {
            found: covered_share,
            expected: minimum_share,
            estimate_start,
            estimate_end,
            truth_start,
            truth_end,
        });
    }
    Ok(Associated { pairs: PosePairs::new(estimated, covered)?, covered_share })
}

fn span(trajectory: &Trajectory) -> (Time, Time) {
    let poses = trajectory.poses();
    (poses.first().map_or(Time::ZERO, |p| p.time), poses.last().map_or(Time::ZERO, |p| p.time))
}

fn nearest(
    estimate: &Trajectory,
    truth: &Trajectory,
    max_difference: Interval,
) -> Result<Associated, EvaluationError> {
    // The sparser one asks, so that none of its poses is lost; on a tie the estimate asks.
    let pairs: Vec<(Pose, Pose)> = if estimate.len() <= truth.len() {
        estimate
            .poses()
            .iter()
            .filter_map(|e| Some((*e, nearest_to(truth, e.time, max_difference)?)))
            .collect()
    } else {
        truth
            .poses()
            .iter()
            .filter_map(|t| Some((nearest_to(estimate, t.time, max_difference)?, *t)))
            .collect()
    };
    if pairs.is_empty() {
        return Err(EvaluationError::NoMatch { max_difference });
    }
    let (estimated, matched): (Vec<Pose>, Vec<Pose>) = pairs.into_iter().unzip();
    // Two poses of a denser estimate never share a pose of the truth, but poses of a sparser one may.
    let mut distinct: Vec<Time> = matched.iter().map(|pose| pose.time).collect();
    distinct.dedup();
    let covered_share = distinct.len() as f64 / truth.len() as f64;
    Ok(Associated { pairs: PosePairs::new(estimated, matched)?, covered_share })
}

/// The pose nearest in time, the earlier of two equally near ones; `None` when further than `max_difference`.
fn nearest_to(trajectory: &Trajectory, time: Time, max_difference: Interval) -> Option<Pose> {
    let poses = trajectory.poses();
    let after = poses.partition_point(|pose| pose.time <= time);
    let before = after.checked_sub(1).and_then(|i| poses.get(i));
    let nearest = match (before, poses.get(after)) {
        (Some(before), Some(after)) if after.time - time < time - before.time => after,
        (Some(before), _) => before,
        (None, Some(after)) => after,
        (None, None) => return None,
    };
    let difference = nearest.time.max(time) - nearest.time.min(time);
    (difference <= max_difference).then_some(*nearest)
}
