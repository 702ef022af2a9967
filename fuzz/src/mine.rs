//! The parser of mine files: any bytes in, no panic, no memory beyond bounds, a mine or clear messages out.
//!
//! The fuzz target `mine` calls it, and so does `crates/mine/tests/mutated_input.rs`.

use adit_mine::file::{self, parse};
use adit_mine::{Summary, plan_view};
use std::path::Path;

/// Name under which the bytes are known; every message must start with it.
const NAME: &str = "fuzzed";

/// Checks a mine of any form, and asks it some questions when it is one. True for a mine.
pub fn check_mine(bytes: &[u8]) -> bool {
    let checked = parse(Path::new(NAME), bytes);
    let lines = bytes.split(|b| *b == b'\n').count() as u64;
    for notice in &checked.notices {
        let text = notice.to_string();
        assert!(text.starts_with(NAME) && !text.contains('\n'), "not one clear line: {text}");
        assert!((1..=lines).contains(&notice.line));
    }
    assert!(checked.notices.is_sorted_by_key(|notice| notice.line), "notices come in order of line");
    let Some(mine) = checked.mine else {
        assert!(checked.errors().count() > 0, "no mine, but no error");
        return false;
    };
    let text = file::to_geojson(mine.plan()).unwrap_or_default();
    let again = parse(Path::new(NAME), text.as_bytes()).mine;
    assert!(again.is_some_and(|again| again.plan() == mine.plan()), "a mine survives GeoJSON");
    let summary = Summary::of(&mine);
    assert!(summary.roadway_m >= 0.0 && !plan_view::draw(&mine).contains("NaN"));
    let devices = mine.plan().anchors.iter().map(|a| a.position_m);
    for pair in devices.clone().zip(devices.skip(1)).take(20) {
        let sight = mine.sight(&pair.0, &pair.1);
        assert!((0.0..=sight.distance_m + 1e-6).contains(&sight.rock_m), "{sight:?}");
        if let Some(foot) = mine.network().nearest(&pair.0) {
            assert!(mine.network().at(&foot.spot).is_some() && foot.distance_m.is_finite());
        }
    }
    true
}
