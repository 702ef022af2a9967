//! How centre lines become a graph.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::frames::Position;
use adit_mine::network::{Edge, EdgeId, Leg, NodeId, Spot, Travel};
use adit_mine::plan::{Junction, MinePlan, Roadway, RoadwayKind};
use adit_mine::{Mine, Problem, check};
use common::{mine, plan, roadway};

fn sizes(mine: &Mine) -> (usize, usize) {
    (mine.network().nodes().len(), mine.network().edges().len())
}

#[test]
fn ends_that_meet_within_the_snap_are_one_node() {
    let joined = mine(vec![
        roadway("a", 4.0, &[[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]]),
        roadway("b", 4.0, &[[50.06, 0.05, 0.0], [50.0, 40.0, 0.0]]),
    ]);
    assert_eq!(sizes(&joined), (3, 2));
    let node = joined.network().edges()[0].to;
    assert_eq!(joined.network().edges_at(node), [EdgeId(0), EdgeId(1)]);
    // The edge ends at the node, not where the second roadway was drawn to begin.
    assert_eq!(joined.network().edges()[1].at(0.0), Position::new(50.0, 0.0, 0.0));
}

#[test]
fn an_end_on_the_middle_of_another_line_cuts_it() {
    let mine = mine(vec![
        roadway("a", 4.0, &[[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [80.0, 0.0, 0.0]]),
        roadway("b", 4.0, &[[50.0, 0.0, 0.0], [50.0, 40.0, 0.0]]),
    ]);
    assert_eq!(sizes(&mine), (4, 3));
    let lengths: Vec<f64> = mine.network().edges().iter().map(Edge::length_m).collect();
    assert_eq!(lengths, [50.0, 30.0, 40.0]);
    assert_eq!(mine.network().edges()[0].points_m().count(), 3);
}

#[test]
fn a_loop_and_a_lollipop_close_on_themselves() {
    let ring = [[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [40.0, 40.0, 0.0], [0.0, 40.0, 0.0]];
    let mut closed = ring.to_vec();
    closed.push(ring[0]);
    let one = mine(vec![roadway("ring", 4.0, &closed)]);
    assert_eq!(sizes(&one), (1, 1));
    assert!((one.network().edges()[0].length_m() - 160.0).abs() < 1e-12);
    // A stem leads to the ring, which ends on its own line.
    let mut lollipop = vec![[-30.0, 0.0, 0.0]];
    lollipop.extend(&closed);
    let two = mine(vec![roadway("lollipop", 4.0, &lollipop)]);
    assert_eq!(sizes(&two), (2, 2));
    let lengths: Vec<f64> = two.network().edges().iter().map(Edge::length_m).collect();
    assert_eq!(lengths, [30.0, 160.0]);
    // The way to a place on the ring is the shorter of two, by the end of its edge.
    let stem = Spot { edge: EdgeId(0), along_m: 0.0 };
    let route =
        two.network().route(&stem, &Spot { edge: EdgeId(1), along_m: 150.0 }, Travel::OnFoot).unwrap();
    assert!((route.length_m - 40.0).abs() < 1e-12);
    assert_eq!(route.legs[1], Leg { edge: EdgeId(1), from_m: 160.0, to_m: 150.0 });
}

fn crossing(height_m: f64) -> MinePlan {
    plan(vec![
        roadway("over", 4.0, &[[-50.0, 0.0, height_m], [50.0, 0.0, height_m]]),
        roadway("under", 4.0, &[[0.0, -50.0, 0.0], [0.0, 50.0, 0.0]]),
        roadway("between", 4.0, &[[50.0, 0.0, height_m], [0.0, 50.0, 0.0]]),
    ])
}

fn rules(plan: &MinePlan) -> Vec<Problem> {
    check(plan).into_iter().map(|finding| finding.problem).filter(|p| *p != Problem::NoPortal {}).collect()
}

#[test]
fn lines_that_cross_meet_only_at_a_junction_or_not_at_all_when_one_is_above_the_other() {
    let above = crossing(8.0);
    assert_eq!(rules(&above), []);
    assert_eq!(sizes(&Mine::new(above).unwrap()), (4, 3));

    let mut level = crossing(0.0);
    assert!(matches!(rules(&level)[..], [Problem::CrossesWithoutJunction { .. }]), "{:?}", rules(&level));
    level.junctions.push(Junction {
        id: "cross".into(),
        name: None,
        position_m: Position::new(0.0, 0.0, 0.0),
        roadways: vec![],
    });
    assert_eq!(rules(&level), []);
    let mine = Mine::new(level).unwrap();
    assert_eq!(sizes(&mine), (5, 5));
    let node = mine.network().nodes().iter().position(|node| node.junction == Some(0)).unwrap();
    assert_eq!(mine.network().edges_at(NodeId(u32::try_from(node).unwrap())).len(), 4);
}

#[test]
fn whoever_walks_does_not_take_the_hoist() {
    let mut hoist = Roadway {
        kind: RoadwayKind::Shaft,
        walkable: false,
        ..roadway("hoist", 4.0, &[[0.0, 0.0, 0.0], [0.0, 0.0, -100.0]])
    };
    let ramp =
        |z| roadway("ramp", 4.0, &[[0.0, 0.0, 0.0], [500.0, 0.0, -50.0], [0.0, 10.0, z], [0.0, 0.0, z]]);
    let two = |hoist: &Roadway| mine(vec![hoist.clone(), ramp(-100.0)]);
    let spots = |mine: &Mine| {
        [Position::new(0.0, 0.0, -1.0), Position::new(0.0, 9.0, -100.0)]
            .map(|p| mine.network().nearest(&p).unwrap().spot)
    };
    let blocked = two(&hoist);
    let [top, bottom] = spots(&blocked);
    let ride = blocked.network().route(&top, &bottom, Travel::Any).unwrap();
    assert!((ride.length_m - 108.0).abs() < 1e-9);
    // Whoever is in the shaft already leaves it by the nearer end.
    let walk = blocked.network().route(&top, &bottom, Travel::OnFoot).unwrap();
    assert!((walk.length_m - 108.0).abs() < 1e-9);
    let start = blocked.network().nearest(&Position::new(20.0, 0.0, -2.0)).unwrap().spot;
    let walk = blocked.network().route(&start, &bottom, Travel::OnFoot).unwrap();
    assert!(walk.length_m > 900.0, "{}", walk.length_m);
    let ride = blocked.network().route(&start, &bottom, Travel::Any).unwrap();
    assert!(ride.length_m < 140.0, "{}", ride.length_m);
    assert_eq!(blocked.network().parts(Travel::OnFoot), [0, 0]);
    hoist.walkable = true;
    let open = two(&hoist);
    let walk = open.network().route(&start, &bottom, Travel::OnFoot).unwrap();
    assert!((walk.length_m - ride.length_m).abs() < 1e-9);
}

#[test]
fn a_place_on_a_slope_knows_its_direction_and_side() {
    let mine = mine(vec![roadway("a", 4.0, &[[0.0, 0.0, 0.0], [0.0, 40.0, 10.0], [30.0, 40.0, 10.0]])]);
    let edge = &mine.network().edges()[0];
    assert!((edge.slope_at(5.0) - 0.25).abs() < 1e-15 && edge.slope_at(60.0) == 0.0);
    assert_eq!(edge.direction_at(60.0).raw().as_slice(), [1.0, 0.0, 0.0]);
    // Northwards, west is left.
    let foot = mine.network().nearest(&Position::new(-1.5, 20.0, 5.0)).unwrap();
    assert!((foot.left_m - 1.5).abs() < 1e-12 && foot.above_m.abs() < 1e-12, "{foot:?}");
    assert!((foot.spot.along_m - 0.5 * 1700.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn numbers_of_another_network_are_no_answer() {
    let mine = mine(vec![roadway("a", 4.0, &[[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]])]);
    let nowhere = Spot { edge: EdgeId(7), along_m: 0.0 };
    let here = Spot { edge: EdgeId(0), along_m: 0.0 };
    assert!(mine.network().route(&nowhere, &here, Travel::Any).is_none());
    assert!(mine.network().route(&here, &nowhere, Travel::Any).is_none());
    assert!(mine.network().at(&nowhere).is_none() && mine.network().edges_at(NodeId(9)).is_empty());
    let empty = Mine::new(plan(vec![])).unwrap();
    assert!(empty.network().nearest(&Position::ORIGIN).is_none());
    assert!(empty.excavation().clearance(&Position::ORIGIN).is_none());
}
