//! Anchors, access points and RFID portals.

use super::{Checks, NICHE_M, Survey};
use crate::excavation::Clearance;
use crate::finding::Place;
use crate::geometry::polygon::{contains, on_outline};
use crate::problem::Problem;
use adit_core::frames::{MineGrid, Position};
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::vec::Vec;

/// Devices closer together than this are in one place, m.
const SAME_PLACE_M: f64 = 1e-3;

impl Checks<'_> {
    pub(super) fn devices(&mut self, survey: &Survey) {
        let plan = self.plan;
        macro_rules! places {
            ($list:ident) => {
                plan.$list.iter().map(|d| (d.id.as_str(), d.position_m)).collect::<Vec<_>>()
            };
        }
        self.group("anchors", "anchor", &places!(anchors), survey);
        self.group("access_points", "access point", &places!(access_points), survey);
        self.group("rfid_portals", "RFID portal", &places!(rfid_portals), survey);
    }

    fn group(
        &mut self,
        list: &'static str,
        called: &str,
        devices: &[(&str, Position<MineGrid>)],
        survey: &Survey,
    ) {
        let mut taken: BTreeMap<[i64; 3], &str> = BTreeMap::new();
        for (index, (id, position)) in devices.iter().enumerate() {
            let place = Place::entry(list, index).at("position_m");
            #[expect(clippy::cast_possible_truncation, reason = "10^7 m are 10^10 mm")]
            let cell: [i64; 3] = position.raw().map(|v| libm::round(v / SAME_PLACE_M) as i64).into();
            if let Some(other) = taken.insert(cell, id) {
                self.report(place.clone(), Problem::SamePlace { other: format!("{called} {other}") });
            }
            if self.openings_known() {
                self.in_the_air(place.clone(), position, survey);
            }
            self.outside_pillars(place, position, survey);
        }
    }

    /// A device, or a point of a belt, is in an opening or in a niche of one.
    pub(super) fn in_the_air(&mut self, place: Place, position: &Position<MineGrid>, survey: &Survey) {
        let Some(clearance) = survey.excavation.clearance(position) else { return };
        let Clearance { opening, beyond_wall_m, above_roof_m, below_floor_m, .. } = clearance;
        if clearance.distance_m() <= NICHE_M {
            return;
        }
        let opening = self.name(opening);
        let problem = if beyond_wall_m >= above_roof_m.max(below_floor_m) {
            Problem::InRock { opening, distance_m: clearance.distance_m() }
        } else if above_roof_m > 0.0 {
            Problem::AboveRoof { opening, distance_m: above_roof_m }
        } else {
            Problem::BelowFloor { opening, distance_m: below_floor_m }
        };
        self.report(place, problem);
    }

    fn outside_pillars(&mut self, place: Place, position: &Position<MineGrid>, survey: &Survey) {
        let p = position.raw();
        let here = [p.x, p.y];
        let inside = self.plan.pillars.iter().find(|pillar| {
            self.level(&pillar.level).is_some_and(|level| survey.levels.of(p.z) == Some(level))
                && pillar.height_m.is_none()
                && contains(&pillar.outline_m, here)
                && !on_outline(&pillar.outline_m, here)
        });
        if let Some(pillar) = inside {
            self.report(place, Problem::InPillar { pillar: pillar.id.clone() });
        }
    }
}
