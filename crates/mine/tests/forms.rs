//! One mine in several forms: nothing is lost on the way from one to another, and mistakes keep their line.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::frames::Position;
use adit_mine::file::{Form, parse, to_geojson, to_json, to_toml};
use adit_mine::plan::{
    AccessPoint, Anchor, ControlPoint, Door, DoorKind, Fit, Grid, Level, MinePlan, PathLoss, Radio,
    RoadwayKind, Zone, ZoneKind,
};
use common::{plan, roadway, shipped};
use proptest::prelude::*;
use std::path::Path;

/// The plan in a text of one of the forms.
fn read(name: &str, text: &str) -> (Form, MinePlan) {
    let checked = parse(Path::new(name), text.as_bytes());
    assert!(checked.notices.is_empty(), "{:?}\n{text}", checked.notices);
    (checked.form, checked.mine.unwrap().plan().clone())
}

/// Through every form and back.
fn round(plan: &MinePlan) {
    let texts = [
        (Form::Toml, to_toml(plan).unwrap()),
        (Form::Json, to_json(plan).unwrap()),
        (Form::GeoJson, to_geojson(plan).unwrap()),
    ];
    for (form, text) in &texts {
        let (found, back) = read("mine", text);
        assert_eq!(found, *form);
        assert_eq!(back, *plan, "through {form:?}");
        // And written again it is the same text.
        let again = match form {
            Form::Toml => to_toml(&back),
            Form::Json => to_json(&back),
            _ => to_geojson(&back),
        };
        assert!(again.unwrap() == *text, "{form:?}");
    }
}

#[test]
fn the_mines_that_ship_survive_every_form() {
    for name in ["haulage.toml", "lab.toml", "two-level.toml"] {
        let text = std::fs::read_to_string(shipped(name)).unwrap();
        round(&read(name, &text).1);
    }
}

#[test]
fn what_programs_build_is_what_files_say() {
    let mut built = plan(vec![roadway("main", 5.0, &[[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]])]);
    built.zones.push(portal());
    let text = "name = \"test\"\n[grid]\nkind = \"local\"\n[[levels]]\nid = \"floor\"\nelevation_m = 0\n\
        [[roadways]]\nid = \"main\"\nwidth_m = 5\nheight_m = 3\npoints_m = [[0, 0, 0], [50, 0, 0]]\n\
        [[zones]]\nid = \"out\"\nkind = \"portal\"\nlevel = \"floor\"\n\
        # Clockwise in the file; kept counter-clockwise.\n\
        outline_m = [[0, 0], [0, 3], [3, 3], [3, 0]]\n";
    assert_eq!(read("mine.toml", text).1, built);
}

fn portal() -> Zone {
    Zone {
        id: "out".into(),
        name: None,
        kind: ZoneKind::Portal,
        level: "floor".into(),
        capacity: None,
        exit_tolerance_m: 0.0,
        exit_delay_s: 0.0,
        outline_m: vec![[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]],
    }
}

/// Any finite number that a survey could hold, with all its digits.
fn metres(limit: f64) -> impl Strategy<Value = f64> {
    -limit..limit
}

fn text() -> impl Strategy<Value = String> {
    // Quotes, backslashes, newlines, other alphabets: whatever a name may have.
    "[ -~äßж井\\n\\t\"\\\\]{0,20}"
}

prop_compose! {
    fn sound_plan()(
        x in metres(1e6), y in metres(1e6), z in metres(4e3),
        length in 20.0..500.0_f64, width in 3.0..9.0_f64, name in text(), zone_name in proptest::option::of(text()),
        offset in proptest::option::of(metres(1.0)), loss in proptest::option::of((metres(90.0), 0.1..6.0_f64, proptest::option::of((1.0..99.0_f64, 0.1..9.0_f64)))),
        walkable: bool, closed: bool, kind in 0..3_usize, epsg: bool, code in proptest::sample::select(vec![4547_u32, 25832, 28350, 32633, 31983]), pressure in proptest::option::of(metres(500.0)),
    ) -> MinePlan {
        // Where these projections are made for.
        let (x, y) = if epsg { (5e5 + 0.1 * x, 5e6 + 0.1 * y) } else { (x, y) };
        let grid = if epsg { Grid::Epsg { code } } else { Grid::Local {} };
        let mut plan = MinePlan::new(name, grid);
        plan.levels.push(Level { id: "floor".into(), name: zone_name.clone(), elevation_m: z });
        let mut main = roadway("main", width, &[[x, y, z], [x + length, y, z], [x + length, y + length / 3.0, z + 0.1]]);
        main.walkable = walkable;
        main.level = Some("floor".into());
        main.kind = [RoadwayKind::Drift, RoadwayKind::Haulage, RoadwayKind::Ventilation][kind];
        plan.roadways.push(main);
        plan.zones.push(Zone {
            name: zone_name,
            capacity: Some(7),
            exit_tolerance_m: width / 7.0,
            outline_m: vec![[x, y], [x + 3.0, y], [x + 3.0, y + 1.0 / 3.0]],
            ..portal()
        });
        plan.anchors.push(Anchor {
            id: "a 1".into(),
            position_m: Position::new(x + 1.0 / 3.0, y, z + 2.0),
            range_offset_m: offset,
            antenna_delay_ns: Some(515.0 + width),
            tx_power_dbm: None,
        });
        plan.access_points.push(AccessPoint {
            id: "ü".into(),
            radio: if closed { Radio::Ble } else { Radio::Wifi },
            mac: None,
            position_m: Position::new(x + 7.0, y, z + 2.0),
            tx_power_dbm: Some(-0.0),
            path_loss: loss.map(|(rssi_at_1m_dbm, exponent, beyond)| PathLoss {
                rssi_at_1m_dbm,
                exponent,
                breakpoint_m: beyond.map(|b| b.0),
                exponent_beyond: beyond.map(|b| b.1),
            }),
        });
        plan.doors.push(Door {
            id: "door".into(),
            kind: DoorKind::Fire,
            level: "floor".into(),
            closed,
            pressure_step_pa: pressure,
            attenuation_db: None,
            ends_m: [[x + 9.0, y - 0.5 * width], [x + 9.0, y + 0.5 * width]],
        });
        plan
    }
}

proptest! {
    #[test]
    fn any_sound_plan_survives_every_form(plan in sound_plan()) {
        round(&plan.canonical());
    }
}

#[test]
fn control_points_survive_every_form() {
    let point = |id: &str, grid_m, latitude_deg, longitude_deg| ControlPoint {
        id: id.into(),
        grid_m,
        latitude_deg,
        longitude_deg,
        height_m: 1.0 / 3.0,
    };
    let mut plan = plan(vec![roadway("main", 5.0, &[[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]])]);
    plan.zones.push(portal());
    plan.grid = Grid::ControlPoints {
        fit: Fit::Similarity,
        tolerance_m: 2.0,
        points: vec![
            point("a", Position::new(0.0, 0.0, 0.0), 50.92, 13.34),
            point("b", Position::new(703.19, 0.05, 0.0), 50.92, 13.35),
            point("c", Position::new(0.0, 1112.48, 0.0), 50.93, 13.34),
        ],
    };
    round(&plan);
}

#[test]
fn a_list_of_anchors_is_a_mine_of_anchors() {
    let text = "# surveyed 2024\nz_m, anchor_id,x_m,y_m\n2.5,A1,0,0.25\n2.5,A2,10,0\n";
    let checked = parse(Path::new("anchors.csv"), text.as_bytes());
    assert_eq!(checked.form, Form::AnchorsCsv);
    assert_eq!(checked.errors().count(), 0);
    assert_eq!(checked.warnings().count(), 1, "nothing is excavated");
    let plan = checked.mine.unwrap().plan().clone();
    assert_eq!(plan.anchors[0].position_m, Position::new(0.0, 0.25, 2.5));
    assert_eq!(plan.anchors[1].id, "A2");
    assert_eq!(plan.anchors[0].range_offset_m, None);
}

#[test]
fn a_list_of_anchors_may_tell_what_they_add_to_ranges() {
    for name in ["range_offset_m", "sfuise_range_offset_m"] {
        let text = format!("anchor_id,x_m,y_m,z_m,{name}\nA1,0,0,2,0.46\nA2,9,0,2,\n");
        let plan = parse(Path::new("anchors.csv"), text.as_bytes()).mine.unwrap().plan().clone();
        assert_eq!((plan.anchors[0].range_offset_m, plan.anchors[1].range_offset_m), (Some(0.46), None));
    }
    let both = "anchor_id,x_m,y_m,z_m,range_offset_m,sfuise_range_offset_m\nA,0,0,2,0,0\n";
    assert!(
        told("a.csv", both).starts_with("a.csv:1: error: key `sfuise_range_offset_m` stands here twice"),
        "{}",
        told("a.csv", both)
    );
    let not = "anchor_id,x_m,y_m,z_m,range_offset_m\nA,0,0,2,far\n";
    assert!(
        told("a.csv", not).starts_with("a.csv:2: error: `range_offset_m`: found \"far\""),
        "{}",
        told("a.csv", not)
    );
}

/// The first message about a file.
fn told(name: &str, text: &str) -> String {
    let checked = parse(Path::new(name), text.as_bytes());
    assert!(checked.mine.is_none());
    checked.errors().next().unwrap().to_string()
}

#[test]
fn a_list_of_anchors_with_a_mistake_is_told_with_its_line() {
    let header = "anchor_id,x_m,y_m,z_m\n";
    let cases = [
        ("# old\n\nanchor_id,x_m,y_m\nA,1,2\n".to_owned(), "a.csv:3: error: `z_m` is missing"),
        ("anchor_id,x_m,y_m\nA,1,2\n".to_owned(), "a.csv:1: error: `z_m` is missing"),
        ("anchor_id,x_ft,y_m,z_m\n".to_owned(), "a.csv:1: error: unknown key `x_ft`"),
        (format!("{header}A,1,2,3\nB,1,2,up\n"), "a.csv:3: error: `z_m`: found \"up\", expected a number"),
        (format!("{header}A,1,2,3\nB,1,2\n"), "a.csv:3: error: found 3 fields, expected 4"),
        (
            format!("{header}A,1,2,3\n\nA,1,2,4\n"),
            "a.csv:4: error: anchor A: id \"A\" is also that of anchor 1",
        ),
        (format!("{header}A,1,NaN,3\n"), "a.csv:2: error: anchor A: `position_m[1]`: found NaN"),
    ];
    for (text, expected) in cases {
        let message = told("a.csv", &text);
        assert!(message.starts_with(expected), "{message}\n{expected}");
    }
}

#[test]
fn a_geojson_file_with_a_mistake_is_told_with_its_line() {
    let mine = "{\"type\": \"FeatureCollection\",\n\"mine\": {\"name\": \"m\", \"grid\": {\"kind\": \"local\"}},\n\"features\": [\n";
    let road = r#"{"type": "Feature", "id": "r", "geometry": {"type": "LineString", "coordinates": [[0, 0, 0], [9, 0, 0]]}, "properties": {"feature": "roadway", "width_m": 4, "height_m": 3, "capacity": null}}"#;
    let good = format!("{mine}{road}\n]}}");
    let checked = parse(Path::new("m.geojson"), good.as_bytes());
    assert_eq!((checked.form, checked.errors().count()), (Form::GeoJson, 0), "{:?}", checked.notices);
    let cases = [
        (good.replace("\"roadway\"", "\"tunnel\""), "m.geojson:4: error: feature: unknown \"tunnel\""),
        (
            good.replace("\"feature\": \"roadway\", ", ""),
            "m.geojson:4: error: feature: property `feature` is missing",
        ),
        (
            good.replace("LineString", "Point"),
            "m.geojson:4: error: feature: found Point, expected a LineString",
        ),
        (
            good.replace("\"width_m\": 4", "\"width_m\": \"4\""),
            "m.geojson:4: error: roadway r: `width_m`: found \"4\"",
        ),
        (good.replace("\"width_m\": 4, ", ""), "m.geojson:4: error: roadway r: `width_m` is missing"),
        (
            good.replace("[9, 0, 0]", "[9, 0]"),
            "m.geojson:4: error: roadway r: `points_m[1]`: found a list of 2",
        ),
        (good.replace("\"name\": \"m\", ", ""), "m.geojson:1: error: `name` is missing"),
        (good.replace("9, 0, 0", "9, 0, 0,"), "m.geojson:4: error: "),
        (
            good.replace("\"id\": \"r\"", "\"id\": \"r\", \"id\": \"s\""),
            "m.geojson:4: error: key `id` stands here twice",
        ),
    ];
    for (text, expected) in cases {
        let message = told("m.geojson", &text);
        assert!(message.starts_with(expected), "{message}\n{expected}");
    }
}

#[test]
fn what_is_no_mine_is_told() {
    for (text, expected) in [
        ("", "`name` is missing"),
        ("{", ""),
        ("{}", "`name` is missing"),
        ("[1]", ""),
        ("name = 3", "`name`: found 3, expected text"),
        ("\u{feff}name = 3", "`name`: found 3"),
        ("{\"type\": \"FeatureCollection\"}", "`name` is missing"),
        ("roadways = 3\nname = \"x\"\ngrid = { kind = \"local\" }", "`roadways`: found 3, expected a list"),
    ] {
        let checked = parse(Path::new("x"), text.as_bytes());
        let messages: Vec<String> = checked.errors().map(ToString::to_string).collect();
        assert!(messages.iter().any(|m| m.contains(expected)), "{text}: {messages:?}");
    }
    let bytes = parse(Path::new("x"), b"name = \"\xff\"");
    assert!(bytes.errors().next().unwrap().to_string().starts_with("x:1: error: not UTF-8 text"));
    // Nested deeper than any mine, and than the stack.
    for deep in ["[".repeat(100_000), "{\"a\":".repeat(100_000), format!("a = {}", "[".repeat(100_000))] {
        told("deep", &deep);
    }
}
