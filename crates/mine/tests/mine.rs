//! What the mine answers: levels, zones, sight, the grid on the Earth.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::frames::{Enu, Position};
use adit_core::geodesy::Geodetic;
use adit_mine::grid_tie::{GridTie, TieError};
use adit_mine::plan::{
    Chamber, ControlPoint, Door, DoorKind, Fit, Grid, Level, MinePlan, Pillar, Zone, ZoneKind,
};
use adit_mine::projection::{Projection, ProjectionError};
use adit_mine::{Mine, plan_view};
use common::{plan, roadway};

fn two_levels() -> MinePlan {
    let mut plan = plan(vec![
        roadway("upper", 5.0, &[[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]),
        roadway("lower", 5.0, &[[0.0, 0.0, -40.0], [100.0, 0.0, -40.0]]),
        roadway("ramp", 5.0, &[[100.0, 0.0, 0.0], [400.0, 0.0, -20.0], [100.0, 0.0, -40.0]]),
    ]);
    plan.levels.push(Level { id: "deep".into(), name: None, elevation_m: -40.0 });
    for (id, level) in [("in-upper", "floor"), ("in-lower", "deep")] {
        plan.zones.push(Zone {
            id: id.into(),
            name: None,
            kind: ZoneKind::Key,
            level: level.into(),
            capacity: None,
            exit_tolerance_m: 2.0,
            exit_delay_s: 0.0,
            outline_m: vec![[10.0, -3.0], [20.0, -3.0], [20.0, 3.0], [10.0, 3.0]],
        });
    }
    plan
}

#[test]
fn heights_belong_to_the_nearest_level_and_zones_to_theirs() {
    let mine = Mine::new(two_levels()).unwrap();
    for (z, level) in [(500.0, "floor"), (0.0, "floor"), (-19.9, "floor"), (-20.1, "deep"), (-900.0, "deep")]
    {
        assert_eq!(mine.level_at(z).unwrap().id, level, "{z}");
    }
    assert_eq!(mine.band_m("deep"), Some((f64::NEG_INFINITY, -20.0)));
    assert_eq!(mine.band_m("attic"), None);
    let zones =
        |z| mine.zones_at(&Position::new(15.0, 1.0, z)).map(|zone| zone.id.clone()).collect::<Vec<_>>();
    assert_eq!(zones(1.0), ["in-upper"]);
    assert_eq!(zones(-39.0), ["in-lower"]);
    assert!(mine.zones_at(&Position::new(25.0, 1.0, 1.0)).next().is_none());
}

#[test]
fn somebody_on_the_line_of_a_zone_does_not_come_and_go() {
    let mine = Mine::new(two_levels()).unwrap();
    let zone = &mine.plan().zones[0];
    let mut inside = false;
    let mut changes = 0;
    // Steps to and fro over the line at x = 10, by less than the tolerance, then away.
    for x in [8.0, 9.5, 10.5, 9.0, 10.2, 8.5, 11.0, 8.1, 7.9, 9.9, 10.0] {
        let now = zone.holds(inside, x, 0.0);
        changes += u32::from(now != inside);
        inside = now;
    }
    assert_eq!((inside, changes), (true, 3), "in, out at 7.9 m, in on the line");
}

#[test]
fn levels_do_not_see_each_other_through_rock() {
    let mine = Mine::new(two_levels()).unwrap();
    let sight = mine.sight(&Position::new(50.0, 0.0, 1.0), &Position::new(50.0, 0.0, -39.0));
    // From the floor of one to the roof of the other.
    assert!((sight.rock_m - 37.0).abs() < 1e-5, "{sight:?}");
    assert!(mine.sight(&Position::new(1.0, 1.0, 1.0), &Position::new(99.0, -1.0, 2.0)).is_clear());
}

#[test]
fn pillars_block_as_high_as_they_are_and_doors_while_they_are_closed() {
    let mut plan = two_levels();
    let stone = vec![[40.0, -1.0], [42.0, -1.0], [42.0, 1.0], [40.0, 1.0]];
    let pillar = |id: &str, height_m| Pillar {
        id: id.into(),
        level: "floor".into(),
        height_m,
        outline_m: stone.clone(),
    };
    plan.pillars = vec![pillar("tall", None)];
    let (low, high) = (1.0, 2.8);
    let at = |x, z| Position::new(x, 0.0, z);
    let tall = Mine::new(plan.clone()).unwrap();
    let sight = tall.sight(&at(30.0, low), &at(50.0, low));
    assert_eq!((sight.pillars, sight.rock_m), (1, 0.0));
    assert!((sight.pillar_m - 2.0).abs() < 1e-12 && !sight.is_clear());
    // Along its face, and on the level below, nothing is in the way.
    assert!(tall.sight(&Position::new(30.0, 1.0, low), &Position::new(50.0, 1.0, low)).is_clear());
    assert!(tall.sight(&at(30.0, -39.0), &at(50.0, -39.0)).is_clear());

    plan.pillars = vec![pillar("low", Some(2.0))];
    let short = Mine::new(plan.clone()).unwrap();
    assert!(short.sight(&at(30.0, high), &at(50.0, high)).is_clear());
    assert!(!short.sight(&at(30.0, low), &at(50.0, low)).is_clear());
    // Down from above it: the line passes 2 m height at 3/4 of the way over the pillar.
    let slanted = short.sight(&at(40.0, 3.5), &at(42.0, 1.5));
    assert!((slanted.pillar_m - 0.25 * slanted.distance_m).abs() < 1e-12, "{slanted:?}");

    plan.pillars.clear();
    let ends_m = [[60.0, -2.5], [60.0, 2.5]];
    let door = |closed| Door {
        id: "door".into(),
        kind: DoorKind::Ventilation,
        level: "floor".into(),
        closed,
        pressure_step_pa: None,
        attenuation_db: None,
        ends_m,
    };
    for (closed, doors) in [(true, 1), (false, 0)] {
        plan.doors = vec![door(closed)];
        let mine = Mine::new(plan.clone()).unwrap();
        assert_eq!(mine.sight(&at(50.0, low), &at(70.0, low)).doors, doors);
        assert_eq!(mine.sight(&at(50.0, -39.0), &at(70.0, -39.0)).doors, 0);
    }
}

#[test]
fn a_chamber_joins_the_roadway_that_it_touches() {
    let mut plan = two_levels();
    let outline_m = vec![[50.0, 2.5], [60.0, 2.5], [60.0, 12.0], [50.0, 12.0]];
    plan.chambers.push(Chamber { id: "room".into(), name: None, floor_m: 0.0, height_m: 3.0, outline_m });
    let mine = Mine::new(plan).unwrap();
    assert!(mine.sight(&Position::new(55.0, 0.0, 1.0), &Position::new(55.0, 11.0, 1.0)).is_clear());
    // Past its corner there are 2.5 m less 5/12 of rock in 12 m: similar triangles.
    let blind = mine.sight(&Position::new(61.0, 0.0, 1.0), &Position::new(61.0, 11.0, 1.0));
    assert!((blind.rock_m - 8.5).abs() < 1e-5, "{blind:?}");
}

/// Control points of a grid that is turned, stretched and shifted by known amounts, on the tangent plane itself.
fn control(turn_rad: f64, scale: [f64; 2], errors: [f64; 4]) -> Vec<ControlPoint> {
    let origin = Geodetic::from_degrees(26.5, 106.7, 1250.0).unwrap();
    let to_ecef = origin.enu_frame().inverse();
    let places = [[0.0, 0.0], [900.0, 50.0], [850.0, 700.0], [-40.0, 620.0]];
    let point = |(number, [x, y]): (usize, [f64; 2])| {
        let (sin, cos) = turn_rad.sin_cos();
        let (u, v) = (scale[0] * (x - 427.5), scale[1] * (y - 342.5));
        let (east, north) = (cos * u + sin * v + errors[number], -sin * u + cos * v);
        let on_plane = to_ecef.position(&Position::<Enu>::new(east, north, 0.0));
        let place = Geodetic::from_ecef(&on_plane).unwrap();
        ControlPoint {
            id: format!("k{number}"),
            grid_m: Position::new(x, y, 40.0),
            latitude_deg: place.latitude_rad.to_degrees(),
            longitude_deg: place.longitude_rad.to_degrees(),
            height_m: 1250.0,
        }
    };
    places.into_iter().enumerate().map(point).collect()
}

#[test]
fn a_known_turn_and_scale_are_found_again() {
    for turn_rad in [0.0, 0.02, -0.5, 2.0, -3.0] {
        let tie = GridTie::fit(&control(turn_rad, [1.0003, 1.0003], [0.0; 4]), Fit::Similarity).unwrap();
        // The plane touches 0.2 m under the control points' mean and curves away by d²/2R = 3 cm: some 1e-8 of scale.
        assert!((tie.scale() - 1.0003).abs() < 5e-8, "{}", tie.scale());
        assert!((tie.convergence_rad() - turn_rad).abs() < 1e-7, "{}", tie.convergence_rad());
        assert!(tie.residuals().iter().all(|r| r.horizontal_m < 1e-4 && r.vertical_m < 1e-9));
        // The rigid part agrees with core's own placement, but for the scale.
        let tag = Position::new(600.0, 100.0, 0.0);
        let enu = tie.placement().to_enu().position(&tag);
        let place = tie.origin().enu_frame().position(&tie.to_geodetic(&tag).unwrap().to_ecef());
        // Apart by 0.0003 of 300 m, and by the curve of the Earth in height.
        assert!((enu - place).norm() < 0.12, "{enu:?} {place:?}");
    }
}

#[test]
fn an_affine_fit_takes_unequal_scales_and_a_similarity_shows_them() {
    let skewed = control(0.1, [1.0002, 0.9995], [0.0; 4]);
    let affine = GridTie::fit(&skewed, Fit::Affine).unwrap();
    assert!(affine.residuals().iter().all(|r| r.horizontal_m < 1e-4));
    let similarity = GridTie::fit(&skewed, Fit::Similarity).unwrap();
    assert!(similarity.residuals().iter().all(|r| r.horizontal_m > 0.05));
}

#[test]
fn the_worst_residual_is_that_of_the_wrong_point() {
    let tie = GridTie::fit(&control(0.1, [1.0, 1.0], [0.0, 0.0, 2.0, 0.0]), Fit::Similarity).unwrap();
    let worst = (0..4).max_by(|a, b| {
        let residual = |i: &usize| tie.residuals()[*i].horizontal_m;
        residual(a).total_cmp(&residual(b))
    });
    assert_eq!(worst, Some(2));
}

#[test]
fn control_points_that_fix_nothing_are_refused() {
    let good = control(0.1, [1.0, 1.0], [0.0; 4]);
    assert_eq!(GridTie::fit(&good[..1], Fit::Similarity), Err(TieError::TooFew { found: 1, expected: 2 }));
    assert_eq!(GridTie::fit(&good[..2], Fit::Affine), Err(TieError::TooFew { found: 2, expected: 3 }));
    let mut line = good.clone();
    for (number, point) in (0_u8..).zip(&mut line) {
        point.grid_m = Position::new(100.0 * f64::from(number), 50.0 * f64::from(number), 0.0);
    }
    assert!(matches!(GridTie::fit(&line, Fit::Affine), Err(TieError::OneLine { .. })));
    let mut heap = good.clone();
    for point in &mut heap {
        point.grid_m = Position::new(7.0, 7.0, 7.0);
    }
    assert!(matches!(GridTie::fit(&heap, Fit::Similarity), Err(TieError::OneLine { .. })));
    let mut odd = good;
    odd[3].latitude_deg = f64::NAN;
    assert_eq!(GridTie::fit(&odd, Fit::Similarity), Err(TieError::NotOnEarth { index: 3 }));
}

#[test]
fn a_plan_view_shows_each_level_and_names_nothing_that_breaks_it() {
    let mut plan = two_levels();
    plan.name = "<Mine> & \"Sons\"\u{7}".into();
    let svg = plan_view::draw(&Mine::new(plan).unwrap());
    assert!(svg.contains("&lt;Mine&gt; &amp; &quot;Sons&quot;<"), "{svg}");
    assert!(svg.contains(">floor, 0 m<") && svg.contains(">deep, −40 m<"));
    assert_eq!(svg.matches('<').count(), svg.matches('>').count());
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let empty = plan_view::draw(&Mine::new(MinePlan::new("", adit_mine::plan::Grid::Local {})).unwrap());
    assert!(!empty.contains("NaN") && !empty.contains("inf"));
}

#[test]
fn a_mine_knows_where_on_earth_it_is_whichever_way_its_file_says_so() {
    let mut plan = two_levels();
    plan.grid = Grid::Local {};
    assert!(Mine::unchecked(plan.clone()).georeference().is_none());

    let here = Position::new(500_100.0, 5_641_500.0, -100.0);
    plan.grid = Grid::Epsg { code: 32633 };
    let georeference = Mine::unchecked(plan.clone()).georeference().unwrap();
    let place = georeference.to_geodetic(&here).unwrap();
    // 100 m east of the central meridian of zone 33 (15° E), and north of the parallel of Dresden.
    assert!(
        (place.longitude_rad.to_degrees() - 15.0).abs() < 0.002 && place.latitude_rad.to_degrees() > 50.9
    );
    assert!((georeference.to_grid(&place).unwrap() - here).norm() < 1e-6);

    plan.grid = Grid::ControlPoints {
        fit: Fit::Similarity,
        tolerance_m: 0.1,
        points: control(0.1, [1.0, 1.0], [0.0; 4]),
    };
    let tied = Mine::unchecked(plan).georeference().unwrap();
    assert!((tied.convergence_rad(&here).unwrap() - 0.1).abs() < 1e-7);
}

#[test]
fn codes_that_are_no_grid_of_a_mine_are_refused_and_say_why() {
    let refused = |code| Projection::epsg(code).unwrap_err();
    assert_eq!(refused(4326), ProjectionError::NotProjected { code: 4326 });
    assert_eq!(refused(4978), ProjectionError::NotProjected { code: 4978 });
    assert_eq!(refused(99), ProjectionError::Unknown { code: 99 });
    assert_eq!(refused(1_000_000), ProjectionError::Unknown { code: 1_000_000 });
    // California zone 3, in US survey feet.
    assert!(matches!(refused(2227), ProjectionError::NotMetres { code: 2227, .. }));
    // Every code of the registry gives a grid or a reason.
    let grids = (0..=u32::from(u16::MAX)).filter(|code| Projection::epsg(*code).is_ok()).count();
    assert!(grids > 3000, "{grids}");
}
