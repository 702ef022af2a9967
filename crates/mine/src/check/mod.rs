//! Is this a mine that can be worked with? Everything that is wrong, at once.

mod devices;
mod grid;
mod ids;
mod meetings;
mod outlines;
mod roadways;
mod values;
mod works;
mod zones;

use crate::excavation::{Excavation, Opening};
use crate::finding::{Finding, Place};
use crate::levels::Levels;
use crate::network::{Built, build};
use crate::plan::MinePlan;
use crate::problem::Problem;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// Farther from the origin of its grid no mine lies, m.
const FARTHEST_M: f64 = 1e7;
/// How far a device may be inside the rock: niches, and the survey's own error, m.
const NICHE_M: f64 = 0.3;

/// Entries that a file has and that could not be read: what refers to them is not wrong for that.
#[derive(Debug, Clone, Default)]
pub struct Unread {
    /// Their ids.
    pub ids: Vec<String>,
    /// A roadway, a chamber or a level is among them: what is connected, and what is rock, cannot be told.
    pub openings: bool,
    /// The grid is.
    pub grid: bool,
}

/// The geometry of a plan, made once for the checks and for the mine.
pub struct Survey {
    pub built: Built,
    pub excavation: Excavation,
    pub levels: Levels,
}

impl Survey {
    pub fn new(plan: &MinePlan) -> Self {
        let built = build(plan);
        let roadways = plan.roadways.iter().zip(&built.lines).map(|(r, line)| (r, line.as_ref()));
        let excavation = Excavation::new(roadways, plan.chambers.iter());
        Self { built, excavation, levels: Levels::new(&plan.levels) }
    }
}

/// All that is wrong with a plan: errors and warnings, in order of place.
pub fn check(plan: &MinePlan) -> Vec<Finding> {
    inspect(plan, &Unread::default()).0
}

/// [`check`], and the geometry that it needed; none when numbers are too odd to work with.
pub fn inspect(plan: &MinePlan, unread: &Unread) -> (Vec<Finding>, Option<Survey>) {
    let mut checks = Checks { plan, unread, findings: Vec::new() };
    checks.values();
    checks.ids();
    checks.references();
    if !unread.grid {
        checks.grid();
    }
    let sound = !checks.findings.iter().any(|f| f.problem.forbids_geometry());
    checks.roadways();
    checks.outlines();
    let survey = sound.then(|| Survey::new(plan));
    if let Some(survey) = &survey {
        checks.meetings(survey);
        checks.zones(survey);
        checks.devices(survey);
        checks.works(survey);
    }
    (checks.findings, survey)
}

impl Problem {
    /// Is a number so odd that no geometry can be made with it?
    const fn forbids_geometry(&self) -> bool {
        matches!(self, Self::FarCoordinate { .. } | Self::NotFinite { .. } | Self::OutOfRange { .. })
    }
}

/// Checks under way.
struct Checks<'p> {
    plan: &'p MinePlan,
    unread: &'p Unread,
    findings: Vec<Finding>,
}

impl Checks<'_> {
    fn report(&mut self, place: Place, problem: Problem) {
        self.findings.push(Finding { place, problem });
    }

    /// Can it be told what is rock and what is connected?
    fn openings_known(&self) -> bool {
        let empty = self.plan.roadways.is_empty() && self.plan.chambers.is_empty();
        !self.unread.openings && !empty
    }

    /// An opening as messages call it.
    fn name(&self, opening: Opening) -> String {
        match opening {
            Opening::Roadway(index) => format!("roadway {}", self.plan.roadways[index].id),
            Opening::Chamber(index) => format!("chamber {}", self.plan.chambers[index].id),
        }
    }

    fn level(&self, id: &str) -> Option<usize> {
        self.plan.levels.iter().position(|level| level.id == id)
    }
}
