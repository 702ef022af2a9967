//! Which way a walker goes, from the attitude of the tag: its recent past, in intervals of the attitude estimator.
//!
//! A pelvis yaws by ±5° with every step and an arm swings by ±40° with every second; over a whole **stride**, two steps, both are
//! back where they were. So the direction of a step is that of the body's forward axis, levelled, averaged over the stride
//! that has the step in its middle. Steps are told late enough for that ([`crate::pedestrian::steps`]).
//!
//! The forward axis is the body's x axis, unless that is steep (a tag that stands on edge): then the body axis nearest to
//! the horizon. When a tag is turned over on the way (from the hand into a pocket) and its forward axis rises, another
//! takes its place that points the same way at that moment, and the direction is less certain from then on.

use crate::attitude::AttitudeFilter;
use crate::attitude::smoother::Recorder;
use crate::attitude::state::ATTITUDE;
use crate::methods::ahrs::AhrsRecorder;
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use adit_core::time::{Interval, Time};
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Intervals remembered: 25 s at five a second, four times the longest that a step can be late.
const REMEMBERED: usize = 128;
/// Intervals for which room is kept beside those that there are.
const ROOM: usize = 6;
/// Upward part of a unit vector that is too steep to begin with (50°), and of one that has become so (65°).
const STEEP: f64 = 0.766;
const TOO_STEEP: f64 = 0.906;
/// What the direction loses when the tag was turned over, standard deviation, rad.
pub const TURNED_OVER_RAD: f64 = 0.35;
/// The principal axis is looked for over this, s.
const AXIS_S: f64 = 2.5;
/// Least ratio of the variances along the principal axis and across.
const LEAST_RATIO: f64 = 1.5;

/// One interval of the attitude estimator.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Leg {
    /// Its end.
    pub end: Time,
    /// Its length, s.
    pub length_s: f64,
    /// `∫ R dt`, s.
    pub rotation_s: Matrix3<f64>,
    /// Mean specific force, ENU, m/s².
    pub force_m_s2: Vector3<f64>,
    /// Attitude at the end.
    pub attitude: Attitude,
    /// Its covariance, ENU, rad².
    pub covariance_rad2: Matrix3<f64>,
    /// North is that of a magnetometer, though the field may be disturbed now.
    pub north: bool,
    /// A magnetometer holds the heading.
    pub magnetic: bool,
}

/// The recent past of the attitude.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Course {
    legs: VecDeque<Leg>,
    now: Time,
    /// Body axis that points forward.
    forward: Option<Vector3<f64>>,
    /// Heading of the step before, rad.
    heading_rad: f64,
    /// Heading of the body's x axis at the start, rad.
    first_heading_rad: Option<f64>,
}

/// Direction of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heading {
    /// Of the forward axis, clockwise from north, rad.
    pub heading_rad: f64,
    /// Another forward axis has taken its place.
    pub turned_over: bool,
}

impl Course {
    /// The leg at a time, or the last before it.
    pub fn at(&self, time: Time) -> Option<&Leg> {
        let after = self.legs.partition_point(|leg| leg.end < time);
        self.legs.get(after).or_else(|| self.legs.back())
    }

    /// What was before a time is not asked for any more, nor what the principal axis looked at then.
    pub fn forget(&mut self, before: Time) {
        let from = before - Interval::from_seconds(AXIS_S).unwrap_or_default();
        let old = self.legs.partition_point(|leg| leg.end < from).min(self.legs.len().saturating_sub(1));
        self.legs.drain(..old);
        if self.legs.capacity() > self.legs.len() + 2 * ROOM {
            self.legs.shrink_to(self.legs.len() + ROOM);
        }
    }

    /// Heading of the body's x axis at the start, rad; `None` without an attitude.
    pub fn first_heading_rad(&self) -> Option<f64> {
        self.first_heading_rad
    }

    /// True when the x axis is the forward axis.
    pub fn is_forward_x(&self) -> bool {
        self.forward.is_none_or(|axis| axis == Vector3::x())
    }

    /// Heading of the forward axis over the span; `None` without an attitude.
    pub fn heading(&mut self, from: Time, to: Time) -> Option<Heading> {
        let mean = self.mean_rotation(from, to)?;
        // Turning shortens the level part of a mean, not the upward one.
        let steepness = |axis: &Vector3<f64>| (mean * axis).z.abs();
        let forward = self.forward.unwrap_or_else(|| {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let levellest = axes.iter().min_by(|a, b| steepness(a).total_cmp(&steepness(b)));
            *levellest.filter(|_| steepness(&axes[0]) > STEEP).unwrap_or(&axes[0])
        });
        self.forward = Some(forward);
        let direction = mean * forward;
        let turned_over = steepness(&forward) > TOO_STEEP;
        if turned_over {
            let attitude = self.at(to).map(|leg| leg.attitude)?;
            let level = Vector3::new(libm::sin(self.heading_rad), libm::cos(self.heading_rad), 0.0);
            self.forward = Some(attitude.inverse() * level);
        } else {
            self.heading_rad = libm::atan2(direction.x, direction.y);
        }
        Some(Heading { heading_rad: self.heading_rad, turned_over })
    }

    /// Principal axis of the level specific force before `to`, clockwise from north, −π/2 to π/2; `None` where there is none.
    pub fn principal_axis_rad(&self, to: Time) -> Option<f64> {
        let from = to - Interval::from_seconds(AXIS_S)?;
        let level = || self.within(from, to).map(|(leg, share_s)| (leg.force_m_s2.xy(), share_s));
        let length_s: f64 = level().map(|(_, share_s)| share_s).sum();
        if length_s < 0.5 * AXIS_S {
            return None;
        }
        let mean = level().fold(Vector2::zeros(), |sum, (force, s)| sum + force * s) / length_s;
        let spread = level()
            .fold(Matrix2::zeros(), |sum, (force, s)| sum + (force - mean) * (force - mean).transpose() * s);
        let (ee, en, nn) = (spread[(0, 0)], spread[(0, 1)], spread[(1, 1)]);
        let half_gap = libm::hypot(0.5 * (ee - nn), en);
        let middle = 0.5 * (ee + nn);
        if middle + half_gap < LEAST_RATIO * (middle - half_gap) || half_gap <= 0.0 {
            return None;
        }
        // Twice the angle from north of the axis.
        Some(0.5 * libm::atan2(2.0 * en, nn - ee))
    }

    /// `∫ R dt` over the span, over its length.
    fn mean_rotation(&self, from: Time, to: Time) -> Option<Matrix3<f64>> {
        let (mut sum, mut length_s) = (Matrix3::zeros(), 0.0);
        for (leg, share_s) in self.within(from, to) {
            sum += leg.rotation_s * (share_s / leg.length_s);
            length_s += share_s;
        }
        if length_s > 0.0 {
            return Some(sum / length_s);
        }
        self.at(to).map(|leg| leg.attitude.to_rotation_matrix().into_inner())
    }

    /// Legs of the span, and how much of each lies in it, s.
    fn within(&self, from: Time, to: Time) -> impl Iterator<Item = (&Leg, f64)> {
        let first = self.legs.partition_point(|leg| leg.end <= from);
        self.legs.range(first..).map_while(move |leg| {
            let begin = leg.end - Interval::from_seconds(leg.length_s).unwrap_or_default();
            let share_s = (leg.end.min(to) - begin.max(from)).seconds();
            (begin < to && leg.length_s > 0.0).then_some((leg, share_s.max(0.0)))
        })
    }
}

impl AhrsRecorder for Course {
    #[inline]
    fn sample(&mut self, time: Time) {
        self.now = time;
    }

    fn interval_ends(&mut self, filter: &AttitudeFilter) {
        let interval = filter.interval();
        self.first_heading_rad.get_or_insert_with(|| attitude::heading(&filter.state().attitude));
        if self.legs.len() == REMEMBERED {
            self.legs.pop_front();
        }
        self.legs.push_back(Leg {
            end: self.now,
            length_s: interval.length_s,
            rotation_s: interval.rotation_s,
            force_m_s2: interval.force_m_s / interval.length_s.max(f64::MIN_POSITIVE),
            attitude: filter.state().attitude,
            covariance_rad2: *filter.covariance().block(ATTITUDE, ATTITUDE),
            north: false,
            magnetic: false,
        });
    }

    fn corrected(&mut self, filter: &AttitudeFilter) {
        if let Some(leg) = self.legs.back_mut() {
            leg.attitude = filter.state().attitude;
            leg.covariance_rad2 = *filter.covariance().block(ATTITUDE, ATTITUDE);
            leg.north = filter.is_magnetic();
            leg.magnetic = filter.is_magnetic() && !filter.is_disturbed();
        }
    }
}

impl Recorder for Course {}
