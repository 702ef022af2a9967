//! The mines that ship: sound, as large as they claim, and made anew by the command that their head names.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;
#[path = "../examples/two_level_mine.rs"]
#[expect(dead_code, reason = "its main is the example's")]
mod two_level_mine;

use adit_core::frames::Position;
use adit_mine::file::{check, schema, to_toml};
use adit_mine::network::Travel;
use adit_mine::plan::ZoneKind;
use adit_mine::{Mine, Summary};
use common::shipped;

fn sound(name: &str) -> Mine {
    let checked = check(&shipped(name)).unwrap();
    assert!(checked.notices.is_empty(), "{name}: {:?}", checked.notices);
    checked.mine.unwrap()
}

#[test]
fn the_haulage_roadway_is_that_of_s1() {
    let mine = sound("haulage.toml");
    let edge = &mine.network().edges()[0];
    // The points are rounded to the centimetre.
    assert!((edge.length_m() - 580.0).abs() < 0.02, "{}", edge.length_m());
    let along: Vec<f64> = mine
        .plan()
        .access_points
        .iter()
        .map(|p| mine.network().nearest(&p.position_m).unwrap().spot.along_m)
        .collect();
    for pair in along.windows(2) {
        assert!((50.0..=80.0).contains(&(pair[1] - pair[0])), "{pair:?}");
    }
    // From one end to the other there is an access point within 40 m.
    assert!(along[0] < 40.0 && 580.0 - along[along.len() - 1] < 40.0);
    assert_eq!(mine.plan().conveyors.len(), 1);
}

#[test]
fn the_laboratory_has_four_anchors_on_a_parallelogram_with_diagonals_of_two_heights() {
    let mine = sound("lab.toml");
    let [a, b, c, d] = mine.plan().anchors.as_slice() else { unreachable!("four anchors") };
    let [a, b, c, d] = [a, b, c, d].map(|anchor| *anchor.position_m.raw());
    assert_eq!((b - a).xy(), (c - d).xy());
    assert_eq!((a.z, b.z), (c.z, d.z));
    assert!((a.z - b.z).abs() > 1.0);
}

#[test]
fn every_walk_of_the_laboratory_has_places_with_and_without_line_of_sight_to_each_anchor() {
    let mine = sound("lab.toml");
    for anchor in &mine.plan().anchors {
        let (mut clear, mut blocked) = (0, 0);
        for edge in mine.network().edges() {
            for step in 0..=20 {
                let floor = edge.at(edge.length_m() * f64::from(step) / 20.0);
                let tag = Position::new(floor.raw().x, floor.raw().y, 1.1);
                let sight = mine.sight(&tag, &anchor.position_m);
                assert!(sight.rock_m < 1e-9, "the hall is one room");
                if sight.is_clear() { clear += 1 } else { blocked += 1 }
            }
        }
        assert!(clear > 20 && blocked > 10, "{}: {clear} clear, {blocked} blocked", anchor.id);
    }
}

#[test]
fn the_two_level_mine_is_made_anew_byte_for_byte() {
    let made = to_toml(&two_level_mine::plan(two_level_mine::SEED)).unwrap();
    let shipped = std::fs::read_to_string(shipped("two-level.toml")).unwrap();
    let (head, body) = shipped.split_once('\n').unwrap();
    assert!(head.starts_with("# Made by: cargo run -p adit-mine --example two_level_mine"));
    assert!(body == made, "mines/two-level.toml is not what its command makes");
}

#[test]
fn other_seeds_make_other_sound_mines() {
    for seed in 2..8 {
        let plan = two_level_mine::plan(seed);
        assert!(adit_mine::check(&plan).is_empty(), "{seed}: {:?}", adit_mine::check(&plan));
        assert_ne!(plan.roadways, two_level_mine::plan(1).roadways);
    }
}

#[test]
fn the_two_level_mine_has_12_km_and_refuges_for_200() {
    let mine = sound("two-level.toml");
    let summary = Summary::of(&mine);
    assert!((11_500.0..12_500.0).contains(&summary.roadway_m), "{}", summary.roadway_m);
    assert!(summary.zones.refuge_capacity >= 200);
    assert_eq!((summary.components, summary.levels.len()), (1, 3));
}

#[test]
fn from_everywhere_in_the_two_level_mine_a_refuge_and_a_way_out_can_be_walked_to() {
    let mine = sound("two-level.toml");
    let spots = |kind| {
        let zones = mine.plan().zones.iter().filter(move |zone| zone.kind == kind);
        zones.flat_map(|zone| mine.spots_in(zone)).collect::<Vec<_>>()
    };
    let (refuges, portals) = (spots(ZoneKind::Refuge), spots(ZoneKind::Portal));
    assert_eq!(refuges.len(), 4);
    for edge in mine.network().edges() {
        let middle = mine.network().nearest(&edge.at(0.5 * edge.length_m())).unwrap().spot;
        let (_, to_refuge) = mine.network().nearest_of(&middle, &refuges, Travel::OnFoot).unwrap();
        let (_, way_out) = mine.network().nearest_of(&middle, &portals, Travel::OnFoot).unwrap();
        // Down the whole decline from its portal, 2.4 km, and half a level.
        assert!(to_refuge.length_m < 3_000.0 && way_out.length_m < 3_500.0, "{middle:?}");
    }
}

#[test]
fn the_schema_that_ships_is_that_of_the_types() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../schema/mine.schema.json");
    let shipped = std::fs::read_to_string(path).unwrap();
    assert!(
        shipped == format!("{:#}\n", schema()),
        "run: cargo run -p adit-mine --example mine_schema > schema/mine.schema.json"
    );
}
