//! How the devices around a tag are seen from it: straight, through doors, or round corners.
//!
//! What changes slowly is remembered: which devices, whether rock is in between, which way round. It is looked at again when the tag
//! has moved by [`STEP_M`]; distances are taken anew every time.

use super::screen::knife_edge_db;
use super::ways::{Way, Ways};
use super::world::{DoorLine, RadioWorld};
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;

/// Movement after which the surroundings are looked at again, m.
const STEP_M: f64 = 0.25;
/// Devices that are looked at, those with the shortest way through the openings: a tag knows its neighbours.
const MOST_LOOKED_AT: usize = 20;
/// Rock at the ends of a line that an antenna on a wall may be embedded in, m; as in [`adit_mine::Mine::sight`].
pub(crate) const EMBEDDED_M: f64 = 0.1;

/// How one device is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Path {
    /// Its number.
    pub device: u32,
    /// The way round the rock; `None` where none is in between.
    pub around: Option<Way>,
    /// What the way to its last corner is, m.
    corner_way_m: f64,
    /// Closed doors on the straight line.
    pub doors: u8,
    /// What they take, dB.
    pub doors_db: f64,
}

/// The devices around a tag, remembered.
#[derive(Debug, Clone, Default)]
pub(crate) struct Paths {
    at_m: Option<Vector3<f64>>,
    list: Vec<Path>,
    nearest: Vec<(f64, usize, Option<Way>)>,
}

/// Devices of one kind and how they are reached.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field<'w> {
    pub places_m: &'w [Vector3<f64>],
    pub ways: &'w Ways,
    pub most_way_m: f64,
    pub door_loss_db: f64,
}

impl Paths {
    /// The paths to a tag here.
    pub fn at(&mut self, world: &RadioWorld, field: Field<'_>, tag_m: &Vector3<f64>) -> &[Path] {
        if self.at_m.is_none_or(|at| (at - tag_m).norm() > STEP_M) {
            self.survey(world, field, tag_m);
        }
        &self.list
    }

    fn survey(&mut self, world: &RadioWorld, field: Field<'_>, tag_m: &Vector3<f64>) {
        self.at_m = Some(*tag_m);
        self.list.clear();
        let tag = Position::from_raw(*tag_m);
        let mine = world.mine();
        let Some(foot) = mine.network().nearest(&tag) else { return };
        let candidates = field.ways.candidates(foot.spot.edge);
        self.nearest.clear();
        for (number, candidate) in candidates.iter().enumerate() {
            let Some(place_m) = field.places_m.get(candidate.device as usize) else { continue };
            if (place_m - tag_m).norm() <= field.most_way_m {
                let way = field.ways.way(candidate, &foot, tag_m);
                self.nearest.push((way.map_or(f64::INFINITY, |way| way.length_m), number, way));
            }
        }
        self.nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, number, way) in self.nearest.iter().take(MOST_LOOKED_AT) {
            let Some(candidate) = candidates.get(*number) else { continue };
            let Some(place_m) = field.places_m.get(candidate.device as usize) else { continue };
            let place = Position::from_raw(*place_m);
            let around = if mine.excavation().rock_m(&tag, &place) <= EMBEDDED_M {
                None
            } else {
                match way {
                    Some(way) if way.length_m <= field.most_way_m => Some(*way),
                    _ => continue,
                }
            };
            let corner_way_m = around.map_or(0.0, |way| way.length_m - (way.corner_m - tag_m).norm());
            let shut = world.doors().iter().filter(|door| door.crossed(tag_m, place_m));
            let (doors, doors_db) = shut.fold((0_u8, 0.0), |(count, sum), door: &DoorLine| {
                (count.saturating_add(1), sum + door.attenuation_db.unwrap_or(field.door_loss_db))
            });
            self.list.push(Path { device: candidate.device, around, corner_way_m, doors, doors_db });
        }
    }
}

impl Path {
    /// The end of the last straight piece of the way to the tag, m: the device or a corner.
    pub fn last_m(&self, place_m: &Vector3<f64>) -> Vector3<f64> {
        self.around.map_or(*place_m, |way| way.corner_m)
    }

    /// Way from the device to a tag near where the path was looked at, m.
    pub fn length_m(&self, place_m: &Vector3<f64>, tag_m: &Vector3<f64>) -> f64 {
        let straight = (place_m - tag_m).norm();
        match self.around {
            None => straight,
            Some(way) => (self.corner_way_m + (way.corner_m - tag_m).norm()).max(straight),
        }
    }

    /// What the bends take, dB: what bends round the edge by diffraction or what the roadway's walls throw round, the less of both.
    pub fn bends_db(&self, excess_m: f64, wavelength_m: f64, corner_loss_db: f64) -> f64 {
        self.around.map_or(0.0, |way| {
            let edge = knife_edge_db(excess_m, wavelength_m);
            // Thrown round by the walls it has at least the loss of the grazing ray.
            edge.min(6.0 + corner_loss_db * way.bends.max(0.05))
        })
    }
}
