//! A mine in a few numbers.

use crate::mine::Mine;
use crate::network::Travel;
use crate::plan::{Grid, RoadwayKind, ZoneKind};
use adit_core::frames::{MineGrid, Position};
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use serde::Serialize;

/// A mine in a few numbers, as `adit mine check` shows it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the mine.
    pub name: String,
    /// What its coordinates mean.
    pub grid: &'static str,
    /// Levels, highest first.
    pub levels: Vec<LevelSummary>,
    /// Number of roadways, shafts left out.
    pub roadways: usize,
    /// Their length together, m.
    pub roadway_m: f64,
    /// Number of shafts.
    pub shafts: usize,
    /// Their length together, m.
    pub shaft_m: f64,
    /// Steepest slope of a roadway that is no shaft, %.
    pub steepest_percent: f64,
    /// Number of chambers.
    pub chambers: usize,
    /// Nodes where three or more ways meet.
    pub junctions: usize,
    /// Nodes where a way ends.
    pub dead_ends: usize,
    /// Pieces of roadway between nodes.
    pub edges: usize,
    /// Parts that are not connected; 1 in a sound mine.
    pub components: usize,
    /// Number of zones of each kind.
    pub zones: ZoneSummary,
    /// UWB anchors.
    pub anchors: usize,
    /// Wi-Fi and BLE access points.
    pub access_points: usize,
    /// RFID portals.
    pub rfid_portals: usize,
    /// Pillars.
    pub pillars: usize,
    /// Doors.
    pub doors: usize,
    /// Conveyors.
    pub conveyors: usize,
    /// Vehicle routes.
    pub vehicle_routes: usize,
}

/// One level in a few numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelSummary {
    /// Its id.
    pub id: String,
    /// Its elevation, m.
    pub elevation_m: f64,
    /// Length of centre lines whose middle belongs to it, shafts left out, m.
    pub roadway_m: f64,
}

/// Number of zones of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ZoneSummary {
    /// Restricted.
    pub restricted: usize,
    /// Dangerous.
    pub dangerous: usize,
    /// Key places.
    pub key: usize,
    /// Refuges.
    pub refuge: usize,
    /// Ways out.
    pub portal: usize,
    /// People whom all refuges together keep alive.
    pub refuge_capacity: u64,
}

impl Summary {
    /// Counts.
    pub fn of(mine: &Mine) -> Self {
        let (plan, network) = (mine.plan(), mine.network());
        let is_shaft = |roadway: usize| plan.roadways[roadway].kind == RoadwayKind::Shaft;
        let shafts = (0..plan.roadways.len()).filter(|r| is_shaft(*r)).count();
        let mut levels: Vec<LevelSummary> = plan
            .levels
            .iter()
            .map(|l| LevelSummary { id: l.id.clone(), elevation_m: l.elevation_m, roadway_m: 0.0 })
            .collect();
        let (mut roadway_m, mut shaft_m, mut steepest) = (0.0, 0.0, 0.0_f64);
        for edge in network.edges() {
            if is_shaft(edge.roadway) {
                shaft_m += edge.length_m();
                continue;
            }
            roadway_m += edge.length_m();
            let points: Vec<Position<MineGrid>> = edge.points_m().collect();
            for pair in points.windows(2) {
                let step = pair[1].raw() - pair[0].raw();
                steepest = steepest.max(step.z.abs() / libm::hypot(step.x, step.y));
                let level = mine.level_at(0.5 * (pair[0].raw().z + pair[1].raw().z));
                if let Some(summary) = levels.iter_mut().find(|l| Some(&l.id) == level.map(|level| &level.id))
                {
                    summary.roadway_m += step.norm();
                }
            }
        }
        levels.sort_by(|a, b| b.elevation_m.total_cmp(&a.elevation_m));
        let mut degree = alloc::vec![0_usize; network.nodes().len()];
        for edge in network.edges() {
            degree[edge.from.0 as usize] += 1;
            degree[edge.to.0 as usize] += 1;
        }
        Self {
            name: plan.name.clone(),
            grid: match plan.grid {
                Grid::Local {} => "local",
                Grid::Epsg { .. } => "epsg",
                Grid::ControlPoints { .. } => "control-points",
            },
            levels,
            roadways: plan.roadways.len() - shafts,
            roadway_m,
            shafts,
            shaft_m,
            steepest_percent: 100.0 * steepest,
            chambers: plan.chambers.len(),
            junctions: degree.iter().filter(|d| **d >= 3).count(),
            dead_ends: degree.iter().filter(|d| **d == 1).count(),
            edges: network.edges().len(),
            components: network.parts(Travel::Any).iter().max().map_or(0, |last| last + 1),
            zones: zones(mine),
            anchors: plan.anchors.len(),
            access_points: plan.access_points.len(),
            rfid_portals: plan.rfid_portals.len(),
            pillars: plan.pillars.len(),
            doors: plan.doors.len(),
            conveyors: plan.conveyors.len(),
            vehicle_routes: plan.vehicle_routes.len(),
        }
    }
}

fn zones(mine: &Mine) -> ZoneSummary {
    let mut zones = ZoneSummary::default();
    for zone in &mine.plan().zones {
        match zone.kind {
            ZoneKind::Restricted => zones.restricted += 1,
            ZoneKind::Dangerous => zones.dangerous += 1,
            ZoneKind::Key => zones.key += 1,
            ZoneKind::Refuge => {
                zones.refuge += 1;
                zones.refuge_capacity += u64::from(zone.capacity.unwrap_or(0));
            }
            ZoneKind::Portal => zones.portal += 1,
        }
    }
    zones
}

/// A number of things: `1 door`, `2 doors`.
struct Count(usize, &'static str);

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}{}", self.0, self.1, if self.0 == 1 { "" } else { "s" })
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "mine        {}, grid {}", self.name, self.grid)?;
        for level in &self.levels {
            writeln!(
                f,
                "level       {} at {} m: {:.2} km of roadway",
                level.id,
                level.elevation_m,
                level.roadway_m / 1000.0
            )?;
        }
        write!(f, "roadways    {:.2} km in {}", self.roadway_m / 1000.0, self.roadways)?;
        if self.steepest_percent > 0.05 {
            write!(f, ", steepest {:.1} %", self.steepest_percent)?;
        }
        if self.shafts > 0 {
            write!(f, "; {:.0} m of shaft in {}", self.shaft_m, self.shafts)?;
        }
        if self.chambers > 0 {
            write!(f, "; {}", Count(self.chambers, "chamber"))?;
        }
        writeln!(f)?;
        writeln!(
            f,
            "network     {}, {}, {} in {}",
            Count(self.junctions, "junction"),
            Count(self.dead_ends, "dead end"),
            Count(self.edges, "edge"),
            Count(self.components, "part")
        )?;
        let z = &self.zones;
        writeln!(
            f,
            "zones       {} restricted, {} dangerous, {} key, {}, {} for {} people",
            z.restricted,
            z.dangerous,
            z.key,
            Count(z.portal, "portal"),
            Count(z.refuge, "refuge"),
            z.refuge_capacity
        )?;
        writeln!(
            f,
            "devices     {}, {}, {}",
            Count(self.anchors, "UWB anchor"),
            Count(self.access_points, "access point"),
            Count(self.rfid_portals, "RFID portal")
        )?;
        writeln!(
            f,
            "works       {}, {}, {}, {}",
            Count(self.pillars, "pillar"),
            Count(self.doors, "door"),
            Count(self.conveyors, "conveyor"),
            Count(self.vehicle_routes, "vehicle route")
        )
    }
}
