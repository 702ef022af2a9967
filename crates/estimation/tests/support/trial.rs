//! A walk without infrastructure through the bank, and how it went.
#![allow(dead_code, reason = "every program uses its own part")]
#![expect(clippy::cast_possible_truncation, reason = "small counts")]

use super::roadways::{Carrier, Draw, Reckoned, Walker, places, random_route, reckon};
use adit_core::nalgebra::{Matrix2, Vector3};
use adit_core::solution::radius_95_m;
use adit_estimation::place::bank::{Bank, BankParams, Estimate, Place};
use adit_estimation::place::roadways::Roadways;
use adit_mine::Mine;
use adit_mine::network::NodeId;
use adit_mine::plan::RoadwayKind;
use std::sync::Arc;

/// Length of a walk, m: half an hour.
pub const WAY_M: f64 = 30.0 * 60.0 * 1.3;
/// Places from one judgement to the next: 2 s.
const JUDGED_EVERY: usize = 4;

/// How a walk went.
pub struct Trial {
    pub seed: u64,
    pub walked_m: f64,
    pub end_m: f64,
    pub largest_m: f64,
    /// Share of the moments within the stated radius of 95 %.
    pub inside: f64,
    /// Share on a roadway that the walker was not on.
    pub wrong: f64,
    pub lost: f64,
    /// Mean number of hypotheses.
    pub hypotheses: f64,
    /// Largest jump of the reported place over the radius stated before it.
    pub jump: f64,
}

/// A walk, as it was and as a carrier had it.
pub struct Walk {
    pub way: Vec<Vector3<f64>>,
    pub reckoned: Reckoned,
}

/// A node that no shaft leads to.
fn start_node(mine: &Mine, draw: &mut Draw) -> NodeId {
    let network = mine.network();
    loop {
        let node = NodeId(draw.below(network.nodes().len()) as u32);
        let edges = network.edges_at(node);
        let open = |edge: &adit_mine::network::Edge| {
            edge.walkable && mine.plan().roadways[edge.roadway].kind != RoadwayKind::Shaft
        };
        if edges.into_iter().filter_map(|edge| network.edge(edge)).all(open) {
            return node;
        }
    }
}

pub fn walk(mine: &Mine, carrier: &Carrier, walker: &Walker, seed: u64) -> Walk {
    let mut draw = Draw::new(seed);
    let node = start_node(mine, &mut draw);
    let route = random_route(mine, &mut draw, walker, node, WAY_M);
    let way = places(&route, walker, &mut draw);
    let reckoned = reckon(&way, walker, carrier, &mut draw);
    Walk { way, reckoned }
}

/// What suits a carrier.
pub fn params(carrier: &Carrier) -> BankParams {
    BankParams { tag_height_m: carrier.tag_height_m, level_way: !carrier.climbs, ..BankParams::default() }
}

/// The radius that an estimate states, m.
pub fn radius_m(estimate: &Estimate) -> f64 {
    let level: Matrix2<f64> = estimate.covariance_m2.fixed_view::<2, 2>(0, 0).into_owned();
    radius_95_m(&level)
}

/// Walks it; `each` sees the bank, what it says, the place on the floor and the way so far, every two seconds.
pub fn follow(
    walk: &Walk,
    roadways: Option<&Arc<Roadways>>,
    params: BankParams,
    seed: u64,
    mut each: impl FnMut(&Bank, &Estimate, &Vector3<f64>, f64),
) -> Trial {
    let mut bank = Bank::new(params, roadways.cloned());
    bank.start(walk.reckoned.start.clone());
    let mut trial = Trial {
        seed,
        walked_m: 0.0,
        end_m: 0.0,
        largest_m: 0.0,
        inside: 0.0,
        wrong: 0.0,
        lost: 0.0,
        hypotheses: 0.0,
        jump: 0.0,
    };
    let mut judged = 0.0;
    let mut last: Option<(Vector3<f64>, f64, f64)> = None;
    for (index, (stretch, pair)) in walk.reckoned.stretches.iter().zip(walk.way.windows(2)).enumerate() {
        bank.walk(stretch);
        trial.walked_m += (pair[1] - pair[0]).norm();
        if index % JUDGED_EVERY != JUDGED_EVERY - 1 {
            continue;
        }
        let estimate = bank.estimate().unwrap();
        let (truth, radius) = (&pair[1], radius_m(&estimate));
        if let Some((place, stated, walked_m)) = last {
            // A fifth more than was walked is walking; lengths may be wrong by that.
            let jump_m = (estimate.position_m - place).xy().norm() - 1.2 * (trial.walked_m - walked_m);
            trial.jump = trial.jump.max(jump_m / stated);
        }
        last = Some((estimate.position_m, radius, trial.walked_m));
        trial.end_m = (estimate.position_m - truth).xy().norm();
        trial.largest_m = trial.largest_m.max(trial.end_m);
        judged += 1.0;
        let count = |yes: bool| f64::from(u8::from(yes));
        trial.inside += count(trial.end_m <= radius);
        trial.lost += count(estimate.lost);
        trial.hypotheses += estimate.hypotheses as f64;
        trial.wrong += count(roadways.is_some_and(|roadways| !on_roadway(roadways, &estimate, truth)));
        each(&bank, &estimate, truth, trial.walked_m);
    }
    for share in [&mut trial.inside, &mut trial.wrong, &mut trial.lost, &mut trial.hypotheses] {
        *share /= judged;
    }
    trial
}

/// The walker is on the reported roadway, or on one that goes on from it as far as the estimate errs, up to 10 m.
fn on_roadway(roadways: &Roadways, estimate: &Estimate, truth: &Vector3<f64>) -> bool {
    let Place::Piece(piece) = estimate.place else { return false };
    let piece = roadways.piece(piece).unwrap();
    let off_m = (estimate.position_m - truth).xy().norm();
    piece.distance_m(&truth.xy()) < piece.half_width_m + 3.0 + off_m.min(10.0)
        && (piece.floor_m(piece.on(&truth.xy()).along_m) - truth.z).abs() < 4.0
}
