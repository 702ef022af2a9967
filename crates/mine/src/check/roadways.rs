//! Roadways, each for itself.

use super::Checks;
use crate::finding::Place;
use crate::geometry::TOUCH_M;
use crate::levels::Levels;
use crate::plan::{Roadway, RoadwayKind};
use crate::problem::Problem;

/// Steeper than this nobody drives or walks without stairs: 1 in 2.5.
const STEEPEST_PERCENT: f64 = 40.0;
/// Centimetres in the heights of two points near each other are not a slope, m.
const HEIGHT_ERROR_M: f64 = 0.05;

impl Checks<'_> {
    pub(super) fn roadways(&mut self) {
        let plan = self.plan;
        let levels = Levels::new(&plan.levels);
        for (i, roadway) in plan.roadways.iter().enumerate() {
            let place = Place::entry("roadways", i);
            let count = roadway.points_m.len();
            if count < 2 {
                let problem = Problem::TooFewPoints { found: count, expected: 2 };
                self.report(place.clone().at("points_m"), problem);
            }
            self.segments(&place, roadway);
            self.right_level(place, roadway, &levels);
        }
        if plan.roadways.is_empty() && plan.chambers.is_empty() && !self.unread.openings {
            self.report(Place::default(), Problem::NothingExcavated {});
        }
    }

    fn segments(&mut self, table: &Place, roadway: &Roadway) {
        for (index, pair) in roadway.points_m.windows(2).enumerate() {
            let place = table.clone().at("points_m").nth(index + 1);
            let step = pair[1].raw() - pair[0].raw();
            if step.norm() <= TOUCH_M {
                self.report(place, Problem::ZeroLengthSegment { index });
                continue;
            }
            let run_m = libm::hypot(step.x, step.y);
            let found_percent = 100.0 * step.z.abs() / run_m;
            let excess_m = |limit_percent: f64| step.z.abs() - 0.01 * limit_percent * run_m;
            match roadway.max_slope_percent {
                Some(limit_percent) if excess_m(limit_percent) > HEIGHT_ERROR_M => {
                    self.report(place, Problem::SteeperThanGiven { index, found_percent, limit_percent });
                }
                None if roadway.kind != RoadwayKind::Shaft && excess_m(STEEPEST_PERCENT) > HEIGHT_ERROR_M => {
                    self.report(place, Problem::TooSteep { index, found_percent });
                }
                _ => {}
            }
        }
    }

    /// Warns of the first point that is nearer to another level.
    fn right_level(&mut self, table: Place, roadway: &Roadway, levels: &Levels) {
        let Some(level) = roadway.level.as_deref().and_then(|id| self.level(id)) else { return };
        let mut heights = roadway.points_m.iter().map(|p| p.raw().z).enumerate();
        let off = heights.find_map(|(i, z)| levels.of(z).filter(|of| *of != level).map(|of| (i, z, of)));
        if let Some((i, z_m, of)) = off {
            let [level, nearest] = [level, of].map(|l| self.plan.levels[l].id.clone());
            self.report(table.at("points_m").nth(i), Problem::OffLevel { z_m, level, nearest });
        }
    }
}
