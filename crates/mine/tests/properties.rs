//! Laws that hold in every mine.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::frames::{MineGrid, Position};
use adit_mine::Mine;
use adit_mine::network::{Spot, Travel};
use adit_mine::plan::Roadway;
use common::{plan, roadway};
use proptest::prelude::*;

type Point = Position<MineGrid>;

fn corner() -> impl Strategy<Value = [f64; 3]> {
    (-80.0..80.0_f64, -80.0..80.0_f64, -6.0..6.0_f64).prop_map(|(x, y, z)| [x, y, z])
}

/// Roadways, most of which begin where an earlier one bends or ends.
fn roadways() -> impl Strategy<Value = Vec<Roadway>> {
    let one = (
        proptest::collection::vec(corner(), 2..5),
        2.0..8.0_f64,
        any::<proptest::sample::Index>(),
        any::<bool>(),
    );
    proptest::collection::vec(one, 1..7).prop_map(|all| {
        let mut points_so_far: Vec<[f64; 3]> = Vec::new();
        let mut made = Vec::new();
        for (number, (mut points, width_m, from, joined)) in all.into_iter().enumerate() {
            if joined && !points_so_far.is_empty() {
                points[0] = points_so_far[from.index(points_so_far.len())];
            }
            points_so_far.extend(&points);
            made.push(roadway(&format!("r{number}"), width_m, &points));
        }
        made
    })
}

fn point() -> impl Strategy<Value = Point> {
    corner().prop_map(|[x, y, z]| Position::new(x, y, z))
}

/// Distance of a point from a segment by calculus on the parabola of squared distance, as in a school book.
fn distance_to_segment(a: &Point, b: &Point, p: &Point) -> f64 {
    let (d, w) = (b.raw() - a.raw(), p.raw() - a.raw());
    let t = d.dot(&w) / d.norm_squared();
    if t <= 0.0 {
        w.norm()
    } else if t >= 1.0 {
        (p.raw() - b.raw()).norm()
    } else {
        (w - d * t).norm()
    }
}

proptest! {
    #[test]
    fn ways_searched_once_are_those_searched_one_by_one(
        roadways in roadways(),
        closed in any::<proptest::sample::Index>(),
        from in point(),
        targets in proptest::collection::vec(point(), 0..4),
    ) {
        let mut plan = plan(roadways);
        let closed = closed.index(plan.roadways.len());
        plan.roadways[closed].walkable = false;
        let mine = Mine::unchecked(plan);
        let network = mine.network();
        let Some(from) = network.nearest(&from).map(|foot| foot.spot) else { return Ok(()) };
        let targets: Vec<Spot> = targets.iter().filter_map(|p| Some(network.nearest(p)?.spot)).collect();
        for travel in [Travel::Any, Travel::OnFoot] {
            let once = network.ways_to(&targets, travel).length_m(network, &from);
            let each = network.nearest_of(&from, &targets, travel).map(|(_, route)| route.length_m);
            prop_assert_eq!(once.is_some(), each.is_some());
            // The same lengths, added from the other end.
            prop_assert!((once.unwrap_or(0.0) - each.unwrap_or(0.0)).abs() < 1e-9, "{once:?} {each:?}");
        }
    }

    #[test]
    fn a_passage_begins_and_ends_at_the_outline_with_nothing_inside_beyond(
        corners in proptest::collection::vec((10.0..40.0_f64, 0.0..1.0_f64), 3..8),
        (a, b) in ([-60.0..60.0_f64, -60.0..60.0_f64], [-60.0..60.0_f64, -60.0..60.0_f64]),
    ) {
        // Corners round the origin by rising angle: a simple outline, convex or not.
        let mut corners = corners;
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let angle = |share: f64| 2.0 * std::f64::consts::PI * share;
        let zone = adit_mine::plan::Zone {
            id: "z".into(),
            name: None,
            kind: adit_mine::plan::ZoneKind::Key,
            level: "l".into(),
            capacity: None,
            exit_tolerance_m: 0.0,
            exit_delay_s: 0.0,
            outline_m: corners.iter().map(|(r, share)| [r * angle(*share).cos(), r * angle(*share).sin()]).collect(),
        };
        let at = |share: f64| [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
        let holds = |share: f64| { let [x, y] = at(share); zone.distance_m(x, y) == 0.0 };
        let passage = zone.passage(a, b);
        for step in 0..=200 {
            let share = f64::from(step) / 200.0;
            let (first, last) = passage.unwrap_or((2.0, -1.0));
            prop_assert!(!holds(share) || (first - 1e-6..=last + 1e-6).contains(&share), "{share} of {passage:?}");
        }
        if let Some((first, last)) = passage {
            prop_assert!(0.0 <= first && first <= last && last <= 1.0);
            for share in [first, last] {
                let [x, y] = at(share);
                prop_assert!(zone.distance_m(x, y) < 1e-6);
            }
        }
    }

    #[test]
    fn the_nearest_place_is_the_nearest_of_all(roadways in roadways(), p in point()) {
        let mine = Mine::unchecked(plan(roadways));
        let foot = mine.network().nearest(&p).unwrap();
        let all = mine.network().edges().iter().flat_map(|edge| {
            let points: Vec<Point> = edge.points_m().collect();
            points.windows(2).map(|w| distance_to_segment(&w[0], &w[1], &p)).collect::<Vec<_>>()
        });
        let least = all.fold(f64::INFINITY, f64::min);
        // Roundings of coordinates of a hundred metres.
        prop_assert!((foot.distance_m - least).abs() < 1e-10);
        prop_assert!((mine.network().at(&foot.spot).unwrap() - foot.position_m).norm() < 1e-10);
        let within = mine.network().within(&p, least + 1.0);
        // At a node several edges are equally near.
        prop_assert!((within[0].distance_m - foot.distance_m).abs() < 1e-12);
        prop_assert!(within.iter().all(|f| f.distance_m <= least + 1.0 + 1e-9));
        // Left and above are two legs of a right angle about the centre line's own direction.
        prop_assert!(foot.left_m.hypot(foot.above_m) <= foot.distance_m + 1e-9);
    }

    #[test]
    fn the_network_is_as_long_as_its_roadways(roadways in roadways()) {
        let drawn: f64 = roadways.iter().flat_map(|r| r.points_m.windows(2)).map(|w| (w[1] - w[0]).norm()).sum();
        let mine = Mine::unchecked(plan(roadways));
        let edges: f64 = mine.network().edges().iter().map(adit_mine::network::Edge::length_m).sum();
        // Each end may be moved by the snap of 0.1 m to meet another; chance meetings within it are rare.
        prop_assert!((edges - drawn).abs() < 0.1 * 2.0 * mine.plan().roadways.len() as f64, "{} {}", edges, drawn);
    }

    #[test]
    fn air_has_no_clearance_and_rock_has(roadways in roadways(), p in point()) {
        let mine = Mine::unchecked(plan(roadways));
        let clearance = mine.excavation().clearance(&p).unwrap();
        let distance_m = clearance.distance_m();
        prop_assume!(!(1e-9..1e-5).contains(&distance_m));
        prop_assert_eq!(mine.excavation().contains(&p), distance_m == 0.0);
        prop_assert_eq!(mine.excavation().openings_at(&p).is_empty(), distance_m > 0.0);
        // A line to itself is air or rock as a whole.
        let up = Position::new(p.raw().x, p.raw().y, p.raw().z + 1e-9);
        let rock_m = mine.excavation().rock_m(&p, &up);
        prop_assert!(rock_m == 0.0);
    }

    #[test]
    fn rock_on_a_line_is_what_a_walk_along_it_finds(roadways in roadways(), a in point(), b in point()) {
        let mine = Mine::unchecked(plan(roadways));
        let rock_m = mine.excavation().rock_m(&a, &b);
        let length_m = (b - a).norm();
        let steps = 2000_u32;
        let inside = |i: u32| {
            let share = (f64::from(i) + 0.5) / f64::from(steps);
            mine.excavation().contains(&(a + (b - a) * share))
        };
        let walls = (1..steps).filter(|i| inside(*i) != inside(i - 1)).count();
        let walked_m = length_m * f64::from((0..steps).map(|i| u32::from(!inside(i))).sum::<u32>()) / f64::from(steps);
        // Each wall is found to half a step on either side; bodies thinner than a step are not found at all.
        let step_m = length_m / f64::from(steps);
        prop_assert!((rock_m - walked_m).abs() <= step_m * (4.0 + walls as f64), "{} {}", rock_m, walked_m);
        prop_assert!((0.0..=length_m + 1e-9).contains(&rock_m));
        prop_assert!((mine.excavation().rock_m(&b, &a) - rock_m).abs() < 1e-9);
    }

    #[test]
    fn ways_are_unbroken_and_obey_the_triangle(roadways in roadways(), picks in proptest::collection::vec((any::<proptest::sample::Index>(), 0.0..1.0_f64), 3)) {
        let mine = Mine::unchecked(plan(roadways));
        let network = mine.network();
        let spots: Vec<Spot> = picks.iter().map(|(edge, share)| {
            let index = edge.index(network.edges().len());
            let id = adit_mine::network::EdgeId(u32::try_from(index).unwrap());
            Spot { edge: id, along_m: share * network.edges()[index].length_m() }
        }).collect();
        let way = |a: usize, b: usize| network.route(&spots[a], &spots[b], Travel::Any);
        for (a, b) in [(0, 1), (1, 2), (2, 0), (1, 0)] {
            let Some(route) = way(a, b) else { continue };
            let mut here = network.at(&spots[a]).unwrap();
            let mut length_m = 0.0;
            for leg in &route.legs {
                let edge = network.edge(leg.edge).unwrap();
                prop_assert!((edge.at(leg.from_m) - here).norm() < 1e-9, "{:?}", route);
                here = edge.at(leg.to_m);
                length_m += (leg.to_m - leg.from_m).abs();
            }
            prop_assert!((network.at(&spots[b]).unwrap() - here).norm() < 1e-9);
            prop_assert!((length_m - route.length_m).abs() < 1e-9);
            prop_assert!(route.length_m >= (network.at(&spots[b]).unwrap() - network.at(&spots[a]).unwrap()).norm() - 1e-9);
        }
        if let (Some(ab), Some(ba)) = (way(0, 1), way(1, 0)) {
            prop_assert!((ab.length_m - ba.length_m).abs() < 1e-9);
        }
        if let (Some(ab), Some(bc), Some(ac)) = (way(0, 1), way(1, 2), way(0, 2)) {
            prop_assert!(ac.length_m <= ab.length_m + bc.length_m + 1e-9);
        }
    }
}
