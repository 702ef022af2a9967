//! Recorded walks with a phone, in the frame of the building; skipped where the recordings are not at hand.
#![expect(clippy::unwrap_used, reason = "tests")]

#[path = "common/recorded.rs"]
#[expect(dead_code, reason = "every test binary uses its own part")]
mod recorded;

#[path = "../examples/phone_walks.rs"]
#[expect(dead_code, reason = "its other table, and main")]
mod phone_walks;

use std::path::Path;

/// Median and third quartile over all walks of a row of the table, m.
fn all_walks(table: &str, row: &str) -> (f64, f64) {
    let line = table.lines().find(|line| line.contains(row)).unwrap();
    let last = line.trim_end_matches(" |").rsplit('|').next().unwrap();
    let (median, quartile) = last.split_once('/').unwrap();
    (median.trim().parse().unwrap(), quartile.trim().parse().unwrap())
}

#[test]
fn beacons_hold_a_phone_whose_start_is_known() {
    let Some(folder) = recorded::folder("phone-walks") else { return };
    let walks = ["trial21", "trial24", "trial26"].map(String::from);
    let adit = Path::new(env!("CARGO_BIN_EXE_adit"));
    let table = phone_walks::in_the_building(adit, &folder, &walks).unwrap();
    println!("{table}");
    let (median, quartile) = all_walks(&table, "first waypoint told, BLE");
    // The goal of the project; a sample result of IPIN 2023 on other runs of the set: 2.44 and 4.35 m.
    assert!(median < 2.4 && quartile < 4.3, "{median} {quartile}");
    let alone = all_walks(&table, "first waypoint told, no radio");
    assert!(median < alone.0 && quartile < alone.1, "{alone:?}");
}
