//! Pressures along the network: steps across closed doors, and what must fall off between them.
//!
//! A mine file says by how much the pressure steps across a door; the network says the rest. Every way round a door must lose the same
//! pressure, by friction. With `q = c Δp` in each piece of roadway (Atkinson's `Δp = R q²` linearised), `c = A³ / (U L)` (cross-section,
//! perimeter, length; Atkinson, *Trans. N. Engl. Inst. Min. Mech. Eng.* 3, 1854), the pressures are those that lose the least power
//! while each door holds its step:
//!
//! `minimise Σ c (pᵢ − pⱼ)²`, `p_behind − p_before = step` for each door
//!
//! a linear system, solved by conjugate gradients. In a roadway with a closed door no air moves, so its pieces have no friction
//! to speak of. The highest node of each connected part has pressure 0: it is open to the sky.
//!
//! Which doors the fans work against is not in the file: where the fans stand, pressures may step otherwise.

use super::doors::{Door, Doors};
use adit_core::frames::{MineGrid, Position};
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::network::{EdgeId, Network, Travel};

/// A step is spread over this to either side of its door, m: it has leaks.
const DOOR_M: f64 = 0.5;
/// How much better a dead-end conducts than its cross-section would.
const STAGNANT: f64 = 1e4;

/// A piece of an edge between nodes and doors.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from_m: f64,
    to_m: f64,
    /// Unknown and what is added to it, at either end.
    ends: [(usize, f64); 2],
    conductance: f64,
}

/// Pressures along the roadways.
#[derive(Debug, Clone)]
pub struct Ventilation {
    network: Network,
    pieces: Vec<Vec<Piece>>,
    pressure_pa: Vec<f64>,
}

impl Ventilation {
    pub(super) fn new(mine: &Mine, doors: &Doors) -> Self {
        let network = mine.network().clone();
        let mut unknowns = network.nodes().len();
        let mut pieces = Vec::new();
        for (id, edge) in (0_u32..).map(EdgeId).zip(network.edges()) {
            let mut here: Vec<(f64, f64)> = doors
                .doors
                .iter()
                .filter_map(|door| {
                    door.spot.filter(|spot| spot.edge == id).map(|spot| (spot.along_m, door.step_pa))
                })
                .collect();
            here.sort_by(|a, b| a.0.total_cmp(&b.0));
            let roadway = &mine.plan().roadways[edge.roadway];
            let (area, perimeter) =
                (roadway.width_m * roadway.height_m, 2.0 * (roadway.width_m + roadway.height_m));
            let stagnant = if here.is_empty() { 1.0 } else { STAGNANT };
            let through = stagnant * area * area * area / perimeter;
            let mut cut = Vec::new();
            let (mut from_m, mut from) = (0.0, (edge.from.0 as usize, 0.0));
            for (along_m, step_pa) in here {
                let conductance = through / (along_m - from_m).max(0.1);
                cut.push(Piece { from_m, to_m: along_m, ends: [from, (unknowns, 0.0)], conductance });
                (from_m, from) = (along_m, (unknowns, step_pa));
                unknowns += 1;
            }
            let (to_m, to) = (edge.length_m(), (edge.to.0 as usize, 0.0));
            let conductance = through / (to_m - from_m).max(0.1);
            cut.push(Piece { from_m, to_m, ends: [from, to], conductance });
            pieces.push(cut);
        }
        let mut pressure_pa = relaxed(unknowns, &pieces);
        let parts = network.parts(Travel::Any);
        let part_of = |unknown: usize| parts.get(unknown).copied();
        // Doors' unknowns belong to the part of their edge.
        let mut belongs: Vec<Option<usize>> = (0..unknowns).map(part_of).collect();
        for piece in pieces.iter().flatten() {
            let part = belongs[piece.ends[0].0];
            belongs[piece.ends[1].0] = belongs[piece.ends[1].0].or(part);
        }
        let height = |node: usize| network.nodes()[node].position_m.raw().z;
        for part in 0..parts.iter().max().map_or(0, |last| last + 1) {
            let nodes = (0..parts.len()).filter(|node| parts[*node] == part);
            let top = nodes.max_by(|a, b| height(*a).total_cmp(&height(*b)));
            let zero_pa = top.map_or(0.0, |top| pressure_pa[top]);
            for (pressure, _) in pressure_pa.iter_mut().zip(&belongs).filter(|(_, b)| **b == Some(part)) {
                *pressure -= zero_pa;
            }
        }
        Self { network, pieces, pressure_pa }
    }

    /// The pressure that the ventilation adds at a place (mine grid), Pa.
    pub fn pressure_pa(&self, place_m: &Vector3<f64>) -> f64 {
        let point: Position<MineGrid> = Position::from_raw(*place_m);
        self.network.nearest(&point).map_or(0.0, |foot| self.along_pa(foot.spot.edge, foot.spot.along_m))
    }

    /// The same on an edge, this far along it, Pa.
    pub fn along_pa(&self, edge: EdgeId, along_m: f64) -> f64 {
        let Some(pieces) = self.pieces.get(edge.0 as usize) else { return 0.0 };
        let number = pieces.partition_point(|piece| piece.to_m < along_m).min(pieces.len() - 1);
        let here = self.in_piece(&pieces[number], along_m);
        // Near a door some of the other side.
        let neighbour = |other: usize, off_m: f64| {
            let u = (0.5 * (1.0 - off_m / DOOR_M)).clamp(0.0, 0.5);
            let share = u * u * u * (10.0 + u * (6.0 * u - 15.0));
            share * (self.in_piece(&pieces[other], along_m) - here)
        };
        let before = if number > 0 { neighbour(number - 1, along_m - pieces[number].from_m) } else { 0.0 };
        let last = number + 1 == pieces.len();
        let after = if last { 0.0 } else { neighbour(number + 1, pieces[number].to_m - along_m) };
        here + before + after
    }

    fn in_piece(&self, piece: &Piece, along_m: f64) -> f64 {
        let [a, b] = piece.ends.map(|(unknown, step_pa)| self.pressure_pa[unknown] + step_pa);
        let share = (along_m - piece.from_m) / (piece.to_m - piece.from_m).max(1e-9);
        a + (b - a) * share.clamp(0.0, 1.0)
    }

    /// Half-way between the pressures on the two sides of a door, Pa.
    pub(super) fn at_door_pa(&self, door: &Door) -> f64 {
        door.spot.map_or(0.0, |spot| self.along_pa(spot.edge, spot.along_m))
    }
}

/// The pressures of least power, by conjugate gradients (Hestenes & Stiefel 1952); up to a constant in each part.
fn relaxed(unknowns: usize, pieces: &[Vec<Piece>]) -> Vec<f64> {
    let apply = |x: &[f64], steps: f64| {
        let mut y = vec![0.0; unknowns];
        for piece in pieces.iter().flatten() {
            let [(i, step_i), (j, step_j)] = piece.ends;
            let flow = piece.conductance * (x[i] + steps * step_i - x[j] - steps * step_j);
            y[i] += flow;
            y[j] -= flow;
        }
        y
    };
    let mut diagonal = vec![0.0; unknowns];
    for piece in pieces.iter().flatten() {
        diagonal[piece.ends[0].0] += piece.conductance;
        diagonal[piece.ends[1].0] += piece.conductance;
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scaled = |r: &[f64]| -> Vec<f64> {
        r.iter().zip(&diagonal).map(|(r, d)| if *d > 0.0 { r / d } else { 0.0 }).collect()
    };
    let mut x = vec![0.0; unknowns];
    let mut r: Vec<f64> = apply(&x, 1.0).iter().map(|v| -v).collect();
    let mut z = scaled(&r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let small = rz * 1e-24;
    for _ in 0..20 * unknowns + 100 {
        let q = apply(&p, 0.0);
        let curvature = dot(&p, &q);
        if rz <= small || curvature <= 0.0 {
            break;
        }
        let step = rz / curvature;
        for index in 0..unknowns {
            x[index] += step * p[index];
            r[index] -= step * q[index];
        }
        z = scaled(&r);
        let next = dot(&r, &z);
        for index in 0..unknowns {
            p[index] = z[index] + next / rz * p[index];
        }
        rz = next;
    }
    x
}
