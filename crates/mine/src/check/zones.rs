//! Zones: whether they hold anything, and whether refuges can be reached.

use super::{Checks, Survey};
use crate::finding::Place;
use crate::network::Travel;
use crate::plan::{Zone, ZoneKind};
use crate::problem::Problem;
use crate::zoning::{holds_opening, spots_in};
use alloc::collections::BTreeSet;
use alloc::string::String;

impl Checks<'_> {
    pub(super) fn zones(&mut self, survey: &Survey) {
        let plan = self.plan;
        for (i, zone) in plan.zones.iter().enumerate() {
            if zone.kind == ZoneKind::Refuge && zone.capacity.is_none() {
                self.report(Place::entry("zones", i), Problem::NoCapacity {});
            }
            let Some(level) = self.level(&zone.level) else { continue };
            if self.openings_known() && zone.outline_m.len() >= 3 && !holds_opening(plan, survey, zone, level)
            {
                let problem = Problem::EmptyZone { level: zone.level.clone() };
                self.report(Place::entry("zones", i).at("outline_m"), problem);
            }
        }
        let is_portal = |zone: &Zone| zone.kind == ZoneKind::Portal;
        if self.openings_known() && !plan.roadways.is_empty() && !plan.zones.iter().any(is_portal) {
            self.report(Place::default(), Problem::NoPortal {});
        }
        if self.openings_known() {
            self.refuges(survey);
        }
    }

    /// A refuge is reached on foot from a portal, or from most of the mine where there is none.
    fn refuges(&mut self, survey: &Survey) {
        let (plan, network) = (self.plan, &survey.built.network);
        let part_of = network.parts(Travel::OnFoot);
        let parts_of = |zone: &Zone| -> BTreeSet<usize> {
            let Some(level) = self.level(&zone.level) else { return BTreeSet::new() };
            let edges = spots_in(plan, network, &survey.levels, zone, level);
            let edges = edges.iter().filter_map(|spot| network.edge(spot.edge)).filter(|edge| edge.walkable);
            edges.map(|edge| part_of[edge.from.0 as usize]).collect()
        };
        let portals: BTreeSet<usize> =
            plan.zones.iter().filter(|z| z.kind == ZoneKind::Portal).flat_map(parts_of).collect();
        let (from, start) = if portals.is_empty() {
            let mut lengths = alloc::vec![0.0; part_of.len()];
            for edge in network.edges().iter().filter(|edge| edge.walkable) {
                lengths[part_of[edge.from.0 as usize]] += edge.length_m();
            }
            let main = (0..lengths.len()).max_by(|a, b| lengths[*a].total_cmp(&lengths[*b]).then(b.cmp(a)));
            ("the rest of the mine", main.into_iter().collect())
        } else {
            ("any portal", portals)
        };
        let mut unreachable = alloc::vec::Vec::new();
        for (i, zone) in plan.zones.iter().enumerate().filter(|(_, z)| z.kind == ZoneKind::Refuge) {
            let known = self.level(&zone.level).is_some_and(|level| holds_opening(plan, survey, zone, level));
            // A refuge in a mine of chambers alone has no roadway to be reached by.
            if known && !plan.roadways.is_empty() && parts_of(zone).is_disjoint(&start) {
                unreachable.push(i);
            }
        }
        for i in unreachable {
            let from: String = from.into();
            self.report(Place::entry("zones", i), Problem::RefugeUnreachable { from });
        }
    }
}
