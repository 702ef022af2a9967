//! Who and what is near: the obstacles of somebody's radio.

use crate::error::SimulationError;
use crate::people::{Activity, Person, Population, Vehicle};
use crate::radio::{Obstacle, Shape};
use adit_core::nalgebra::Vector3;
use std::sync::Arc;

/// The list of those who may come near is renewed after so long, s.
const RENEWED_S: f64 = 1.0;
/// Obstacles that matter are this near, m; in [`RENEWED_S`] the fastest vehicle comes 30 m nearer.
const NEAR_M: f64 = 90.0;
/// Sitting or on hands and knees, a person is this share of their height.
const LOW: f64 = 0.55;
/// Lying, this share.
const LYING: f64 = 0.17;
const TRUNK_RADIUS_M: f64 = 0.2;

/// Everybody and every vehicle.
#[derive(Debug, Clone)]
pub(super) struct Crowd {
    people: Vec<Arc<Person>>,
    vehicles: Vec<Arc<Vehicle>>,
    shades: bool,
}

/// The part of a crowd around one person, looked up anew every second.
#[derive(Debug, Clone, Default)]
pub(super) struct Neighbours {
    renewed_s: Option<f64>,
    people: Vec<u32>,
    vehicles: Vec<u32>,
    obstacles: Vec<Obstacle>,
}

impl Crowd {
    /// `shades`: whether people are in the way of radio.
    pub fn new(population: &Population, shades: bool) -> Result<Self, SimulationError> {
        let people = (0..population.len()).filter_map(|index| population.person(index));
        Ok(Self {
            people: people.map(|person| person.map(Arc::new)).collect::<Result<_, _>>()?,
            vehicles: population.vehicles().to_vec(),
            shades,
        })
    }

    pub fn people(&self) -> impl Iterator<Item = &Person> {
        self.people.iter().map(AsRef::as_ref)
    }

    pub fn person(&self, index: usize) -> Option<&Arc<Person>> {
        self.people.get(index)
    }
}

impl Neighbours {
    /// Obstacles around `here_m` at a time, without the wearer and what carries them.
    pub fn around(
        &mut self,
        crowd: &Crowd,
        wearer: usize,
        here_m: &Vector3<f64>,
        time_s: f64,
    ) -> &[Obstacle] {
        if self.renewed_s.is_none_or(|renewed_s| !(renewed_s..renewed_s + RENEWED_S).contains(&time_s)) {
            self.renew(crowd, wearer, here_m, time_s);
        }
        self.obstacles.clear();
        for index in &self.people {
            let person = &crowd.people[*index as usize];
            let now = person.at(time_s);
            let share = match now.activity {
                Activity::Lie => LYING,
                Activity::Crawl | Activity::Ride => LOW,
                _ => 1.0,
            };
            let height_m = person.body().height_m * share;
            let shape = Shape::Round { radius_m: TRUNK_RADIUS_M };
            self.obstacles.push(Obstacle { foot_m: now.floor_m, height_m, shape });
        }
        for index in &self.vehicles {
            let obstacle = as_obstacle(&crowd.vehicles[*index as usize], time_s);
            if !inside(&obstacle, here_m) {
                self.obstacles.push(obstacle);
            }
        }
        &self.obstacles
    }

    fn renew(&mut self, crowd: &Crowd, wearer: usize, here_m: &Vector3<f64>, time_s: f64) {
        let near = |floor_m: Vector3<f64>| (floor_m - here_m).norm_squared() < NEAR_M * NEAR_M;
        self.renewed_s = Some(time_s);
        self.people.clear();
        let others = (0..).zip(&crowd.people).filter(|(index, _)| crowd.shades && *index as usize != wearer);
        self.people.extend(others.filter(|(_, person)| near(person.floor_m(time_s))).map(|(index, _)| index));
        self.vehicles.clear();
        let vehicles = (0..).zip(&crowd.vehicles).filter(|(_, vehicle)| near(vehicle.pose(time_s).floor_m));
        self.vehicles.extend(vehicles.map(|(index, _)| index));
    }
}

fn as_obstacle(vehicle: &Vehicle, time_s: f64) -> Obstacle {
    let pose = vehicle.pose(time_s);
    let [length_m, width_m, height_m] = vehicle.spec().size_m;
    let shape = Shape::Box {
        half_length_m: 0.5 * length_m,
        half_width_m: 0.5 * width_m,
        heading_rad: core::f64::consts::FRAC_PI_2 - pose.yaw_rad,
    };
    Obstacle { foot_m: pose.floor_m, height_m, shape }
}

/// Who sits in a vehicle is not behind it.
fn inside(obstacle: &Obstacle, place_m: &Vector3<f64>) -> bool {
    let Shape::Box { half_length_m, half_width_m, heading_rad } = obstacle.shape else { return false };
    let off = (place_m - obstacle.foot_m).xy();
    let (sin, cos) = libm::sincos(heading_rad);
    let (ahead, aside) = (off.x * sin + off.y * cos, off.x * cos - off.y * sin);
    ahead.abs() < half_length_m && aside.abs() < half_width_m && (place_m.z - obstacle.foot_m.z).abs() < 3.0
}
