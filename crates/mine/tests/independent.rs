//! Geometry and graph against other people's code: shapely (GEOS), networkx, PROJ. The scripts stand in `reference/`.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::frames::Position;
use adit_core::geodesy::Geodetic;
use adit_mine::Mine;
use adit_mine::grid_tie::GridTie;
use adit_mine::network::{EdgeId, Spot, Travel};
use adit_mine::plan::{ControlPoint, Fit, Pillar, Zone, ZoneKind};
use adit_mine::projection::Projection;
use common::{plan, roadway};
use std::collections::BTreeMap;

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

fn pairs(text: &str) -> Vec<[f64; 2]> {
    numbers(text).chunks(2).map(|p| [p[0], p[1]]).collect()
}

/// Rows of a stored file without its header.
fn rows(text: &str) -> impl Iterator<Item = Vec<&str>> {
    text.lines().skip(1).map(|line| line.split(',').collect())
}

#[test]
fn distances_from_zones_are_those_of_geos() {
    let mut count = 0;
    for row in rows(include_str!("reference/polygons.csv")) {
        let zone = Zone {
            id: "z".into(),
            name: None,
            kind: ZoneKind::Key,
            level: "floor".into(),
            capacity: None,
            exit_tolerance_m: 0.0,
            exit_delay_s: 0.0,
            outline_m: pairs(row[0]),
        };
        let (x, y, expected): (f64, f64, f64) =
            (row[1].parse().unwrap(), row[2].parse().unwrap(), row[3].parse().unwrap());
        let found = zone.distance_m(x, y);
        // Northings of 5.7e6 m are stored to 1e-9 m.
        assert!((found - expected).abs() < 1e-8, "{row:?}: {found}");
        assert_eq!(zone.holds(false, x, y), expected == 0.0);
        count += 1;
    }
    assert!(count > 100);
}

struct Case {
    mine: Mine,
    sights: Vec<[f64; 6]>,
}

fn sight_cases() -> Vec<Case> {
    let mut by_case: BTreeMap<usize, Vec<Vec<&str>>> = BTreeMap::new();
    for row in rows(include_str!("reference/sights.csv")) {
        by_case.entry(row[0].parse().unwrap()).or_default().push(row);
    }
    let case = |rows: Vec<Vec<&str>>| {
        let mut plan = plan(Vec::new());
        let mut sights = Vec::new();
        for (number, row) in rows.iter().enumerate() {
            match row[1] {
                "roadway" => {
                    let points: Vec<[f64; 3]> = pairs(row[3]).iter().map(|p| [p[0], p[1], 0.0]).collect();
                    plan.roadways.push(roadway(&format!("r{number}"), row[2].parse().unwrap(), &points));
                }
                "pillar" => plan.pillars.push(Pillar {
                    id: format!("p{number}"),
                    level: "floor".into(),
                    height_m: None,
                    outline_m: pairs(row[3]),
                }),
                _ => sights.push(numbers(row[3]).try_into().unwrap()),
            }
        }
        // These corridors cross as they like: the checks' complaints are not what is tested.
        let errors = adit_mine::check(&plan);
        assert!(!errors.iter().any(|f| matches!(f.problem, adit_mine::Problem::UnknownReference { .. })));
        Case { mine: Mine::unchecked(plan), sights }
    };
    by_case.into_values().map(case).collect()
}

#[test]
fn rock_and_pillars_on_a_line_of_sight_are_those_of_geos() {
    let (mut clear, mut blocked, mut through) = (0, 0, 0);
    for Case { mine, sights } in sight_cases() {
        for [ax, ay, bx, by, rock_m, pillar_m] in sights {
            let (a, b) = (Position::new(ax, ay, 1.5), Position::new(bx, by, 1.5));
            let sight = mine.sight(&a, &b);
            // A circle of 4096 sides lies up to 1e-6 m inside the true one; a line that enters at a grazing angle of
            // 3° meets it 2e-5 m later, and at a tangent up to the root of the two: 2 mm.
            assert!((sight.rock_m - rock_m).abs() < 4e-3, "{ax} {ay} {bx} {by}: {sight:?}, shapely {rock_m}");
            assert!(
                (sight.pillar_m - pillar_m).abs() < 1e-9,
                "{ax} {ay} {bx} {by}: {sight:?}, shapely {pillar_m}"
            );
            assert_eq!(sight.pillars > 0, pillar_m > 0.0);
            clear += usize::from(rock_m == 0.0);
            blocked += usize::from(rock_m > 0.0);
            through += usize::from(pillar_m > 0.0);
            // Seen from the other end it is the same.
            let back = mine.sight(&b, &a);
            assert!(
                (back.rock_m - sight.rock_m).abs() < 1e-9 && (back.pillar_m - sight.pillar_m).abs() < 1e-9
            );
        }
    }
    assert!(clear > 30 && blocked > 100 && through > 30, "{clear} {blocked} {through}");
}

#[derive(Default)]
struct Maze {
    roadways: Vec<Vec<f64>>,
    ways: Vec<Vec<f64>>,
}

#[test]
fn shortest_ways_are_those_of_networkx() {
    let mut mazes: BTreeMap<usize, Maze> = BTreeMap::new();
    for row in rows(include_str!("reference/routes.csv")) {
        let maze = mazes.entry(row[0].parse().unwrap()).or_default();
        if row[1] == "roadway" {
            maze.roadways.push(numbers(row[2]));
        } else {
            maze.ways.push(numbers(row[2]));
        }
    }
    let (mut found, mut none) = (0, 0);
    for Maze { roadways, ways } in mazes.into_values() {
        let roadways = roadways.iter().enumerate().map(|(number, points)| {
            let points: Vec<[f64; 3]> = points.chunks(3).map(|p| [p[0], p[1], p[2]]).collect();
            roadway(&format!("r{number}"), 3.0, &points)
        });
        let mine = Mine::unchecked(plan(roadways.collect()));
        let network = mine.network();
        for way in ways {
            let [first, s, last, t, expected] = way[..] else { unreachable!("five numbers") };
            // Each roadway is one edge, in order.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "small whole numbers"
            )]
            let spot = |number: f64, along_m| Spot { edge: EdgeId(number as u32), along_m };
            let route = network.route(&spot(first, s), &spot(last, t), Travel::OnFoot);
            let Some(route) = route else {
                assert!(expected < 0.0);
                none += 1;
                continue;
            };
            assert!((route.length_m - expected).abs() < 1e-9, "{way:?}: {}", route.length_m);
            let legs: f64 = route.legs.iter().map(|leg| (leg.to_m - leg.from_m).abs()).sum();
            assert!((legs - expected).abs() < 1e-9, "{way:?}: {legs}");
            found += 1;
        }
    }
    assert!(found > 100 && none > 0, "{found} {none}");
}

#[test]
fn a_fitted_grid_is_utm_as_proj_knows_it() {
    let mut points = Vec::new();
    let mut tests = Vec::new();
    for (number, row) in rows(include_str!("reference/grid.csv")).enumerate() {
        let v: Vec<f64> = row[1..].iter().map(|n| n.parse().unwrap()).collect();
        let grid_m = Position::new(v[0], v[1], v[2]);
        if row[0] == "control" {
            let (longitude_deg, latitude_deg, height_m) = (v[3], v[4], v[5]);
            points.push(ControlPoint {
                id: format!("k{number}"),
                grid_m,
                latitude_deg,
                longitude_deg,
                height_m,
            });
        } else {
            tests.push((grid_m, v));
        }
    }
    for fit in [Fit::Similarity, Fit::Affine] {
        let tie = GridTie::fit(&points, fit).unwrap();
        // PROJ's scale is that on the ellipsoid; 344.25 m above it a degree is longer by that over the Earth's radius.
        let centre = &tests[tests.len() / 2].1;
        let expected = (1.0 + 344.25 / 6.38e6) / centre[7];
        assert!((tie.scale() - expected).abs() < 2e-6, "{} {expected}", tie.scale());
        // Over 2 km UTM turns by 0.04° and stretches by 1e-5: a centimetre.
        assert!((tie.convergence_rad().to_degrees() - centre[6]).abs() < 0.01);
        assert!(tie.residuals().iter().all(|r| r.horizontal_m < 0.03 && r.vertical_m < 1e-9));
        for (grid_m, v) in &tests {
            let place = tie.to_geodetic(grid_m).unwrap();
            let north_m = (place.latitude_rad - v[4].to_radians()) * 6.38e6;
            let east_m = (place.longitude_rad - v[3].to_radians()) * 6.38e6 * place.latitude_rad.cos();
            assert!(north_m.hypot(east_m) < 0.03, "{grid_m:?}: {north_m} {east_m}");
            assert!((place.height_m - v[5]).abs() < 1e-9, "points are plumbed down the shaft");
            let back = tie.to_grid(&place).unwrap();
            // Nanoradians of the Earth's circumference are millimetres; roundings of f64 a thousand times less.
            assert!((back - *grid_m).norm() < 1e-6, "{back:?}");
        }
    }
}

#[test]
fn grids_of_the_epsg_registry_are_those_of_proj() {
    for row in rows(include_str!("reference/projections.csv")).skip(1) {
        let v: Vec<f64> = row.iter().map(|n| n.parse().unwrap()).collect();
        let projection = Projection::epsg(row[0].parse().unwrap()).unwrap();
        let place = Geodetic::from_degrees(v[1], v[2], -420.0).unwrap();
        let expected = Position::new(v[3], v[4], -420.0);
        let grid = projection.to_grid(&place).unwrap();
        // Six decimals are printed; PROJ's own series are good to a micrometre and less.
        assert!((grid - expected).norm() < 1e-5, "EPSG:{} {grid:?}", row[0]);
        let back = projection.to_geodetic(&expected).unwrap();
        let off_m =
            6.38e6 * (back.latitude_rad - place.latitude_rad).hypot(back.longitude_rad - place.longitude_rad);
        assert!(
            off_m < 1e-5 && back.height_m.to_bits() == place.height_m.to_bits(),
            "EPSG:{} {off_m}",
            row[0]
        );
        // A conformal grid turns by some 1e-8 rad per metre. LAEA shears: its north is not square to its east, and PROJ tells another angle.
        let convergence_deg = projection.convergence_rad(&expected).unwrap().to_degrees();
        let tolerance_deg = if row[0] == "3035" { 1e-3 } else { 1e-5 };
        assert!((convergence_deg - v[5]).abs() < tolerance_deg, "EPSG:{} {convergence_deg}", row[0]);
    }
}
