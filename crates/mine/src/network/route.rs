//! The shortest way along the roadways.

use super::{EdgeId, Network, NodeId, Spot, number};
use alloc::vec::Vec;
use petgraph::algo::{astar, dijkstra};
use petgraph::graph::{EdgeReference, NodeIndex};
use petgraph::visit::EdgeRef as _;

/// By what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Travel {
    /// Through every edge, hoisting shafts too.
    Any,
    /// Only through edges that people may walk.
    OnFoot,
}

/// A part of a way on one edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// The edge.
    pub edge: EdgeId,
    /// Where it is entered: way from the edge's beginning, m.
    pub from_m: f64,
    /// Where it is left; smaller than `from_m` against the edge's direction, m.
    pub to_m: f64,
}

/// A way from one spot to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// Its length along the centre lines, m.
    pub length_m: f64,
    /// Its parts in order; empty when it leads nowhere.
    pub legs: Vec<Leg>,
}

/// A node that a spot can be left or reached by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Door {
    pub(super) node: NodeIndex,
    pub(super) way_m: f64,
    along_m: f64,
}

/// The best way found so far.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    length_m: f64,
    target: usize,
    /// The nodes by which it leaves and arrives; none along one edge.
    through: Option<(Door, Door)>,
}

impl Network {
    /// The shortest way; `None` when there is none or an edge is not of this network.
    pub fn route(&self, from: &Spot, to: &Spot, travel: Travel) -> Option<Route> {
        self.nearest_of(from, &[*to], travel).map(|(_, route)| route)
    }

    /// The nearest of several targets by the way to it, with its place in the list; `None` when none can be reached. The
    /// edge on which the way begins may be one that is not walkable: whoever is there leaves it.
    pub fn nearest_of(&self, from: &Spot, targets: &[Spot], travel: Travel) -> Option<(usize, Route)> {
        let cost = |edge: EdgeReference<'_, super::Passage>| edge.weight().cost_m(travel);
        let starts = self.doors(from)?;
        let ways = starts.map(|start| dijkstra(&self.graph, start.node, None, cost));
        let mut best: Option<Candidate> = None;
        let mut offer = |length_m: f64, target: usize, through: Option<(Door, Door)>| {
            if length_m.is_finite() && best.is_none_or(|known| length_m < known.length_m) {
                best = Some(Candidate { length_m, target, through });
            }
        };
        for (index, target) in targets.iter().enumerate() {
            if target.edge == from.edge {
                offer((self.clamped(target)? - self.clamped(from)?).abs(), index, None);
            }
            if travel == Travel::OnFoot && !self.edge(target.edge)?.walkable {
                continue;
            }
            for end in self.doors(target)? {
                for (start, ways) in starts.iter().zip(&ways) {
                    if let Some(between) = ways.get(&end.node) {
                        offer(start.way_m + between + end.way_m, index, Some((*start, end)));
                    }
                }
            }
        }
        let Candidate { length_m, target: index, through } = best?;
        let target = targets.get(index)?;
        let mut legs = Vec::new();
        let mut go = |edge, from_m: f64, to_m: f64| {
            if (to_m - from_m).abs() > 0.0 {
                legs.push(Leg { edge, from_m, to_m });
            }
        };
        let (first, last) = (self.clamped(from)?, self.clamped(target)?);
        if let Some((start, end)) = through {
            let straight = |node: NodeIndex| (self.graph[node] - self.graph[end.node]).norm();
            let (_, nodes) = astar(&self.graph, start.node, |node| node == end.node, cost, straight)?;
            go(from.edge, first, start.along_m);
            for pair in nodes.windows(2) {
                // Of several edges between two nodes the shortest way takes the shortest.
                let edges = self.graph.edges_connecting(pair[0], pair[1]);
                let edge = edges.min_by(|a, b| cost(*a).total_cmp(&cost(*b)))?;
                let id = EdgeId(number(edge.id()));
                let length_m = edge.weight().length_m;
                let forwards = self.edge(id)?.from == NodeId(u32::try_from(pair[0].index()).ok()?);
                if forwards { go(id, 0.0, length_m) } else { go(id, length_m, 0.0) }
            }
            go(target.edge, end.along_m, last);
        } else {
            go(from.edge, first, last);
        }
        Some((index, Route { length_m, legs }))
    }

    pub(super) fn clamped(&self, spot: &Spot) -> Option<f64> {
        Some(spot.along_m.clamp(0.0, self.edge(spot.edge)?.length_m()))
    }

    pub(super) fn doors(&self, spot: &Spot) -> Option<[Door; 2]> {
        let edge = self.edge(spot.edge)?;
        let (along_m, length_m) = (self.clamped(spot)?, edge.length_m());
        let door =
            |node: NodeId, way_m, along_m| Door { node: NodeIndex::new(node.0 as usize), way_m, along_m };
        Some([door(edge.from, along_m, 0.0), door(edge.to, length_m - along_m, length_m)])
    }
}
