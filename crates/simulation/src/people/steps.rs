//! From an itinerary to steps: when each foot strikes, where, and the nodes between which the body is carried.
//!
//! A node stands at each heel strike and where standing begins, ends or changes. It holds the place of the body axis on the floor, the
//! heading and the count of steps with their first two derivatives: none where the body is held, else those of the parabola through
//! the neighbours. Between nodes each is the quintic of its ends, so that all is C².
//!
//! At the strike `k` of `m` the body is half-way between foot `k − 1` and foot `k`; the foot of strike `k` stands `k` steps from the
//! start, the last one beside the one before it.

use super::body::Body;
use super::hermite::through;
use super::itinerary::{Doing, Episode, Going, Itinerary, seated};
use super::posture::Manner;
use super::vehicle::Vehicle;
use crate::jet::{Jet, JetVector};
use adit_core::nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;

/// From one foot to the other across, m: half of it to either side of the body.
const HALF_STEP_WIDTH_M: f64 = 0.055;
/// Standing, sitting: apart by more.
const FOOTWELL_M: [f64; 3] = [0.40, 0.12, -0.45];
/// From one posture to another where no step takes the time, s.
const SHIFT_S: f64 = 1.5;
/// A body that faints comes down in this time, s: a free fall from hip height takes 0.45, knees that give way some more.
const DROP_S: f64 = 0.7;
/// A shin lies on the floor while crawling: the foot points down, rad.
const CRAWL_PITCH_RAD: f64 = 1.2;
/// Vigour of the steps of turning on the spot.
const TURN_EFFORT: f32 = 0.35;

/// The state of the carried body at one time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub time_s: f64,
    pub place: JetVector,
    pub yaw: Jet,
    /// Steps taken so far.
    pub phase: Jet,
    /// Pitch of what carries, nose down, rad.
    pub tilt: f64,
    /// Vigour of the steps, against the manner's own.
    pub effort: f32,
    pub manner: Manner,
    /// Nothing moves here.
    held: bool,
    /// The ride that begins here.
    pub ride: Option<u32>,
}

/// A foot that comes down.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fall {
    /// When the heel strikes, s; not before `earliest_s` does the foot begin to move.
    pub time_s: f64,
    pub earliest_s: f64,
    /// The sole's middle.
    pub place: Vector3<f64>,
    pub yaw: f64,
    pub pitch: f64,
    pub left: bool,
    pub manner: Manner,
    /// How much faster the steps follow one another than the person's own.
    pub hurry: f64,
    /// The foot was carried here since the fall before, not moved.
    pub carried: bool,
}

/// A ride on a vehicle.
#[derive(Debug, Clone)]
pub(super) struct Ride {
    pub start_s: f64,
    pub end_s: f64,
    pub vehicle: Arc<Vehicle>,
    pub seat_m: Vector3<f64>,
}

impl Ride {
    /// Where a foot rests, vehicle axes, m.
    pub fn foot_m(&self, left: bool) -> Vector3<f64> {
        let [forward, side, up] = FOOTWELL_M;
        self.seat_m + Vector3::new(forward, if left { side } else { -side }, up)
    }
}

/// All steps of an itinerary.
#[derive(Debug, Clone)]
pub(super) struct Steps {
    pub nodes: Vec<Node>,
    pub falls: Vec<Fall>,
    pub rides: Vec<Ride>,
}

impl Steps {
    /// Lays the steps; two draws of `rng` for each step of going.
    pub fn lay(itinerary: &Itinerary, body: &Body, rng: &mut ChaCha8Rng) -> Self {
        let mut layer = Layer {
            body,
            rng,
            manner: Manner::Still,
            hurry: 1.0,
            phase: 0.0,
            tilt: 0.0,
            steps: Self::empty(),
        };
        if let Some(first) = itinerary.episodes.first() {
            layer.node(first.start_s, first.place, first.yaw, true);
            for left in [true, false] {
                layer.fall(first.start_s, first.start_s, beside(first.place, first.yaw, left), left);
            }
        }
        for episode in &itinerary.episodes {
            layer.episode(episode);
        }
        let mut steps = layer.steps;
        steps.bend();
        steps
    }

    fn empty() -> Self {
        Self { nodes: Vec::new(), falls: Vec::new(), rides: Vec::new() }
    }

    /// Gives the nodes that are not held their derivatives.
    fn bend(&mut self) {
        for index in 1..self.nodes.len().saturating_sub(1) {
            let (a, b, c) = (self.nodes[index - 1], self.nodes[index], self.nodes[index + 1]);
            if b.held {
                continue;
            }
            let jet =
                |of: fn(&Node) -> f64| through((a.time_s, of(&a)), (b.time_s, of(&b)), (c.time_s, of(&c)));
            let here = &mut self.nodes[index];
            here.yaw = jet(|node| node.yaw.value);
            here.phase = jet(|node| node.phase.value);
            here.place = JetVector([
                jet(|node| node.place.0[0].value),
                jet(|node| node.place.0[1].value),
                jet(|node| node.place.0[2].value),
            ]);
        }
    }
}

/// Where a foot stands beside the body axis.
fn beside(place: Vector3<f64>, yaw: f64, left: bool) -> (Vector3<f64>, f64, f64) {
    let (sin, cos) = libm::sincos(yaw);
    let side = if left { HALF_STEP_WIDTH_M } else { -HALF_STEP_WIDTH_M };
    (place + Vector3::new(-sin * side, cos * side, 0.0), yaw, 0.0)
}

struct Layer<'a> {
    body: &'a Body,
    rng: &'a mut ChaCha8Rng,
    manner: Manner,
    hurry: f64,
    phase: f64,
    tilt: f64,
    steps: Steps,
}

impl Layer<'_> {
    /// A node with the layer's posture; the heading goes on the shorter way from that before.
    fn node(&mut self, time_s: f64, place: Vector3<f64>, yaw: f64, held: bool) {
        let before = self.steps.nodes.last().map_or(yaw, |node| node.yaw.value);
        let yaw = before + super::errands::nearest_turn(yaw - before);
        self.steps.nodes.push(Node {
            time_s,
            place: JetVector::constant(&place),
            yaw: Jet::constant(yaw),
            phase: Jet::constant(self.phase),
            tilt: self.tilt,
            effort: 0.0,
            manner: self.manner,
            held,
            ride: None,
        });
    }

    fn fall(
        &mut self,
        time_s: f64,
        earliest_s: f64,
        (place, yaw, pitch): (Vector3<f64>, f64, f64),
        left: bool,
    ) {
        let (manner, hurry) = (self.manner, self.hurry);
        let fall = Fall { time_s, earliest_s, place, yaw, pitch, left, manner, hurry, carried: false };
        self.steps.falls.push(fall);
    }

    fn next_is_left(&self) -> bool {
        libm::fmod(self.phase, 2.0) == 0.0
    }

    fn varied(&mut self) -> f64 {
        let draw: f64 = StandardNormal.sample(self.rng);
        0.5 * self.body.variation * draw.clamp(-3.0, 3.0)
    }

    fn episode(&mut self, episode: &Episode) {
        let Episode { start_s, end_s, place, yaw, ref doing } = *episode;
        match doing {
            Doing::Stay { manner } => self.stay(episode, *manner),
            Doing::Turn { to_yaw, steps } => {
                let count = f64::from(*steps);
                self.manner = Manner::Walk;
                for step in 1..=*steps {
                    let share = f64::from(step) / count;
                    // The first and the last step turn the body half as far, as in going.
                    let turned = ((f64::from(step) - 0.5) / (count - 1.0)).min(1.0);
                    let time_s = start_s + share * (end_s - start_s);
                    self.phase += 1.0;
                    let foot_yaw = yaw + (to_yaw - yaw) * (f64::from(step) / (count - 1.0)).min(1.0);
                    let left = self.next_is_left();
                    self.fall(time_s, start_s - 0.1, beside(place, foot_yaw, left), left);
                    self.node(time_s, place, yaw + (to_yaw - yaw) * turned, step == *steps);
                    if step < *steps
                        && let Some(node) = self.steps.nodes.last_mut()
                    {
                        node.effort = TURN_EFFORT;
                    }
                }
            }
            Doing::Go(going) => self.go(episode, going),
            Doing::Climb { to, to_yaw, tilt, sit } => {
                self.manner = if *sit { Manner::Sit } else { Manner::Stand };
                self.tilt = *tilt;
                self.climb_feet(episode, *to, *to_yaw);
                self.node(end_s, *to, *to_yaw, true);
            }
            Doing::Ride { vehicle, seat_m } => {
                let number = u32::try_from(self.steps.rides.len()).unwrap_or(u32::MAX);
                if let Some(node) = self.steps.nodes.last_mut() {
                    node.ride = Some(number);
                }
                let ride = Ride { start_s, end_s, vehicle: Arc::clone(vehicle), seat_m: *seat_m };
                let pose = vehicle.pose(end_s);
                self.tilt = pose.pitch_rad;
                let place = |at: &Vector3<f64>| seated(at, pose.floor_m, pose.yaw_rad, pose.pitch_rad);
                for left in [true, false] {
                    let print = (place(&ride.foot_m(left)), pose.yaw_rad, pose.pitch_rad);
                    self.fall(end_s, end_s, print, left);
                    if let Some(fall) = self.steps.falls.last_mut() {
                        fall.carried = true;
                    }
                }
                self.node(end_s, place(seat_m), pose.yaw_rad, true);
                self.steps.rides.push(ride);
            }
        }
    }

    fn stay(&mut self, episode: &Episode, manner: Manner) {
        let Episode { start_s, end_s, place, yaw, .. } = *episode;
        let lowered = (manner == Manner::Crawl) != (self.manner == Manner::Crawl);
        if manner != self.manner {
            self.manner = manner;
            let shift_s = match manner {
                _ if lowered => end_s - start_s,
                Manner::Lie => DROP_S,
                _ => SHIFT_S,
            };
            if lowered {
                // Feet: onto the toes for the knees to come down, or flat again.
                let pitch = if manner == Manner::Crawl { CRAWL_PITCH_RAD } else { 0.0 };
                for (left, share) in [(true, 0.5), (false, 0.9)] {
                    let (at, foot_yaw, _) = beside(place, yaw, left);
                    self.fall(start_s + share * shift_s, start_s, (at, foot_yaw, pitch), left);
                }
            }
            if end_s - start_s > 2.0 * shift_s {
                self.node(start_s + shift_s, place, yaw, true);
            }
        }
        self.node(end_s, place, yaw, true);
    }

    /// Both feet, one after the other, onto a vehicle or down from it.
    fn climb_feet(&mut self, episode: &Episode, to: Vector3<f64>, to_yaw: f64) {
        let long_s = episode.end_s - episode.start_s;
        let sit = self.manner == Manner::Sit;
        for (left, from, until) in [(true, 0.05, 0.5), (false, 0.45, 0.9)] {
            let print = if sit {
                let [forward, side, up] = FOOTWELL_M;
                let foot = Vector3::new(forward, if left { side } else { -side }, up);
                (seated(&foot, to, to_yaw, self.tilt), to_yaw, self.tilt)
            } else {
                beside(to, to_yaw, left)
            };
            self.fall(episode.start_s + until * long_s, episode.start_s + from * long_s, print, left);
        }
    }

    fn go(&mut self, episode: &Episode, going: &Going) {
        let Episode { start_s, end_s, .. } = *episode;
        let (steps, step_m) = (going.steps, going.step_m());
        let step_s = (end_s - start_s) / f64::from(steps);
        let (own_m, _) = self.body.step(going.manner);
        self.manner = going.manner;
        self.hurry = going.hurry;
        // How far each foot has come, varied but for the last two, which stand side by side.
        let mut foot_m = going.from_m;
        for step in 1..=steps {
            let last = step == steps;
            let (length, time) = (self.varied(), self.varied());
            let before_m = foot_m;
            let whole = f64::from(step.min(steps - 1));
            let wander = if step + 1 < steps { length } else { 0.0 };
            foot_m = going.from_m + (whole + wander) * step_m;
            let time_s = if last { end_s } else { start_s + (f64::from(step) + time) * step_s };
            self.phase += 1.0;
            let left = self.next_is_left();
            self.fall(time_s, start_s - 0.1, foot_on(going, foot_m, left), left);
            let (place, yaw) = going.at(if last { going.to_m } else { 0.5 * (before_m + foot_m) });
            self.node(time_s, place, yaw, last);
            if let Some(node) = self.steps.nodes.last_mut().filter(|_| !last) {
                // The first step and the last but one are half as lively.
                let full = if step == 1 || step + 1 == steps { 0.6 } else { 1.0 };
                #[expect(clippy::cast_possible_truncation, reason = "an amplitude: seven digits are plenty")]
                let effort = (full * (foot_m - before_m) / own_m * (1.0 + time)) as f32;
                node.effort = effort;
            }
        }
        self.hurry = 1.0;
    }
}

/// The print of a foot this far along a way.
fn foot_on(going: &Going, sigma: f64, left: bool) -> (Vector3<f64>, f64, f64) {
    let (place, yaw) = going.at(sigma);
    let (low, high) = ((sigma - 0.1).max(0.0), (sigma + 0.1).min(going.path.length_m()));
    let slope_pitch = -libm::atan2(going.path.floor_m(high) - going.path.floor_m(low), high - low);
    let (at, yaw, _) = beside(place, yaw, left);
    let pitch = if going.manner == Manner::Crawl { CRAWL_PITCH_RAD + slope_pitch } else { slope_pitch };
    (at, yaw, pitch)
}
