//! One hypothesis: a state, and the piece of roadway, or the chamber, that it is held to.

use super::{BankParams, CONTRADICTED, DEFORMED};
use crate::place::roadways::{Piece, Roadways};
use crate::place::state::{EAST, State, UP};
use adit_core::nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// What somebody is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Place {
    /// A straight piece of a roadway, by its number.
    Piece(u32),
    /// A chamber, by its number.
    Chamber(u32),
    /// Somewhere that the map does not know.
    Off,
}

/// A hypothesis of the bank.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hypothesis {
    /// Its name: a change of place keeps it, a branch has its own.
    pub id: u32,
    /// What it is held to.
    pub place: Place,
    /// Logarithm of its weight; weights sum to one.
    pub log_weight: f64,
    /// Mean over the last metres of how far it lay from its roadway, squared, in units of what is to be expected: about 1 where it is right.
    pub strain: f64,
    /// The same of the measurements taken.
    pub surprise: f64,
    /// The way of the last metres leads across its roadway, and along another that it may be on instead.
    pub(super) elsewhere: bool,
    /// Logarithm of the probability of being within the walls while it is not held, as it has gone into the weight.
    pub(super) walls: f64,
    /// Its last step, where those are recorded.
    #[serde(skip)]
    pub(super) lineage: Option<u32>,
    /// State and covariance.
    pub state: State,
}

/// Within this many joints a walker comes in one look.
const JOINTS: usize = 8;
/// Huber's bound of what a roadway says.
const BOUND: f64 = 9.0;
/// What no map costs, in squares of what is to be expected: three times a roadway's own.
const OFF_COST: f64 = 4.0;
/// The same within a chamber.
const CHAMBER_COST: f64 = 2.0;
/// Walls are known by this, m.
const WALL_M: f64 = 0.5;
/// No place between walls is less probable than this.
const IN_ROCK: f64 = 1e-6;
/// Share of the variance across a roadway that is a side that somebody keeps to, and of that of the tag's height that is the wearer's own.
const KEPT: f64 = 0.5;
/// At corners people leave the centre line by this more, m.
const CORNER_M: f64 = 1.0;

/// What holding a hypothesis to its place said.
#[derive(Debug, Clone, Copy, Default)]
struct Held {
    log_likelihood: f64,
    strain: f64,
}

impl Hypothesis {
    /// Weight, 0 to 1.
    pub fn weight(&self) -> f64 {
        libm::exp(self.log_weight)
    }

    /// Standard deviation of the position along a direction on the map, m.
    pub(super) fn sigma_m(&self, direction: &Vector2<f64>) -> f64 {
        let p = self.state.covariance.fixed_view::<2, 2>(EAST, EAST);
        libm::sqrt(direction.dot(&(p * direction)).max(0.0))
    }

    /// Holds it to its place after `walked_m`. What one look says weighs as much as `walked_m / 2λ` independent ones would, λ the length over which somebody's place across
    /// the roadway is forgotten: sums over a way then have the variance of the mean of a correlated sequence.
    ///
    /// Where the way bends or leads elsewhere the place is only judged: a branch must not inherit that its parent was held to another roadway. Its walls
    /// judge it then: the probability of being between them, which is that of the last place, not of all.
    pub(super) fn hold(&mut self, roadways: &Roadways, params: &BankParams, walked_m: f64, straight: bool) {
        let before = (!straight || self.elsewhere).then(|| self.state.clone());
        let rate = (0.5 * walked_m / params.forgotten_m).min(1.0);
        let held = match self.place {
            Place::Piece(_) => {
                self.advance(roadways);
                let Place::Piece(index) = self.place else { return };
                let Some(piece) = roadways.piece(index) else { return };
                let walls = if before.is_some() { self.within_walls(piece) } else { 0.0 };
                self.log_weight += walls - self.walls;
                self.walls = walls;
                self.hold_to_piece(roadways, piece, params, rate)
            }
            Place::Chamber(index) => {
                let Some(room) = roadways.chamber(index) else { return };
                let here = self.state.position_m.xy();
                let mut held = Held { log_likelihood: -0.5 * CHAMBER_COST * rate, strain: 1.0 };
                if !room.contains(&here) {
                    let wall = room.wall(&here);
                    let outward = (here - wall) / (here - wall).norm().max(f64::MIN_POSITIVE);
                    let (point, direction) = (wall.push(0.0), outward.push(0.0));
                    held.add(self.measure((&point, &direction), (0.0, WALL_M), rate));
                }
                held.add(self.measure(
                    (&Vector3::new(0.0, 0.0, room.floor_m), &Vector3::z()),
                    (params.tag_height_m, params.tag_height_sigma_m),
                    rate,
                ));
                held
            }
            Place::Off => Held { log_likelihood: -0.5 * OFF_COST * rate, strain: 0.0 },
        };
        if let Some(before) = before {
            self.state = before;
        }
        self.log_weight += held.log_likelihood;
        let share = (walked_m / params.forgotten_m).min(1.0);
        self.strain += (held.strain - self.strain) * share;
    }

    /// Goes over to the piece that carries the roadway on where it has passed an end.
    fn advance(&mut self, roadways: &Roadways) {
        let here = self.state.position_m.xy();
        let mut left = None;
        for _ in 0..JOINTS {
            let Place::Piece(index) = self.place else { return };
            let Some(piece) = roadways.piece(index) else { return };
            let along_m = piece.on(&here).along_m;
            let end = if along_m > piece.length_m {
                1
            } else if along_m < 0.0 {
                0
            } else {
                return;
            };
            let next = carried_on(roadways, index, end).filter(|next| Some(*next) != left);
            let Some(next) = next else { return };
            (left, self.place) = (Some(index), Place::Piece(next));
        }
    }

    /// Logarithm of the probability that it is between the walls of its roadway.
    fn within_walls(&self, piece: &Piece) -> f64 {
        let left_m = piece.on(&self.state.position_m.xy()).left_m;
        let scale = libm::hypot(self.sigma_m(&piece.left()), WALL_M) * core::f64::consts::SQRT_2;
        let below = |m: f64| libm::erf(m / scale);
        let share = 0.5 * (below(piece.half_width_m - left_m) + below(piece.half_width_m + left_m));
        libm::log(share.max(IN_ROCK))
    }

    fn hold_to_piece(&mut self, roadways: &Roadways, piece: &Piece, params: &BankParams, rate: f64) -> Held {
        let mut held = Held::default();
        let left = piece.left().push(0.0);
        let across_m = piece.half_width_m / libm::sqrt(3.0);
        held.add(self.measure((piece.start_m(), &left), (0.0, across_m), rate));
        // The floor rises with the way: n = (−rise t, 1).
        let slope = (piece.direction * -piece.rise).push(1.0);
        held.add(self.measure(
            (piece.start_m(), &slope),
            (params.tag_height_m, params.tag_height_sigma_m),
            rate,
        ));
        // A face, or the far wall of the roadway that this one ends in.
        let along_m = piece.on(&self.state.position_m.xy()).along_m;
        for (end, beyond_m) in [(0, -along_m), (1, along_m - piece.length_m)] {
            let room_m = room_at(roadways, piece, end);
            if beyond_m > room_m {
                let point = piece.at(if end == 0 { 0.0 } else { piece.length_m });
                let away = -piece.away_from(end).push(0.0);
                if let Some((beyond, log_within)) = self.state.keep_within((&point, &away), room_m, DEFORMED)
                {
                    held.add(Held { log_likelihood: log_within, strain: beyond * beyond });
                }
            }
        }
        held
    }

    /// Takes that it lies `value_m` from a point in a direction, by `sigma_m` and that only every so often.
    ///
    /// A share of that spread stays with somebody: the side they keep to, the height of their tag. No repetition averages it out, so the noise grows without bound as what is
    /// known comes near it: `R (hᵀPh)/(hᵀPh − s σ²)`.
    fn measure(
        &mut self,
        line: (&Vector3<f64>, &Vector3<f64>),
        (value_m, sigma_m): (f64, f64),
        rate: f64,
    ) -> Held {
        let (sigma_m2, weak_m2) = (sigma_m * sigma_m, sigma_m * sigma_m / rate);
        let p = self.state.position_covariance_m2();
        let known_m2 = line.1.dot(&(p * line.1)).max(0.0);
        let told = 1.0 - KEPT * sigma_m2 / known_m2;
        let weaker_m = libm::sqrt(weak_m2 / told.max(f64::EPSILON));
        let seen = self.state.see_along(line, (value_m, weaker_m), &Vector3::zeros());
        let off_m2 = seen.residual[0] * seen.residual[0];
        let strain = off_m2 / (sigma_m2 + known_m2);
        // What cannot be is no reason to correct anything.
        if told > 0.0 && strain < CONTRADICTED && self.state.take(&seen, BOUND).is_none() {
            return Held::default();
        }
        let spread = 1.0 + known_m2 / weak_m2;
        Held { log_likelihood: -0.5 * off_m2 / (weak_m2 * spread) - 0.5 * libm::log(spread), strain }
    }

    /// The same hypothesis on another piece, if it can be there: conditioned on lying within its width, with the probability of that. Its strain is how badly it fits.
    pub(super) fn on_piece(&self, index: u32, piece: &Piece, params: &BankParams) -> Option<Self> {
        let across_m = libm::hypot(piece.half_width_m / libm::sqrt(3.0), CORNER_M);
        let here = self.state.position_m.xy();
        let off_m = piece.on(&here).left_m;
        let sigma_m = self.sigma_m(&piece.left());
        if off_m.abs() > DEFORMED * libm::hypot(across_m, sigma_m) {
            return None;
        }
        let mut child = self.clone();
        child.place = Place::Piece(index);
        let left = piece.left().push(0.0);
        let slope = (piece.direction * -piece.rise).push(1.0);
        let lateral = child.measure((piece.start_m(), &left), (0.0, across_m), 1.0);
        let height =
            child.measure((piece.start_m(), &slope), (params.tag_height_m, params.tag_height_sigma_m), 1.0);
        (height.strain < DEFORMED * DEFORMED).then(|| {
            child.log_weight += lateral.log_likelihood + height.log_likelihood;
            child.strain = lateral.strain.max(height.strain);
            child
        })
    }

    /// The same hypothesis in a chamber, if it can be there.
    pub(super) fn in_chamber(&self, index: u32, roadways: &Roadways, params: &BankParams) -> Option<Self> {
        let room = roadways.chamber(index)?;
        let here = self.state.position_m.xy();
        let floor = (&Vector3::new(0.0, 0.0, room.floor_m), &Vector3::z());
        let mut child = self.clone();
        child.place = Place::Chamber(index);
        child.strain = 1.0;
        if !room.contains(&here) {
            let off = here - room.wall(&here);
            let outward = off / off.norm().max(f64::MIN_POSITIVE);
            if off.norm() > DEFORMED * libm::hypot(WALL_M, self.sigma_m(&outward)) {
                return None;
            }
            let wall = room.wall(&here).push(0.0);
            let inside = child.measure((&wall, &outward.push(0.0)), (0.0, WALL_M), 1.0);
            child.log_weight += inside.log_likelihood;
        }
        let height = child.measure(floor, (params.tag_height_m, params.tag_height_sigma_m), 1.0);
        (height.strain < DEFORMED * DEFORMED).then(|| {
            child.log_weight += height.log_likelihood;
            child
        })
    }

    /// The nearest place in the air, where it is held to a roadway or chamber, m.
    pub(super) fn in_air(&self, roadways: Option<&Roadways>) -> Vector3<f64> {
        in_air(self.place, self.state.position_m, roadways)
    }

    /// Both are in one place by their states and go along one line: what tells them apart is small beside what they do not know.
    pub(super) fn is_like(&self, other: &Self, roadways: &Roadways) -> bool {
        let apart = (other.state.position_m - self.state.position_m).xy();
        let turned = libm::remainder(other.state.turn_rad - self.state.turn_rad, core::f64::consts::TAU);
        if turned.abs() > TURNED_RAD {
            return false;
        }
        let rise = other.state.position_m.z - self.state.position_m.z;
        match (self.place, other.place) {
            (Place::Piece(a), Place::Piece(b)) => {
                let (Some(a), Some(b)) = (roadways.piece(a), roadways.piece(b)) else { return false };
                let along = a.direction;
                let together_m = ALIKE_M + self.sigma_m(&along).max(other.sigma_m(&along));
                along.dot(&b.direction).abs() > PARALLEL
                    && along.perp(&apart).abs() < ALIKE_M
                    && along.dot(&apart).abs() < together_m
                    && rise.abs() < ALIKE_M
            }
            (a, b) => a == b,
        }
    }
}

/// As near as this two hypotheses on one line are one, m.
const ALIKE_M: f64 = 3.0;
/// Angle from which two directions are not one, rad: 45°.
const TURNED_RAD: f64 = 0.8;
/// Cosine of the angle up to which two pieces are one line: 25°.
const PARALLEL: f64 = 0.9;
/// Cosine of the angle up to which a roadway is carried on: 35°.
const CARRIED_ON: f64 = 0.82;

impl Held {
    fn add(&mut self, other: Self) {
        self.log_likelihood += other.log_likelihood;
        self.strain = self.strain.max(other.strain);
    }
}

/// The nearest place to another in the air of a roadway or chamber, m; off the map every place is.
pub(super) fn in_air(place: Place, here: Vector3<f64>, roadways: Option<&Roadways>) -> Vector3<f64> {
    let upright = |level: Vector2<f64>, floor_m: f64, height_m: f64| {
        level.push(here[UP].clamp(floor_m, floor_m + height_m))
    };
    match (place, roadways) {
        (Place::Piece(index), Some(roadways)) => roadways.piece(index).map_or(here, |piece| {
            let on = piece.on(&here.xy());
            let [before_m, behind_m] = [0, 1].map(|end| room_at(roadways, piece, end));
            let along_m = on.along_m.clamp(-before_m, piece.length_m + behind_m);
            // Beyond an end the roadway is round.
            let on_line_m = along_m.clamp(0.0, piece.length_m);
            let (half_m, beyond_m) = (piece.half_width_m, along_m - on_line_m);
            let aside_m = libm::sqrt((half_m * half_m - beyond_m * beyond_m).max(0.0));
            let place = piece.at(along_m).xy() + piece.left() * on.left_m.clamp(-aside_m, aside_m);
            upright(place, piece.floor_m(on_line_m), piece.height_m)
        }),
        (Place::Chamber(index), Some(roadways)) => roadways.chamber(index).map_or(here, |room| {
            let inside = room.contains(&here.xy());
            let place = if inside { here.xy() } else { room.wall(&here.xy()) };
            upright(place, room.floor_m, room.height_m)
        }),
        _ => here,
    }
}

/// The air that is nearest to a place which is not in that of its roadway: perhaps that of the next one. Gives it and what it is of.
pub(super) fn nearest_air(
    place: Place,
    here: Vector3<f64>,
    roadways: Option<&Roadways>,
) -> (Vector3<f64>, Place) {
    let own_m = in_air(place, here, roadways);
    let off_m = (own_m - here).norm();
    let (Some(roadways), true) = (roadways, off_m > 0.0) else { return (own_m, place) };
    let others = roadways.within(&here.xy(), off_m).into_iter().map(|index| {
        let other = Place::Piece(index);
        (in_air(other, here, Some(roadways)), other)
    });
    let far = |(air_m, _): &(Vector3<f64>, Place)| (air_m - here).norm();
    let nearest = others.min_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.filter(|nearest| far(nearest) < off_m).unwrap_or((own_m, place))
}

/// The piece that carries a roadway on beyond an end of one of its pieces: the straightest.
pub(super) fn carried_on(roadways: &Roadways, index: u32, end: usize) -> Option<u32> {
    let piece = roadways.piece(index)?;
    let ahead = -piece.away_from(end);
    let joint = piece.joints[end];
    let ways = roadways.at(joint).iter().filter(|other| **other != index).filter_map(|other| {
        let next = roadways.piece(*other)?;
        Some((*other, ahead.dot(&next.away_from(next.end_at(joint)))))
    });
    let straightest = ways.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (straightest.1 > CARRIED_ON).then_some(straightest.0)
}

/// How far beyond an end there is air: half the width of the widest roadway there, m.
fn room_at(roadways: &Roadways, piece: &Piece, end: usize) -> f64 {
    let meeting = roadways.at(piece.joints[end]).iter().filter_map(|other| roadways.piece(*other));
    meeting.fold(piece.half_width_m, |widest, other| widest.max(other.half_width_m))
}
