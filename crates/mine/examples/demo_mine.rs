//! The mine of `adit demo`, `mines/demo.toml`: `cargo run -p adit-mine --example demo_mine`.
//!
//! The two-level mine, with roadways into its refuges, workshops and magazines, and as many places in refuges as there are people in a shift.
#![expect(clippy::print_stdout, reason = "an example that prints")]

#[path = "two_level_mine.rs"]
#[expect(dead_code, reason = "its own program is not run here")]
mod two_level_mine;

use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::plan::{Anchor, MinePlan, Roadway, RoadwayKind, ZoneKind};

/// Places in each of the four refuges.
const PLACES: u32 = 80;
/// Rooms and the crosscut that each is entered from.
const ROOMS: [(&str, usize); 4] = [("refuge-1", 2), ("refuge-2", 7), ("workshop", 4), ("magazine", 1)];

fn main() -> Result<(), adit_mine::MineError> {
    let mut plan = two_level_mine::plan(two_level_mine::SEED);
    plan.name = "Demo mine".into();
    for level in ["l300", "l360"] {
        for (room, crosscut) in ROOMS {
            open(&mut plan, level, room, &format!("{level}-crosscut-{crosscut}"));
        }
    }
    for zone in plan.zones.iter_mut().filter(|zone| zone.kind == ZoneKind::Refuge) {
        zone.capacity = Some(PLACES);
    }
    print!("# Made by: cargo run -p adit-mine --example demo_mine\n{}", adit_mine::file::to_toml(&plan)?);
    Ok(())
}

/// Leads a roadway from a crosscut through the middle of a room, with an anchor over its end.
fn open(plan: &mut MinePlan, level: &str, room: &str, crosscut: &str) {
    let zone = format!("{level}-{room}");
    let Some(zone) = plan.zones.iter().find(|z| z.id == zone) else { return };
    let middle_y = 0.5 * (zone.outline_m[0][1] + zone.outline_m[2][1]);
    let far_x = zone.outline_m[1][0] - 1.0;
    let Some(crosscut) = plan.roadways.iter_mut().find(|r| r.id == crosscut) else { return };
    let (from, to) = (*crosscut.points_m[0].raw(), *crosscut.points_m[1].raw());
    let cm = |v: f64| (100.0 * v).round() / 100.0;
    let door = (from + (to - from) * ((middle_y - from.y) / (to.y - from.y))).map(cm);
    crosscut.points_m.insert(1, Position::from_raw(door));
    let end = Vector3::new(far_x, door.y, door.z);
    plan.roadways.push(Roadway {
        id: format!("{level}-{room}-way"),
        name: None,
        level: Some(level.into()),
        kind: RoadwayKind::Drift,
        width_m: 4.0,
        height_m: 3.0,
        max_slope_percent: Some(3.0),
        walkable: true,
        points_m: vec![Position::from_raw(door), Position::from_raw(end)],
    });
    plan.anchors.push(Anchor {
        id: format!("a-{level}-{room}"),
        position_m: Position::from_raw((end + Vector3::new(-0.5, 1.2, 2.5)).map(cm)),
        range_offset_m: None,
        antenna_delay_ns: Some(515.0),
        tx_power_dbm: None,
    });
}
