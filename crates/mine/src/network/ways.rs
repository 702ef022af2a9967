//! How far it is to a few places from everywhere: searched once, asked often.

use super::{Network, Passage, Spot, Travel};
use alloc::vec::Vec;
use petgraph::algo::dijkstra;
use petgraph::graph::NodeIndex;

/// Lengths of the shortest ways to the nearest of some places of a network.
#[derive(Debug, Clone)]
pub struct Ways {
    /// From each node, m; infinite where no way leads.
    from_node_m: Vec<f64>,
    targets: Vec<Spot>,
}

impl Network {
    /// The shortest ways from everywhere to the nearest of some places: one search for all of them. Targets on edges of another network
    /// count for nothing, nor do such on edges that cannot be gone, but for somebody on the same edge.
    pub fn ways_to(&self, targets: &[Spot], travel: Travel) -> Ways {
        // One more node that stands for all targets, so that one search finds the nearest.
        let mut graph = self.graph.clone();
        let goal = graph.add_node(nalgebra::Vector3::zeros());
        for target in targets {
            let goes = self.edge(target.edge).is_some_and(|edge| travel == Travel::Any || edge.walkable);
            for door in self.doors(target).into_iter().flatten().filter(|_| goes) {
                graph.add_edge(door.node, goal, Passage { length_m: door.way_m, walkable: true });
            }
        }
        let lengths = dijkstra(&graph, goal, None, |edge| edge.weight().cost_m(travel));
        let length_m = |node| lengths.get(&NodeIndex::new(node)).copied().unwrap_or(f64::INFINITY);
        Ways {
            from_node_m: (0..self.nodes.len()).map(length_m).collect(),
            targets: targets.iter().copied().filter(|t| self.edge(t.edge).is_some()).collect(),
        }
    }
}

impl Ways {
    /// Length of the shortest way from a place of the same network, m: that of [`Network::nearest_of`]; `None` where none leads.
    pub fn length_m(&self, network: &Network, from: &Spot) -> Option<f64> {
        let at_m = network.clamped(from)?;
        let along = self.targets.iter().filter(|target| target.edge == from.edge);
        let along = along.filter_map(|target| Some((network.clamped(target)? - at_m).abs()));
        let doors = network.doors(from)?;
        let through =
            doors.iter().filter_map(|door| Some(door.way_m + self.from_node_m.get(door.node.index())?));
        let length_m = along.chain(through).fold(f64::INFINITY, f64::min);
        length_m.is_finite().then_some(length_m)
    }
}
