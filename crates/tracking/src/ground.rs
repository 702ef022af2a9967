//! What is made of the mine and the zones: nothing of it is in the saved state.

use crate::evacuation::Exits;
use crate::zones::{Levels, LiveZone, Watch};
use adit_core::frames::{MineGrid, Position};
use adit_mine::Mine;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The mine as tracking asks it.
#[derive(Debug, Clone)]
pub struct Ground {
    pub mine: Arc<Mine>,
    pub levels: Levels,
    pub watch: Watch,
    pub exits: Exits,
    /// Bounds of all that is excavated: west, south, east, north, m.
    bounds_m: Option<[f64; 4]>,
}

impl Ground {
    pub fn new(mine: Arc<Mine>, zones: &BTreeMap<String, LiveZone>) -> Self {
        let levels = Levels::new(&mine);
        let watch = Watch::new(zones, &levels);
        let exits = Exits::new(&mine, zones);
        let bounds_m = bounds_m(&mine);
        Self { mine, levels, watch, exits, bounds_m }
    }

    /// Takes other zones.
    pub fn rezone(&mut self, zones: &BTreeMap<String, LiveZone>) {
        self.watch = Watch::new(zones, &self.levels);
        self.exits = Exits::new(&self.mine, zones);
    }

    /// Distance to the farthest corner of the mine's bounds: whoever is in the mine is no farther, m.
    pub fn reach_m(&self, from: &Position<MineGrid>) -> f64 {
        let p = from.raw();
        self.bounds_m.map_or(f64::MAX, |[west, south, east, north]| {
            (p.x - west).abs().max((p.x - east).abs()).hypot((p.y - south).abs().max((p.y - north).abs()))
        })
    }
}

fn bounds_m(mine: &Mine) -> Option<[f64; 4]> {
    let plan = mine.plan();
    let roadways = plan.roadways.iter().flat_map(|roadway| {
        let half_m = 0.5 * roadway.width_m;
        roadway.points_m.iter().map(move |p| ([p.raw().x, p.raw().y], half_m))
    });
    let chambers =
        plan.chambers.iter().flat_map(|chamber| chamber.outline_m.iter().map(|corner| (*corner, 0.0)));
    let zones = plan.zones.iter().flat_map(|zone| zone.outline_m.iter().map(|corner| (*corner, 0.0)));
    roadways.chain(chambers).chain(zones).fold(None, |bounds, ([x, y], half_m)| {
        let [west, south, east, north] = bounds.unwrap_or([x, y, x, y]);
        Some([west.min(x - half_m), south.min(y - half_m), east.max(x + half_m), north.max(y + half_m)])
    })
}
