//! `fused`: one estimator for everything at hand.
//!
//! ```text
//!                  ┌ foot: strapdown with zero velocity, a compass beside it ┐
//! log → evidence ──┼ body: steps (pdr)                                       ├→ follower: place, heading, scale … held by ranges, signal
//!                  │                                                         ┘   strengths, fixes, barometer, portals, roadways (place)
//!                  ├ strapdown between fixes, of a sensor too slow for steps (ins_wifi)
//!                  ├ on nobody's body: attitude alone (ahrs), or ranges
//!                  └ nothing felt: ranges alone (uwb_filter), signal strengths alone (wifi)
//! ```
//!
//! **Why a carrier and a place.** Zero velocity at each step makes velocity, roll, pitch and the biases of a strapdown observable; position and heading alone are not
//! (Foxlin 2005; Nilsson, Skog & Händel 2010). So the carrier keeps its own filter, and a second one holds only what is left: position, turn of the
//! heading, its drift, the factor of lengths (Nilsson, Zachariah, Skog & Händel 2013, who send a foot's steps to a filter of the same kind). Every other observation is held against these
//! states by itself: a range, not a position of ranges.
//!
//! Frames: the mine's grid where something tells of it (anchors, transmitters, portals, a start), else the carrier's own.

mod across;
mod aiding;
mod carrier;
mod ears;
mod evidence;
mod follower;
mod foot;
mod holding;
mod method;
mod params;
mod placing;
mod repeats;
mod signals;
mod smoothing;

pub use carrier::CarrierKind;
pub use ears::Ears;
pub use evidence::Process;
pub use method::FusedReport;
pub use params::FusedParams;
pub use smoothing::smooth;

use crate::methods::ahrs::Ahrs;
use crate::methods::ins_wifi::{InsWifi, Reduced, reduced};
use crate::methods::uwb_filter::UwbFilter;
use crate::methods::wifi::Wifi;
use crate::methods::{Method, MethodError, MethodReport};
use crate::radio::HeardReport;
use crate::ranging::listener::RangesHeard;
use crate::weighed::SourceWeighed;
use adit_core::solution::{Quality, Solution};
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use carrier::Carrier;
use evidence::Evidence;
use follower::Follower;
use repeats::Repeats;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "fused";
/// Solutions for which room is kept.
const MOST_DUE: usize = 1;

/// One tag, streaming. One that was serialised and read back goes on to the same bits once [`Self::attach`] has given it its site again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Fused {
    stage: Stage,
    repeats: Repeats,
    due: VecDeque<Solution>,
    report: FusedReport,
}

/// How far the run has come.
#[derive(Debug, Clone, Serialize, Deserialize)]
enum Stage {
    /// What the log is of is not known yet.
    Looking(Box<(FusedParams, Evidence)>),
    /// A carrier, followed on the map.
    Carried(Box<(Carrier, Follower)>),
    /// Strapdown between fixes.
    Strapdown(Box<InsWifi<Reduced, { reduced::STATES }>>),
    /// Ranges alone.
    Ranges(Box<UwbFilter>),
    /// Signal strengths alone.
    Signals(Box<Wifi>),
    /// Attitude alone.
    Attitude(Box<Ahrs>),
}

impl Fused {
    /// A tag of which nothing is known but the settings.
    pub fn new(params: FusedParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        Ok(Self {
            stage: Stage::Looking(Box::new((params, Evidence::default()))),
            repeats: Repeats::default(),
            due: VecDeque::with_capacity(MOST_DUE),
            report: FusedReport::default(),
        })
    }

    /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        if self.repeats.is_repeated(observation) {
            return self.next_due();
        }
        match &mut self.stage {
            Stage::Looking(looking) => {
                let (params, evidence) = looking.as_mut();
                if let Some(process) = evidence.observe(observation, params) {
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
        let due = self.due.pop_front();
        if self.due.is_empty() && self.due.capacity() > MOST_DUE {
            // A thousand walkers hold what was due at the beginning of each.
            self.due.shrink_to(MOST_DUE);
        }
        Ok(due)
    }

    /// Gives a tag that was read back its site again: that of the settings it was started with, of which it then holds no copies.
    pub fn attach(&mut self, params: &FusedParams) -> Result<(), MethodError> {
        match &mut self.stage {
            Stage::Looking(looking) => {
                looking.0.site.clone_from(&params.site);
                looking.0.ears.clone_from(&params.ears);
                Ok(())
            }
            Stage::Carried(both) => both.1.attach(params),
            // They keep all that they need.
            Stage::Strapdown(_) | Stage::Ranges(_) | Stage::Signals(_) | Stage::Attitude(_) => Ok(()),
        }
    }

    /// Without what belongs to the site and all tags there have in common, megabytes of it: to be kept, and to go on after [`Self::attach`].
    #[must_use]
    pub fn detached(mut self) -> Self {
        if let Stage::Carried(both) = &mut self.stage {
            both.1.detach();
        }
        self
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        if let Stage::Looking(looking) = &self.stage {
            let (params, evidence) = looking.as_ref();
            let process = evidence.verdict(params);
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
                if due.is_empty() {
                    report.hear_out(carrier);
                    if report.solutions == 0 {
                        return Err(report.never_placed());
                    }
                }
            }
            Stage::Strapdown(method) => due.extend(ended(method.as_mut(), report)?),
            Stage::Ranges(method) => due.extend(ended(method.as_mut(), report)?),
            Stage::Signals(method) => due.extend(ended(method.as_mut(), report)?),
            Stage::Attitude(method) => due.extend(ended(method.as_mut(), report)?),
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

    /// The last innovation of each anchor and transmitter that holds the place.
    pub fn last_weighed(&self) -> Vec<SourceWeighed> {
        match &self.stage {
            Stage::Carried(both) => both.1.last_weighed(),
            Stage::Ranges(method) => Method::last_weighed(method.as_ref()),
            Stage::Looking(_) | Stage::Strapdown(_) | Stage::Signals(_) | Stage::Attitude(_) => Vec::new(),
        }
    }

    /// The log is known: what was kept of it goes to whom it concerns.
    fn begin(&mut self, process: Process) -> Result<(), MethodError> {
        self.report.process = Some(process);
        let Stage::Looking(looking) = &self.stage else { return Ok(()) };
        if looking.1.is_empty() {
            return Err(MethodError::Empty);
        }
        let params = &looking.0;
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
            Process::Attitude => Stage::Attitude(Box::new(Ahrs::new(params.attitude.clone())?)),
        };
        let Stage::Looking(looking) = core::mem::replace(&mut self.stage, stage) else { return Ok(()) };
        let kept: Vec<Observation> = looking.1.kept;
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
            Stage::Strapdown(method) => drive(method.as_mut(), observation, due, report)?,
            Stage::Ranges(method) => drive(method.as_mut(), observation, due, report)?,
            Stage::Signals(method) => drive(method.as_mut(), observation, due, report)?,
            Stage::Attitude(method) => drive(method.as_mut(), observation, due, report)?,
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
    report: &mut FusedReport,
) -> Result<(), MethodError> {
    let mut solution = method.observe(observation)?;
    while let Some(now) = solution {
        due.push_back(now);
        solution = method.next_due()?;
    }
    report.weigh_alone(method.report());
    Ok(())
}

/// The next solution of a method alone after the end, and at last what it has to say.
fn ended(method: &mut impl Method, report: &mut FusedReport) -> Result<Option<Solution>, MethodError> {
    let solution = method.finish_next()?;
    if solution.is_none() {
        report.warnings = method.report().warnings().to_vec();
        report.weigh_alone(method.report());
    }
    Ok(solution)
}

impl FusedReport {
    /// What the carrier and those who listened have to say at the end.
    fn hear_out(&mut self, carrier: &Carrier) {
        self.warnings = carrier.warnings().to_vec();
        self.warnings.extend(self.ranges.as_ref().and_then(RangesHeard::warning));
        self.warnings.extend(self.signals.as_ref().and_then(HeardReport::warning));
    }

    /// Why a walk was told nowhere on the map.
    fn never_placed(&self) -> MethodError {
        MethodError::NeverPlaced {
            ranges: self.ranges.as_ref().map_or(0, |heard| heard.ranges - heard.unknown_ranges),
            signals: self.signals.as_ref().map_or(0, |heard| heard.signals - heard.unknown_signals),
            fixes: self.fixes,
        }
    }

    fn count(&mut self, solution: &Solution) {
        self.solutions += 1;
        self.reckoned_solutions += u64::from(solution.quality == Quality::DeadReckoning);
        self.lost_solutions += u64::from(solution.quality == Quality::Lost);
    }
}
