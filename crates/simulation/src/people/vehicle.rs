//! Vehicles: they shuttle along a route of the mine, stop by stop, for ever, in closed form.
//!
//! A vehicle goes from the first stop of its route to the last and back, without turning round: on the way back it reverses. Between
//! two stops it gathers speed over `t_r = 15/8 v/a` (`v` cruising speed, `a` the strongest acceleration asked for) as the quintic
//! step, cruises, and loses speed in the same way; where there is no room to reach `v`, it goes as fast as there is. Its way is the
//! centre line with rounded corners (private module `path`), so that its position is C³; heading and pitch are those of the way.
//!
//! Frame: mine grid; vehicle axes x forward, y left, z up, origin on the floor below its middle. m, s, rad.
//!
//! **Limits.** Vehicles and people do not heed one another. The corners of a long vehicle may touch rock in a bend: its middle follows
//! the centre line. A parked vehicle does not shake.

use super::ground::Ground;
use super::hermite::ease;
use super::path::Path;
use super::vibration::Vibration;
use crate::error::{SimulationError, check_within};
use crate::jet::{Jet, JetVector};
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Corners are rounded over this, where there is room, m either side.
const ROUND_M: f64 = 6.0;

/// A vehicle on a route.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleSpec {
    /// Id of a vehicle route of the mine.
    pub route: String,
    /// Cruising speed, m/s; that of the route when absent.
    #[serde(default)]
    pub speed_m_s: Option<f64>,
    /// Strongest acceleration and braking, m/s².
    #[serde(default = "acceleration_m_s2")]
    pub acceleration_m_s2: f64,
    /// Stops, evenly spread over the route, both ends included.
    #[serde(default = "stops")]
    pub stops: u32,
    /// Time at each stop, s.
    #[serde(default = "dwell_s")]
    pub dwell_s: f64,
    /// When it arrives at its first stop, s; drawn within its round trip when absent.
    #[serde(default)]
    pub first_s: Option<f64>,
    /// Length, width and height of its box, m.
    #[serde(default = "size_m")]
    pub size_m: [f64; 3],
    /// The first seat: forward, left, up, m; the others behind it in rows of two.
    #[serde(default = "seat_m")]
    pub seat_m: [f64; 3],
    /// How many may ride.
    #[serde(default = "seats")]
    pub seats: u32,
    /// Vertical vibration of a seat at speed, rms, m/s².
    #[serde(default = "vibration_rms_m_s2")]
    pub vibration_rms_m_s2: f64,
    /// Highest bump that reaches the seat, m.
    #[serde(default = "bump_m")]
    pub bump_m: f64,
}

const fn acceleration_m_s2() -> f64 {
    0.8
}
const fn stops() -> u32 {
    3
}
const fn dwell_s() -> f64 {
    60.0
}
const fn size_m() -> [f64; 3] {
    [6.0, 2.0, 2.2]
}
const fn seat_m() -> [f64; 3] {
    [1.0, 0.45, 0.9]
}
const fn seats() -> u32 {
    6
}
const fn vibration_rms_m_s2() -> f64 {
    0.6
}
const fn bump_m() -> f64 {
    0.004
}

impl VehicleSpec {
    /// A personnel carrier on a route: 6 m × 2 m, six seats.
    pub fn on(route: impl Into<String>) -> Self {
        Self {
            route: route.into(),
            speed_m_s: None,
            acceleration_m_s2: acceleration_m_s2(),
            stops: stops(),
            dwell_s: dwell_s(),
            first_s: None,
            size_m: size_m(),
            seat_m: seat_m(),
            seats: seats(),
            vibration_rms_m_s2: vibration_rms_m_s2(),
            bump_m: bump_m(),
        }
    }

    /// The numbers are those of a vehicle in a mine.
    pub fn check(&self) -> Result<(), SimulationError> {
        if let Some(speed_m_s) = self.speed_m_s {
            check_within("speed_m_s", speed_m_s, 0.1, 30.0, "0.1 to 30 m/s")?;
        }
        check_within("acceleration_m_s2", self.acceleration_m_s2, 0.05, 5.0, "0.05 to 5 m/s²")?;
        check_within("stops", f64::from(self.stops), 2.0, 1000.0, "2 to 1000")?;
        check_within("dwell_s", self.dwell_s, 1.0, 1e5, "1 to 1e5 s")?;
        check_within("first_s", self.first_s.unwrap_or(0.0), -1e6, 1e6, "-1e6 to 1e6 s")?;
        for size_m in self.size_m {
            check_within("size_m", size_m, 0.2, 30.0, "0.2 to 30 m")?;
        }
        for seat_m in self.seat_m {
            check_within("seat_m", seat_m, -15.0, 15.0, "-15 to 15 m")?;
        }
        check_within("seats", f64::from(self.seats), 1.0, 1000.0, "1 to 1000")?;
        check_within("vibration_rms_m_s2", self.vibration_rms_m_s2, 0.0, 10.0, "0 to 10 m/s²")?;
        check_within("bump_m", self.bump_m, 0.0, 0.1, "0 to 0.1 m")
    }
}

/// Where a vehicle is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VehiclePose {
    /// The floor below its middle, mine grid, m.
    pub floor_m: Vector3<f64>,
    /// Its forward axis, anticlockwise from east, rad.
    pub yaw_rad: f64,
    /// Nose down positive, rad.
    pub pitch_rad: f64,
    /// Speed, negative when it reverses, m/s.
    pub speed_m_s: f64,
}

/// A vehicle at a stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dwell {
    /// When it comes to rest there, s.
    pub arrive_s: f64,
    /// When it leaves, s.
    pub depart_s: f64,
}

/// One arrival within a round trip.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Visit {
    stop: usize,
    arrive_s: f64,
}

/// A vehicle that shuttles along its route.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    id: String,
    spec: VehicleSpec,
    path: Path,
    /// Length along the path of each stop, m.
    stops_m: Vec<f64>,
    visits: Vec<Visit>,
    round_s: f64,
    first_s: f64,
    cruise_m_s: f64,
    vibration: Vibration,
}

/// A frame that carries somebody: its origin, heading and pitch as functions of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Carriage {
    pub place: JetVector,
    pub yaw: Jet,
    pub pitch: Jet,
    pub roll: Jet,
}

/// Speed and time of a run between two stops.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "units")]
struct Run {
    speed_m_s: f64,
    ramp_s: f64,
    length_s: f64,
}

impl Run {
    fn new(distance_m: f64, cruise_m_s: f64, acceleration_m_s2: f64) -> Self {
        // The quintic step is steepest in its middle, 15/8.
        let reached = libm::sqrt(distance_m * acceleration_m_s2 / 1.875);
        let speed_m_s = cruise_m_s.min(reached).max(1e-3);
        let ramp_s = 1.875 * speed_m_s / acceleration_m_s2;
        Self { speed_m_s, ramp_s, length_s: distance_m / speed_m_s + ramp_s }
    }

    /// Distance covered, and how lively the ride is (0 at rest, 1 at speed).
    fn at(&self, since_s: f64) -> (Jet, Jet) {
        let left_s = self.length_s - since_s;
        let end_m = self.speed_m_s * (self.length_s - self.ramp_s);
        if since_s < self.ramp_s {
            let vigour = ease(self.ramp_s, since_s);
            (self.gathering(since_s, vigour), vigour)
        } else if left_s < self.ramp_s {
            let mirrored = ease(self.ramp_s, left_s);
            let way = self.gathering(left_s, mirrored);
            let way = Jet { value: end_m - way.value, first: way.first, second: -way.second };
            (way, Jet { first: -mirrored.first, ..mirrored })
        } else {
            (Jet::linear(self.speed_m_s * (since_s - 0.5 * self.ramp_s), self.speed_m_s), Jet::constant(1.0))
        }
    }

    fn gathering(&self, since_s: f64, vigour: Jet) -> Jet {
        let u = since_s / self.ramp_s;
        let integral = u * u * u * u * (2.5 + u * (u - 3.0));
        Jet {
            value: self.speed_m_s * self.ramp_s * integral,
            first: self.speed_m_s * vigour.value,
            second: self.speed_m_s * vigour.first,
        }
    }
}

impl Vehicle {
    pub(super) fn new(
        mine: &Mine,
        ground: &Ground,
        spec: &VehicleSpec,
        id: String,
        rng: &mut ChaCha8Rng,
    ) -> Result<Self, SimulationError> {
        spec.check()?;
        let route = mine.plan().vehicle_routes.iter().find(|route| route.id == spec.route);
        let Some(route) = route else {
            let expected = "the id of a vehicle route of the mine";
            return Err(SimulationError::Unknown { name: "route", found: spec.route.clone(), expected });
        };
        let line = ground.follow("route", &route.roadways)?;
        let path = Path::new(line, ROUND_M);
        // The box stays within the ends of the route.
        let inset_m = 0.5 * spec.size_m[0] + 0.5;
        let path = path.filter(|path| path.length_m() > 4.0 * inset_m);
        let Some(path) = path else {
            let expected = "a route longer than twice the vehicle";
            return Err(SimulationError::Unknown { name: "route", found: spec.route.clone(), expected });
        };
        let cruise_m_s = spec.speed_m_s.unwrap_or(route.speed_m_s);
        let span_m = path.length_m() - 2.0 * inset_m;
        let share = |stop: u32| inset_m + span_m * f64::from(stop) / f64::from(spec.stops - 1);
        let stops_m: Vec<f64> = (0..spec.stops).map(share).collect();
        let there = 0..stops_m.len();
        let back = (1..stops_m.len() - 1).rev();
        let mut visits = Vec::new();
        let mut arrive_s = 0.0;
        let mut before: Option<usize> = None;
        let run_s = |a: usize, b: usize| {
            Run::new((stops_m[b] - stops_m[a]).abs(), cruise_m_s, spec.acceleration_m_s2).length_s
        };
        for stop in there.chain(back).chain([0]) {
            arrive_s += before.map_or(0.0, |before| spec.dwell_s + run_s(before, stop));
            visits.push(Visit { stop, arrive_s });
            before = Some(stop);
        }
        let round_s = arrive_s;
        visits.pop();
        let vibration = Vibration::new(rng, spec.vibration_rms_m_s2, spec.bump_m);
        let drawn_s = super::vibration::between(rng, 0.0, round_s) - round_s;
        let first_s = spec.first_s.unwrap_or(drawn_s);
        Ok(Self { id, spec: spec.clone(), path, stops_m, visits, round_s, first_s, cruise_m_s, vibration })
    }

    /// Its name.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// What it was made from.
    pub fn spec(&self) -> &VehicleSpec {
        &self.spec
    }

    /// How many stops it has.
    pub fn stops(&self) -> usize {
        self.stops_m.len()
    }

    /// Time from one arrival at the first stop to the next, s.
    pub fn round_s(&self) -> f64 {
        self.round_s
    }

    /// The floor in the middle of a stop, mine grid, m; that of the last stop beyond it.
    pub fn stop_m(&self, stop: usize) -> Vector3<f64> {
        self.path.at(self.stops_m[stop.min(self.stops_m.len() - 1)]).place
    }

    /// The stop that is nearest to a place.
    pub fn nearest_stop(&self, place_m: &Vector3<f64>) -> Option<usize> {
        let distance = |stop: &usize| (self.stop_m(*stop) - place_m).norm();
        (0..self.stops()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The next stay at a stop that is under way or to come at `time_s` and lasts for another `at_least_s`.
    pub fn next_dwell(&self, stop: usize, time_s: f64, at_least_s: f64) -> Option<Dwell> {
        let round = libm::floor((time_s - self.first_s) / self.round_s) - 1.0;
        (0..4)
            .flat_map(|later| {
                let start_s = self.first_s + (round + f64::from(later)) * self.round_s;
                self.visits.iter().filter(move |visit| visit.stop == stop).map(move |visit| {
                    let arrive_s = start_s + visit.arrive_s;
                    Dwell { arrive_s, depart_s: arrive_s + self.spec.dwell_s }
                })
            })
            .find(|dwell| dwell.depart_s >= time_s.max(dwell.arrive_s) + at_least_s)
    }

    /// Where it is; cheap.
    pub fn pose(&self, time_s: f64) -> VehiclePose {
        let (sigma, _) = self.way(time_s);
        let on = self.path.at(sigma.value);
        VehiclePose {
            floor_m: on.place,
            yaw_rad: libm::atan2(on.first.y, on.first.x),
            pitch_rad: -libm::atan2(on.first.z, on.first.xy().norm()),
            speed_m_s: sigma.first,
        }
    }

    /// Way along its path, and how lively the ride is.
    fn way(&self, time_s: f64) -> (Jet, Jet) {
        let since = time_s - self.first_s;
        let phase = since - libm::floor(since / self.round_s) * self.round_s;
        let index = self.visits.partition_point(|visit| visit.arrive_s <= phase).saturating_sub(1);
        let visit = self.visits[index];
        let (from, next) = (self.stops_m[visit.stop], self.visits.get(index + 1).map_or(0, |next| next.stop));
        let since_left = phase - visit.arrive_s - self.spec.dwell_s;
        if since_left <= 0.0 {
            return (Jet::constant(from), Jet::constant(0.0));
        }
        let to = self.stops_m[next];
        let run = Run::new((to - from).abs(), self.cruise_m_s, self.spec.acceleration_m_s2);
        let (way, vigour) = run.at(since_left.min(run.length_s));
        (Jet::constant(from) + way * (to - from).signum(), vigour)
    }

    /// The frame of a place on it (forward, left, up from its origin), shaking as a seat does.
    pub(super) fn carriage(&self, time_s: f64, place_m: &Vector3<f64>) -> Carriage {
        let (sigma, vigour) = self.way(time_s);
        let on = self.path.at(sigma.value);
        let axis = |i: usize| sigma.chain(on.place[i], on.first[i], on.second[i]);
        let slope = |i: usize| sigma.chain(on.first[i], on.second[i], on.third[i]);
        let (x, y, z) = (slope(0), slope(1), slope(2));
        let level = (x * x + y * y).sqrt();
        let (yaw, pitch) = (Jet::atan2(y, x), -Jet::atan2(z, level));
        let [rock, roll] = self.vibration.rocking(time_s, vigour);
        let arm = JetVector::constant(place_m) + self.vibration.shift(time_s, sigma, vigour);
        let place = JetVector([axis(0), axis(1), axis(2)]) + arm.turned_about_y(pitch).turned_about_z(yaw);
        Carriage { place, yaw, pitch: pitch + rock, roll }
    }

    /// Place of a seat, vehicle axes, m; seats beyond the last are shared.
    pub(super) fn seat_m(&self, number: u32) -> Vector3<f64> {
        let number = number % self.spec.seats;
        let [forward, left, up] = self.spec.seat_m;
        let side = if number.is_multiple_of(2) { left } else { -left };
        Vector3::new(forward - 0.85 * f64::from(number / 2), side, up)
    }
}
