//! Mines to move in.

use adit_core::frames::Position;
use adit_mine::Mine;
use adit_mine::plan::{Grid, MinePlan, Roadway, RoadwayKind};
use std::path::Path;

/// The mine that ships.
pub fn two_level() -> Mine {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    adit_mine::file::open(Path::new(file)).unwrap().0
}

/// Roadways `a` (20 m, 3 m high), `low` (20 m, 1 m high), `b` (40 m) in a row to the east.
pub fn crawlway() -> Mine {
    let roadway = |id: &str, from: f64, to: f64, height_m: f64| Roadway {
        id: id.into(),
        name: None,
        level: None,
        kind: RoadwayKind::Drift,
        width_m: 4.0,
        height_m,
        max_slope_percent: None,
        walkable: true,
        points_m: vec![Position::new(from, 0.0, -300.0), Position::new(to, 0.0, -300.0)],
    };
    let mut plan = MinePlan::new("low", Grid::Local {});
    plan.roadways =
        vec![roadway("a", 0.0, 20.0, 3.0), roadway("low", 20.0, 40.0, 1.0), roadway("b", 40.0, 80.0, 3.0)];
    Mine::new(plan).unwrap()
}
