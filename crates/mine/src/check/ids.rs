//! Ids, and what refers to them.

use super::Checks;
use crate::finding::Place;
use crate::plan::{Grid, MinePlan};
use crate::problem::Problem;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// A longer id is a mistake, characters.
const LONGEST_ID: usize = 64;

/// List, what its entries are called, and their ids.
type Entries<'p> = (&'static str, &'static str, Vec<&'p str>);

fn entries(plan: &MinePlan) -> [Entries<'_>; 12] {
    macro_rules! ids {
        ($list:ident, $called:literal) => {
            (stringify!($list), $called, plan.$list.iter().map(|entry| entry.id.as_str()).collect())
        };
    }
    [
        ids!(levels, "level"),
        ids!(roadways, "roadway"),
        ids!(chambers, "chamber"),
        ids!(junctions, "junction"),
        ids!(zones, "zone"),
        ids!(anchors, "anchor"),
        ids!(access_points, "access point"),
        ids!(rfid_portals, "RFID portal"),
        ids!(pillars, "pillar"),
        ids!(doors, "door"),
        ids!(conveyors, "conveyor"),
        ids!(vehicle_routes, "vehicle route"),
    ]
}

impl Checks<'_> {
    /// Ids can be typed and are unique in the file.
    pub(super) fn ids(&mut self) {
        let plan = self.plan;
        let mut known: BTreeMap<&str, String> = BTreeMap::new();
        for (list, called, ids) in entries(plan) {
            for (index, id) in ids.into_iter().enumerate() {
                let place = Place::entry(list, index).at("id");
                self.id(place.clone(), id);
                if let Some(other) = known.get(id) {
                    let problem = Problem::DuplicateId { id: id.into(), other: other.clone() };
                    self.report(place, problem);
                } else {
                    known.insert(id, format!("{called} {} in `{list}`", index + 1));
                }
            }
        }
        if let Grid::ControlPoints { points, .. } = &plan.grid {
            for (index, point) in points.iter().enumerate() {
                self.id(Place::key("grid").at("points").nth(index).at("id"), &point.id);
            }
        }
        self.macs();
    }

    fn id(&mut self, place: Place, id: &str) {
        let odd = id.is_empty() || id.trim() != id || id.chars().any(char::is_control);
        if odd || id.chars().count() > LONGEST_ID {
            let id = id.chars().take(LONGEST_ID).collect();
            self.report(place, Problem::BadId { id, limit: LONGEST_ID });
        }
    }

    fn macs(&mut self) {
        let plan = self.plan;
        let mut known: BTreeMap<String, &str> = BTreeMap::new();
        for (index, point) in plan.access_points.iter().enumerate() {
            let Some(mac) = &point.mac else { continue };
            let place = Place::entry("access_points", index).at("mac");
            let digits: String = mac
                .chars()
                .filter(|c| !matches!(c, ':' | '-' | '.'))
                .map(|c| c.to_ascii_lowercase())
                .collect();
            if digits.len() != 12 || !digits.chars().all(|c| c.is_ascii_hexdigit()) {
                self.report(place, Problem::BadMac { mac: mac.chars().take(LONGEST_ID).collect() });
            } else if let Some(other) = known.insert(digits, &point.id) {
                self.report(place, Problem::DuplicateMac { mac: mac.clone(), other: other.into() });
            }
        }
    }

    /// What is named exists.
    pub(super) fn references(&mut self) {
        let plan = self.plan;
        let levels: Vec<&str> = plan.levels.iter().map(|l| l.id.as_str()).collect();
        let roadways: Vec<&str> = plan.roadways.iter().map(|r| r.id.as_str()).collect();
        for (i, roadway) in plan.roadways.iter().enumerate() {
            if let Some(level) = &roadway.level {
                self.refers(Place::entry("roadways", i).at("level"), "level", level, &levels);
            }
        }
        for (i, zone) in plan.zones.iter().enumerate() {
            self.refers(Place::entry("zones", i).at("level"), "level", &zone.level, &levels);
        }
        for (i, pillar) in plan.pillars.iter().enumerate() {
            self.refers(Place::entry("pillars", i).at("level"), "level", &pillar.level, &levels);
        }
        for (i, door) in plan.doors.iter().enumerate() {
            self.refers(Place::entry("doors", i).at("level"), "level", &door.level, &levels);
        }
        for (i, junction) in plan.junctions.iter().enumerate() {
            for (n, id) in junction.roadways.iter().enumerate() {
                let place = Place::entry("junctions", i).at("roadways").nth(n);
                self.refers(place, "roadway", id, &roadways);
            }
        }
        for (i, route) in plan.vehicle_routes.iter().enumerate() {
            for (n, id) in route.roadways.iter().enumerate() {
                let place = Place::entry("vehicle_routes", i).at("roadways").nth(n);
                self.refers(place, "roadway", id, &roadways);
            }
        }
    }

    fn refers(&mut self, place: Place, kind: &'static str, id: &str, known: &[&str]) {
        if known.contains(&id) || self.unread.ids.iter().any(|unread| unread == id) {
            return;
        }
        let nearest = similar(id, known).map(Into::into);
        self.report(place, Problem::UnknownReference { kind, id: id.into(), nearest });
    }
}

/// The id that was probably meant: the same letters and digits in the same order.
fn similar<'k>(id: &str, known: &[&'k str]) -> Option<&'k str> {
    let plain = |id: &str| -> String {
        id.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    };
    let wanted = plain(id);
    known.iter().copied().find(|known| plain(known) == wanted)
}
