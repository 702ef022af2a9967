//! The roadways that a bank walks on, against the mine that they were made of; and the moments that it takes.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::frames::Position;
use adit_core::nalgebra::{Vector2, Vector3};
use adit_estimation::place::roadways::Roadways;
use adit_estimation::place::state::{EAST, FACTOR, HEADING, NORTH, State, TURN, UP, Vector};
use adit_mine::Mine;
use adit_mine::network::EdgeId;
use adit_mine::plan::RoadwayKind;
use proptest::prelude::*;
use std::path::Path;
use std::sync::LazyLock;

static MINE: LazyLock<(Mine, Roadways)> = LazyLock::new(|| {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    let (mine, _) = adit_mine::file::open(Path::new(file)).unwrap();
    let roadways = Roadways::new(&mine);
    (mine, roadways)
});

fn walkable(mine: &Mine, edge: &adit_mine::network::Edge) -> bool {
    edge.walkable && mine.plan().roadways[edge.roadway].kind != RoadwayKind::Shaft
}

#[test]
fn they_are_as_long_as_the_walkable_edges_of_the_network() {
    let (mine, roadways) = &*MINE;
    let edges = mine.network().edges().iter().filter(|edge| walkable(mine, edge));
    let network_m: f64 = edges.map(adit_mine::network::Edge::length_m).sum();
    let pieces = (0_u32..).map_while(|index| roadways.piece(index));
    let own_m: f64 = pieces.map(|piece| piece.length_m * (1.0 + piece.rise * piece.rise).sqrt()).sum();
    // Sums of two hundred lengths, rounded differently.
    assert!((network_m - own_m).abs() < 1e-6, "{network_m} and {own_m}");
}

#[test]
fn pieces_that_meet_at_a_joint_end_there() {
    let (_, roadways) = &*MINE;
    for (index, piece) in (0_u32..).map_while(|index| Some((index, roadways.piece(index)?))) {
        for (end, along_m) in [(0, 0.0), (1, piece.length_m)] {
            let meeting = roadways.at(piece.joints[end]);
            assert!(meeting.contains(&index));
            for other in meeting.iter().map(|other| roadways.piece(*other).unwrap()) {
                let there = if other.end_at(piece.joints[end]) == 0 { 0.0 } else { other.length_m };
                // Centre lines are joined at the node: only rounding is left.
                assert!((other.at(there) - piece.at(along_m)).norm() < 1e-6);
            }
        }
    }
}

#[test]
fn chambers_open_to_the_crosscut_beside_them() {
    let (mine, roadways) = &*MINE;
    assert_eq!(mine.plan().chambers.len(), 8);
    for index in 0..8 {
        let room = roadways.chamber(index).unwrap();
        assert!(!room.doors.is_empty(), "chamber {index}");
        for door in &room.doors {
            assert!(roadways.beside(*door).any(|beside| beside == index));
        }
    }
}

proptest! {
    #[test]
    fn the_nearest_piece_is_that_of_the_network(east in 4700.0..6200.0, north in 2800.0..3300.0) {
        let (mine, roadways) = &*MINE;
        let place = Vector2::new(east, north);
        let found = roadways.within(&place, 60.0);
        let every = (0..u32::try_from(roadways.pieces()).unwrap()).filter(|index| roadways.piece(*index).unwrap().distance_m(&place) <= 60.0);
        prop_assert_eq!(&found, &every.collect::<Vec<u32>>());
        // The network measures in space: on the floor of the nearest piece both are one.
        let nearest = found.iter().min_by(|a, b| {
            let far = |index: &u32| roadways.piece(index.to_owned()).unwrap().distance_m(&place);
            far(a).total_cmp(&far(b))
        });
        if let Some(piece) = nearest.and_then(|index| roadways.piece(*index)) {
            let on = piece.on(&place);
            let along_m = on.along_m.clamp(0.0, piece.length_m);
            let foot = Position::from_raw(piece.at(along_m));
            let edges = (0_u32..).map(EdgeId).map_while(|id| mine.network().edge(id)).filter(|edge| walkable(mine, edge));
            let off_m = edges.map(|edge| edge.distance_m(&foot)).fold(f64::INFINITY, f64::min);
            prop_assert!(off_m < 1e-6, "{off_m}");
        }
    }

    /// Against sums over a fine grid of the normal distribution, cut off at the wall.
    #[test]
    fn a_wall_leaves_what_is_left_of_the_distribution(mean in -3.0..3.0, sigma in 0.2..5.0, limit in -2.0..2.0, slant in -0.9..0.9) {
        let mut sigmas = Vector::zeros();
        (sigmas[EAST], sigmas[NORTH], sigmas[UP]) = (sigma, sigma, 1.0);
        let mut state = State::new(&sigmas.component_mul(&sigmas));
        state.covariance[(EAST, NORTH)] = slant * sigma * sigma;
        state.covariance[(NORTH, EAST)] = slant * sigma * sigma;
        state.position_m.x = mean;
        let beyond: f64 = (mean - limit) / sigma;
        prop_assume!(beyond < 3.4);
        let (told, log_within) = state.keep_within((&Vector3::zeros(), &Vector3::x()), limit, 3.5).unwrap();
        let step = sigma * 1e-3;
        let (mut mass, mut first, mut second) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut x = limit - 0.5 * step;
        while x > mean.min(limit) - 12.0 * sigma {
            let density: f64 = (-0.5 * ((x - mean) / sigma).powi(2)).exp();
            mass += density;
            first += density * x;
            second += density * x * x;
            x -= step;
        }
        let (kept, variance): (f64, f64) = (first / mass, second / mass - (first / mass).powi(2));
        // The midpoint rule with a thousandth of σ: 1e-6 of the moments, more where little mass is left.
        prop_assert!((told - beyond).abs() < 1e-12);
        prop_assert!((state.position_m.x - kept).abs() < 1e-4 * sigma, "{} and {kept}", state.position_m.x);
        prop_assert!((state.covariance[(EAST, EAST)] - variance).abs() < 1e-4 * sigma * sigma);
        prop_assert!((log_within.exp() - mass * step / (sigma * (core::f64::consts::TAU).sqrt())).abs() < 1e-5);
        // What is correlated moves with it.
        let moved: f64 = state.position_m.y - slant * (kept - mean);
        prop_assert!(moved.abs() < 1e-4 * sigma);
    }

    #[test]
    fn two_states_joined_have_the_moments_of_both(share in 0.0..1.0, apart in -5.0..5.0, turned in -0.5..0.5, sigma in 0.1..2.0) {
        let mut sigmas = Vector::zeros();
        (sigmas[EAST], sigmas[NORTH], sigmas[UP]) = (1.0, sigma, 0.5);
        (sigmas[TURN], sigmas[HEADING], sigmas[FACTOR]) = (0.1, 0.2, 0.05);
        let first = State::new(&sigmas.component_mul(&sigmas));
        let mut second = first.clone();
        second.covariance[(NORTH, NORTH)] = 4.0;
        second.position_m.y = apart;
        second.turn_rad = turned;
        second.factor = 1.1;
        let mut joined = first.clone();
        joined.join(&second, share);
        let variance = (1.0 - share) * sigma * sigma + share * 4.0 + share * (1.0 - share) * apart * apart;
        // Rounding only.
        prop_assert!((joined.position_m.y - share * apart).abs() < 1e-12);
        prop_assert!((joined.covariance[(NORTH, NORTH)] - variance).abs() < 1e-12);
        prop_assert!((joined.turn_rad - share * turned).abs() < 1e-12);
        prop_assert!((joined.factor - 1.0 - share * 0.1).abs() < 1e-12);
        let direction = 0.1 * 0.1 + 0.2 * 0.2 + share * (1.0 - share) * turned * turned;
        prop_assert!((joined.direction_rad2() - direction).abs() < 1e-12);
        let both = share * (1.0 - share) * apart * 0.1;
        prop_assert!((joined.covariance[(NORTH, FACTOR)] - both).abs() < 1e-12);
    }
}
