//! The mine: a plan that was checked, with the geometry and the graph made of it.

use crate::check::{Survey, Unread, inspect};
use crate::error::MineError;
use crate::excavation::Excavation;
use crate::finding::Severity;
use crate::geometry::plane::meeting;
use crate::geometry::polygon::{Outline, chords};
use crate::geometry::spans::{Span, covered};
use crate::georeference::Georeference;
use crate::levels::Levels;
use crate::network::Network;
use crate::plan::{Level, MinePlan, Pillar, Zone};
use crate::zoning::spots_in;
use adit_core::frames::{MineGrid, Position};
use alloc::vec::Vec;

/// Rock at the ends of a line of sight that an antenna on a wall may be embedded in, m.
const EMBEDDED_M: f64 = 0.1;

/// A mine to ask about.
#[derive(Debug, Clone)]
pub struct Mine {
    plan: MinePlan,
    network: Network,
    excavation: Excavation,
    levels: Levels,
}

/// What lies on the straight line between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Length of the line, m.
    pub distance_m: f64,
    /// How much of it runs through rock, m.
    pub rock_m: f64,
    /// Pillars that it runs through.
    pub pillars: usize,
    /// How much of it runs through them, m.
    pub pillar_m: f64,
    /// Closed doors that it runs through.
    pub doors: usize,
}

impl Sight {
    /// Nothing is in the way; an antenna may be embedded in the wall by a hand's breadth.
    pub fn is_clear(&self) -> bool {
        self.rock_m <= EMBEDDED_M && self.pillars == 0 && self.doors == 0
    }
}

impl Mine {
    /// Checks a plan and makes a mine of it; all its errors when it has any. Warnings are for [`check`](crate::check()).
    pub fn new(plan: MinePlan) -> Result<Self, MineError> {
        let plan = plan.canonical();
        let (mut findings, survey) = inspect(&plan, &Unread::default());
        findings.retain(|finding| finding.severity() == Severity::Error);
        match survey {
            Some(survey) if findings.is_empty() => Ok(Self::from_survey(plan, survey)),
            _ => Err(MineError::Unsound { findings }),
        }
    }

    /// A mine of a plan that is not checked: what is wrong in it stays wrong. For what programs make, and for tests.
    ///
    /// Numbers must be finite and within 10⁷ m, as [`check`](crate::check()) wants them; else answers mean nothing.
    pub fn unchecked(plan: MinePlan) -> Self {
        let plan = plan.canonical();
        let survey = Survey::new(&plan);
        Self::from_survey(plan, survey)
    }

    pub(crate) fn from_survey(plan: MinePlan, survey: Survey) -> Self {
        let Survey { built, excavation, levels } = survey;
        Self { plan, network: built.network, excavation, levels }
    }

    /// What the file says.
    pub fn plan(&self) -> &MinePlan {
        &self.plan
    }

    /// The roadways as a graph.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// What is air.
    pub fn excavation(&self) -> &Excavation {
        &self.excavation
    }

    /// Where on Earth its grid lies; `None` for a local grid.
    pub fn georeference(&self) -> Option<Georeference> {
        Georeference::of(&self.plan)
    }

    /// The level that a height belongs to: the one whose elevation is nearest; `None` without levels.
    pub fn level_at(&self, z_m: f64) -> Option<&Level> {
        self.levels.of(z_m).map(|index| &self.plan.levels[index])
    }

    /// Lowest and highest height that belong to a level, m; `None` for an id that is none.
    pub fn band_m(&self, level: &str) -> Option<(f64, f64)> {
        self.level_index(level).map(|index| self.levels.band_m(index))
    }

    /// The zones that a point is in, on its level.
    pub fn zones_at(&self, point: &Position<MineGrid>) -> impl Iterator<Item = &Zone> {
        let p = *point.raw();
        let level = self.level_at(p.z).map(|level| level.id.as_str());
        self.plan
            .zones
            .iter()
            .filter(move |zone| Some(zone.level.as_str()) == level && zone.holds(false, p.x, p.y))
    }

    /// Places on the network inside a zone, to find the way to it; empty when no roadway leads there.
    pub fn spots_in(&self, zone: &Zone) -> Vec<crate::network::Spot> {
        let level = self.level_index(&zone.level);
        level.map_or_else(Vec::new, |level| spots_in(&self.plan, &self.network, &self.levels, zone, level))
    }

    /// What lies between two points: rock, pillars, closed doors.
    pub fn sight(&self, from: &Position<MineGrid>, to: &Position<MineGrid>) -> Sight {
        let (a, b) = (from.raw(), to.raw());
        let distance_m = (b - a).norm();
        let mut pillars = 0;
        let mut blocked: Vec<Span> = Vec::new();
        for pillar in &self.plan.pillars {
            let Some((low, high)) = self.pillar_band_m(pillar) else { continue };
            let upright = Span::WHOLE.where_between(a.z, b.z - a.z, low, high);
            let across = chords(&pillar.outline_m, [a.x, a.y], [b.x, b.y], Outline::Outside);
            let parts = across.into_iter().filter_map(|c| upright?.clipped(c.from, c.to));
            let before = blocked.len();
            blocked.extend(parts);
            pillars += usize::from(blocked.len() > before);
        }
        let doors = self.plan.doors.iter().filter(|door| door.closed).filter(|door| {
            let Some((low, high)) = self.band_m(&door.level) else { return false };
            let [c, d] = door.ends_m;
            meeting([a.x, a.y], [b.x, b.y], c, d).is_some_and(|(s, t)| {
                let z = a.z + s * (b.z - a.z);
                (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) && (low..high).contains(&z)
            })
        });
        Sight {
            distance_m,
            rock_m: self.excavation.rock_m(from, to),
            pillars,
            pillar_m: covered(&mut blocked) * distance_m,
            doors: doors.count(),
        }
    }

    fn pillar_band_m(&self, pillar: &Pillar) -> Option<(f64, f64)> {
        let level = self.level_index(&pillar.level)?;
        let (low, high) = self.levels.band_m(level);
        let top = pillar.height_m.map_or(high, |height_m| self.plan.levels[level].elevation_m + height_m);
        Some((low, top.min(high)))
    }

    fn level_index(&self, id: &str) -> Option<usize> {
        self.plan.levels.iter().position(|level| level.id == id)
    }
}
