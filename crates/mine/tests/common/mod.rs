//! Mines for the tests.
#![allow(dead_code, reason = "each test binary uses a part")]
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::frames::Position;
use adit_mine::Mine;
use adit_mine::file::{Checked, parse};
use adit_mine::plan::{Grid, Level, MinePlan, Roadway, RoadwayKind};
use std::path::{Path, PathBuf};

/// A mine of the repository.
pub fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines").join(name)
}

/// What becomes of a text.
pub fn checked(text: &str) -> Checked {
    parse(Path::new("mine.toml"), text.as_bytes())
}

/// A roadway of this width, 3 m high.
pub fn roadway(id: &str, width_m: f64, points: &[[f64; 3]]) -> Roadway {
    Roadway {
        id: id.into(),
        name: None,
        level: None,
        kind: RoadwayKind::Drift,
        width_m,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: points.iter().map(|p| Position::new(p[0], p[1], p[2])).collect(),
    }
}

/// A plan with these roadways, on one level at height 0.
pub fn plan(roadways: Vec<Roadway>) -> MinePlan {
    let mut plan = MinePlan::new("test", Grid::Local {});
    plan.levels.push(Level { id: "floor".into(), name: None, elevation_m: 0.0 });
    plan.roadways = roadways;
    plan
}

/// A mine with these roadways, on one level at height 0.
pub fn mine(roadways: Vec<Roadway>) -> Mine {
    Mine::new(plan(roadways)).unwrap()
}
