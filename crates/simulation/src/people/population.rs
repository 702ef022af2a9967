//! Everybody in a mine, and each of them alone.

use super::body::Body;
use super::errands::{Errand, Planner};
use super::foot::FootMotion;
use super::ground::{Ground, Place};
use super::itinerary::{Itinerary, Whereabouts};
use super::posture::{Manner, Posture};
use super::shift::{ShiftSpec, Workings, plan};
use super::steps::Steps;
use super::vehicle::{Vehicle, VehicleSpec};
use super::vibration::between;
use super::waist::{Belt, WaistMotion};
use crate::error::{SimulationError, check_within};
use crate::gait::Foot;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Somebody whose errands are given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PersonSpec {
    /// Build, speeds, habits.
    #[serde(default)]
    pub body: Body,
    /// Draw them about `body` by the seed, as those of people whose shift is drawn.
    #[serde(default)]
    pub drawn: bool,
    /// Where they are at first.
    pub start: Place,
    /// What they do, in order.
    pub errands: Vec<Errand>,
}

/// Who and what moves in a mine.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PopulationSpec {
    /// Number of people whose shift is drawn; they come after those of `persons`.
    pub people: u32,
    /// Their shift.
    pub shift: ShiftSpec,
    /// Their build on average; height, speeds and habits of each are drawn about it.
    pub body: Body,
    /// People whose errands are given.
    pub persons: Vec<PersonSpec>,
    /// Vehicles.
    pub vehicles: Vec<VehicleSpec>,
}

/// What a stream of random numbers is for; `ChaCha8` streams from 2³² on, 16 to each person or vehicle.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    Plan = 0,
    Steps = 1,
    Sway = 2,
    Vehicle = 3,
}

fn stream(seed: u64, index: u64, purpose: Purpose) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream((1 << 32) + 16 * index + purpose as u64);
    rng
}

/// People and vehicles of a mine, made from a seed. Each person depends on the mine, the vehicles, the seed and their own number alone.
#[derive(Debug, Clone)]
pub struct Population {
    ground: Ground,
    spec: PopulationSpec,
    seed: u64,
    vehicles: Vec<Arc<Vehicle>>,
    workings: Option<Workings>,
}

impl Population {
    /// Checks the specification and makes the vehicles; people are made one by one, by [`Self::person`].
    pub fn new(mine: &Mine, spec: &PopulationSpec, seed: u64) -> Result<Self, SimulationError> {
        spec.body.check()?;
        spec.shift.check()?;
        check_within("people", f64::from(spec.people), 0.0, 1e6, "0 to 1e6")?;
        let ground = Ground::new(mine);
        let make = |(index, vehicle): (u64, &VehicleSpec)| {
            let rng = &mut stream(seed, index, Purpose::Vehicle);
            Vehicle::new(mine, &ground, vehicle, format!("vehicle-{index}"), rng).map(Arc::new)
        };
        let vehicles = (0..).zip(&spec.vehicles).map(make).collect::<Result<Vec<_>, _>>()?;
        let workings = if spec.people > 0 { Some(Workings::new(mine, &ground, &spec.shift)?) } else { None };
        Ok(Self { ground, spec: spec.clone(), seed, vehicles, workings })
    }

    /// Number of people.
    pub fn len(&self) -> usize {
        self.spec.persons.len() + self.spec.people as usize
    }

    /// Nobody.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vehicles.
    pub fn vehicles(&self) -> &[Arc<Vehicle>] {
        &self.vehicles
    }

    /// A person by number from 0; `None` beyond the last.
    pub fn person(&self, index: usize) -> Option<Result<Person, SimulationError>> {
        if index >= self.len() {
            return None;
        }
        let scripted = self.spec.persons.get(index);
        let number = index as u64;
        let rng = &mut stream(self.seed, number, Purpose::Plan);
        let seat = u32::try_from(index).unwrap_or(u32::MAX);
        Some(match (scripted, &self.workings) {
            (Some(person), _) => self.scripted(person, number, seat, rng),
            (None, Some(workings)) => {
                let body = drawn(&self.spec.body, rng);
                let start = workings.portal(rng, &self.ground);
                let planner = Planner::new(&self.ground, &self.vehicles, body, seat, start, rng);
                Ok(Person::new(body, plan(planner, workings, &self.spec.shift), self.seed, number))
            }
            (None, None) => return None,
        })
    }

    fn scripted(
        &self,
        person: &PersonSpec,
        number: u64,
        seat: u32,
        rng: &mut ChaCha8Rng,
    ) -> Result<Person, SimulationError> {
        person.body.check()?;
        let start = self.ground.stand("start", &person.start)?;
        let body = if person.drawn { drawn(&person.body, rng) } else { person.body };
        let mut planner = Planner::new(&self.ground, &self.vehicles, body, seat, start, rng);
        for errand in &person.errands {
            planner.run(errand)?;
        }
        Ok(Person::new(body, planner.finish(), self.seed, number))
    }
}

/// A build about the average: height 4 %, speeds 10 % (standard deviations), habits evenly up to half as much again.
fn drawn(mean: &Body, rng: &mut ChaCha8Rng) -> Body {
    let mut about = |mean: f64, share: f64| {
        let draw: f64 = StandardNormal.sample(rng);
        mean * (1.0 + share * draw.clamp(-2.5, 2.5))
    };
    let (height_m, walk_m_s) = (about(mean.height_m, 0.04), about(mean.walk_m_s, 0.1));
    let (run_m_s, crawl_m_s) = (about(mean.run_m_s, 0.1), about(mean.crawl_m_s, 0.1));
    let keep_right_m = mean.keep_right_m * between(rng, 0.5, 1.5);
    let wander_m = mean.wander_m * between(rng, 0.5, 1.5);
    Body { height_m, walk_m_s, run_m_s, crawl_m_s, keep_right_m, wander_m, ..*mean }
}

/// Somebody in a mine: where they are at any time, and the motion of sensors that they wear.
#[derive(Debug, Clone)]
pub struct Person {
    body: Body,
    itinerary: Itinerary,
    seed: u64,
    number: u64,
}

impl Person {
    fn new(body: Body, itinerary: Itinerary, seed: u64, number: u64) -> Self {
        Self { body, itinerary, seed, number }
    }

    /// Build, speeds, habits.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// When their itinerary ends, s.
    pub fn duration_s(&self) -> f64 {
        self.itinerary.end_s()
    }

    /// Where they are, whither they face, what they do: the coarse view, for radio and for others; cheap.
    pub fn at(&self, time_s: f64) -> Whereabouts {
        self.itinerary.at(time_s)
    }

    /// The body axis on the floor (on the seat while riding), mine grid, m.
    pub fn floor_m(&self, time_s: f64) -> Vector3<f64> {
        self.at(time_s).floor_m
    }

    /// Height of the middle of the pelvis above [`Self::floor_m`], m.
    pub fn waist_height_m(&self, time_s: f64) -> f64 {
        let manner = match self.at(time_s).activity {
            super::Activity::Crawl => Manner::Crawl,
            super::Activity::Ride => Manner::Sit,
            super::Activity::Lie => Manner::Lie,
            _ => Manner::Stand,
        };
        Posture::of(manner, self.body.height_m, self.body.step(manner).0).height
    }

    /// Times at which an episode begins, with what is done in it from then on; in order.
    pub fn episodes(&self) -> impl Iterator<Item = (f64, super::Activity)> + '_ {
        self.itinerary.episodes.iter().map(|episode| (episode.start_s, self.at(episode.start_s).activity))
    }

    fn steps(&self) -> Steps {
        Steps::lay(&self.itinerary, &self.body, &mut stream(self.seed, self.number, Purpose::Steps))
    }

    /// The motion of a sensor on the belt.
    pub fn waist(&self, belt: Belt) -> WaistMotion {
        let rng = &mut stream(self.seed, self.number, Purpose::Sway);
        WaistMotion::new(Arc::new(self.steps()), &self.body, belt, rng)
    }

    /// The motion of a sensor on a foot.
    pub fn foot(&self, foot: Foot, left: bool) -> FootMotion {
        FootMotion::new(&self.steps(), &self.body, foot, left)
    }
}
