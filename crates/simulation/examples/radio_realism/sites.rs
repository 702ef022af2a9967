//! Rooms like those of the recorded sets: the same distances, something in between where the set says so.
//!
//! No set has a plan of its walls, so a blocked link gets a pillar of its own: 0.3 to 1.3 m wide for NLOS, 1.2 to 2.5 m for no direct path. The
//! wall of a flat lets some of the signal through, a pillar here does not; the power that arrives is alike, its way is not.

use super::Outcome;
use super::rows::Rows;
use adit_core::frames::Position;
use adit_mine::Mine;
use adit_mine::plan::{Anchor, Chamber, Grid, Level, MinePlan, Pillar, Roadway, RoadwayKind};
use std::path::Path;

/// What the set says of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    Los,
    Nlos,
    Ndp,
}

impl Class {
    pub const ALL: [Self; 3] = [Self::Los, Self::Nlos, Self::Ndp];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Los => "LOS",
            Self::Nlos => "NLOS",
            Self::Ndp => "NDP",
        }
    }
}

/// One anchor and one tag.
#[derive(Debug, Clone)]
pub struct Site {
    pub group: String,
    pub class: Class,
    pub anchor_m: [f64; 3],
    pub tag_m: [f64; 3],
}

/// The 24 geometries of `uwb-cir`; heights are not told: 1.2 m and 1.6 m.
pub fn apartment(data: &Path) -> Outcome<Vec<Site>> {
    let rows = Rows::read(&data.join("uwb-cir/geometries.csv"))?;
    let site = |row| {
        let number = |name| rows.number(row, name);
        let class = Class::ALL.into_iter().find(|c| c.name() == rows.text(row, "label"));
        Some(Site {
            group: rows.text(row, "geometry_id").to_owned(),
            class: class?,
            anchor_m: [number("anchor_x_m"), number("anchor_y_m"), 1.6],
            tag_m: [number("tag_x_m"), number("tag_y_m"), 1.2],
        })
    };
    Ok((0..rows.len()).filter_map(site).collect())
}

/// A room with one anchor, and a pillar between it and the tag where the link is blocked; `draw` (0 to 1) sets its width.
pub fn room(site: &Site, draw: f64) -> Outcome<Mine> {
    let mut plan = MinePlan::new("a room", Grid::Local {});
    plan.levels.push(Level { id: "room".into(), name: None, elevation_m: 0.0 });
    let ([ax, ay, az], [tx, ty, _]) = (site.anchor_m, site.tag_m);
    let around = |low: f64, high: f64| (low.min(high) - 8.0, low.max(high) + 8.0);
    let ((west, east), (south, north)) = (around(ax, tx), around(ay, ty));
    plan.chambers.push(Chamber {
        id: "hall".into(),
        name: None,
        floor_m: 0.0,
        height_m: 6.0,
        outline_m: vec![[west, south], [east, south], [east, north], [west, north]],
    });
    plan.roadways.push(Roadway {
        id: "path".into(),
        name: None,
        level: Some("room".into()),
        kind: RoadwayKind::Drift,
        width_m: 2.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: vec![Position::new(tx - 1.0, ty, 0.0), Position::new(tx + 1.0, ty, 0.0)],
    });
    plan.anchors.push(Anchor {
        id: "anchor".into(),
        position_m: Position::new(ax, ay, az),
        range_offset_m: Some(0.0),
        antenna_delay_ns: None,
        tx_power_dbm: None,
    });
    let width_m = match site.class {
        Class::Los => return Ok(Mine::new(plan)?),
        Class::Nlos => 0.3 + 1.0 * draw,
        Class::Ndp => 1.2 + 1.3 * draw,
    };
    let (run, middle) = ([tx - ax, ty - ay], [0.5 * (tx + ax), 0.5 * (ty + ay)]);
    let length = run[0].hypot(run[1]);
    let [ux, uy] = run.map(|v| v / length);
    let half = 0.5 * width_m;
    let corner = |along: f64, across: f64| {
        [middle[0] + ux * along - uy * across, middle[1] + uy * along + ux * across]
    };
    plan.pillars.push(Pillar {
        id: "pillar".into(),
        level: "room".into(),
        height_m: Some(3.0),
        outline_m: vec![corner(-0.1, -half), corner(0.1, -half), corner(0.1, half), corner(-0.1, half)],
    });
    Ok(Mine::unchecked(plan))
}
