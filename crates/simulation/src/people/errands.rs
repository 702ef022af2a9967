//! Errands of one person, planned into an itinerary.

use super::body::Body;
use super::ground::{BODY_HALF_WIDTH_M, Ground, Place, Stand};
use super::itinerary::{Doing, Episode, Going, Itinerary, seated, wander_m};
use super::posture::Manner;
use super::roam::{self, Roam};
use super::vehicle::Vehicle;
use super::vibration::{Tone, between};
use crate::error::{SimulationError, check_within};
use adit_core::frames::{MineGrid, Position};
use adit_core::nalgebra::Vector3;
use core::f64::consts::{FRAC_PI_6, PI, TAU};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Turning on the spot: at most this much in one step, rad, and the time of it, s.
const TURN_PER_STEP_RAD: f64 = FRAC_PI_6;
const TURN_STEP_S: f64 = 0.55;
/// Less than this is no way to go, m, and no turn to make, rad.
const NO_WAY_M: f64 = 0.3;
const NO_TURN_RAD: f64 = 0.1;
/// Getting down on hands and knees, or up again, s.
const KNEEL_S: f64 = 2.0;
/// Boarding or leaving a vehicle, and waiting before each, s.
const CLIMB_S: f64 = 4.0;
const SETTLE_S: f64 = 1.0;
/// Between a vehicle's side and who waits for it, m.
const ASIDE_M: f64 = 0.45;
/// A stretch of ordinary height between two low ones shorter than this is crawled as well, m.
const RISE_M: f64 = 1.5;

/// How somebody goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pace {
    /// On foot, at walking speed.
    #[default]
    Walk,
    /// Running.
    Run,
    /// On hands and knees; low roadways are crawled at any pace.
    Crawl,
}

/// One thing to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Errand {
    /// Stand.
    Stand {
        /// For so long, s.
        seconds: f64,
    },
    /// Stand and work.
    Work {
        /// For so long, s.
        seconds: f64,
    },
    /// Stand, or work, until a time.
    Until {
        /// That time of the simulation, s; nothing where it is over.
        until_s: f64,
        /// Work, not stand.
        #[serde(default)]
        work: bool,
    },
    /// Fall to the floor and lie there.
    Fall {
        /// For so long, s.
        seconds: f64,
    },
    /// Turn on the spot.
    Turn {
        /// Change of heading, rad, positive to the right.
        turn_rad: f64,
    },
    /// Go somewhere by the shortest way.
    Go {
        /// There.
        to: Place,
        /// How.
        #[serde(default)]
        pace: Pace,
        /// Speed, m/s, in place of the person's own at that pace.
        speed_m_s: Option<f64>,
    },
    /// Go to the nearest stop of a vehicle, wait for it, ride.
    Ride {
        /// Number of the vehicle, from 0.
        vehicle: usize,
        /// Number of the stop to leave it at, from 0.
        to_stop: usize,
    },
    /// Walk about, to places that are drawn.
    Roam(Roam),
}

/// The pen that writes an itinerary.
pub(super) struct Planner<'a> {
    ground: &'a Ground,
    vehicles: &'a [Arc<Vehicle>],
    body: Body,
    seat: u32,
    pub rng: &'a mut ChaCha8Rng,
    pub now_s: f64,
    pub stand: Stand,
    place: Vector3<f64>,
    yaw: f64,
    itinerary: Itinerary,
}

impl<'a> Planner<'a> {
    pub fn new(
        ground: &'a Ground,
        vehicles: &'a [Arc<Vehicle>],
        body: Body,
        seat: u32,
        start: Stand,
        rng: &'a mut ChaCha8Rng,
    ) -> Self {
        let (place, yaw) = ground.place(&start);
        let itinerary = Itinerary::default();
        Self { ground, vehicles, body, seat, rng, now_s: 0.0, stand: start, place, yaw, itinerary }
    }

    pub fn ground(&self) -> &'a Ground {
        self.ground
    }

    pub fn vehicles(&self) -> &'a [Arc<Vehicle>] {
        self.vehicles
    }

    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Comes to rest: the itinerary.
    pub fn finish(mut self) -> Itinerary {
        let fallen = matches!(
            self.itinerary.episodes.last(),
            Some(Episode { doing: Doing::Stay { manner: Manner::Lie }, .. })
        );
        self.stay(2.0, if fallen { Manner::Lie } else { Manner::Still });
        self.itinerary
    }

    pub fn run(&mut self, errand: &Errand) -> Result<(), SimulationError> {
        let seconds = |found| check_within("seconds", found, 0.0, 1e6, "0 to 1e6 s");
        match errand {
            Errand::Stand { seconds: time } => {
                seconds(*time)?;
                self.stay(*time, Manner::Stand);
            }
            Errand::Work { seconds: time } => {
                seconds(*time)?;
                self.stay(*time, Manner::Work);
            }
            Errand::Until { until_s, work } => {
                check_within("until_s", *until_s, 0.0, 1e6, "0 to 1e6 s")?;
                self.stay(*until_s - self.now_s, if *work { Manner::Work } else { Manner::Stand });
            }
            Errand::Fall { seconds: time } => {
                seconds(*time)?;
                self.stay(*time, Manner::Lie);
            }
            Errand::Turn { turn_rad } => {
                check_within("turn_rad", *turn_rad, -100.0, 100.0, "-100 to 100 rad")?;
                self.turn(-turn_rad);
            }
            Errand::Go { to, pace, speed_m_s } => {
                let to = self.ground.stand("to", to)?;
                let body = speed_m_s.map_or(self.body, |speed| self.body.at_speed(*pace, speed));
                body.check()?;
                if !self.go_as(&body, &to, *pace) {
                    let found = self.describe(&to);
                    let expected = "a place that can be walked to";
                    return Err(SimulationError::Unknown { name: "to", found, expected });
                }
            }
            Errand::Roam(roam) => roam::plan(self, roam)?,
            Errand::Ride { vehicle, to_stop } => {
                let known = self.vehicles.get(*vehicle);
                let vehicles = self.vehicles.len() as f64 - 1.0;
                check_within("vehicle", *vehicle as f64, 0.0, vehicles, "the number of a vehicle, from 0")?;
                let stops = known.map_or(0.0, |known| known.stops() as f64 - 1.0);
                check_within("to_stop", *to_stop as f64, 0.0, stops, "the number of a stop, from 0")?;
                if !self.ride(*vehicle, *to_stop) {
                    let found = vehicle.to_string();
                    let expected = "a vehicle that can be walked to, and that goes to another stop";
                    return Err(SimulationError::Unknown { name: "vehicle", found, expected });
                }
            }
        }
        Ok(())
    }

    fn describe(&self, stand: &Stand) -> String {
        let (place, _) = self.ground.place(stand);
        format!("{:.1}, {:.1}, {:.1}", place.x, place.y, place.z)
    }

    fn write(&mut self, seconds: f64, doing: Doing) {
        let (start_s, end_s) = (self.now_s, self.now_s + seconds);
        let episode = Episode { start_s, end_s, place: self.place, yaw: self.yaw, doing };
        self.itinerary.episodes.push(episode);
        self.now_s = end_s;
    }

    pub fn stay(&mut self, seconds: f64, manner: Manner) {
        if seconds > 0.0 {
            self.write(seconds, Doing::Stay { manner });
        }
    }

    /// Turns on the spot, positive to the left.
    pub fn turn(&mut self, by_rad: f64) {
        if by_rad.abs() < NO_TURN_RAD {
            return;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a checked angle: a few turns"
        )]
        let steps = libm::ceil(by_rad.abs() / TURN_PER_STEP_RAD).max(2.0) as u32;
        let to_yaw = self.yaw + by_rad;
        self.write(TURN_STEP_S * f64::from(steps), Doing::Turn { to_yaw, steps });
        self.yaw = to_yaw;
    }

    /// Turns the shorter way to a heading (anticlockwise from east).
    fn face(&mut self, yaw: f64) {
        self.turn(nearest_turn(yaw - self.yaw));
    }

    /// Goes somewhere at the person's own speed; false when no way leads there.
    pub fn go(&mut self, to: &Stand, pace: Pace) -> bool {
        let body = self.body;
        self.go_as(&body, to, pace)
    }

    /// Goes somewhere with the speeds of this body.
    pub fn go_as(&mut self, body: &Body, to: &Stand, pace: Pace) -> bool {
        let headroom_m = self.body.headroom * self.body.height_m;
        let from = self.stand;
        if (self.ground.place(to).0 - self.place).norm() < NO_WAY_M {
            return true;
        }
        let Some(way) = self.ground.way(&from, to, self.body.keep_right_m, headroom_m) else { return false };
        let amplitude = 0.5 * wander_m(self.body.wander_m, way.room_m);
        let wander = [19.0, 47.0].map(|wave_m| Tone {
            amplitude,
            omega: TAU / (wave_m * between(self.rng, 0.8, 1.25)),
            phase: between(self.rng, 0.0, TAU),
        });
        let path = Arc::new(way.path);
        let length_m = path.length_m();
        let upright = if pace == Pace::Run { Manner::Run } else { Manner::Walk };
        let low = if pace == Pace::Crawl { vec![(0.0, length_m)] } else { way.low };
        let mut parts: Vec<(f64, f64, Manner)> = Vec::new();
        let mut gone = 0.0;
        for (start, end) in low {
            let start = if start - gone < RISE_M { gone } else { start };
            let end = if length_m - end < RISE_M { length_m } else { end };
            if start > gone {
                parts.push((gone, start, upright));
            }
            parts.push((start, end, Manner::Crawl));
            gone = end;
        }
        if gone < length_m {
            parts.push((gone, length_m, upright));
        }
        for (from_m, to_m, manner) in parts {
            self.go_part(body, &path, wander, (from_m, to_m), manner);
        }
        self.stand = *to;
        true
    }

    fn go_part(
        &mut self,
        body: &Body,
        path: &Arc<super::path::Path>,
        wander: [Tone; 2],
        (from_m, to_m): (f64, f64),
        manner: Manner,
    ) {
        let (step_m, step_s) = body.step(manner);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a way in a mine: some km at most"
        )]
        let steps = libm::ceil((to_m - from_m) / step_m - 1e-9).max(1.0) as u32 + 1;
        let hurry = self.body.step(manner).1 / step_s;
        let going = Going { path: Arc::clone(path), wander, from_m, to_m, steps, manner, hurry };
        let (_, yaw) = going.at(from_m);
        self.face(yaw);
        if manner == Manner::Crawl {
            self.stay(KNEEL_S, Manner::Crawl);
        }
        let (place, yaw) = going.at(to_m);
        // Shorter steps take as much less time, but no less than two thirds.
        let haste = (going.step_m() / step_m).clamp(2.0 / 3.0, 1.0);
        self.write(f64::from(steps) * step_s * haste, Doing::Go(going));
        self.place = place;
        self.yaw = yaw;
        if manner == Manner::Crawl {
            self.stay(KNEEL_S, Manner::Stand);
        }
    }

    /// Where to wait for a vehicle at one of its stops.
    pub fn beside(&self, vehicle: &Vehicle, stop: usize) -> Option<Stand> {
        let point: Position<MineGrid> = Position::from_raw(vehicle.stop_m(stop));
        let near = self.ground.network.within(&point, 3.0);
        let foot = near.iter().find(|foot| self.ground.walkable(foot.spot.edge))?;
        let room_m = self.ground.half_width_m(foot.spot.edge) - BODY_HALF_WIDTH_M;
        let left_m = (0.5 * vehicle.spec().size_m[1] + ASIDE_M).min(room_m.max(0.0));
        Some(Stand { spot: foot.spot, left_m })
    }

    /// Walks to the nearest stop of a vehicle and rides to another; false when that cannot be.
    pub fn ride(&mut self, vehicle: usize, to_stop: usize) -> bool {
        let Some(vehicle) = self.vehicles.get(vehicle).map(Arc::clone) else { return false };
        let Some(from_stop) = vehicle.nearest_stop(&self.place) else { return false };
        let (Some(wait_at), Some(leave_at)) =
            (self.beside(&vehicle, from_stop), self.beside(&vehicle, to_stop))
        else {
            return false;
        };
        let needed_s = 2.0 * SETTLE_S + CLIMB_S;
        if from_stop == to_stop
            || vehicle.spec().dwell_s < needed_s + SETTLE_S
            || !self.go(&wait_at, Pace::Walk)
        {
            return false;
        }
        let Some(boarding) = vehicle.next_dwell(from_stop, self.now_s, needed_s) else { return false };
        let Some(leaving) = vehicle.next_dwell(to_stop, boarding.depart_s, needed_s) else { return false };
        let seat_m = vehicle.seat_m(self.seat);
        self.stay(boarding.arrive_s.max(self.now_s) + SETTLE_S - self.now_s, Manner::Stand);
        let pose = vehicle.pose(self.now_s);
        let to = seated(&seat_m, pose.floor_m, pose.yaw_rad, pose.pitch_rad);
        let to_yaw = self.yaw + nearest_turn(pose.yaw_rad - self.yaw);
        self.write(CLIMB_S, Doing::Climb { to, to_yaw, tilt: pose.pitch_rad, sit: true });
        (self.place, self.yaw) = (to, to_yaw);
        let until_s = leaving.arrive_s + SETTLE_S;
        self.write(until_s - self.now_s, Doing::Ride { vehicle: Arc::clone(&vehicle), seat_m });
        let pose = vehicle.pose(self.now_s);
        self.place = seated(&seat_m, pose.floor_m, pose.yaw_rad, pose.pitch_rad);
        self.yaw = pose.yaw_rad;
        let (to, _) = self.ground.place(&leave_at);
        self.write(CLIMB_S, Doing::Climb { to, to_yaw: self.yaw, tilt: 0.0, sit: false });
        self.place = to;
        self.stand = leave_at;
        true
    }
}

/// The same turn, at most half a round.
pub(super) fn nearest_turn(by_rad: f64) -> f64 {
    let rest = libm::fmod(by_rad, TAU);
    if rest > PI {
        rest - TAU
    } else if rest < -PI {
        rest + TAU
    } else {
        rest
    }
}
