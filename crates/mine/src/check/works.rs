//! Pillars, doors, conveyors and routes.

use super::meetings::nodes_of_roadways;
use super::{Checks, Survey};
use crate::excavation::Opening;
use crate::finding::Place;
use crate::geometry::plane::{length, minus};
use crate::geometry::polygon::centroid;
use crate::network::Travel;
use crate::problem::Problem;

/// A door this much narrower than its roadway leaves a gap, m.
const GAP_M: f64 = 0.5;

impl Checks<'_> {
    pub(super) fn works(&mut self, survey: &Survey) {
        if self.openings_known() {
            self.pillars(survey);
            self.doors(survey);
            for (i, conveyor) in self.plan.conveyors.iter().enumerate() {
                for (n, point) in conveyor.points_m.iter().enumerate() {
                    self.in_the_air(Place::entry("conveyors", i).at("points_m").nth(n), point, survey);
                }
            }
        }
        self.conveyor_lengths();
        self.routes(survey);
    }

    fn pillars(&mut self, survey: &Survey) {
        for (i, pillar) in self.plan.pillars.iter().enumerate() {
            let Some(level) = self.level(&pillar.level) else { continue };
            let band = survey.levels.band_m(level);
            let middle = centroid(&pillar.outline_m);
            let in_air =
                pillar.outline_m.iter().chain([&middle]).any(|p| survey.excavation.reaches(*p, band));
            if !in_air {
                let place = Place::entry("pillars", i).at("outline_m");
                self.report(place, Problem::WorksInRock { what: "the whole pillar" });
            }
        }
    }

    fn doors(&mut self, survey: &Survey) {
        for (i, door) in self.plan.doors.iter().enumerate() {
            let Some(level) = self.level(&door.level) else { continue };
            let [a, b] = door.ends_m;
            let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            let openings = survey.excavation.openings_over(middle, survey.levels.band_m(level));
            let place = Place::entry("doors", i).at("ends_m");
            if openings.is_empty() {
                self.report(place, Problem::WorksInRock { what: "the middle of the door" });
                continue;
            }
            let width_m = length(minus(b, a));
            let roadways = openings.iter().filter_map(|opening| match opening {
                Opening::Roadway(index) => Some(&self.plan.roadways[*index]),
                Opening::Chamber(_) => None,
            });
            // Where roadways meet, it is enough to close the narrowest.
            let narrowest = roadways.min_by(|a, b| a.width_m.total_cmp(&b.width_m));
            if let Some(roadway) = narrowest
                && width_m < roadway.width_m - GAP_M
            {
                let (roadway, expected_m) = (roadway.id.clone(), roadway.width_m);
                self.report(place, Problem::DoorTooNarrow { width_m, roadway, expected_m });
            }
        }
    }

    fn conveyor_lengths(&mut self) {
        for (i, conveyor) in self.plan.conveyors.iter().enumerate() {
            let found = conveyor.points_m.len();
            if found < 2 {
                let place = Place::entry("conveyors", i).at("points_m");
                self.report(place, Problem::TooFewPoints { found, expected: 2 });
            }
        }
    }

    fn routes(&mut self, survey: &Survey) {
        let plan = self.plan;
        let nodes = nodes_of_roadways(survey, plan.roadways.len());
        let part_of = survey.built.network.parts(Travel::Any);
        let part = |roadway: usize| nodes[roadway].first().map(|node| part_of[node.0 as usize]);
        let roadway = |id: &str| plan.roadways.iter().position(|r| r.id == id);
        for (i, route) in plan.vehicle_routes.iter().enumerate() {
            let place = Place::entry("vehicle_routes", i).at("roadways");
            if route.roadways.is_empty() {
                self.report(place.clone(), Problem::TooFewPoints { found: 0, expected: 1 });
            }
            for (n, pair) in route.roadways.windows(2).enumerate() {
                let (Some(first), Some(second)) = (roadway(&pair[0]), roadway(&pair[1])) else { continue };
                // Where the parts of the mine are not connected, that is told of them.
                let connected = part(first).is_some() && part(first) == part(second);
                if first != second && connected && nodes[first].is_disjoint(&nodes[second]) {
                    let problem = Problem::BrokenRoute { first: pair[0].clone(), second: pair[1].clone() };
                    self.report(place.clone().nth(n + 1), problem);
                }
            }
        }
    }
}
