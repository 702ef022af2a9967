//! Truth: the pose of a sensor on a foot of somebody who goes through a mine.
//!
//! The strides are those of [`crate::foot_motion`], from one fall of the foot to the next; the heel strikes at 0.88 of a stride's
//! moving time, at the node of the body's motion. On a vehicle the foot is carried by it.
//!
//! **Limits.** A crawling foot is drawn along with its toes down, without the shin that holds it. A foot that climbs into a vehicle
//! goes straight there.

use super::body::Body;
use super::posture::Manner;
use super::steps::{Fall, Ride, Steps};
use crate::foot_motion::FootWalk;
use crate::gait::{Foot, Gait};
use crate::motion::{Angles, Motion, MotionState};
use crate::walk_plan::{Footprint, Footprints, Stride};
use adit_core::attitude;
use adit_core::nalgebra::Vector3;

/// Share of a stride's moving time that is left at the heel strike.
const AFTER_STRIKE: f64 = 0.12;
/// Shortest swing, s.
const QUICKEST_S: f64 = 0.15;

/// The motion of a sensor on somebody's foot.
#[derive(Debug, Clone)]
pub struct FootMotion {
    walk: FootWalk,
    foot: Foot,
    left: bool,
    rides: Vec<Ride>,
}

impl FootMotion {
    pub(super) fn new(steps: &Steps, body: &Body, foot: Foot, left: bool) -> Self {
        let end_s = steps.nodes.last().map_or(0.0, |node| node.time_s);
        let mut falls = steps.falls.iter().filter(|fall| fall.left == left);
        let first = falls
            .next()
            .map_or(Footprint { position_m: Vector3::zeros(), yaw_rad: 0.0, pitch_rad: 0.0 }, |fall| {
                print(fall, &foot, 0.0)
            });
        let mut strides: Vec<Stride> = Vec::new();
        let (mut here, mut flat_s) = (first, 0.0);
        for fall in falls {
            let to = print(fall, &foot, here.yaw_rad);
            if fall.carried {
                // The ride itself is the vehicle's motion.
                (here, flat_s) = (to, fall.time_s);
                continue;
            }
            let stride = stride(body, fall, here, to, flat_s);
            (here, flat_s) = (to, stride.end_s());
            strides.push(stride);
        }
        let end_s = end_s.max(flat_s);
        let walk = FootWalk::over(foot, Footprints { first, strides, end_s });
        Self { walk, foot, left, rides: steps.rides.clone() }
    }

    /// The strides, in order of time.
    pub fn strides(&self) -> &[Stride] {
        self.walk.strides()
    }
}

/// Where the sensor rests when the foot lies as it fell.
fn print(fall: &Fall, foot: &Foot, yaw_before: f64) -> Footprint {
    let yaw_rad = yaw_before + super::errands::nearest_turn(fall.yaw - yaw_before);
    let turn = attitude::exp(&(Vector3::z() * yaw_rad)) * attitude::exp(&(Vector3::y() * fall.pitch));
    // A flat foot stands on all of its sole; one with its toes down on the ball.
    let contact = if fall.manner == Manner::Crawl && fall.pitch > 0.5 {
        turn * foot.ball_m
    } else {
        turn * Vector3::new(0.5 * (foot.ball_m.x + foot.heel_m.x), 0.0, foot.ball_m.z)
    };
    Footprint { position_m: fall.place - contact, yaw_rad, pitch_rad: fall.pitch }
}

/// The stride that ends with a fall.
fn stride(body: &Body, fall: &Fall, from: Footprint, to: Footprint, flat_s: f64) -> Stride {
    let nominal = body.gait(fall.manner);
    let full_s = nominal.stride_s / fall.hurry * (1.0 - nominal.still_share);
    // When it would lift off, were the stride a full one; but neither before it may nor while it is still coming down.
    let begin_s = (fall.time_s - (1.0 - AFTER_STRIKE) * full_s).max(fall.earliest_s).max(flat_s + 0.02);
    let moving_s = ((fall.time_s - begin_s) / (1.0 - AFTER_STRIKE)).max(QUICKEST_S);
    let length_m = (to.position_m - from.position_m).xy().norm();
    let effort = 0.35 + 0.65 * (length_m / nominal.stride_m).min(1.1);
    let gait = Gait {
        early_heel_off_rad: nominal.early_heel_off_rad * effort,
        heel_off_rad: nominal.heel_off_rad * effort,
        heel_strike_rad: nominal.heel_strike_rad * effort,
        circumduction_m: nominal.circumduction_m * effort,
        swing_roll_rad: nominal.swing_roll_rad * effort,
        swing_yaw_rad: nominal.swing_yaw_rad * effort,
        shock_m: nominal.shock_m * effort,
        // Standing is standing, whatever the gait after it.
        stance_rock_rad: if flat_s < fall.earliest_s + 0.2 { 0.0 } else { nominal.stance_rock_rad },
        ..nominal
    };
    Stride { start_s: flat_s, still_s: begin_s - flat_s, moving_s, from, to, gait }
}

impl Motion for FootMotion {
    fn at(&self, time_s: f64) -> MotionState {
        let ride = self.rides.partition_point(|ride| ride.start_s <= time_s).checked_sub(1);
        let Some(ride) = ride.and_then(|ride| self.rides.get(ride)).filter(|ride| time_s < ride.end_s) else {
            return self.walk.at(time_s);
        };
        let middle_x = 0.5 * (self.foot.ball_m.x + self.foot.heel_m.x);
        let foot = ride.foot_m(self.left) - Vector3::new(middle_x, 0.0, self.foot.ball_m.z);
        let carriage = ride.vehicle.carriage(time_s, &foot);
        let angles = Angles { yaw: carriage.yaw, pitch: carriage.pitch, roll: carriage.roll };
        MotionState {
            position_m: carriage.place.value(),
            velocity_m_s: carriage.place.first(),
            acceleration_m_s2: carriage.place.second(),
            attitude: angles.attitude() * self.foot.mounting,
            angular_rate_rad_s: self.foot.mounting.inverse_transform_vector(&angles.rate_rad_s()),
            stance: carriage.place.first() == Vector3::zeros(),
        }
    }

    fn duration_s(&self) -> f64 {
        self.walk.duration_s()
    }
}
