//! Truth: the pose of a sensor on a walking foot, in closed form.
//!
//! # Model
//! Each stride is still on one footprint and then moves to the next. While it moves, with `u ∈ [0, 1]` the share of the
//! moving time, the sensor is carried by a rigid foot with attitude `R = Rz(ψ) Ry(θ) Rx(φ)` and a pivot:
//!
//! `p(u) = c(u) − R(u) r(u)`, `r(u) = r_ball + w(u) (r_heel − r_ball)`
//!
//! where `r` points from the sensor to the pivot, foot axes. The pivot starts as the ball of the foot, which stands on
//! the floor while the heel begins to rise (the sensor then moves at `ω × r`), and becomes the heel, on which the foot
//! lands and rolls to flat. `c`, `w` and the angles are sums of smooth windows: septic steps and quartic
//! pulses, C³ (private module `blend`), over these shares of the moving time:
//!
//! | function | windows |
//! |---|---|
//! | pitch `θ`: early heel-off, heel-off, swing to toe-up, foot slap, settling | 0–0.30, 0.12–0.42, 0.33–0.88, 0.84–0.96, 0.86–1 |
//! | pivot forward: mean of two steps | 0.15–0.74, 0.36–0.92 |
//! | pivot up: pulse; height of the next footprint, going up or down | 0.25–0.90; 0.25–0.75 or 0.45–0.90 |
//! | pivot outward: pulse | 0.30–0.88 |
//! | ball to heel `w` | 0.34–0.88 |
//! | yaw of the path | 0.35–0.88 |
//! | roll and yaw of the swing: two opposite pulses | 0.12–0.58, 0.48–0.97 |
//! | shock of the heel strike: rings 3 cycles, backward and up | 0.86–0.97 |
//!
//! Position is C³, thus the specific force is C¹. Derivatives are exact, by second-order jets (private module `jet`): no
//! numerical differentiation anywhere.
//!
//! # Frames and units
//! Navigation ENU (x east, y north, z up), origin at the sensor in the first stance; foot axes x towards the toe, y left,
//! z up; `θ > 0` is heel up. SI units, rad.
//!
//! # Against recorded feet
//! Ranges of the medians per trial: walks at 1.05 to 1.34 m/s of foot-vicon (5 trials) and foot-hallway (3, no camera),
//! runs at 1.9 to 2.3 m/s of foot-vicon (6), with the presets of [`crate::Gait`] at 200 Hz and `3DM-GX5-25` errors beside them.
//! Stance is `|ω|` below 0.6 rad/s walking, 2 rad/s running. The recorded gyros clip at 522 °/s.
//!
//! | figure | walks | `walk` | runs | `run` |
//! |---|---|---|---|---|
//! | stride, m | 1.24–1.42 | 1.37 | 1.44–1.64 | 1.60 |
//! | stride time, s | 1.03–1.23 | 1.09 | 0.72–0.78 | 0.74 |
//! | stance share | 0.21–0.31 | 0.26 | 0.13–0.33 | 0.27 |
//! | peak rate on one axis, °/s | 420–524 | 431 | 520–529 (clipped) | 522 (clipped) |
//! | peak horizontal speed, m/s | 3.3–3.9 | 3.6 | 4.5–5.5 | 5.8 |
//! | rise of the sensor, m | 0.07–0.09 | 0.07 | 0.08–0.14 | 0.11 |
//! | peak specific force, m/s² | 29–41 | 40 | 62–80 | 74 |
//! | least specific force, m/s² | 5.7–8.0 | 2.1 | 10–12 | 5 |
//! | RMS rate in stance, °/s | 15–21 | 9 (16 for `restless_walk`) | – | 44 |
//!
//! # Limits
//! A recorded foot is never quite still: at mid-stance it still turns at 3 to 10 °/s walking and 10 to 33 °/s running. The presets
//! `walk`, `slow` and `stairs` are truly still there; `restless_walk` and `run` rock about the ball, but come to a
//! short full rest where stance begins and ends. A standing person sways: in the recorded rests the sensors are up to six times
//! (gyro) and eight times (accelerometer) noisier than their data sheet, here they are as quiet as it says. The flexible sole, the vibration of the mount and the other foot are not
//! modelled; the foot does not slip.

use crate::blend::Window;
use crate::error::SimulationError;
use crate::gait::Foot;
use crate::jet::{Jet, JetVector};
use crate::motion::{Angles, Motion, MotionState};
use crate::walk_plan::{Footprint, Footprints, Stride, WalkPlan};
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

const EARLY_HEEL_OFF: Window = Window::new(0.0, 0.30);
const HEEL_OFF: Window = Window::new(0.12, 0.42);
const TOE_UP: Window = Window::new(0.33, 0.88);
const FOOT_SLAP: Window = Window::new(0.84, 0.96);
const SETTLING: Window = Window::new(0.86, 1.0);
const STANCE: Window = Window::new(0.0, 1.0);
/// Share of the landing pitch that the slap takes; the rest settles more slowly.
const SLAP_SHARE: f64 = 0.80;
const FORWARD_EARLY: Window = Window::new(0.15, 0.74);
const FORWARD_LATE: Window = Window::new(0.36, 0.92);
const CLEARANCE: Window = Window::new(0.25, 0.90);
const CLIMB: Window = Window::new(0.25, 0.75);
const DESCENT: Window = Window::new(0.45, 0.90);
const BALL_TO_HEEL: Window = Window::new(0.34, 0.88);
const PATH_YAW: Window = Window::new(0.35, 0.88);
const SIDEWAYS: Window = Window::new(0.30, 0.88);
const INWARD: Window = Window::new(0.12, 0.58);
const OUTWARD: Window = Window::new(0.48, 0.97);
const SHOCK: Window = Window::new(0.86, 0.97);
const SHOCK_CYCLES: f64 = 3.0;

/// A walk as a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct FootWalk {
    foot: Foot,
    footprints: Footprints,
}

impl FootWalk {
    /// Lays the footprints of `plan`; `seed` fixes the variation from stride to stride (`ChaCha8`, stream 1).
    pub fn new(plan: &WalkPlan, foot: Foot, seed: u64) -> Result<Self, SimulationError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(1);
        Ok(Self { foot, footprints: plan.footprints(&mut rng)? })
    }

    /// Over footprints that are laid already.
    pub(crate) fn over(foot: Foot, footprints: Footprints) -> Self {
        Self { foot, footprints }
    }

    /// The strides in order of time.
    pub fn strides(&self) -> &[Stride] {
        &self.footprints.strides
    }

    /// Length of the path over the footprints, m.
    pub fn length_m(&self) -> f64 {
        self.strides().iter().map(|s| (s.to.position_m - s.from.position_m).norm()).sum()
    }

    fn resting(&self, on: &Footprint) -> MotionState {
        MotionState {
            position_m: on.position_m,
            velocity_m_s: Vector3::zeros(),
            acceleration_m_s2: Vector3::zeros(),
            attitude: flat(on) * self.foot.mounting,
            angular_rate_rad_s: Vector3::zeros(),
            stance: true,
        }
    }

    fn in_stride(&self, stride: &Stride, since_flat_s: f64) -> MotionState {
        let moving_s = since_flat_s - stride.still_s;
        if moving_s > 0.0 {
            let phase = Jet::linear(moving_s / stride.moving_s, 1.0 / stride.moving_s);
            return self.moving(stride, phase);
        }
        if stride.gait.stance_rock_rad == 0.0 {
            return self.resting(&stride.from);
        }
        let phase = Jet::linear(since_flat_s / stride.still_s, 1.0 / stride.still_s);
        self.rocking(stride, phase)
    }

    /// Stance of a gait in which the foot never quite rests: it rocks about the ball.
    fn rocking(&self, stride: &Stride, phase: Jet) -> MotionState {
        let rock_rad = stride.gait.stance_rock_rad;
        let angles = Angles {
            yaw: Jet::constant(stride.from.yaw_rad),
            pitch: Jet::constant(stride.from.pitch_rad) + STANCE.pulse(phase) * rock_rad,
            // Out of step with the pitch, so that the rate does not vanish in mid-stance.
            roll: STANCE.ring(phase, 1.0) * rock_rad,
        };
        let pivot = JetVector::constant(&contact(&stride.from, &self.foot.ball_m));
        let mut state = self.carried(&angles, pivot, JetVector::constant(&-self.foot.ball_m));
        state.stance = true;
        state
    }

    fn moving(&self, stride: &Stride, phase: Jet) -> MotionState {
        let Stride { gait, from, to, .. } = stride;
        let turn = to.yaw_rad - from.yaw_rad;
        let landing = gait.heel_strike_rad;
        let toe_off = gait.early_heel_off_rad + gait.heel_off_rad;
        let pitch = Jet::constant(from.pitch_rad)
            + EARLY_HEEL_OFF.step(phase) * gait.early_heel_off_rad
            + HEEL_OFF.step(phase) * gait.heel_off_rad
            + TOE_UP.step(phase) * (to.pitch_rad - from.pitch_rad - toe_off - landing)
            + FOOT_SLAP.step(phase) * (SLAP_SHARE * landing)
            + SETTLING.step(phase) * ((1.0 - SLAP_SHARE) * landing);
        let wobble = INWARD.pulse(phase) - OUTWARD.pulse(phase) * 0.7;
        let angles = Angles {
            yaw: Jet::constant(from.yaw_rad) + PATH_YAW.step(phase) * turn + wobble * gait.swing_yaw_rad,
            pitch,
            roll: wobble * -gait.swing_roll_rad,
        };

        let lift_off = contact(from, &self.foot.ball_m);
        let landing_point = contact(to, &self.foot.heel_m);
        let travel = landing_point - lift_off;
        let level = Vector3::new(travel.x, travel.y, 0.0);
        let (sin, cos) = libm::sincos(0.5 * (from.yaw_rad + to.yaw_rad));
        let (forward, outward, up) =
            (Vector3::new(cos, sin, 0.0), Vector3::new(sin, -cos, 0.0), Vector3::z());
        let rise = if travel.z > 0.0 { CLIMB } else { DESCENT };
        let shock = SHOCK.ring(phase, SHOCK_CYCLES) * gait.shock_m;
        let pivot = JetVector::constant(&lift_off)
            + JetVector::along(&level, (FORWARD_EARLY.step(phase) + FORWARD_LATE.step(phase)) * 0.5)
            + JetVector::along(
                &up,
                rise.step(phase) * travel.z + CLEARANCE.pulse(phase) * gait.clearance_m + shock,
            )
            + JetVector::along(&outward, SIDEWAYS.pulse(phase) * gait.circumduction_m)
            + JetVector::along(&forward, -shock);

        let arm = JetVector::constant(&-self.foot.ball_m)
            + JetVector::along(&(self.foot.ball_m - self.foot.heel_m), BALL_TO_HEEL.step(phase));
        self.carried(&angles, pivot, arm)
    }

    /// Sensor at `arm` (foot axes) from a pivot, turned by the angles.
    fn carried(&self, angles: &Angles, pivot: JetVector, arm: JetVector) -> MotionState {
        let position =
            pivot + arm.turned_about_x(angles.roll).turned_about_y(angles.pitch).turned_about_z(angles.yaw);
        MotionState {
            position_m: position.value(),
            velocity_m_s: position.first(),
            acceleration_m_s2: position.second(),
            attitude: angles.attitude() * self.foot.mounting,
            angular_rate_rad_s: self.foot.mounting.inverse_transform_vector(&angles.rate_rad_s()),
            stance: false,
        }
    }
}

impl Motion for FootWalk {
    fn at(&self, time_s: f64) -> MotionState {
        let strides = &self.footprints.strides;
        let index = strides.partition_point(|stride| stride.start_s <= time_s);
        match index.checked_sub(1).and_then(|i| strides.get(i)) {
            Some(stride) if time_s < stride.end_s() => self.in_stride(stride, time_s - stride.start_s),
            Some(stride) => self.resting(&stride.to),
            None => self.resting(&self.footprints.first),
        }
    }

    fn duration_s(&self) -> f64 {
        self.footprints.end_s
    }
}

/// Attitude of the foot on a footprint.
fn flat(on: &Footprint) -> Attitude {
    attitude::exp(&(Vector3::z() * on.yaw_rad)) * attitude::exp(&(Vector3::y() * on.pitch_rad))
}

/// Where a point of the flat foot touches the floor.
fn contact(on: &Footprint, point_m: &Vector3<f64>) -> Vector3<f64> {
    on.position_m + flat(on) * point_m
}
