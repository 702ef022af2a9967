//! Where a person is and what they do, as a function of time: the coarse view.
//!
//! An itinerary is a chain of episodes without gaps. In a moving one the body follows its way step by step: of `m` steps the first
//! and the last go half as far as the others, so that the body starts and stops with both feet together:
//! `σ(x) = ℓ · {x²/2, x − ½, m − 1 − (m − x)²/2}`, `x` the time in steps. Across its way a body wanders slowly.

use super::ground::BODY_HALF_WIDTH_M;
use super::path::Path;
use super::posture::Manner;
use super::vehicle::Vehicle;
use super::vibration::{Tone, sum};
use crate::jet::Jet;
use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Wandering dies out over this before the ends of a way, m.
const STEADY_M: f64 = 4.0;

/// What a person does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Activity {
    /// Stands, waits, rests.
    Stand,
    /// Stands and works: the trunk moves.
    Work,
    /// Walks, or turns on the spot.
    Walk,
    /// Runs.
    Run,
    /// Goes on hands and knees.
    Crawl,
    /// Boards or leaves a vehicle.
    Board,
    /// Rides.
    Ride,
    /// Has fallen and lies.
    Lie,
}

impl Activity {
    /// As written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stand => "stand",
            Self::Work => "work",
            Self::Walk => "walk",
            Self::Run => "run",
            Self::Crawl => "crawl",
            Self::Board => "board",
            Self::Ride => "ride",
            Self::Lie => "lie",
        }
    }
}

/// Part of a way, covered in steps.
#[derive(Debug, Clone)]
pub(super) struct Going {
    pub path: Arc<Path>,
    pub wander: [Tone; 2],
    pub from_m: f64,
    pub to_m: f64,
    pub steps: u32,
    pub manner: Manner,
    /// Steps in the time that one takes at the person's own speed.
    pub hurry: f64,
}

impl Going {
    /// Way along the path after `steps` steps.
    pub fn sigma(&self, steps: f64) -> f64 {
        let last = f64::from(self.steps);
        let x = steps.clamp(0.0, last);
        let gone = if x < 1.0 {
            0.5 * x * x
        } else if x > last - 1.0 {
            last - 1.0 - 0.5 * (last - x) * (last - x)
        } else {
            x - 0.5
        };
        self.from_m + gone * self.step_m()
    }

    /// Length of a step, m.
    pub fn step_m(&self) -> f64 {
        (self.to_m - self.from_m) / (f64::from(self.steps) - 1.0)
    }

    /// Body axis on the floor and direction of the way, anticlockwise from east, rad.
    pub fn at(&self, sigma: f64) -> (Vector3<f64>, f64) {
        let on = self.path.at(sigma);
        let yaw = libm::atan2(on.first.y, on.first.x);
        let (sin, cos) = libm::sincos(yaw);
        let end = sigma.min(self.path.length_m() - sigma) / STEADY_M;
        let taper = super::hermite::ease(1.0, end).value;
        let left = if taper > 0.0 { taper * sum(&self.wander, sigma).value } else { 0.0 };
        let place = on.place + Vector3::new(-sin * left, cos * left, 0.0);
        (Vector3::new(place.x, place.y, self.path.floor_m(sigma)), yaw)
    }
}

/// What an episode is.
#[derive(Debug, Clone)]
pub(super) enum Doing {
    /// Stands or works at a place.
    Stay { manner: Manner },
    /// Turns on the spot in steps, to this heading.
    Turn { to_yaw: f64, steps: u32 },
    /// Goes.
    Go(Going),
    /// Climbs to a place, in a time; and sits there or stands.
    Climb { to: Vector3<f64>, to_yaw: f64, tilt: f64, sit: bool },
    /// Rides on a vehicle, carried at this place of it.
    Ride { vehicle: Arc<Vehicle>, seat_m: Vector3<f64> },
}

/// One piece of an itinerary.
#[derive(Debug, Clone)]
pub(super) struct Episode {
    pub start_s: f64,
    pub end_s: f64,
    /// Where and how it begins; not reduced to one turn.
    pub place: Vector3<f64>,
    pub yaw: f64,
    pub doing: Doing,
}

/// The chain of episodes of one person.
#[derive(Debug, Clone, Default)]
pub(super) struct Itinerary {
    pub episodes: Vec<Episode>,
}

/// Where a body is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whereabouts {
    /// Body axis on the floor (on the seat while riding), mine grid, m.
    pub floor_m: Vector3<f64>,
    /// Which way the body faces, anticlockwise from east, rad.
    pub yaw_rad: f64,
    /// What it does.
    pub activity: Activity,
}

impl Episode {
    fn activity(&self) -> Activity {
        match &self.doing {
            Doing::Stay { manner: Manner::Work } => Activity::Work,
            Doing::Stay { manner: Manner::Crawl } => Activity::Crawl,
            Doing::Stay { manner: Manner::Lie } => Activity::Lie,
            Doing::Stay { .. } => Activity::Stand,
            Doing::Turn { .. } => Activity::Walk,
            Doing::Go(going) => match going.manner {
                Manner::Run => Activity::Run,
                Manner::Crawl => Activity::Crawl,
                _ => Activity::Walk,
            },
            Doing::Climb { .. } => Activity::Board,
            Doing::Ride { .. } => Activity::Ride,
        }
    }

    fn whereabouts(&self, time_s: f64) -> Whereabouts {
        let share = ((time_s - self.start_s) / (self.end_s - self.start_s)).clamp(0.0, 1.0);
        let eased = super::hermite::ease(1.0, share).value;
        let (floor_m, yaw_rad) = match &self.doing {
            Doing::Stay { .. } => (self.place, self.yaw),
            Doing::Turn { to_yaw, .. } => (self.place, self.yaw + (to_yaw - self.yaw) * eased),
            Doing::Go(going) => going.at(going.sigma(share * f64::from(going.steps))),
            Doing::Climb { to, to_yaw, .. } => {
                (self.place + (to - self.place) * eased, self.yaw + (to_yaw - self.yaw) * eased)
            }
            Doing::Ride { vehicle, seat_m } => {
                let pose = vehicle.pose(time_s);
                (seated(seat_m, pose.floor_m, pose.yaw_rad, pose.pitch_rad), pose.yaw_rad)
            }
        };
        Whereabouts { floor_m, yaw_rad, activity: self.activity() }
    }
}

/// A place on a vehicle, in the mine.
pub(super) fn seated(seat_m: &Vector3<f64>, floor_m: Vector3<f64>, yaw: f64, pitch: f64) -> Vector3<f64> {
    let arm = crate::jet::JetVector::constant(seat_m);
    floor_m + arm.turned_about_y(Jet::constant(pitch)).turned_about_z(Jet::constant(yaw)).value()
}

impl Itinerary {
    pub fn end_s(&self) -> f64 {
        self.episodes.last().map_or(0.0, |episode| episode.end_s)
    }

    /// The number of the episode under way: the first before the start, the last after the end.
    pub fn under_way(&self, time_s: f64) -> usize {
        self.episodes.partition_point(|episode| episode.start_s <= time_s).saturating_sub(1)
    }

    pub fn at(&self, time_s: f64) -> Whereabouts {
        match self.episodes.get(self.under_way(time_s)) {
            Some(episode) => episode.whereabouts(time_s.min(episode.end_s)),
            None => Whereabouts { floor_m: Vector3::zeros(), yaw_rad: 0.0, activity: Activity::Stand },
        }
    }
}

/// Amplitude of a wander that keeps a body off the walls, m.
pub(super) fn wander_m(asked_m: f64, room_m: f64) -> f64 {
    asked_m.min(room_m.max(0.0)).min(4.0 * BODY_HALF_WIDTH_M)
}
