//! Single numbers.

use super::{Checks, FARTHEST_M};
use crate::finding::Place;
use crate::plan::{FORMAT, Grid};
use crate::problem::Problem;
use alloc::format;
use alloc::vec::Vec;

/// What a number may be.
#[derive(Clone, Copy)]
enum Range {
    AboveZero,
    ZeroOrMore,
    Any,
}

impl Checks<'_> {
    /// Every number is finite and within what it can be.
    pub(super) fn values(&mut self) {
        let plan = self.plan;
        if plan.format != FORMAT {
            let problem = Problem::UnknownFormat { found: plan.format, expected: FORMAT };
            self.report(Place::key("format"), problem);
        }
        self.number(&Place::default(), "snap_m", plan.snap_m, Range::AboveZero);
        if plan.snap_m > 5.0 {
            let problem = Problem::OutOfRange { key: "snap_m", found: plan.snap_m, expected: "5 m at most" };
            self.report(Place::key("snap_m"), problem);
        }
        for (i, level) in plan.levels.iter().enumerate() {
            self.coordinates(&Place::entry("levels", i).at("elevation_m"), &[level.elevation_m]);
        }
        self.openings();
        self.devices_values();
        self.works_values();
        for (i, zone) in plan.zones.iter().enumerate() {
            let place = Place::entry("zones", i);
            self.number(&place, "exit_tolerance_m", zone.exit_tolerance_m, Range::ZeroOrMore);
            self.number(&place, "exit_delay_s", zone.exit_delay_s, Range::ZeroOrMore);
            self.points(&place.at("outline_m"), &zone.outline_m);
        }
        if let Grid::ControlPoints { tolerance_m, .. } = &plan.grid {
            self.number(&Place::key("grid"), "tolerance_m", *tolerance_m, Range::AboveZero);
        }
    }

    fn openings(&mut self) {
        let plan = self.plan;
        for (i, roadway) in plan.roadways.iter().enumerate() {
            let place = Place::entry("roadways", i);
            self.number(&place, "width_m", roadway.width_m, Range::AboveZero);
            self.number(&place, "height_m", roadway.height_m, Range::AboveZero);
            self.optional(&place, "max_slope_percent", roadway.max_slope_percent, Range::ZeroOrMore);
            let points: Vec<[f64; 3]> = roadway.points_m.iter().map(|p| (*p.raw()).into()).collect();
            self.points(&place.at("points_m"), &points);
        }
        for (i, chamber) in plan.chambers.iter().enumerate() {
            let place = Place::entry("chambers", i);
            self.coordinates(&place.clone().at("floor_m"), &[chamber.floor_m]);
            self.number(&place, "height_m", chamber.height_m, Range::AboveZero);
            self.points(&place.at("outline_m"), &chamber.outline_m);
        }
        for (i, junction) in plan.junctions.iter().enumerate() {
            self.position(Place::entry("junctions", i), junction.position_m.raw().as_ref());
        }
    }

    fn devices_values(&mut self) {
        let plan = self.plan;
        for (i, anchor) in plan.anchors.iter().enumerate() {
            let place = Place::entry("anchors", i);
            self.position(place.clone(), anchor.position_m.raw().as_ref());
            self.optional(&place, "range_offset_m", anchor.range_offset_m, Range::Any);
            self.optional(&place, "antenna_delay_ns", anchor.antenna_delay_ns, Range::ZeroOrMore);
            self.optional(&place, "tx_power_dbm", anchor.tx_power_dbm, Range::Any);
        }
        for (i, point) in plan.access_points.iter().enumerate() {
            let place = Place::entry("access_points", i);
            self.position(place.clone(), point.position_m.raw().as_ref());
            self.optional(&place, "tx_power_dbm", point.tx_power_dbm, Range::Any);
            if let Some(loss) = &point.path_loss {
                let place = place.at("path_loss");
                self.number(&place, "rssi_at_1m_dbm", loss.rssi_at_1m_dbm, Range::Any);
                self.number(&place, "exponent", loss.exponent, Range::AboveZero);
                self.optional(&place, "breakpoint_m", loss.breakpoint_m, Range::AboveZero);
                self.optional(&place, "exponent_beyond", loss.exponent_beyond, Range::AboveZero);
                if loss.breakpoint_m.is_some() != loss.exponent_beyond.is_some() {
                    self.report(place, Problem::HalfPathLoss {});
                }
            }
        }
        for (i, portal) in plan.rfid_portals.iter().enumerate() {
            let place = Place::entry("rfid_portals", i);
            self.position(place.clone(), portal.position_m.raw().as_ref());
            self.number(&place, "range_m", portal.range_m, Range::AboveZero);
        }
    }

    fn works_values(&mut self) {
        let plan = self.plan;
        for (i, pillar) in plan.pillars.iter().enumerate() {
            let place = Place::entry("pillars", i);
            self.optional(&place, "height_m", pillar.height_m, Range::AboveZero);
            self.points(&place.at("outline_m"), &pillar.outline_m);
        }
        for (i, door) in plan.doors.iter().enumerate() {
            let place = Place::entry("doors", i);
            self.optional(&place, "pressure_step_pa", door.pressure_step_pa, Range::Any);
            self.optional(&place, "attenuation_db", door.attenuation_db, Range::ZeroOrMore);
            self.points(&place.at("ends_m"), &door.ends_m);
        }
        for (i, conveyor) in plan.conveyors.iter().enumerate() {
            let points: Vec<[f64; 3]> = conveyor.points_m.iter().map(|p| (*p.raw()).into()).collect();
            self.points(&Place::entry("conveyors", i).at("points_m"), &points);
        }
        for (i, route) in plan.vehicle_routes.iter().enumerate() {
            self.number(&Place::entry("vehicle_routes", i), "speed_m_s", route.speed_m_s, Range::AboveZero);
        }
    }

    fn number(&mut self, table: &Place, key: &'static str, found: f64, range: Range) {
        let (good, expected) = match range {
            Range::AboveZero => (found > 0.0, "a number above 0"),
            Range::ZeroOrMore => (found >= 0.0, "0 or more"),
            Range::Any => (true, "a number"),
        };
        if !found.is_finite() {
            let problem = Problem::NotFinite { key: key.into(), found: format!("{found}") };
            self.report(table.clone().at(key), problem);
        } else if !good {
            self.report(table.clone().at(key), Problem::OutOfRange { key, found, expected });
        }
    }

    fn optional(&mut self, table: &Place, key: &'static str, found: Option<f64>, range: Range) {
        if let Some(found) = found {
            self.number(table, key, found, range);
        }
    }

    fn points<const N: usize>(&mut self, list: &Place, points: &[[f64; N]]) {
        for (i, point) in points.iter().enumerate() {
            self.coordinates(&list.clone().nth(i), point);
        }
    }

    fn position(&mut self, table: Place, point: &[f64; 3]) {
        self.coordinates(&table.at("position_m"), point);
    }

    /// Reports the first coordinate of a point that is no place.
    fn coordinates(&mut self, place: &Place, point: &[f64]) {
        let odd = point.iter().find(|v| !v.is_finite() || v.abs() > FARTHEST_M);
        let Some(&found) = odd else { return };
        let problem = if found.is_finite() {
            Problem::FarCoordinate { found, limit: FARTHEST_M }
        } else {
            Problem::NotFinite { key: "coordinate".into(), found: format!("{found}") }
        };
        self.report(place.clone(), problem);
    }
}
