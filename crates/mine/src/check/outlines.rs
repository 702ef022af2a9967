//! Outlines of chambers, zones and pillars.

use super::Checks;
use crate::finding::Place;
use crate::geometry::polygon::{self_crossing, signed_area_m2};
use crate::problem::Problem;

/// More corners are a drawing, not an outline.
const MOST_CORNERS: usize = 2000;
/// Less is no room, m².
const SMALLEST_M2: f64 = 1e-3;

impl Checks<'_> {
    pub(super) fn outlines(&mut self) {
        let plan = self.plan;
        for (i, chamber) in plan.chambers.iter().enumerate() {
            self.outline(Place::entry("chambers", i), &chamber.outline_m);
        }
        for (i, zone) in plan.zones.iter().enumerate() {
            self.outline(Place::entry("zones", i), &zone.outline_m);
        }
        for (i, pillar) in plan.pillars.iter().enumerate() {
            self.outline(Place::entry("pillars", i), &pillar.outline_m);
        }
    }

    fn outline(&mut self, table: Place, outline: &[[f64; 2]]) {
        let place = table.at("outline_m");
        if outline.len() < 3 {
            return self.report(place, Problem::TooFewPoints { found: outline.len(), expected: 3 });
        }
        if outline.len() > MOST_CORNERS {
            return self.report(place, Problem::TooManyPoints { found: outline.len(), limit: MOST_CORNERS });
        }
        if let Some((first, second)) = self_crossing(outline) {
            return self.report(place.nth(first), Problem::SelfCrossing { first, second });
        }
        let area_m2 = signed_area_m2(outline).abs();
        if area_m2.is_nan() || area_m2 < SMALLEST_M2 {
            self.report(place, Problem::NoArea { area_m2 });
        }
    }
}
