//! Where a body is while the walker walks: standing, going from point to point, or keeping beside the walker.
//!
//! A course is a list of knots, time, place and direction, with even speed between them: position is continuous, speed
//! jumps where a body starts, stops or turns a corner. Before the first knot and after the last the body stands.

use crate::error::{SimulationError, check_within};
use crate::foot_motion::FootWalk;
use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Furthest a body may be from the origin, m, and latest it may move, s.
const FURTHEST_M: f64 = 1e5;
const LATEST_S: f64 = 1e6;

/// One piece of a course.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Move {
    /// Go straight to a point at an even speed.
    Go {
        /// Where to, ENU, m.
        to_m: [f64; 3],
        /// How fast, m/s.
        speed_m_s: f64,
    },
    /// Stand.
    Stop {
        /// How long, s.
        seconds: f64,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    time_s: f64,
    position_m: Vector3<f64>,
    /// Direction of the body's x axis, anticlockwise from east, rad.
    yaw_rad: f64,
}

/// Place and direction of a body over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// In order of time; never empty. Two knots of one time are a turn on the spot.
    knots: Vec<Knot>,
}

impl Course {
    /// Standing there, its x axis east.
    pub fn standing(position_m: Vector3<f64>) -> Self {
        Self { knots: vec![Knot { time_s: 0.0, position_m, yaw_rad: 0.0 }] }
    }

    /// Standing at `from_m` until `start_s`, then one move after the other, looking where it goes.
    pub fn moving(from_m: [f64; 3], start_s: f64, moves: &[Move]) -> Result<Self, SimulationError> {
        check_within("start_s", start_s, -LATEST_S, LATEST_S, "-1e6 to 1e6 s")?;
        let mut here = Knot { time_s: start_s, position_m: point("at_m", from_m)?, yaw_rad: 0.0 };
        let mut knots = vec![here];
        let mut went = false;
        for step in moves {
            match *step {
                Move::Stop { seconds } => {
                    check_within("seconds", seconds, 0.0, LATEST_S, "0 to 1e6 s")?;
                    here.time_s += seconds;
                }
                Move::Go { to_m, speed_m_s } => {
                    check_within("speed_m_s", speed_m_s, 0.01, 100.0, "0.01 to 100 m/s")?;
                    let to = point("to_m", to_m)?;
                    let way = to - here.position_m;
                    if way.xy().norm() > 0.0 {
                        here.yaw_rad = libm::atan2(way.y, way.x);
                    }
                    if !went {
                        // Waiting, it already looked that way.
                        for knot in &mut knots {
                            knot.yaw_rad = here.yaw_rad;
                        }
                        went = true;
                    }
                    knots.push(here);
                    here = Knot { time_s: here.time_s + way.norm() / speed_m_s, position_m: to, ..here };
                }
            }
            knots.push(here);
        }
        Ok(Self { knots })
    }

    /// Keeping `offset_m` (forward, left, up, as the foot points) from a walker between two times, standing before and
    /// after. It follows the footprints, not the swing of the foot.
    pub fn beside(
        walk: &FootWalk,
        offset_m: [f64; 3],
        from_s: f64,
        until_s: f64,
    ) -> Result<Self, SimulationError> {
        let offset = point("offset_m", offset_m)?;
        check_within("from_s", from_s, 0.0, LATEST_S, "0 to 1e6 s")?;
        check_within("until_s", until_s, from_s, LATEST_S, "from_s to 1e6 s")?;
        let knot = |time_s, position_m: Vector3<f64>, yaw_rad: f64| {
            let (sin, cos) = libm::sincos(yaw_rad);
            let beside =
                Vector3::new(cos * offset.x - sin * offset.y, sin * offset.x + cos * offset.y, offset.z);
            Knot { time_s, position_m: position_m + beside, yaw_rad }
        };
        let whole = Self {
            knots: match walk.strides().first() {
                None => return Ok(Self::standing(offset)),
                Some(first) => {
                    core::iter::once(knot(first.start_s, first.from.position_m, first.from.yaw_rad))
                        .chain(walk.strides().iter().flat_map(|stride| {
                            let (from, to) = (stride.from, stride.to);
                            [
                                knot(stride.start_s + stride.still_s, from.position_m, from.yaw_rad),
                                knot(stride.end_s(), to.position_m, to.yaw_rad),
                            ]
                        }))
                        .collect()
                }
            },
        };
        let inner = whole.knots.iter().filter(|knot| (from_s..=until_s).contains(&knot.time_s));
        let knots =
            core::iter::once(whole.at(from_s)).chain(inner.copied()).chain([whole.at(until_s)]).collect();
        Ok(Self { knots })
    }

    /// Place, ENU, m, and direction of the x axis, anticlockwise from east, rad.
    pub fn pose(&self, time_s: f64) -> (Vector3<f64>, f64) {
        let Knot { position_m, yaw_rad, .. } = self.at(time_s);
        (position_m, yaw_rad)
    }

    fn at(&self, time_s: f64) -> Knot {
        let next = self.knots.partition_point(|knot| knot.time_s <= time_s);
        let (before, after) =
            (self.knots[next.saturating_sub(1)], self.knots[next.min(self.knots.len() - 1)]);
        let span_s = after.time_s - before.time_s;
        let share = if span_s > 0.0 { ((time_s - before.time_s) / span_s).clamp(0.0, 1.0) } else { 0.0 };
        Knot {
            time_s,
            position_m: before.position_m.lerp(&after.position_m, share),
            yaw_rad: before.yaw_rad + share * (after.yaw_rad - before.yaw_rad),
        }
    }
}

fn point(name: &'static str, coordinates_m: [f64; 3]) -> Result<Vector3<f64>, SimulationError> {
    for found in coordinates_m {
        check_within(name, found, -FURTHEST_M, FURTHEST_M, "-100 to 100 km")?;
    }
    Ok(Vector3::from(coordinates_m))
}
