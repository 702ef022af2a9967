//! From centre lines to nodes and edges.

use super::{Edge, Network, Node, NodeId};
use crate::geometry::polyline::Polyline;
use crate::plan::MinePlan;
use adit_core::frames::Position;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;
use petgraph::unionfind::UnionFind;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// A network and what its making told.
pub struct Built {
    /// The network.
    pub network: Network,
    /// The line of each roadway; `None` where it has none.
    pub lines: Vec<Option<Polyline>>,
    /// For each junction of the plan the roadways that it names and does not touch, with the distance, m.
    pub missed: Vec<Vec<(usize, f64)>>,
    /// For each roadway the nodes at its two ends.
    pub ends: Vec<Option<[NodeId; 2]>>,
    /// The node of each junction of the plan that lies on a roadway.
    pub junctions: Vec<Option<NodeId>>,
}

/// A place on a roadway where a node is.
#[derive(Debug, Clone, Copy)]
struct Mark {
    roadway: usize,
    along_m: f64,
    place: Vector3<f64>,
}

/// A straight piece: its roadway and its number on it.
type Piece = GeomWithData<Rectangle<[f64; 3]>, (usize, usize)>;

/// Straight pieces of all roadways, found by place.
struct Pieces<'l> {
    lines: &'l [Option<Polyline>],
    tree: RTree<Piece>,
}

impl<'l> Pieces<'l> {
    fn new(lines: &'l [Option<Polyline>]) -> Self {
        let mut boxes = Vec::new();
        for (roadway, line) in lines.iter().enumerate() {
            for (index, (a, b)) in line.iter().flat_map(Polyline::segments).enumerate() {
                let bounds = Rectangle::from_corners([a.x, a.y, a.z], [b.x, b.y, b.z]);
                boxes.push(GeomWithData::new(bounds, (roadway, index)));
            }
        }
        Self { lines, tree: RTree::bulk_load(boxes) }
    }

    /// Places within `reach_m` of a point, the nearest on each straight piece, in order of roadway and way along it.
    fn near(&self, point: &Vector3<f64>, reach_m: f64) -> Vec<Mark> {
        let low = point.add_scalar(-reach_m);
        let high = point.add_scalar(reach_m);
        let around = AABB::from_corners([low.x, low.y, low.z], [high.x, high.y, high.z]);
        let mut marks: Vec<Mark> = self
            .tree
            .locate_in_envelope_intersecting(around)
            .filter_map(|piece| {
                let (roadway, index) = piece.data;
                let place = self.lines[roadway].as_ref()?.nearest_on_segment(index, point);
                let close = (place.point_m - point).norm() <= reach_m;
                close.then_some(Mark { roadway, along_m: place.along_m, place: place.point_m })
            })
            .collect();
        marks.sort_by(|a, b| a.roadway.cmp(&b.roadway).then(a.along_m.total_cmp(&b.along_m)));
        marks
    }
}

/// Nodes under construction.
struct Nodes<'l> {
    lines: &'l [Option<Polyline>],
    snap_m: f64,
    marks: Vec<Mark>,
    same: Vec<(usize, usize)>,
    /// Number of the mark at the start of each roadway; that at its end follows.
    starts: Vec<Option<usize>>,
}

impl<'l> Nodes<'l> {
    fn new(lines: &'l [Option<Polyline>], snap_m: f64) -> Self {
        let (mut marks, mut starts) = (Vec::new(), Vec::new());
        for (roadway, line) in lines.iter().enumerate() {
            starts.push(line.as_ref().map(|line| {
                let start = marks.len();
                for along_m in [0.0, line.length_m()] {
                    marks.push(Mark { roadway, along_m, place: line.at(along_m) });
                }
                start
            }));
        }
        Self { lines, snap_m, marks, same: Vec::new(), starts }
    }

    /// The number of a mark, the end of its roadway where that is near.
    fn number(&mut self, mark: Mark) -> Option<usize> {
        let length_m = self.lines[mark.roadway].as_ref()?.length_m();
        let start = self.starts[mark.roadway]?;
        if mark.along_m <= self.snap_m {
            return Some(start);
        }
        if length_m - mark.along_m <= self.snap_m {
            return Some(start + 1);
        }
        self.marks.push(mark);
        Some(self.marks.len() - 1)
    }

    /// Ends meet whatever is near them, but not the piece of their own roadway that leads to them.
    fn join_ends(&mut self, pieces: &Pieces<'_>) {
        for end in self.starts.clone().into_iter().flatten().flat_map(|start| [start, start + 1]) {
            let at = self.marks[end];
            for mark in pieces.near(&at.place, self.snap_m) {
                let own_way =
                    mark.roadway == at.roadway && (mark.along_m - at.along_m).abs() <= 3.0 * self.snap_m;
                if !own_way && let Some(other) = self.number(mark) {
                    self.same.push((end, other));
                }
            }
        }
    }

    /// Marks on one roadway that are hardly apart are one.
    fn join_neighbours(&mut self) {
        let mut order: Vec<usize> = (0..self.marks.len()).collect();
        let key = |i: &usize| (self.marks[*i].roadway, self.marks[*i].along_m);
        order.sort_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
        for pair in order.windows(2) {
            let (a, b) = (self.marks[pair[0]], self.marks[pair[1]]);
            if a.roadway == b.roadway && b.along_m - a.along_m <= self.snap_m {
                self.same.push((pair[0], pair[1]));
            }
        }
    }
}

/// Joins the centre lines of a plan. Roadways without a length have no part in it.
pub fn build(plan: &MinePlan) -> Built {
    let lines: Vec<Option<Polyline>> =
        plan.roadways.iter().map(|r| Polyline::new(r.points_m.iter().map(|p| *p.raw()))).collect();
    let pieces = Pieces::new(&lines);
    let mut marking = Nodes::new(&lines, plan.snap_m);
    marking.join_ends(&pieces);

    let mut missed = vec![Vec::new(); plan.junctions.len()];
    let mut junction_marks = vec![None; plan.junctions.len()];
    for (index, junction) in plan.junctions.iter().enumerate() {
        let place = junction.position_m.raw();
        let named = |roadway: usize| {
            junction.roadways.is_empty() || junction.roadways.contains(&plan.roadways[roadway].id)
        };
        let here: Vec<Mark> =
            pieces.near(place, plan.snap_m).into_iter().filter(|mark| named(mark.roadway)).collect();
        for id in &junction.roadways {
            let roadway = plan.roadways.iter().position(|r| r.id == *id);
            if let Some((roadway, line)) = roadway.and_then(|r| Some((r, lines[r].as_ref()?)))
                && !here.iter().any(|mark| mark.roadway == roadway)
            {
                let distance_m = (line.nearest(place).point_m - place).norm();
                missed[index].push((roadway, distance_m));
            }
        }
        let numbers: Vec<usize> = here.into_iter().filter_map(|mark| marking.number(mark)).collect();
        junction_marks[index] = numbers.first().copied();
        marking.same.extend(numbers.windows(2).map(|w| (w[0], w[1])));
    }
    marking.join_neighbours();
    assemble(plan, &marking, &junction_marks).finish(lines, missed)
}

struct Assembled {
    network: Network,
    ends: Vec<Option<[NodeId; 2]>>,
    junctions: Vec<Option<NodeId>>,
}

impl Assembled {
    fn finish(self, lines: Vec<Option<Polyline>>, missed: Vec<Vec<(usize, f64)>>) -> Built {
        let Self { network, ends, junctions } = self;
        Built { network, lines, missed, ends, junctions }
    }
}

/// Gives marks that are one a node, and makes the edges between nodes that follow each other.
fn assemble(plan: &MinePlan, marking: &Nodes<'_>, junction_marks: &[Option<usize>]) -> Assembled {
    let mut sets = UnionFind::<usize>::new(marking.marks.len());
    for (a, b) in &marking.same {
        sets.union(*a, *b);
    }
    let mut of_root: Vec<Option<NodeId>> = vec![None; marking.marks.len()];
    let mut nodes: Vec<Node> = Vec::new();
    let node_of: Vec<NodeId> = (0..marking.marks.len())
        .map(|mark| {
            let root = sets.find_mut(mark);
            *of_root[root].get_or_insert_with(|| {
                let position_m = Position::from_raw(marking.marks[mark].place);
                nodes.push(Node { position_m, junction: None });
                NodeId(u32::try_from(nodes.len() - 1).unwrap_or(u32::MAX))
            })
        })
        .collect();
    let junctions: Vec<Option<NodeId>> = junction_marks.iter().map(|mark| mark.map(|m| node_of[m])).collect();
    for (index, node) in junctions.iter().enumerate() {
        if let Some(node) = node.and_then(|n| nodes.get_mut(n.0 as usize)) {
            node.junction = Some(index);
            node.position_m = plan.junctions[index].position_m;
        }
    }

    let mut on_roadway: Vec<Vec<usize>> = vec![Vec::new(); plan.roadways.len()];
    for (number, mark) in marking.marks.iter().enumerate() {
        on_roadway[mark.roadway].push(number);
    }
    let mut edges = Vec::new();
    for (roadway, mut here) in on_roadway.into_iter().enumerate() {
        let Some(line) = &marking.lines[roadway] else { continue };
        here.sort_by(|a, b| marking.marks[*a].along_m.total_cmp(&marking.marks[*b].along_m));
        for pair in here.windows(2) {
            let (a, b) = (marking.marks[pair[0]].along_m, marking.marks[pair[1]].along_m);
            let (from, to) = (node_of[pair[0]], node_of[pair[1]]);
            if from == to && b - a <= marking.snap_m {
                continue;
            }
            let place = |node: NodeId| *nodes[node.0 as usize].position_m.raw();
            let points =
                core::iter::once(place(from)).chain(line.between(a, b)).chain(core::iter::once(place(to)));
            if let Some(line) = Polyline::new(points) {
                edges.push(Edge { from, to, roadway, walkable: plan.roadways[roadway].walkable, line });
            }
        }
    }
    let ends = marking.starts.iter().map(|start| start.map(|s| [node_of[s], node_of[s + 1]])).collect();
    Assembled { network: Network::new(nodes, edges), ends, junctions }
}
