//! Truth: the pose of a sensor on a belt, in closed form.
//!
//! `p = c + Rz(ψ) q + Rz(ψ + y) Ry(θ) Rx(φ) b`: the carried point `c` and the heading `ψ` are quintics between steps (private module
//! `steps`) or those of a seat (private module `vehicle`); `q` and the angles are those of the pelvis in its manner of moving (private
//! module `posture`), one manner going over into the next by a quintic step; `b` is the sensor on the belt. Position is C², so the
//! specific force is continuous; derivatives are exact, by jets.

use super::body::Body;
use super::hermite::{ease, quintic, quintic_vector};
use super::posture::{Manner, Posture};
use super::steps::Steps;
use super::turn::Turn;
use super::vibration::{Tone, between};
use crate::jet::{Jet, JetVector};
use crate::motion::{Motion, MotionState};
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Width of the index of nodes, s.
const BUCKET_S: f64 = 1.0;
/// A standing body sways by this, m, and nods by this, rad, rms.
const SWAY_M: f64 = 0.004;
const SWAY_RAD: f64 = 0.006;
/// A trunk at work moves by this, m, and turns by this, rad, rms: reaching, bending, lifting at 0.1 to 0.6 Hz.
const REACH_M: f64 = 0.05;
const REACH_RAD: f64 = 0.18;

/// Where a sensor sits on the belt.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Belt {
    /// From the middle of the pelvis to the sensor: forward, left, up, m.
    pub offset_m: Vector3<f64>,
    /// Sensor axes into body axes (x forward, y left, z up).
    pub mounting: Attitude,
}

impl Belt {
    /// On the back, its x axis to the back and its z axis up.
    pub fn back() -> Self {
        Self { offset_m: Vector3::new(-0.12, 0.0, 0.04), mounting: about_z(PI) }
    }

    /// In front, its x axis forward and its z axis up.
    pub fn front() -> Self {
        Self { offset_m: Vector3::new(0.14, 0.0, 0.02), mounting: Attitude::identity() }
    }

    /// On the right hip, its x axis to the right and its z axis up.
    pub fn right() -> Self {
        Self { offset_m: Vector3::new(0.02, -0.18, 0.03), mounting: about_z(-FRAC_PI_2) }
    }

    /// On the left hip, its x axis to the left and its z axis up.
    pub fn left() -> Self {
        Self { offset_m: Vector3::new(0.02, 0.18, 0.03), mounting: about_z(FRAC_PI_2) }
    }
}

fn about_z(angle_rad: f64) -> Attitude {
    attitude::exp(&(Vector3::z() * angle_rad))
}

/// The slow motions of a body that stands or works: three of place (forward, left, up), three of angle (yaw, pitch, roll), each made of
/// the same few tones in its own measure and phase.
#[derive(Debug, Clone, PartialEq)]
struct Slow {
    tones: [Tone; 4],
    /// Of sine and cosine of each tone in each motion.
    shares: [[[f64; 2]; 4]; 6],
}

impl Slow {
    fn new(rng: &mut ChaCha8Rng, place_m: f64, angle_rad: f64, bands_hz: [f64; 4]) -> Self {
        let tones = bands_hz.map(|band_hz| Tone {
            amplitude: 1.0,
            omega: TAU * between(rng, band_hz, 1.5 * band_hz),
            phase: between(rng, 0.0, TAU),
        });
        let motions = [place_m, place_m, 0.5 * place_m, angle_rad, angle_rad, 0.5 * angle_rad];
        let shares = motions.map(|rms| {
            core::array::from_fn(|_| {
                let (sin, cos) = libm::sincos(between(rng, 0.0, TAU));
                // Four tones of equal strength.
                let amplitude = rms * core::f64::consts::FRAC_1_SQRT_2;
                [amplitude * cos, amplitude * sin]
            })
        });
        Self { tones, shares }
    }

    fn add(&self, time_s: f64, strength: Jet, shift: &mut JetVector, angles: [&mut Jet; 3]) {
        if strength == Jet::constant(0.0) {
            return;
        }
        let waves = self.tones.map(|tone| {
            let (sin, cos) = Jet::linear(tone.omega * time_s + tone.phase, tone.omega).sin_cos();
            [sin * strength, cos * strength]
        });
        let motion = |number: usize| {
            let parts = self.shares[number].iter().zip(&waves);
            parts.fold(Jet::default(), |all, ([s, c], [sin, cos])| all + *sin * *s + *cos * *c)
        };
        for axis in 0..3 {
            shift.0[axis] = shift.0[axis] + motion(axis);
        }
        for (axis, angle) in angles.into_iter().enumerate() {
            *angle = *angle + motion(3 + axis);
        }
    }
}

/// The motion of a sensor on somebody's belt.
#[derive(Debug, Clone)]
pub struct WaistMotion {
    steps: Arc<Steps>,
    postures: [Posture<f64>; 8],
    /// The last node at or before the beginning of each bucket.
    index: Vec<u32>,
    belt: Belt,
    standing: Slow,
    working: Slow,
}

impl WaistMotion {
    pub(super) fn new(steps: Arc<Steps>, body: &Body, belt: Belt, rng: &mut ChaCha8Rng) -> Self {
        let all = [
            Manner::Still,
            Manner::Stand,
            Manner::Work,
            Manner::Walk,
            Manner::Run,
            Manner::Crawl,
            Manner::Sit,
            Manner::Lie,
        ];
        let postures = all.map(|manner| Posture::of(manner, body.height_m, body.step(manner).0));
        let mut index = Vec::new();
        let mut last = 0_u32;
        for (number, node) in (0_u32..).zip(&steps.nodes) {
            while index.len() as f64 * BUCKET_S < node.time_s {
                index.push(last);
            }
            last = number;
        }
        index.push(last);
        Self {
            steps,
            postures,
            index,
            belt,
            standing: Slow::new(rng, SWAY_M, SWAY_RAD, [0.1, 0.2, 0.35, 0.6]),
            working: Slow::new(rng, REACH_M, REACH_RAD, [0.08, 0.15, 0.25, 0.42]),
        }
    }

    /// The node at or before a time, not the last.
    fn node(&self, time_s: f64) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "floats beyond saturate")]
        let bucket = ((time_s / BUCKET_S).max(0.0) as usize).min(self.index.len().saturating_sub(1));
        let nodes = &self.steps.nodes;
        // The last bucket may know the last node alone.
        let mut node =
            self.index.get(bucket).map_or(0, |node| *node as usize).min(nodes.len().saturating_sub(2));
        while node + 2 < nodes.len() && nodes[node + 1].time_s <= time_s {
            node += 1;
        }
        node
    }

    fn posture(&self, manner: Manner, effort: f32) -> Posture<f64> {
        self.postures[manner as usize].scaled(f64::from(effort))
    }
}

impl Motion for WaistMotion {
    fn at(&self, time_s: f64) -> MotionState {
        let nodes = &self.steps.nodes;
        let time = time_s.clamp(0.0, self.duration_s());
        let index = self.node(time);
        let (from, to) = (&nodes[index], &nodes[index + 1]);
        let (long_s, since_s) = (to.time_s - from.time_s, time - from.time_s);
        let blend = ease(long_s, since_s);
        let posture =
            self.posture(from.manner, from.effort).towards(&self.posture(to.manner, to.effort), blend);
        let stance = posture.at(quintic(from.phase, to.phase, long_s, since_s));
        let (mut place, mut yaw, mut pitch, mut roll);
        if let Some(ride) = from.ride.and_then(|ride| self.steps.rides.get(ride as usize)) {
            let carriage = ride.vehicle.carriage(time, &ride.seat_m);
            (place, yaw, pitch, roll) = (carriage.place, carriage.yaw, carriage.pitch, carriage.roll);
        } else {
            place = quintic_vector(&from.place, &to.place, long_s, since_s);
            yaw = quintic(from.yaw, to.yaw, long_s, since_s);
            pitch = blend * (to.tilt - from.tilt) + Jet::constant(from.tilt);
            roll = Jet::constant(0.0);
        }
        let heading = yaw;
        let mut shift = stance.shift;
        (yaw, pitch, roll) = (yaw + stance.yaw, pitch + stance.pitch, roll + stance.roll);
        self.standing.add(time, posture.standing, &mut shift, [&mut yaw, &mut pitch, &mut roll]);
        self.working.add(time, posture.working, &mut shift, [&mut yaw, &mut pitch, &mut roll]);
        let turn = Turn::new(yaw, pitch, roll);
        place = place + shift.turned_about_z(heading) + turn.apply(&self.belt.offset_m);
        MotionState {
            position_m: place.value(),
            velocity_m_s: place.first(),
            acceleration_m_s2: place.second(),
            attitude: turn.attitude() * self.belt.mounting,
            angular_rate_rad_s: self.belt.mounting.inverse_transform_vector(&turn.rate_rad_s()),
            stance: from.manner == Manner::Still && to.manner == Manner::Still,
        }
    }

    fn duration_s(&self) -> f64 {
        self.steps.nodes.last().map_or(0.0, |node| node.time_s)
    }
}
