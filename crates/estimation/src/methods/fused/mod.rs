//! `fused`: one estimator for everything at hand.
//!
//! ```text
//!                  ┌ foot: strapdown with zero velocity (foot_ins, marg_ins) ┐
//! log → evidence ──┼ body: steps (pdr)                                       ├→ follower: place, heading, scale … held by ranges, signal
//!                  │                                                         ┘   strengths, fixes, barometer, portals, roadways (place)
//!                  ├ strapdown between fixes, of a sensor too slow for steps (ins_wifi)
//!                  └ nothing felt: ranges alone (uwb_filter), signal strengths alone (wifi)
//! ```
//!
//! **Why a carrier and a place.** Zero velocity at each step makes velocity, roll, pitch and the biases of a strapdown observable; position and heading alone are not
//! (Foxlin 2005; Nilsson, Skog & Händel 2010). So the carrier keeps its own filter, and a second one holds only what is left: position, turn of the
//! heading, its drift, the factor of lengths (Nilsson, Zachariah, Skog & Händel 2013, who send a foot's steps to a filter of the same kind). Every other observation is held against these
//! states by itself: a range, not a position of ranges.
//!
//! Frames: the mine's grid where something tells of it (anchors, transmitters, portals, a start), else the carrier's own.

mod aiding;
mod carrier;
mod evidence;
mod follower;
mod method;
mod params;
mod signals;

pub use carrier::CarrierKind;
pub use evidence::Process;
pub use method::FusedReport;
pub use params::FusedParams;

use crate::methods::ins_wifi::{InsWifi, Reduced, reduced};
use crate::methods::uwb_filter::UwbFilter;
use crate::methods::wifi::Wifi;
use crate::methods::{Method, MethodError, MethodReport};
use adit_core::solution::{Quality, Solution};
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use carrier::Carrier;
use evidence::Evidence;
use follower::Follower;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "fused";

/// One tag, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Fused {
    params: FusedParams,
    stage: Stage,
    due: VecDeque<Solution>,
    report: FusedReport,
}

/// How far the run has come.
#[derive(Debug, Clone, Serialize, Deserialize)]
enum Stage {
    /// What the log is of is not known yet.
    Looking(Box<Evidence>),
    /// A carrier, followed on the map.
    Carried(Box<(Carrier, Follower)>),
    /// Strapdown between fixes.
    Strapdown(Box<InsWifi<Reduced, { reduced::STATES }>>),
    /// Ranges alone.
    Ranges(Box<UwbFilter>),
    /// Signal strengths alone.
    Signals(Box<Wifi>),
}

impl Fused {
    /// A tag of which nothing is known but the settings.
    pub fn new(params: FusedParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        Ok(Self {
            params,
            stage: Stage::Looking(Box::default()),
            due: VecDeque::new(),
            report: FusedReport::default(),
        })
    }

    /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match &mut self.stage {
            Stage::Looking(evidence) => {
                if let Some(process) = evidence.observe(observation, &self.params) {
                    self.begin(process)?;
                }
            }
            _ => self.take(observation)?,
        }
        self.next_due()
    }

    /// A further solution that the observations so far make due, if any.
    #[inline]
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Ok(self.due.pop_front())
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        if let Stage::Looking(evidence) = &self.stage {
            let process = evidence.verdict(&self.params);
            self.begin(process)?;
        }
        if let Some(due) = self.due.pop_front() {
            return Ok(Some(due));
        }
        let Self { stage, due, report, .. } = self;
        match stage {
            Stage::Looking(_) => {}
            Stage::Carried(both) => {
                let (carrier, follower) = both.as_mut();
                follower.finish(report);
                while due.is_empty()
                    && let Some(reckoned) = carrier.finish_next()?
                {
                    due.extend(follower.reckon(carrier, reckoned, report)?);
                }
            }
            Stage::Strapdown(method) => due.extend(ended(method.as_mut(), report)?),
            Stage::Ranges(method) => due.extend(ended(method.as_mut(), report)?),
            Stage::Signals(method) => due.extend(ended(method.as_mut(), report)?),
        }
        let solution = self.due.pop_front();
        if let Some(solution) = &solution {
            self.report.count(solution);
        }
        Ok(solution)
    }

    /// What the run did so far.
    pub fn report(&self) -> &FusedReport {
        &self.report
    }

    /// The log is known: what was kept of it goes to whom it concerns.
    fn begin(&mut self, process: Process) -> Result<(), MethodError> {
        self.report.process = Some(process);
        let params = &self.params;
        let stage = match process {
            Process::Carried(kind) => {
                let carrier = Carrier::new(kind, params)?;
                let follower = Follower::new(params, &carrier)?;
                Stage::Carried(Box::new((carrier, follower)))
            }
            Process::Strapdown => Stage::Strapdown(Box::new(InsWifi::new(params.strapdown.clone())?)),
            Process::Ranges => {
                let mut alone = params.ranges_alone.clone();
                alone.site.clone_from(&params.site);
                Stage::Ranges(Box::new(UwbFilter::new(alone)?))
            }
            Process::Signals => {
                let mut alone = params.signals_alone.clone();
                alone.site.clone_from(&params.site);
                Stage::Signals(Box::new(Wifi::new(alone)?))
            }
        };
        let Stage::Looking(evidence) = core::mem::replace(&mut self.stage, stage) else { return Ok(()) };
        let kept: Vec<Observation> = evidence.kept;
        kept.iter().try_for_each(|observation| self.take(observation))
    }

    #[inline]
    fn take(&mut self, observation: &Observation) -> Result<(), MethodError> {
        let Self { stage, due, report, .. } = self;
        let before = due.len();
        match stage {
            Stage::Looking(_) => {}
            Stage::Carried(both) => {
                let (carrier, follower) = both.as_mut();
                follower.observe(observation, report);
                let mut reckoned = carrier.observe(observation)?;
                while let Some(now) = reckoned {
                    due.extend(follower.reckon(carrier, now, report)?);
                    reckoned = carrier.next_due()?;
                }
            }
            Stage::Strapdown(method) => drive(method.as_mut(), observation, due)?,
            Stage::Ranges(method) => drive(method.as_mut(), observation, due)?,
            Stage::Signals(method) => drive(method.as_mut(), observation, due)?,
        }
        for solution in due.iter().skip(before) {
            report.count(solution);
        }
        Ok(())
    }
}

/// A method alone.
fn drive(
    method: &mut impl Method,
    observation: &Observation,
    due: &mut VecDeque<Solution>,
) -> Result<(), MethodError> {
    let mut solution = method.observe(observation)?;
    while let Some(now) = solution {
        due.push_back(now);
        solution = method.next_due()?;
    }
    Ok(())
}

/// The next solution of a method alone after the end, and at last what it has to say.
fn ended(method: &mut impl Method, report: &mut FusedReport) -> Result<Option<Solution>, MethodError> {
    let solution = method.finish_next()?;
    if solution.is_none() {
        report.warnings = method.report().warnings().to_vec();
        if let Some(nis) = method.report().nis() {
            report.nis_sum = nis.sum;
            report.nis_count = nis.count * nis.dimension as u64;
        }
    }
    Ok(solution)
}

impl FusedReport {
    fn count(&mut self, solution: &Solution) {
        self.solutions += 1;
        self.reckoned_solutions += u64::from(solution.quality == Quality::DeadReckoning);
        self.lost_solutions += u64::from(solution.quality == Quality::Lost);
    }
}
