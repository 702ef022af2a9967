//! Roadways to draw places on: each metre is as likely as any other.

use super::ground::{BODY_HALF_WIDTH_M, Ground, Stand};
use super::vibration::between;
use adit_mine::network::{Edge, EdgeId, Spot};
use rand_chacha::ChaCha8Rng;

/// Edges that can be walked, of some levels.
#[derive(Debug, Clone)]
pub(super) struct Stretches {
    /// Each edge, and the length up to its end, m.
    edges: Vec<(EdgeId, f64)>,
}

impl Stretches {
    /// Those of the levels that are wanted; what leads from level to level is none of them.
    pub fn new(ground: &Ground, wanted: impl Fn(&str) -> bool) -> Self {
        let mut length_m = 0.0;
        let mut edges = Vec::new();
        for (id, edge) in (0_u32..).map(EdgeId).zip(ground.network.edges()) {
            if edge.walkable && ground.level_of(edge).is_some_and(&wanted) {
                length_m += edge.length_m();
                edges.push((id, length_m));
            }
        }
        Self { edges }
    }

    /// The edges.
    pub fn edges(&self) -> impl Iterator<Item = EdgeId> + '_ {
        self.edges.iter().map(|(edge, _)| *edge)
    }

    /// A place on them; `None` where there are none.
    pub fn draw(&self, rng: &mut ChaCha8Rng) -> Option<Spot> {
        let (_, total_m) = self.edges.last()?;
        let at = between(rng, 0.0, *total_m);
        let index = self.edges.partition_point(|(_, end_m)| *end_m < at).min(self.edges.len() - 1);
        let (edge, end_m) = self.edges[index];
        Some(Spot { edge, along_m: end_m - at })
    }
}

/// A stand on the same edge within reach of a spot, anywhere across.
pub(super) fn near(ground: &Ground, spot: &Spot, reach_m: f64, rng: &mut ChaCha8Rng) -> Stand {
    let length_m = ground.network.edge(spot.edge).map_or(0.0, Edge::length_m);
    let along_m = (spot.along_m + between(rng, -reach_m, reach_m)).clamp(0.0, length_m);
    let room_m = (ground.half_width_m(spot.edge) - BODY_HALF_WIDTH_M - 0.1).max(0.0);
    Stand { spot: Spot { edge: spot.edge, along_m }, left_m: between(rng, -room_m, room_m) }
}
