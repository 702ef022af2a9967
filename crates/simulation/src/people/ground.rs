//! What people and vehicles move on: the mine's network with the width and height of each roadway, and ways over it.
//!
//! People do not climb: shafts and whatever is steeper than 45° are closed to them, and to vehicles.

use super::path::Path;
use crate::error::SimulationError;
use adit_core::frames::{MineGrid, Position};
use adit_core::nalgebra::{Vector2, Vector3};
use adit_mine::Mine;
use adit_mine::network::{Edge, EdgeId, Network, NodeId, Spot, Travel};
use adit_mine::plan::{Roadway, RoadwayKind};
use serde::{Deserialize, Serialize};

/// Half of a body's width, arms included, m.
pub(crate) const BODY_HALF_WIDTH_M: f64 = 0.3;
/// Over which a person's way rounds corners, m either side.
const ROUND_M: f64 = 1.2;
/// Rise over run from which nobody walks.
const TOO_STEEP: f64 = 1.0;
/// Centre-line points nearer than this to the one before are left out where neither begins nor ends a way, m.
const CLUTTER_M: f64 = 0.5;

/// A place in a mine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Place {
    /// Beside the centre line of a roadway.
    Roadway {
        /// Its id.
        id: String,
        /// Way from its beginning, m.
        along_m: f64,
        /// Left of its centre line, m.
        #[serde(default)]
        left_m: f64,
    },
    /// Where the network is nearest to a point.
    Near {
        /// East, north, height, m.
        point_m: [f64; 3],
    },
    /// In a zone: at the middle of the places on the network inside it.
    Zone {
        /// Its id.
        id: String,
    },
}

/// Where a body stands: on which edge, and how far left of its centre line (in the edge's direction).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stand {
    pub spot: Spot,
    pub left_m: f64,
}

/// The floor of a mine as those see it who move on it.
#[derive(Debug, Clone)]
pub(crate) struct Ground {
    pub network: Network,
    /// Half width and height of each roadway, m, and its id.
    roadways: Vec<(f64, f64, String)>,
    /// Number of the level of each roadway; none of what leads from level to level.
    on_level: Vec<Option<usize>>,
    levels: Vec<String>,
    zones: Vec<(String, Vec<Spot>)>,
}

/// A way from one stand to another.
#[derive(Debug, Clone)]
pub(crate) struct Way {
    pub path: Path,
    /// Lengths along the path between which the roof is so low that one crawls, m.
    pub low: Vec<(f64, f64)>,
    /// How far to either side of the path a body may still go, m.
    pub room_m: f64,
}

/// A centre-line point of a way.
#[derive(Clone, Copy)]
struct Milestone {
    point: Vector3<f64>,
    /// Of the piece that leads on from here.
    half_width_m: f64,
    height_m: f64,
}

impl Ground {
    pub fn new(mine: &Mine) -> Self {
        let mut plan = mine.plan().clone();
        for roadway in &mut plan.roadways {
            let steep = roadway.points_m.windows(2).any(|pair| {
                let d = pair[1].raw() - pair[0].raw();
                d.z.abs() > TOO_STEEP * d.xy().norm()
            });
            roadway.walkable &= roadway.kind != RoadwayKind::Shaft && !steep;
        }
        // The mine was checked; closing roadways makes no new mistakes.
        let mine = Mine::unchecked(plan);
        let zones = mine.plan().zones.iter().map(|zone| (zone.id.clone(), mine.spots_in(zone))).collect();
        let roadways = &mine.plan().roadways;
        let levels: Vec<String> = mine.plan().levels.iter().map(|level| level.id.clone()).collect();
        let on_level = |roadway: &Roadway| {
            let id = roadway.level.as_ref().filter(|_| roadway.kind != RoadwayKind::Ramp)?;
            levels.iter().position(|level| level == id)
        };
        let on_level = roadways.iter().map(on_level).collect();
        let roadways = roadways.iter().map(|r| (0.5 * r.width_m, r.height_m, r.id.clone())).collect();
        Self { network: mine.network().clone(), roadways, on_level, levels, zones }
    }

    /// The level of an edge; none of what leads from level to level.
    pub fn level_of(&self, edge: &Edge) -> Option<&str> {
        self.on_level[edge.roadway].map(|level| self.levels[level].as_str())
    }

    /// The ids are those of levels.
    pub fn check_levels(&self, ids: &[String]) -> Result<(), SimulationError> {
        match ids.iter().find(|id| !self.levels.contains(id)) {
            None => Ok(()),
            Some(found) => {
                let expected = "the id of a level";
                Err(SimulationError::Unknown { name: "levels", found: found.clone(), expected })
            }
        }
    }

    pub fn half_width_m(&self, edge: EdgeId) -> f64 {
        self.network.edge(edge).map_or(0.0, |edge| self.roadways[edge.roadway].0)
    }

    fn roadway(&self, edge: &Edge) -> (f64, f64) {
        let (half_width_m, height_m, _) = &self.roadways[edge.roadway];
        (*half_width_m, *height_m)
    }

    /// The edges of a roadway in order along it; none for an id of none.
    pub fn edges_of(&self, id: &str) -> Vec<(EdgeId, &Edge)> {
        (0_u32..)
            .map(EdgeId)
            .zip(self.network.edges())
            .filter(|(_, edge)| self.roadways[edge.roadway].2 == id)
            .collect()
    }

    /// Where a place is; only walkable edges count.
    pub fn stand(&self, name: &'static str, place: &Place) -> Result<Stand, SimulationError> {
        let unknown = |found: String, expected| SimulationError::Unknown { name, found, expected };
        match place {
            Place::Roadway { id, along_m, left_m } => {
                let edges = self.edges_of(id);
                let length_m: f64 = edges.iter().map(|(_, edge)| edge.length_m()).sum();
                if edges.is_empty() {
                    return Err(unknown(id.clone(), "the id of a roadway"));
                }
                if !(0.0..=length_m + 1e-6).contains(along_m) {
                    let expected = "within the length of the roadway";
                    return Err(SimulationError::Parameter { name: "along_m", found: *along_m, expected });
                }
                let mut left = *along_m;
                let mut spot = Spot { edge: edges[0].0, along_m: 0.0 };
                for (edge, piece) in edges {
                    spot = Spot { edge, along_m: left.min(piece.length_m()) };
                    if left <= piece.length_m() {
                        break;
                    }
                    left -= piece.length_m();
                }
                let room_m = self.half_width_m(spot.edge) - BODY_HALF_WIDTH_M;
                if !(-room_m..=room_m).contains(left_m) {
                    let expected = "a place for a body between the walls";
                    return Err(SimulationError::Parameter { name: "left_m", found: *left_m, expected });
                }
                Ok(Stand { spot, left_m: *left_m })
            }
            Place::Near { point_m } => {
                let found = || format!("{}, {}, {}", point_m[0], point_m[1], point_m[2]);
                let point: Position<MineGrid> = Position::from_raw(Vector3::from(*point_m));
                if !point_m.iter().all(|v| v.is_finite()) {
                    return Err(unknown(found(), "three numbers"));
                }
                let spot = self.network.nearest(&point).map(|foot| foot.spot);
                spot.map(|spot| Stand { spot, left_m: 0.0 })
                    .ok_or_else(|| unknown(found(), "a point in a mine with roadways"))
            }
            Place::Zone { id } => {
                let spots = self.zone(id).ok_or_else(|| unknown(id.clone(), "the id of a zone"))?;
                let middle = spots.get(spots.len() / 2).copied();
                middle
                    .map(|spot| Stand { spot, left_m: 0.0 })
                    .ok_or_else(|| unknown(id.clone(), "a zone with a roadway in it that can be walked"))
            }
        }
    }

    /// The places inside a zone that can be walked to.
    pub fn zone(&self, id: &str) -> Option<Vec<Spot>> {
        let (_, spots) = self.zones.iter().find(|(zone, _)| zone == id)?;
        Some(spots.iter().copied().filter(|spot| self.walkable(spot.edge)).collect())
    }

    pub fn walkable(&self, edge: EdgeId) -> bool {
        self.network.edge(edge).is_some_and(|edge| edge.walkable)
    }

    /// The place on the floor, and the direction of the edge there, anticlockwise from east, rad.
    pub fn place(&self, stand: &Stand) -> (Vector3<f64>, f64) {
        let Some(edge) = self.network.edge(stand.spot.edge) else { return (Vector3::zeros(), 0.0) };
        let (centre, along) = (edge.at(stand.spot.along_m), edge.direction_at(stand.spot.along_m));
        let yaw = libm::atan2(along.raw().y, along.raw().x);
        let left = Vector3::new(-libm::sin(yaw), libm::cos(yaw), 0.0);
        (centre.raw() + left * stand.left_m, yaw)
    }

    /// The way between two stands on foot, `keep_right_m` right of the centre lines where the width allows, crawling where the roof
    /// is lower than `headroom_m`; `None` when there is none, or no length to it.
    pub fn way(&self, from: &Stand, to: &Stand, keep_right_m: f64, headroom_m: f64) -> Option<Way> {
        let route = self.network.route(&from.spot, &to.spot, Travel::OnFoot)?;
        let mut line: Vec<Milestone> = Vec::new();
        for leg in &route.legs {
            let edge = self.network.edge(leg.edge)?;
            let (half_width_m, height_m) = self.roadway(edge);
            let milestone = |point| Milestone { point, half_width_m, height_m };
            line.extend(between(edge, leg.from_m, leg.to_m).into_iter().map(milestone));
        }
        let (start, _) = self.place(from);
        let (end, _) = self.place(to);
        let line = tidy(&line);
        let narrowest = line.iter().map(|m| m.half_width_m).fold(self.half_width_m(from.spot.edge), f64::min);
        let offset = keep_right_m.min(narrowest - BODY_HALF_WIDTH_M - 0.1).max(0.0);
        let room_m = (narrowest - BODY_HALF_WIDTH_M - offset).max(0.0);
        let mut points = vec![start];
        if route.length_m > 8.0 {
            points.extend(beside(&line, offset));
        } else {
            // A few steps: straight, over the bends of the centre line if there are any.
            let inner = line.iter().skip(1).take(line.len().saturating_sub(2));
            points.extend(inner.map(|m| m.point));
        }
        points.push(end);
        let path = Path::new(points, ROUND_M)?;
        let low = self.low_parts(&path, &line, headroom_m);
        Some(Way { path, low, room_m })
    }

    /// Parts of a path under a low roof, told at every half metre.
    fn low_parts(&self, path: &Path, line: &[Milestone], headroom_m: f64) -> Vec<(f64, f64)> {
        let mut parts: Vec<(f64, f64)> = Vec::new();
        if line.iter().all(|m| m.height_m >= headroom_m) {
            return parts;
        }
        let length_m = path.length_m();
        let mut sigma = 0.0;
        while sigma <= length_m {
            let here: Position<MineGrid> = Position::from_raw(path.at(sigma).place);
            let roof = self.network.nearest(&here).and_then(|foot| self.network.edge(foot.spot.edge));
            if roof.is_some_and(|edge| self.roadway(edge).1 < headroom_m) {
                let (from, to) = ((sigma - 1.0).max(0.0), (sigma + 1.0).min(length_m));
                match parts.last_mut() {
                    Some(last) if from <= last.1 + 2.0 => last.1 = to,
                    _ => parts.push((from, to)),
                }
            }
            sigma += 0.5;
        }
        parts
    }

    /// The line over whole roadways, each meeting the next: from the far end of the first to the far end of the last.
    pub fn follow(&self, name: &'static str, ids: &[String]) -> Result<Vec<Vector3<f64>>, SimulationError> {
        let chains: Vec<(Vec<NodeId>, Vec<&Edge>)> = ids
            .iter()
            .map(|id| {
                let edges: Vec<&Edge> = self.edges_of(id).into_iter().map(|(_, edge)| edge).collect();
                let mut nodes: Vec<NodeId> = edges.iter().map(|edge| edge.from).collect();
                nodes.extend(edges.last().map(|edge| edge.to));
                (nodes, edges)
            })
            .collect();
        let meet = |a: usize, b: usize| -> Result<(usize, usize), SimulationError> {
            let expected = "a roadway of the mine that meets the one before it on the route";
            let unknown = || SimulationError::Unknown { name, found: ids[b].clone(), expected };
            let (here, there) = (&chains[a].0, &chains[b].0);
            let met = here.iter().position(|node| there.contains(node)).ok_or_else(unknown)?;
            Ok((met, there.iter().position(|node| *node == here[met]).ok_or_else(unknown)?))
        };
        let mut line = Vec::new();
        let mut entered: Option<usize> = None;
        for (index, (nodes, edges)) in chains.iter().enumerate() {
            let end = nodes.len().saturating_sub(1);
            let left = if index + 1 < chains.len() { Some(meet(index, index + 1)?.0) } else { None };
            let far = |from: usize| if from > end - from { 0 } else { end };
            let (from, to) = match (entered, left) {
                (Some(from), Some(to)) => (from, to),
                (None, Some(to)) => (far(to), to),
                (Some(from), None) => (from, far(from)),
                (None, None) => (0, end),
            };
            let span = &edges[from.min(to)..from.max(to)];
            let mut points: Vec<Vector3<f64>> =
                span.iter().flat_map(|edge| edge.points_m().map(|p| *p.raw())).collect();
            if from > to {
                points.reverse();
            }
            line.extend(points);
            entered = if index + 1 < chains.len() { Some(meet(index, index + 1)?.1) } else { None };
        }
        Ok(line)
    }
}

/// The points of an edge from one place on it to another, both included.
fn between(edge: &Edge, from_m: f64, to_m: f64) -> Vec<Vector3<f64>> {
    let (low, high) = (from_m.min(to_m), from_m.max(to_m));
    let mut points = vec![*edge.at(low).raw()];
    let mut along_m = 0.0;
    let mut before: Option<Vector3<f64>> = None;
    for point in edge.points_m().map(|p| *p.raw()) {
        along_m += before.map_or(0.0, |before| (point - before).norm());
        if along_m > low && along_m < high {
            points.push(point);
        }
        before = Some(point);
    }
    points.push(*edge.at(high).raw());
    if from_m > to_m {
        points.reverse();
    }
    points
}

/// Without points that repeat or crowd the one before them; the narrower width holds where two roadways meet.
fn tidy(line: &[Milestone]) -> Vec<Milestone> {
    let mut kept: Vec<Milestone> = Vec::new();
    for (index, here) in line.iter().enumerate() {
        let last = index + 1 == line.len();
        match kept.last_mut() {
            Some(before) if (here.point - before.point).norm() < CLUTTER_M => {
                before.half_width_m = here.half_width_m;
                before.height_m = before.height_m.min(here.height_m);
                if last {
                    before.point = here.point;
                }
            }
            _ => kept.push(*here),
        }
    }
    kept
}

/// The line `offset` right of the centre line, from a few metres after its beginning to a few metres before its end.
///
/// The floor of a roadway piece rises with the way along **its** centre line and is level in the round end at each point; where the
/// offset line is longer or shorter than the centre line, points are added beside the corner so that heights stay on that floor.
fn beside(line: &[Milestone], offset: f64) -> Vec<Vector3<f64>> {
    let mut points = Vec::new();
    let pieces = line.len().saturating_sub(1);
    let direction = |piece: usize| {
        let run = (line[piece + 1].point - line[piece].point).xy();
        run / run.norm().max(1e-9)
    };
    let right = |d: &Vector2<f64>| Vector3::new(d.y, -d.x, 0.0) * offset;
    // On the piece, this far after its beginning.
    let on = |piece: usize, after_m: f64| {
        let (a, b) = (line[piece].point, line[piece + 1].point);
        a + (b - a) * (after_m / (b - a).xy().norm().max(1e-9)) + right(&direction(piece))
    };
    let length = |piece: usize| (line[piece + 1].point - line[piece].point).xy().norm();
    for piece in 0..pieces {
        let (long, d) = (length(piece), direction(piece));
        let ring = line[piece].half_width_m;
        // Within this of a corner the offset line is over its level round end.
        let near = 0.9 * libm::sqrt((ring * ring - offset * offset).max(0.0));
        let (first, last) = (piece == 0, piece + 1 == pieces);
        let after = if first { 3.0_f64.min(0.4 * long) } else { near };
        let before = if last { 3.0_f64.min(0.4 * long) } else { near };
        if after + before < long {
            points.push(on(piece, after));
            points.push(on(piece, long - before));
        } else if first || last {
            points.push(on(piece, 0.5 * long));
        }
        if last {
            break;
        }
        let next = direction(piece + 1);
        let (corner, cos) = (line[piece + 1].point, d.dot(&next));
        let half = libm::sqrt((0.5 * (1.0 + cos)).max(0.0));
        let middle = right(&d) + right(&next);
        // The meeting point of the two offset lines, not farther out than the round end allows.
        let reach = (offset / half.max(1e-3)).min((ring - BODY_HALF_WIDTH_M).max(0.0));
        let to_the_left = d.perp(&next) > 0.05;
        if to_the_left && half > 0.3 {
            points.push(corner + right(&d));
            points.push(corner + right(&next));
        } else if middle.norm() > 1e-6 {
            points.push(corner + middle * (reach / middle.norm()));
        } else {
            points.push(corner);
        }
    }
    points
}
