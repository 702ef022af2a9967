//! The way of a wave through the openings: along roadways and round corners, where rock is in between.
//!
//! From each device the roadways' graph is searched once (Dijkstra 1959); a bend by more than 20° is passed at its inner corner,
//! half a width off the centre lines, as a taut string would. What is left to do for a tag is the last edge: from the last corner
//! straight to the tag. Each edge knows the devices that reach it, so that a tag asks no other.
//!
//! Limits: openings are those of the centre lines (a hall without one is seen only straight through); the corner of a bend that is
//! not a right angle stands on the bisector; up and down, a way follows the floor.

use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::network::{Edge, EdgeId, Foot};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// cos 20°: what turns less is no corner.
const STRAIGHT: f64 = 0.94;
/// Height of a corner over the floor at which waves pass it, m: where antennas and tags hang.
const CORNER_HEIGHT_M: f64 = 1.5;

/// How a wave comes to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    /// Its length, m.
    pub length_m: f64,
    /// `Σ (1 − cos θ)` over its bends: 1 for a right angle.
    pub bends: f64,
    /// The last corner on it; the device itself where there is none.
    pub corner_m: Vector3<f64>,
}

/// How a wave comes to a node or to a point of an edge.
#[derive(Debug, Clone, Copy)]
struct Reach {
    /// Way to the last corner.
    corner_way_m: f64,
    corner_m: Vector3<f64>,
    bends: f64,
    /// Direction of the roadway that it comes along.
    heading: Vector3<f64>,
}

/// A device that reaches an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    /// Its number.
    pub device: u32,
    /// From either end.
    ends: [Option<Reach>; 2],
    /// Where its own foot is, if on this edge.
    own: Option<f64>,
}

/// What reaches what.
#[derive(Debug, Clone)]
pub(crate) struct Ways {
    lines: Vec<EdgeLine>,
    candidates: Vec<Vec<Candidate>>,
    places: Vec<Vector3<f64>>,
}

#[derive(Debug, Clone)]
struct EdgeLine {
    points_m: Vec<Vector3<f64>>,
    half_width_m: f64,
}

struct Next {
    way_m: f64,
    node: usize,
    reach: Reach,
}

impl Ways {
    /// Searches from all devices up to a way of `most_m`.
    pub fn new(mine: &Mine, places: &[Vector3<f64>], most_m: f64) -> Self {
        let network = mine.network();
        let line = |edge: &Edge| EdgeLine {
            points_m: edge.points_m().map(|p| *p.raw()).collect(),
            half_width_m: 0.5 * mine.plan().roadways.get(edge.roadway).map_or(4.0, |r| r.width_m),
        };
        let mut ways = Self {
            lines: network.edges().iter().map(line).collect(),
            candidates: vec![Vec::new(); network.edges().len()],
            places: places.to_vec(),
        };
        for (device, place) in (0_u32..).zip(places) {
            if let Some(foot) = network.nearest(&adit_core::frames::Position::from_raw(*place)) {
                ways.search(mine, device, place, &foot, most_m);
            }
        }
        ways
    }

    fn search(&mut self, mine: &Mine, device: u32, place: &Vector3<f64>, foot: &Foot, most_m: f64) {
        let network = mine.network();
        let mut reached: Vec<Option<Reach>> = vec![None; network.nodes().len()];
        let mut queue = BinaryHeap::new();
        let start = Reach { corner_way_m: 0.0, corner_m: *place, bends: 0.0, heading: Vector3::zeros() };
        let own = foot.spot.edge.0 as usize;
        for forwards in [true, false] {
            let reach = self.lines[own].along(start, foot.spot.along_m, forwards, None);
            let edge = &network.edges()[own];
            let node = if forwards { edge.to } else { edge.from }.0 as usize;
            queue.push(Next { way_m: reach.way_to(self.lines[own].end(forwards)), node, reach });
        }
        while let Some(Next { way_m, node, reach }) = queue.pop() {
            if way_m > most_m || reached[node].is_some() {
                continue;
            }
            reached[node] = Some(reach);
            let id = adit_mine::network::NodeId(u32::try_from(node).unwrap_or(u32::MAX));
            for EdgeId(number) in network.edges_at(id) {
                let edge = &network.edges()[number as usize];
                let line = &self.lines[number as usize];
                for (near, far, forwards) in [(edge.from, edge.to, true), (edge.to, edge.from, false)] {
                    if near == id && reached[far.0 as usize].is_none() {
                        let start_m = if forwards { 0.0 } else { line.length_m() };
                        let next = line.along(reach, start_m, forwards, None);
                        let way_m = next.way_to(line.end(forwards));
                        queue.push(Next { way_m, node: far.0 as usize, reach: next });
                    }
                }
            }
        }
        for (number, edge) in network.edges().iter().enumerate() {
            let ends = [edge.from, edge.to].map(|node| reached[node.0 as usize]);
            let own = (number == own).then_some(foot.spot.along_m);
            if own.is_some() || ends.iter().any(Option::is_some) {
                self.candidates[number].push(Candidate { device, ends, own });
            }
        }
    }

    /// The devices that reach an edge.
    pub fn candidates(&self, edge: EdgeId) -> &[Candidate] {
        self.candidates.get(edge.0 as usize).map_or(&[], Vec::as_slice)
    }

    /// The shortest way from a candidate of the edge to a tag whose foot is on it.
    pub fn way(&self, candidate: &Candidate, foot: &Foot, tag_m: &Vector3<f64>) -> Option<Way> {
        let line = self.lines.get(foot.spot.edge.0 as usize)?;
        let along = foot.spot.along_m;
        let length = line.length_m();
        let own = candidate.own.and_then(|own| {
            let place = self.places.get(candidate.device as usize)?;
            let start = Reach { corner_way_m: 0.0, corner_m: *place, bends: 0.0, heading: Vector3::zeros() };
            Some(line.along(start, own, along >= own, Some(along)))
        });
        let from = candidate.ends[0].map(|reach| line.along(reach, 0.0, true, Some(along)));
        let to = candidate.ends[1].map(|reach| line.along(reach, length, false, Some(along)));
        let ways = own.into_iter().chain(from).chain(to).map(|reach| Way {
            length_m: reach.way_to(*tag_m),
            bends: reach.bends,
            corner_m: reach.corner_m,
        });
        ways.min_by(|a, b| a.length_m.total_cmp(&b.length_m))
    }
}

impl Reach {
    fn way_to(&self, place_m: Vector3<f64>) -> f64 {
        self.corner_way_m + (place_m - self.corner_m).norm()
    }
}

impl EdgeLine {
    fn length_m(&self) -> f64 {
        self.points_m.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
    }

    fn end(&self, forwards: bool) -> Vector3<f64> {
        let end = if forwards { self.points_m.last() } else { self.points_m.first() };
        end.copied().unwrap_or_default()
    }

    /// Goes along the edge from `start_m`, to its end or to `stop_m`, bending where it bends.
    fn along(&self, mut reach: Reach, start_m: f64, forwards: bool, stop_m: Option<f64>) -> Reach {
        let count = self.points_m.len() - 1;
        let mut before_m = if forwards { 0.0 } else { self.length_m() };
        for step in 0..count {
            let (a, b) = if forwards { (step, step + 1) } else { (count - step, count - step - 1) };
            let run = self.points_m[b] - self.points_m[a];
            let length = run.norm();
            let (from, to) = (before_m, if forwards { before_m + length } else { before_m - length });
            before_m = to;
            let passed = if forwards { to <= start_m } else { to >= start_m };
            let beyond = stop_m.is_some_and(|stop| if forwards { from > stop } else { from < stop });
            if passed || length == 0.0 {
                continue;
            }
            if beyond {
                break;
            }
            let heading = run / length;
            reach.turn(heading, self.points_m[a], self.half_width_m);
        }
        reach
    }
}

impl Reach {
    /// Comes to a point of a centre line and goes on in another direction.
    fn turn(&mut self, heading: Vector3<f64>, at_m: Vector3<f64>, half_width_m: f64) {
        let before = self.heading;
        self.heading = heading;
        if before == Vector3::zeros() {
            return;
        }
        let cosine = before.dot(&heading).clamp(-1.0, 1.0);
        self.bends += 1.0 - cosine;
        if cosine > STRAIGHT {
            return;
        }
        let sine = libm::sqrt(1.0 - cosine * cosine).max(0.5);
        let inwards = (heading - before) * (half_width_m / sine);
        let corner = at_m + inwards + Vector3::new(0.0, 0.0, CORNER_HEIGHT_M);
        self.corner_way_m = self.way_to(corner);
        self.corner_m = corner;
    }
}

impl PartialEq for Next {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Next {}

impl PartialOrd for Next {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Next {
    /// The shortest way is the greatest, as the heap gives the greatest first; equals by node, so that every run is the same.
    fn cmp(&self, other: &Self) -> Ordering {
        other.way_m.total_cmp(&self.way_m).then(other.node.cmp(&self.node))
    }
}
