//! Where the foot is to go: a path of legs, turned into footprints.
//!
//! Legs follow each other from the origin in the plan's first heading. A leg of a given length is walked in
//! `⌈length / stride⌉` equal strides (plus the variation of the gait), so that it ends exactly where it should.
//! The path is the path of the one foot that carries the sensor: strides at the start and the end of a leg are full
//! ones, where a walker would begin and end with a half stride.
//!
//! Frame: ENU with its origin at the sensor in the first stance; headings clockwise from north, rad.

use crate::error::{SimulationError, check_within};
use crate::gait::Gait;
use adit_core::nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Pivoting on the spot: at most this much in one stride, rad.
const TURN_PER_STRIDE_RAD: f64 = core::f64::consts::FRAC_PI_4;
/// Longest leg, and most strides in it: a walk of a shift, not of a typing error.
const LONGEST_LEG_M: f64 = 100_000.0;

/// One piece of a walk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Leg {
    /// Walk on with another gait.
    Gait(Gait),
    /// Stand still, s.
    Stand {
        /// Duration, s.
        seconds: f64,
    },
    /// Walk straight on.
    Straight {
        /// Length, m.
        length_m: f64,
    },
    /// Walk along an arc.
    Arc {
        /// Radius, m.
        radius_m: f64,
        /// Change of heading, rad, positive to the right.
        turn_rad: f64,
    },
    /// Turn on the spot.
    Turn {
        /// Change of heading, rad, positive to the right.
        turn_rad: f64,
    },
    /// Walk straight on over an inclined floor; the foot lies on it.
    Ramp {
        /// Horizontal length, m.
        length_m: f64,
        /// Slope angle, rad, positive up.
        slope_rad: f64,
    },
    /// Climb or descend stairs: two risers per stride of one foot.
    Stairs {
        /// Number of risers.
        risers: u32,
        /// Height of each, m, negative down.
        rise_m: f64,
        /// Depth of a tread, m.
        tread_m: f64,
    },
}

impl Leg {
    /// The numbers are those of a walk.
    pub fn check(&self) -> Result<(), SimulationError> {
        match *self {
            Self::Gait(gait) => gait.check(),
            Self::Stand { seconds } => check_within("seconds", seconds, 0.0, 1e6, "0 to 1e6 s"),
            Self::Straight { length_m } => {
                check_within("length_m", length_m, 0.0, LONGEST_LEG_M, "0 to 100 km")
            }
            Self::Arc { radius_m, turn_rad } => {
                check_within("radius_m", radius_m, 0.2, 1e4, "0.2 m to 10 km")?;
                check_within("turn_rad", turn_rad, -100.0, 100.0, "-100 to 100 rad")
            }
            Self::Turn { turn_rad } => check_within("turn_rad", turn_rad, -100.0, 100.0, "-100 to 100 rad"),
            Self::Ramp { length_m, slope_rad } => {
                check_within("length_m", length_m, 0.0, LONGEST_LEG_M, "0 to 100 km")?;
                check_within("slope_rad", slope_rad, -0.6, 0.6, "-0.6 to 0.6 rad")
            }
            Self::Stairs { risers, rise_m, tread_m } => {
                check_within("rise_m", rise_m, -0.4, 0.4, "-0.4 to 0.4 m")?;
                check_within("tread_m", tread_m, 0.1, 1.0, "0.1 to 1 m")?;
                check_within("risers", f64::from(risers), 0.0, 1e5, "0 to 100000")
            }
        }
    }
}

/// A walk: gait, first heading, legs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WalkPlan {
    /// Gait until a leg changes it.
    pub gait: Gait,
    /// First heading, clockwise from north, rad.
    pub heading_rad: f64,
    /// The legs, in order.
    pub legs: Vec<Leg>,
}

/// Where the sensor is while the foot is flat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Sensor position, ENU, m.
    pub position_m: Vector3<f64>,
    /// Direction of the toes, anticlockwise from east, rad; not reduced to one turn.
    pub yaw_rad: f64,
    /// Pitch of the floor along the foot, rad, positive where it falls.
    pub pitch_rad: f64,
}

/// One stride: still on one footprint, then moving to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stride {
    /// When the foot is flat, s from the start of the walk.
    pub start_s: f64,
    /// How long it stays so, s.
    pub still_s: f64,
    /// How long it then moves, s.
    pub moving_s: f64,
    /// From here.
    pub from: Footprint,
    /// To here.
    pub to: Footprint,
    /// The gait as varied for this stride.
    pub gait: Gait,
}

impl Stride {
    /// When the foot is flat again, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.still_s + self.moving_s
    }
}

/// Strides in order of time, and how long the walker stands after the last.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Footprints {
    pub first: Footprint,
    pub strides: Vec<Stride>,
    pub end_s: f64,
}

impl WalkPlan {
    /// Checks the legs and lays the footprints; three draws of `rng` per stride (length, time, angles and shock).
    pub(crate) fn footprints(&self, rng: &mut ChaCha8Rng) -> Result<Footprints, SimulationError> {
        self.gait.check()?;
        check_within("heading_rad", self.heading_rad, -100.0, 100.0, "a finite angle")?;
        let first = Footprint {
            position_m: Vector3::zeros(),
            yaw_rad: core::f64::consts::FRAC_PI_2 - self.heading_rad,
            pitch_rad: 0.0,
        };
        let mut layer =
            Layer { rng, gait: self.gait, here: first, now_s: 0.0, rest_s: 0.0, strides: Vec::new() };
        for leg in &self.legs {
            layer.lay(leg)?;
        }
        let end_s = layer.now_s + layer.rest_s;
        Ok(Footprints { first, strides: layer.strides, end_s })
    }
}

/// The pen that walks along the plan.
struct Layer<'a> {
    rng: &'a mut ChaCha8Rng,
    gait: Gait,
    here: Footprint,
    now_s: f64,
    rest_s: f64,
    strides: Vec<Stride>,
}

impl Layer<'_> {
    fn lay(&mut self, leg: &Leg) -> Result<(), SimulationError> {
        leg.check()?;
        match *leg {
            Leg::Gait(gait) => self.gait = gait,
            Leg::Stand { seconds } => self.rest_s += seconds,
            Leg::Straight { length_m } => self.walk(length_m, 0.0, 0.0, 0.0),
            Leg::Arc { radius_m, turn_rad } => self.walk(radius_m * turn_rad.abs(), turn_rad, 0.0, 0.0),
            Leg::Turn { turn_rad } => {
                let strides = whole(turn_rad.abs() / TURN_PER_STRIDE_RAD);
                for _ in 0..strides {
                    self.stride(ahead(&self.here, 0.0, -turn_rad / f64::from(strides), 0.0));
                }
            }
            Leg::Ramp { length_m, slope_rad } => {
                self.walk(length_m, 0.0, length_m * libm::tan(slope_rad), -slope_rad);
            }
            Leg::Stairs { risers, rise_m, tread_m } => {
                let mut left = risers;
                while left > 0 {
                    let taken = f64::from(left.min(2));
                    self.stride(ahead(&self.here, taken * tread_m, 0.0, taken * rise_m));
                    left -= left.min(2);
                }
            }
        }
        Ok(())
    }

    /// Equal strides (with the gait's variation) along an arc, a straight line when `turn_rad` is 0, rising evenly.
    fn walk(&mut self, length_m: f64, turn_rad: f64, rise_m: f64, floor_pitch_rad: f64) {
        let start = self.here;
        let strides = whole(length_m / self.gait.stride_m);
        for stride in 1..=strides {
            let mut share = f64::from(stride) / f64::from(strides);
            let wander: f64 = StandardNormal.sample(self.rng);
            if stride < strides {
                // Half of the variation goes into each of the two strides that meet here; never past 3 sigma.
                share += wander.clamp(-3.0, 3.0) * self.gait.variation / f64::from(strides) * 0.5;
            }
            let mut to = ahead(&start, length_m * share, -turn_rad * share, rise_m * share);
            to.pitch_rad = floor_pitch_rad;
            self.stride(to);
        }
    }

    fn stride(&mut self, to: Footprint) {
        let nominal = self.gait;
        let mut varied = || {
            let draw: f64 = StandardNormal.sample(self.rng);
            1.0 + nominal.variation * draw.clamp(-3.0, 3.0)
        };
        let (time, vigour) = (varied(), varied());
        let length_m = (to.position_m - self.here.position_m).xy().norm();
        // A foot that steps short rolls and swings less; on the spot it still lifts.
        let effort = vigour * (0.35 + 0.65 * (length_m / nominal.stride_m).min(1.1));
        let gait = Gait {
            early_heel_off_rad: nominal.early_heel_off_rad * effort,
            heel_off_rad: nominal.heel_off_rad * effort,
            heel_strike_rad: nominal.heel_strike_rad * effort,
            clearance_m: nominal.clearance_m * vigour,
            circumduction_m: nominal.circumduction_m * effort,
            swing_roll_rad: nominal.swing_roll_rad * effort,
            swing_yaw_rad: nominal.swing_yaw_rad * effort,
            shock_m: nominal.shock_m * effort * vigour,
            // Standing is standing, whatever the gait before it.
            stance_rock_rad: if self.rest_s > 0.0 { 0.0 } else { nominal.stance_rock_rad * vigour },
            stride_s: nominal.stride_s * time,
            ..nominal
        };
        let stride = Stride {
            start_s: self.now_s,
            still_s: self.rest_s + gait.stride_s * gait.still_share,
            moving_s: gait.stride_s * (1.0 - gait.still_share),
            from: self.here,
            to,
            gait,
        };
        self.now_s = stride.end_s();
        self.rest_s = 0.0;
        self.here = to;
        self.strides.push(stride);
    }
}

/// The footprint `forward_m` ahead along an arc that turns left by `left_turn_rad`, and `up_m` higher; floor level.
fn ahead(from: &Footprint, forward_m: f64, left_turn_rad: f64, up_m: f64) -> Footprint {
    let half = 0.5 * left_turn_rad;
    // Chord of the arc: length · sin(half)/half, in the mean direction.
    let chord_m = if half.abs() < 1e-9 { forward_m } else { forward_m * libm::sin(half) / half };
    let (sin, cos) = libm::sincos(from.yaw_rad + half);
    Footprint {
        position_m: from.position_m + Vector3::new(chord_m * cos, chord_m * sin, up_m),
        yaw_rad: from.yaw_rad + left_turn_rad,
        pitch_rad: 0.0,
    }
}

/// Number of equal parts none of which is longer than one; none for nothing.
fn whole(parts: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "legs are checked: at most 100 km in strides of at least 5 cm, 2 million"
    )]
    // A length that is a whole number of strides but for rounding takes that number.
    let count = libm::ceil(parts - 1e-9).max(0.0) as u32;
    count
}
