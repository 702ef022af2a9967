//! Poses over time, with interpolation.

use crate::attitude::{self, Attitude};
use crate::time::Time;
use alloc::vec::Vec;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Position and attitude at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Time of validity.
    pub time: Time,
    /// Position in a z-up frame, m.
    pub position_m: Vector3<f64>,
    /// Body to z-up frame.
    pub attitude: Attitude,
}

/// Why a trajectory could not be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TrajectoryError {
    /// Two poses are not in rising order of time.
    #[error("pose {index}: time {found} s does not come after {before} s")]
    TimeNotRising {
        /// Index of the offending pose, from 0.
        index: usize,
        /// Its time.
        found: Time,
        /// The time before it.
        before: Time,
    },
    /// A component is NaN or infinite.
    #[error("pose {index} at {time} s has a component that is not a finite number")]
    NotFinite {
        /// Index of the offending pose, from 0.
        index: usize,
        /// Its time.
        time: Time,
    },
}

/// Poses in strictly rising order of time.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Trajectory {
    poses: Vec<Pose>,
}

impl Trajectory {
    /// Checks order and finiteness once, so that nobody has to later.
    pub fn new(poses: Vec<Pose>) -> Result<Self, TrajectoryError> {
        for (index, pose) in poses.iter().enumerate() {
            let finite = pose.position_m.iter().chain(pose.attitude.coords.iter()).all(|v| v.is_finite());
            if !finite {
                return Err(TrajectoryError::NotFinite { index, time: pose.time });
            }
            if let Some(before) = index.checked_sub(1).map(|i| poses[i].time)
                && pose.time <= before
            {
                return Err(TrajectoryError::TimeNotRising { index, found: pose.time, before });
            }
        }
        Ok(Self { poses })
    }

    /// The poses, in order of time.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// True when there is no pose.
    pub fn is_empty(&self) -> bool {
        self.poses.is_empty()
    }

    /// Number of poses.
    pub fn len(&self) -> usize {
        self.poses.len()
    }

    /// Pose at `time`: linear in position, shortest arc in attitude; `None` outside the span.
    pub fn at(&self, time: Time) -> Option<Pose> {
        let after = self.poses.partition_point(|p| p.time < time);
        let next = self.poses.get(after)?;
        if next.time == time {
            return Some(*next);
        }
        let previous = self.poses.get(after.checked_sub(1)?)?;
        let share = (time - previous.time).seconds() / (next.time - previous.time).seconds();
        let turn = attitude::log(&(previous.attitude.inverse() * next.attitude));
        Some(Pose {
            time,
            position_m: previous.position_m + (next.position_m - previous.position_m) * share,
            attitude: attitude::turn_body(&previous.attitude, &(turn * share)),
        })
    }
}
