//! Where a walk along roadways goes: legs, and how they are drawn.

use crate::error::{SimulationError, check_within};
use core::f64::consts::TAU;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};

/// Random stream of the plan.
const STREAM: u64 = 1;
/// A drawn walk begins at rest, s.
const FIRST_STAND_S: f64 = 1.0;

/// A part of a walk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RoadwayLeg {
    /// Comes to a halt and stands, s.
    Stand {
        /// Time at rest, s.
        seconds: f64,
    },
    /// Straight on.
    Straight {
        /// Length, m, of what is walked at full speed; gathering and losing speed come on top.
        length_m: f64,
        /// Speed, m/s.
        speed_m_s: f64,
    },
    /// Into a roadway that branches off, at the speed of the leg before, slower in the corner.
    Turn {
        /// Clockwise seen from above, rad.
        turn_rad: f64,
    },
}

/// A walk: first heading, legs, and how long a change of velocity takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadwayPlan {
    /// First heading, clockwise from north, rad.
    pub heading_rad: f64,
    /// Time to change speed, s.
    pub speed_change_s: f64,
    /// Time for a turn, s.
    pub turn_s: f64,
    /// Legs, one after the other; the walk ends standing.
    pub legs: Vec<RoadwayLeg>,
}

/// From what a walk is drawn; a pair is the least and the most, evenly distributed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadwayRanges {
    /// How long the walk lasts, s.
    pub duration_s: f64,
    /// Speed on a straight, m/s.
    pub speed_m_s: [f64; 2],
    /// Length of a straight, m.
    pub straight_m: [f64; 2],
    /// Angle of a turn to either side, rad.
    pub turn_rad: [f64; 2],
    /// A straight ends in a stop, not in a turn, with this probability.
    pub stop_probability: f64,
    /// Time at rest at a stop, s.
    pub stop_s: [f64; 2],
    /// Time to change speed, s.
    pub speed_change_s: f64,
    /// Time for a turn, s.
    pub turn_s: f64,
}

impl Default for RoadwayRanges {
    /// System S0: 1000 s at 0.75 to 1.5 m/s (0.5 m/s and more in the corners).
    fn default() -> Self {
        Self {
            duration_s: 1000.0,
            speed_m_s: [0.75, 1.5],
            straight_m: [15.0, 60.0],
            turn_rad: [TAU / 8.0, TAU / 4.0],
            stop_probability: 0.25,
            stop_s: [5.0, 20.0],
            speed_change_s: 2.0,
            turn_s: 4.0,
        }
    }
}

impl RoadwayRanges {
    /// Ranges are ranges, and of people.
    pub fn check(&self) -> Result<(), SimulationError> {
        let ranges = [
            ("speed_m_s", self.speed_m_s, 0.1, 3.0, "least and most, 0.1 to 3 m/s"),
            ("straight_m", self.straight_m, 1.0, 1e4, "least and most, 1 to 10000 m"),
            ("turn_rad", self.turn_rad, 0.0, TAU / 3.0, "least and most, 0 to 2π/3 rad (120°)"),
            ("stop_s", self.stop_s, 0.0, 1e5, "least and most, 0 to 100000 s"),
        ];
        for (name, [least, most], low, high, expected) in ranges {
            check_within(name, least, low, high, expected)?;
            check_within(name, most, least, high, expected)?;
        }
        check_within("duration_s", self.duration_s, 1.0, 1e6, "1 to 1e6 s")?;
        check_within("stop_probability", self.stop_probability, 0.0, 1.0, "0 to 1")?;
        check_within("speed_change_s", self.speed_change_s, 0.5, 60.0, "0.5 to 60 s")?;
        check_within("turn_s", self.turn_s, 0.5, 60.0, "0.5 to 60 s")
    }
}

impl RoadwayPlan {
    /// Draws a walk at least as long as asked for: a second at rest, a straight, then a stop or a turn to either side, and so on.
    pub fn random(ranges: &RoadwayRanges, seed: u64) -> Result<Self, SimulationError> {
        ranges.check()?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(STREAM);
        // 53 random bits, as many as an f64 in [0, 1) holds.
        let mut share = || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let mut within = |[least, most]: [f64; 2]| least + (most - least) * share();
        let heading_rad = within([0.0, TAU]);
        let mut legs = vec![RoadwayLeg::Stand { seconds: FIRST_STAND_S }];
        let mut spent_s = FIRST_STAND_S;
        while spent_s < ranges.duration_s {
            let (length_m, speed_m_s) = (within(ranges.straight_m), within(ranges.speed_m_s));
            legs.push(RoadwayLeg::Straight { length_m, speed_m_s });
            spent_s += length_m / speed_m_s;
            if within([0.0, 1.0]) < ranges.stop_probability {
                let seconds = within(ranges.stop_s);
                legs.push(RoadwayLeg::Stand { seconds });
                spent_s += seconds;
            } else {
                let side = if within([0.0, 1.0]) < 0.5 { -1.0 } else { 1.0 };
                legs.push(RoadwayLeg::Turn { turn_rad: side * within(ranges.turn_rad) });
                spent_s += ranges.turn_s;
            }
        }
        let RoadwayRanges { speed_change_s, turn_s, .. } = *ranges;
        Ok(Self { heading_rad, speed_change_s, turn_s, legs })
    }

    /// Angles, lengths and speeds are those of a walk.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("heading_rad", self.heading_rad, -10.0, 10.0, "-10 to 10 rad")?;
        check_within("speed_change_s", self.speed_change_s, 0.5, 60.0, "0.5 to 60 s")?;
        check_within("turn_s", self.turn_s, 0.5, 60.0, "0.5 to 60 s")?;
        self.legs.iter().try_for_each(|leg| match *leg {
            RoadwayLeg::Stand { seconds } => check_within("seconds", seconds, 0.0, 1e6, "0 to 1e6 s"),
            RoadwayLeg::Straight { length_m, speed_m_s } => {
                check_within("speed_m_s", speed_m_s, 0.1, 3.0, "0.1 to 3 m/s")?;
                check_within("length_m", length_m, 0.0, 1e5, "0 to 100000 m")
            }
            RoadwayLeg::Turn { turn_rad } => {
                check_within("turn_rad", turn_rad, -TAU / 3.0, TAU / 3.0, "-2π/3 to 2π/3 rad (120°)")
            }
        })
    }
}
