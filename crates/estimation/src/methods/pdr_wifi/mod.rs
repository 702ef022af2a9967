//! `pdr-wifi`: system S1 (Lu, Zhao & Xu): dead reckoning at the waist, a position by Wi-Fi with every report, and a filter of four
//! states between them.
//!
//! ```text
//! gyro, acc, mag    → steps, length, direction (methods::pdr, without fixes)     ┐
//! signal strengths  → scans, averaged → improved weighted centroid (radio)       ┴→ report → filter (fusion) → solution
//! ```
//!
//! One solution for every step, and one a second while nobody walks: dead reckoning less what the filter holds it to be off. A report is of the mean time of its
//! scans; it is held against where dead reckoning was then, whichever of them comes first, and tells in the next solution.
//!
//! Frame: that of the site. Dead reckoning begins at the start that somebody told; else at the first position by radio, before which there is no
//! solution. Its heading is that of the magnetometer: the paper's filter has no state for a heading that is off, its velocities take up what
//! is constant.
//! Limits: those of both halves; heights are zero.

mod fusion;
mod method;

pub use fusion::{Components, Fused, Fusion, FusionParams, Report, Walk, squared_error_m2};
pub use method::{PdrWifiParams, PdrWifiReport};

use crate::methods::MethodError;
use crate::methods::pdr::Pdr;
use crate::pedestrian::trail::Trail;
use crate::radio::Listener;
use adit_core::nalgebra::Vector2;
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_observation::{Observation, PositionFix};
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "pdr-wifi";
/// Positions by radio that may wait for the steps before them; with more, the oldest are dropped.
const MOST_HELD: usize = 64;

/// One walker, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PdrWifi {
    params: PdrWifiParams,
    pdr: Pdr,
    listener: Listener,
    /// `None` until it is known where dead reckoning begins.
    fusion: Option<Fusion>,
    /// From the origin of dead reckoning to that of the site, m.
    origin_m: Vector2<f64>,
    /// Positions by radio newer than dead reckoning, in order of time.
    held: VecDeque<PositionFix>,
    /// Where dead reckoning has been of late, in its own frame.
    trail: Trail,
    /// Time of the last report.
    reported: Option<Time>,
    due: VecDeque<Solution>,
    report: PdrWifiReport,
}

impl PdrWifi {
    /// A walker of whom nothing is known but the settings.
    pub fn new(params: PdrWifiParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        let mut dead_reckoning = params.pdr.clone();
        dead_reckoning.fixes.used = false;
        let start_sigma_m = params.start_sigma_m();
        Ok(Self {
            pdr: Pdr::new(dead_reckoning)?,
            listener: Listener::new(NAME, params.site.as_deref(), params.scan, params.locator)?,
            fusion: start_sigma_m.map(|sigma_m| Fusion::new(&params.fusion, sigma_m)),
            origin_m: Vector2::zeros(),
            held: VecDeque::with_capacity(MOST_HELD),
            trail: Trail::default(),
            reported: None,
            due: VecDeque::new(),
            report: PdrWifiReport::default(),
            params,
        })
    }

    /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match observation {
            Observation::Signal(signal) => {
                self.listener.observe(signal);
                self.listen();
            }
            Observation::Imu(imu) => {
                self.listener.advance(imu.time);
                self.listen();
                let mut reckoned = self.pdr.observe(observation)?;
                while let Some(now) = reckoned {
                    self.reckon(&now)?;
                    reckoned = self.pdr.next_due();
                }
            }
            // Fixes of another origin are not the paper's.
            Observation::Fix(_) => {}
            other => {
                let mut reckoned = self.pdr.observe(other)?;
                while let Some(now) = reckoned {
                    self.reckon(&now)?;
                    reckoned = self.pdr.next_due();
                }
            }
        }
        Ok(self.due.pop_front())
    }

    /// A further solution that the observations so far make due, if any.
    pub fn next_due(&mut self) -> Option<Solution> {
        self.due.pop_front()
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(fix) = self.listener.finish() {
            self.hold(fix);
        }
        while let Some(reckoned) = self.pdr.finish_next()? {
            self.reckon(&reckoned)?;
        }
        self.report.account(&self.listener, self.pdr.report());
        if self.fusion.is_none() {
            return Err(self.report.heard.no_position());
        }
        Ok(self.due.pop_front())
    }

    /// What the run did so far.
    pub fn report(&self) -> &PdrWifiReport {
        &self.report
    }

    /// Takes the positions by radio that are due.
    fn listen(&mut self) {
        while let Some(fix) = self.listener.pop() {
            self.hold(fix);
        }
    }

    /// Takes a position by radio, or keeps it until dead reckoning has come to its time.
    fn hold(&mut self, fix: PositionFix) {
        if self.trail.newest().is_some_and(|newest| fix.time <= newest) {
            self.take(&fix);
            return;
        }
        if self.held.len() == MOST_HELD {
            self.held.pop_front();
            self.report.late_fixes += 1;
        }
        let place = self.held.partition_point(|held| held.time <= fix.time);
        self.held.insert(place, fix);
    }

    /// Dead reckoning has come to a solution: the reports on the way, then the solution itself.
    fn reckon(&mut self, now: &Solution) -> Result<(), MethodError> {
        self.trail.push(now.time, now.position_m.xy());
        while self.held.front().is_some_and(|fix| fix.time <= now.time) {
            if let Some(fix) = self.held.pop_front() {
                self.take(&fix);
            }
        }
        self.tell(now)
    }

    /// A report: where dead reckoning is, and where radio is.
    fn take(&mut self, fix: &PositionFix) {
        let old = self.reported.is_some_and(|reported| fix.time <= reported);
        let Some(reckoned_m) = self.trail.at(fix.time).filter(|_| !old) else {
            self.report.late_fixes += 1;
            return;
        };
        let fusion = self.fusion.get_or_insert_with(|| {
            // Nobody told a start: the first position by radio is it, and says nothing more.
            self.origin_m = fix.level_m - reckoned_m;
            Fusion::new(&self.params.fusion, Vector2::repeat(self.params.fusion.fix_sigma_m))
        });
        let report =
            Report { time_s: fix.time.seconds(), reckoned_m: reckoned_m + self.origin_m, fix_m: fix.level_m };
        let fused = fusion.observe(&report);
        self.reported = Some(fix.time);
        self.report.note(&report, &fused);
    }

    /// Puts dead reckoning out, corrected.
    fn tell(&mut self, reckoned: &Solution) -> Result<(), MethodError> {
        let Some(fusion) = &self.fusion else { return Ok(()) };
        let since_s = self.reported.map_or(0.0, |reported| (reckoned.time - reported).seconds());
        let ([offset_m, rate_m_s], variances) = fusion.ahead(since_s);
        let mut solution = reckoned.clone();
        let level_m = reckoned.position_m.xy() + self.origin_m - offset_m;
        let velocity_m_s = reckoned.velocity_m_s.xy() - rate_m_s;
        if !level_m.iter().chain(&velocity_m_s).chain(&variances).all(|value| value.is_finite()) {
            return Err(MethodError::Diverged { time: reckoned.time });
        }
        solution.position_m.fixed_rows_mut::<2>(0).copy_from(&level_m);
        solution.velocity_m_s.fixed_rows_mut::<2>(0).copy_from(&velocity_m_s);
        // Before the first report dead reckoning knows best how sure it is.
        let known = self.reported.is_some();
        for (index, variance) in [0, 1, 3, 4].into_iter().zip(&variances).filter(|_| known) {
            solution.covariance.fixed_view_mut::<1, 9>(index, 0).fill(0.0);
            solution.covariance.fixed_view_mut::<9, 1>(0, index).fill(0.0);
            solution.covariance[(index, index)] = *variance;
        }
        let held = self
            .reported
            .is_some_and(|reported| (reckoned.time - reported).seconds() <= self.params.pdr.fixes.hold_s);
        solution.quality = if held { Quality::Fixed } else { Quality::DeadReckoning };
        self.due.push_back(solution);
        Ok(())
    }
}
