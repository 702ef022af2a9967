//! The roadways as a graph: nodes where centre lines meet or end, edges the pieces between them.
//!
//! Lines meet where they come within `snap_m` of each other at an end of one of them, and at the junctions that the plan names. Two
//! lines that only cross do not meet: one may run above the other. The points of an edge are those of its roadway, its two
//! ends the nodes'; lengths are taken along the line in space, so that a ramp counts its slope.

mod build;
mod route;
mod ways;

pub(crate) use build::{Built, build};
pub use route::{Leg, Route, Travel};
pub use ways::Ways;

use crate::geometry::polyline::{OnLine, Polyline};
use adit_core::frames::{MineGrid, Position, Vector};
use alloc::vec::Vec;
use nalgebra::Vector3;
use petgraph::graph::{EdgeIndex, NodeIndex, UnGraph};
use petgraph::visit::EdgeRef as _;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

/// A node, by its number from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// An edge, by its number from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EdgeId(pub u32);

/// Where roadways meet, or where one ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Place on the floor.
    pub position_m: Position<MineGrid>,
    /// Index in [`MinePlan::junctions`](crate::plan::MinePlan::junctions) where the plan names it.
    pub junction: Option<usize>,
}

/// A piece of a roadway between two nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// Node at its beginning.
    pub from: NodeId,
    /// Node at its end.
    pub to: NodeId,
    /// Index in [`MinePlan::roadways`](crate::plan::MinePlan::roadways); the edge runs in its direction.
    pub roadway: usize,
    /// People may walk here.
    pub walkable: bool,
    line: Polyline,
}

/// A place on an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// The edge.
    pub edge: EdgeId,
    /// Way from the edge's beginning along the centre line, m.
    pub along_m: f64,
}

/// The place on an edge that is nearest to a point, and how the point lies to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Where on which edge.
    pub spot: Spot,
    /// The place on the centre line.
    pub position_m: Position<MineGrid>,
    /// Distance of the point from it in space, m.
    pub distance_m: f64,
    /// How far the point lies left of the centre line, seen in the edge's direction, m; negative on the right.
    pub left_m: f64,
    /// How far the point lies above the centre line, which is on the floor, m.
    pub above_m: f64,
}

/// A straight piece of a centre line: its edge and its number on it.
type Piece = GeomWithData<Line<[f64; 3]>, (EdgeId, usize)>;

/// The graph of a mine's roadways.
#[derive(Debug, Clone, Default)]
pub struct Network {
    nodes: Vec<Node>,
    edges: Vec<Edge>,
    graph: UnGraph<Vector3<f64>, Passage>,
    segments: RTree<Piece>,
}

/// What the path search knows of an edge.
#[derive(Debug, Clone, Copy)]
struct Passage {
    length_m: f64,
    walkable: bool,
}

impl Passage {
    /// Length of the way through it, m; infinite where it cannot be gone.
    fn cost_m(&self, travel: Travel) -> f64 {
        if travel == Travel::Any || self.walkable { self.length_m } else { f64::INFINITY }
    }
}

impl Edge {
    /// Length along the line, m.
    pub fn length_m(&self) -> f64 {
        self.line.length_m()
    }

    /// The points of its centre line, m.
    pub fn points_m(&self) -> impl Iterator<Item = Position<MineGrid>> + '_ {
        self.line.points().iter().map(|p| Position::from_raw(*p))
    }

    /// The place on the centre line this far from the beginning; the ends beyond them.
    pub fn at(&self, along_m: f64) -> Position<MineGrid> {
        Position::from_raw(self.line.at(along_m))
    }

    /// Unit vector in which the centre line runs there.
    pub fn direction_at(&self, along_m: f64) -> Vector<MineGrid> {
        Vector::from_raw(self.line.direction_at(along_m))
    }

    /// Distance of a point from the centre line in space, m.
    pub fn distance_m(&self, point: &Position<MineGrid>) -> f64 {
        (self.line.nearest(point.raw()).point_m - point.raw()).norm()
    }

    /// Rise over run there; infinite in a shaft.
    pub fn slope_at(&self, along_m: f64) -> f64 {
        let d = self.line.direction_at(along_m);
        d.z / libm::hypot(d.x, d.y)
    }
}

impl Network {
    fn new(nodes: Vec<Node>, edges: Vec<Edge>) -> Self {
        let mut graph = UnGraph::with_capacity(nodes.len(), edges.len());
        for node in &nodes {
            graph.add_node(*node.position_m.raw());
        }
        let mut segments = Vec::new();
        for (id, edge) in (0_u32..).map(EdgeId).zip(&edges) {
            let passage = Passage { length_m: edge.length_m(), walkable: edge.walkable };
            graph.add_edge(NodeIndex::new(edge.from.0 as usize), NodeIndex::new(edge.to.0 as usize), passage);
            let lines = edge.line.segments().enumerate();
            segments.extend(
                lines.map(|(i, (a, b))| {
                    GeomWithData::new(Line::new([a.x, a.y, a.z], [b.x, b.y, b.z]), (id, i))
                }),
            );
        }
        Self { nodes, edges, graph, segments: RTree::bulk_load(segments) }
    }

    /// All nodes, in order of their numbers.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// All edges, in order of their numbers.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// An edge; `None` for a number of another network.
    pub fn edge(&self, id: EdgeId) -> Option<&Edge> {
        self.edges.get(id.0 as usize)
    }

    /// A node; `None` for a number of another network.
    pub fn node(&self, id: NodeId) -> Option<&Node> {
        self.nodes.get(id.0 as usize)
    }

    /// The edges that meet at a node, in order of their numbers; one that comes back to where it began is listed once.
    pub fn edges_at(&self, node: NodeId) -> Vec<EdgeId> {
        let index = NodeIndex::new(node.0 as usize);
        if index.index() >= self.graph.node_count() {
            return Vec::new();
        }
        let mut edges: Vec<EdgeId> = self.graph.edges(index).map(|e| EdgeId(number(e.id()))).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The place of a spot; `None` for an edge of another network.
    pub fn at(&self, spot: &Spot) -> Option<Position<MineGrid>> {
        self.edge(spot.edge).map(|edge| edge.at(spot.along_m))
    }

    /// The nearest place on any centre line, in space; `None` in a network without edges.
    pub fn nearest(&self, point: &Position<MineGrid>) -> Option<Foot> {
        let p = point.raw();
        let segment = self.segments.nearest_neighbor([p.x, p.y, p.z])?;
        self.foot(segment.data, point)
    }

    /// The nearest place on each edge within reach, nearest edge first: the hypotheses of a map matcher.
    pub fn within(&self, point: &Position<MineGrid>, reach_m: f64) -> Vec<Foot> {
        let p = point.raw();
        let near = self.segments.locate_within_distance([p.x, p.y, p.z], reach_m * reach_m);
        let mut feet: Vec<Foot> = near.filter_map(|segment| self.foot(segment.data, point)).collect();
        feet.sort_by(|a, b| a.spot.edge.cmp(&b.spot.edge).then(a.distance_m.total_cmp(&b.distance_m)));
        feet.dedup_by_key(|foot| foot.spot.edge);
        feet.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m).then(a.spot.edge.cmp(&b.spot.edge)));
        feet
    }

    fn foot(&self, (id, segment): (EdgeId, usize), point: &Position<MineGrid>) -> Option<Foot> {
        let edge = self.edge(id)?;
        let OnLine { along_m, point_m } = edge.line.nearest_on_segment(segment, point.raw());
        let off = point.raw() - point_m;
        let (a, b) = edge.line.segments().nth(segment)?;
        let run = b - a;
        let level = libm::hypot(run.x, run.y);
        let left_m = if level > 0.0 { (run.x * off.y - run.y * off.x) / level } else { 0.0 };
        Some(Foot {
            spot: Spot { edge: id, along_m },
            position_m: Position::from_raw(point_m),
            distance_m: off.norm(),
            left_m,
            above_m: off.z,
        })
    }

    /// For each node the number of its connected part; parts are numbered from 0 in order of their first node. With
    /// [`Travel::OnFoot`] edges that are not walkable do not connect.
    pub fn parts(&self, travel: Travel) -> Vec<usize> {
        let mut sets = petgraph::unionfind::UnionFind::<usize>::new(self.nodes.len());
        for edge in self.edges.iter().filter(|edge| travel == Travel::Any || edge.walkable) {
            sets.union(edge.from.0 as usize, edge.to.0 as usize);
        }
        let mut part_of_root: Vec<Option<usize>> = alloc::vec![None; self.nodes.len()];
        let mut count = 0;
        let number = |node: usize| {
            *part_of_root[sets.find(node)].get_or_insert_with(|| {
                count += 1;
                count - 1
            })
        };
        (0..self.nodes.len()).map(number).collect()
    }
}

/// Number of an edge of the path search, which are added in the order of the edges.
fn number(index: EdgeIndex) -> u32 {
    u32::try_from(index.index()).unwrap_or(u32::MAX)
}
