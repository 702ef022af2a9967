//! Roadways together: where they meet, and where they should.

use super::{Checks, Survey};
use crate::finding::Place;
use crate::geometry::plane::{Point, along, cross, dot, length, meeting, minus};
use crate::geometry::polyline::Polyline;
use crate::network::{Edge, NodeId, Travel};
use crate::problem::Problem;
use alloc::collections::{BTreeMap, BTreeSet};
use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// Sine of the angle below which two lines count as parallel: 3°.
const PARALLEL: f64 = 0.05;
/// How far beyond the wall of another roadway an end still seems meant to meet it, m.
const ALMOST_M: f64 = 0.5;
/// Unconnected parts named one by one.
const PARTS_NAMED: usize = 20;

/// A straight piece of a roadway.
#[derive(Clone, Copy)]
struct Piece {
    roadway: usize,
    index: usize,
    a: Vector3<f64>,
    b: Vector3<f64>,
}

impl Piece {
    fn plan(&self) -> (Point, Point) {
        ([self.a.x, self.a.y], [self.b.x, self.b.y])
    }

    fn z_at(&self, share: f64) -> f64 {
        self.a.z + share * (self.b.z - self.a.z)
    }
}

type Pieces = RTree<GeomWithData<Rectangle<[f64; 3]>, usize>>;

impl Checks<'_> {
    pub(super) fn meetings(&mut self, survey: &Survey) {
        self.junctions(survey);
        let mut all = Vec::new();
        for (roadway, line) in survey.built.lines.iter().enumerate() {
            let segments = line.iter().flat_map(Polyline::segments).enumerate();
            all.extend(segments.map(|(index, (a, b))| Piece { roadway, index, a, b }));
        }
        let boxes = all.iter().enumerate().map(|(i, p)| {
            let corners = Rectangle::from_corners([p.a.x, p.a.y, p.a.z], [p.b.x, p.b.y, p.b.z]);
            GeomWithData::new(corners, i)
        });
        let tree: Pieces = RTree::bulk_load(boxes.collect());
        let overlapping = self.cuts(survey, &all, &tree);
        let missed = self.near_misses(survey, &all, &tree, &overlapping);
        if self.openings_known() {
            self.parts(survey, &missed);
        }
    }

    fn junctions(&mut self, survey: &Survey) {
        let (plan, built) = (self.plan, &survey.built);
        for (i, junction) in plan.junctions.iter().enumerate() {
            let place = Place::entry("junctions", i);
            for (roadway, distance_m) in &built.missed[i] {
                let roadway = &plan.roadways[*roadway].id;
                let entry = junction.roadways.iter().position(|id| id == roadway).unwrap_or(0);
                let problem = Problem::JunctionOff {
                    roadway: roadway.clone(),
                    distance_m: *distance_m,
                    snap_m: plan.snap_m,
                };
                self.report(place.clone().at("roadways").nth(entry), problem);
            }
            let meet: BTreeSet<usize> = built.junctions[i]
                .map(|node| built.network.edges_at(node))
                .into_iter()
                .flatten()
                .filter_map(|edge| built.network.edge(edge).map(|e| e.roadway))
                .collect();
            if meet.len() < 2 && built.missed[i].is_empty() && !self.unread.openings {
                self.report(place, Problem::JunctionOfOne { found: meet.len() });
            }
        }
    }

    /// Roadways that run in the same place or cut each other; gives those of the first kind.
    fn cuts(&mut self, survey: &Survey, all: &[Piece], tree: &Pieces) -> BTreeSet<usize> {
        let plan = self.plan;
        let nodes = nodes_of_roadways(survey, plan.roadways.len());
        let mut overlaps: BTreeMap<(usize, usize), (f64, usize)> = BTreeMap::new();
        let mut twins: BTreeSet<(usize, usize)> = BTreeSet::new();
        let mut crossed: BTreeSet<(usize, usize)> = BTreeSet::new();
        for one in all {
            let mine = &plan.roadways[one.roadway];
            let reach = mine.width_m.max(mine.height_m);
            let low = one.a.inf(&one.b).add_scalar(-reach);
            let high = one.a.sup(&one.b).add_scalar(reach);
            let around = AABB::from_corners([low.x, low.y, low.z], [high.x, high.y, high.z]);
            for found in tree.locate_in_envelope_intersecting(around) {
                let two = &all[found.data];
                // Of a pair the later one in the file is told.
                if two.roadway >= one.roadway {
                    continue;
                }
                let other = &plan.roadways[two.roadway];
                let pair = (one.roadway, two.roadway);
                if same_line(&mine.points_m, &other.points_m) {
                    twins.insert(pair);
                } else if let Some(length_m) = overlap_m(one, two, 0.25 * (mine.width_m + other.width_m))
                    && (one.a.z - two.a.z).abs() < mine.height_m.min(other.height_m).max(reach)
                {
                    let known = overlaps.entry(pair).or_insert((0.0, one.index));
                    known.0 += length_m;
                } else if let Some(place) = cut(one, two, mine.height_m, other.height_m) {
                    let near = 0.5 * (mine.width_m + other.width_m) + plan.snap_m;
                    let shared = nodes[one.roadway].intersection(&nodes[two.roadway]).any(|node| {
                        let node = survey.built.network.node(*node).map(|n| *n.position_m.raw());
                        node.is_some_and(|n| length(minus([n.x, n.y], place)) <= near)
                    });
                    if !shared && crossed.insert(pair) {
                        let problem = Problem::CrossesWithoutJunction {
                            other: other.id.clone(),
                            x_m: place[0],
                            y_m: place[1],
                        };
                        self.report(points(one.roadway, one.index), problem);
                    }
                }
            }
        }
        for (one, two) in &twins {
            let problem = Problem::DuplicateLine { other: plan.roadways[*two].id.clone() };
            self.report(Place::entry("roadways", *one).at("points_m"), problem);
        }
        let mut overlapping: BTreeSet<usize> = twins.iter().map(|(one, _)| *one).collect();
        for ((one, two), (length_m, index)) in overlaps {
            let other = &plan.roadways[two];
            if length_m > plan.roadways[one].width_m + other.width_m {
                overlapping.insert(one);
                self.report(points(one, index), Problem::Overlap { other: other.id.clone(), length_m });
            }
        }
        overlapping
    }

    /// Ends inside another roadway that do not meet it, but for roadways that run in it anyway; gives their roadways.
    fn near_misses(
        &mut self,
        survey: &Survey,
        all: &[Piece],
        tree: &Pieces,
        overlapping: &BTreeSet<usize>,
    ) -> BTreeSet<usize> {
        let (plan, network) = (self.plan, &survey.built.network);
        let widest = plan.roadways.iter().map(|r| r.width_m.max(r.height_m)).fold(0.0, f64::max);
        let mut missed = BTreeSet::new();
        let all_ends = survey.built.ends.iter().enumerate();
        for (roadway, ends) in all_ends.filter(|(roadway, _)| !overlapping.contains(roadway)) {
            let (Some(ends), Some(line)) = (ends, &survey.built.lines[roadway]) else { continue };
            let last = plan.roadways[roadway].points_m.len().saturating_sub(1);
            for (node, end, index) in [(ends[0], line.at(0.0), 0), (ends[1], line.at(line.length_m()), last)]
            {
                if network.edges_at(node).len() != 1 || ends[0] == ends[1] {
                    continue;
                }
                let (low, high) = (end.add_scalar(-widest), end.add_scalar(widest));
                let around = AABB::from_corners([low.x, low.y, low.z], [high.x, high.y, high.z]);
                let near = tree.locate_in_envelope_intersecting(around).map(|found| all[found.data]);
                let closest = near
                    .filter(|piece| piece.roadway != roadway)
                    .filter_map(|piece| {
                        almost_m(&piece, &end, &plan.roadways[piece.roadway]).map(|d| (d, piece))
                    })
                    .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.roadway.cmp(&b.1.roadway)));
                if let Some((distance_m, piece)) = closest {
                    missed.insert(roadway);
                    let other = plan.roadways[piece.roadway].id.clone();
                    let problem = Problem::NearMiss { other, distance_m, snap_m: plan.snap_m };
                    self.report(points(roadway, index), problem);
                }
            }
        }
        missed
    }

    /// Parts of the mine that nothing connects, but those that are explained by a near miss.
    fn parts(&mut self, survey: &Survey, missed: &BTreeSet<usize>) {
        let network = &survey.built.network;
        let part_of = network.parts(Travel::Any);
        let count = part_of.iter().max().map_or(0, |last| last + 1);
        let part_of_edge = |edge: &Edge| part_of[edge.from.0 as usize];
        let mut lengths = vec![0.0; count];
        for edge in network.edges() {
            lengths[part_of_edge(edge)] += edge.length_m();
        }
        let main = (0..count).max_by(|a, b| lengths[*a].total_cmp(&lengths[*b]).then(b.cmp(a)));
        let explained: BTreeSet<usize> =
            network.edges().iter().filter(|edge| missed.contains(&edge.roadway)).map(part_of_edge).collect();
        let others = (0..count).filter(|part| Some(*part) != main && !explained.contains(part));
        for part in others.take(PARTS_NAMED) {
            let own = || network.edges().iter().filter(|edge| part_of_edge(edge) == part);
            let Some(first) = own().map(|edge| edge.roadway).min() else { continue };
            let rest = || network.edges().iter().filter(|edge| Some(part_of_edge(edge)) == main);
            let places = own().flat_map(Edge::points_m);
            let nearest = places
                .flat_map(|p| rest().map(move |edge| (edge.distance_m(&p), edge.roadway)))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let Some((distance_m, roadway)) = nearest else { continue };
            let nearest = format!("roadway {}", self.plan.roadways[roadway].id);
            let problem = Problem::Disconnected { length_m: lengths[part], nearest, distance_m };
            self.report(Place::entry("roadways", first), problem);
        }
    }
}

fn points(roadway: usize, index: usize) -> Place {
    Place::entry("roadways", roadway).at("points_m").nth(index)
}

/// The nodes on each roadway.
pub(super) fn nodes_of_roadways(survey: &Survey, count: usize) -> Vec<BTreeSet<NodeId>> {
    let mut nodes = vec![BTreeSet::new(); count];
    for edge in survey.built.network.edges() {
        nodes[edge.roadway].extend([edge.from, edge.to]);
    }
    nodes
}

fn same_line<T: PartialEq>(one: &[T], two: &[T]) -> bool {
    one.len() == two.len() && (one == two || one.iter().eq(two.iter().rev()))
}

/// Length over which one piece runs along the other, at most `reach_m` beside it.
fn overlap_m(one: &Piece, two: &Piece, reach_m: f64) -> Option<f64> {
    let ((a, b), (c, d)) = (one.plan(), two.plan());
    let (u, v) = (minus(b, a), minus(d, c));
    let (long, other) = (length(u), length(v));
    if cross(u, v).abs() > PARALLEL * long * other || long == 0.0 || other == 0.0 {
        return None;
    }
    let unit = [u[0] / long, u[1] / long];
    let (s, t) = (dot(minus(c, a), unit), dot(minus(d, a), unit));
    let (from, to) = (s.min(t).max(0.0), s.max(t).min(long));
    let beside = cross(unit, minus(c, a)).abs().max(cross(unit, minus(d, a)).abs());
    (to > from && beside <= reach_m).then_some(to - from)
}

/// Where two pieces cut each other, seen from above, if their heights do too.
fn cut(one: &Piece, two: &Piece, height_one_m: f64, height_two_m: f64) -> Option<Point> {
    let ((a, b), (c, d)) = (one.plan(), two.plan());
    let (s, t) = meeting(a, b, c, d).filter(|(s, t)| (0.0..=1.0).contains(s) && (0.0..=1.0).contains(t))?;
    let above = one.z_at(s) - two.z_at(t);
    (above < height_two_m && -above < height_one_m).then(|| along(a, minus(b, a), s))
}

/// Distance of an end from a piece of another roadway that it is inside of or almost.
fn almost_m(piece: &Piece, end: &Vector3<f64>, other: &crate::plan::Roadway) -> Option<f64> {
    let (a, b) = piece.plan();
    let share = crate::geometry::plane::nearest_on_segment(a, b, [end.x, end.y]);
    let off = minus([end.x, end.y], along(a, minus(b, a), share));
    let above = end.z - piece.z_at(share);
    let inside = length(off) <= 0.5 * other.width_m + ALMOST_M && above > -ALMOST_M && above < other.height_m;
    inside.then(|| libm::hypot(length(off), above))
}
