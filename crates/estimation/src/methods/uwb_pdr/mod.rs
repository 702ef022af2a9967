//! `uwb-pdr`: system S4 (Jia et al. 2024): positions by UWB and dead reckoning at the waist, weighed by what is in the way of the ranges.
//!
//! ```text
//! impulse responses → line of sight? (adit-nlos, before the log comes here) ┐
//! ranges            → corrected (ranging::correction) → position (solver) ──┼→ environment → ω_u, ω_p → Z = ω_u Z_u + ω_p Z_p   eq. 11
//! gyro, acc, mag    → steps, length, direction (methods::pdr) ── aligned ───┘
//! ```
//!
//! `Z_p` is the last fused position carried on by the steps since. The paper sets the weights "by the relative accuracy of the two methods" in the recognised
//! [`Environment`] and prints no number; here they are the inverse variances of both ([`Fusion`]): `ω_u = σ_p²/(σ_p² + σ_u²)`.
//!
//! One solution for every epoch of ranges and for every step. Solutions come as late as those of `pdr`: an epoch waits for the step around it.
//! Frame: that of the anchors. Height: that of the solver's settings.
//! Limits: those of `pdr` and of [`crate::ranging`]. The heading of dead reckoning is never corrected: the fused place drifts with it while nothing clear is heard.

mod environment;
mod fusion;
mod method;

pub use environment::Environment;
pub use fusion::{Fusion, FusionParams, Weights};
pub use method::{UwbPdrParams, UwbPdrReport};

use crate::methods::alignment::{Alignment, Event};
use crate::methods::somewhere::somewhere;
use crate::methods::{MethodError, MethodWarning};
use crate::radio::AreaPrior;
use crate::ranging::epochs::Epoch;
use crate::ranging::listener::{Link, RangeListener};
use crate::ranging::solver::{Solver, SolverKind};
use crate::ranging::{Ranged, RangingFix};
use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_observation::Observation;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "uwb-pdr";
/// Mirror images are parted by so many standard deviations of the expected place, and at least by so much, m.
const SIDES: f64 = 3.0;
const SIDE_M: f64 = 3.0;

/// One walker, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct UwbPdr {
    params: UwbPdrParams,
    alignment: Alignment,
    solver: Solver,
    fusion: Fusion,
    /// The last solution of dead reckoning.
    reckoned: Option<Solution>,
    /// Height of the last position by UWB, m, and its variance, m².
    height: [f64; 2],
    /// Time of the last epoch that counted, and of the last solution.
    fixed: Option<Time>,
    told: Option<Time>,
    report: UwbPdrReport,
}

impl UwbPdr {
    /// A walker of whom nothing is known but the settings.
    pub fn new(params: UwbPdrParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        let listener = RangeListener::new(NAME, params.site.as_deref(), params.ranges.clone())?;
        let start = params.pdr.start.map(|start| {
            let [east, north] = start.position_sigma_m;
            0.5 * (east * east + north * north)
        });
        Ok(Self {
            alignment: Alignment::new(listener, Some(params.pdr.clone()))?,
            solver: Solver::new(params.solver, params.site.as_deref()),
            fusion: Fusion::new(params.fusion, start),
            reckoned: None,
            height: [
                params.solver.height_m.unwrap_or(0.0),
                params.solver.height_sigma_m * params.solver.height_sigma_m,
            ],
            fixed: None,
            told: None,
            report: UwbPdrReport::default(),
            params,
        })
    }

    /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        self.alignment.observe(observation)?;
        self.next_due()
    }

    /// A further solution that the observations so far make due, if any.
    #[inline]
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(event) = self.alignment.pop() {
            let solution = match event {
                Event::Reckoned(reckoned) => self.reckon(reckoned)?,
                Event::Ranges(epoch, way_m) => self.range(&epoch, way_m)?,
            };
            if solution.is_some() {
                return Ok(solution);
            }
        }
        Ok(None)
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        self.alignment.finish()?;
        let solution = self.next_due()?;
        if solution.is_none() {
            self.report.account(&self.alignment);
            if self.told.is_none() {
                return Err(self.report.heard.no_position());
            }
            if self.report.unjudged_epochs > 0 {
                self.report.warn(MethodWarning::Unjudged { epochs: self.report.unjudged_epochs });
            }
        }
        Ok(solution)
    }

    /// What the run did so far.
    pub fn report(&self) -> &UwbPdrReport {
        &self.report
    }

    /// An epoch: the environment, the position by UWB, both weights.
    fn range(&mut self, epoch: &Epoch, way_m: Option<Vector2<f64>>) -> Result<Option<Solution>, MethodError> {
        let (time, listener) = (epoch.time(), self.alignment.listener());
        self.report.heard.clone_from(listener.heard());
        let links: Vec<Link> = epoch.ranges.iter().filter_map(|range| listener.link(range)).collect();
        self.report.unjudged_epochs += u64::from(links.iter().all(|link| link.line_of_sight.is_none()));
        let environment = Environment::of(&links, self.params.solver.least_ranges);
        self.report.note(environment);
        let expected = way_m.and_then(|way_m| self.expected(&way_m));
        let Some(fix) = self.fix(&links, environment, expected.as_ref()) else { return Ok(None) };
        self.height = [fix.position_m.z, fix.covariance_m2[(2, 2)]];
        let covariance_m2 = fix.covariance_m2.fixed_view::<2, 2>(0, 0).into_owned();
        let Some(way_m) = way_m else {
            // Nothing but UWB.
            self.report.fixes += 1;
            return Ok(self.tell_once(time, |_| Some(somewhere(time, fix.position_m, &fix.covariance_m2))));
        };
        let weight = self.fusion.observe(time, &way_m, &fix.position_m.xy(), &covariance_m2, environment);
        self.report.fixes += 1;
        self.report.uwb_weight_sum += weight;
        self.fixed = self.fixed.max(Some(time));
        self.tell(time, &way_m)
    }

    /// Where ranges are to look: about the place that dead reckoning tells, so far that it decides between mirror images and says nothing else.
    fn expected(&self, way_m: &Vector2<f64>) -> Option<AreaPrior> {
        let (mean_m, covariance_m2) = self.fusion.place(way_m)?;
        let wide = Matrix2::identity() * (SIDE_M * SIDE_M);
        Some(AreaPrior { mean_m, covariance_m2: covariance_m2 * (SIDES * SIDES) + wide })
    }

    /// A position by UWB of what the environment leaves.
    fn fix(
        &self,
        links: &[Link],
        environment: Environment,
        expected: Option<&AreaPrior>,
    ) -> Option<RangingFix> {
        // Linear squares have no weights: what is clear is enough, or everything counts alike.
        let clear_alone =
            environment == Environment::WithError && self.params.solver.kind != SolverKind::Robust;
        let taken = links.iter().filter(|link| !clear_alone || link.is_clear());
        let ranges: Vec<Ranged> = taken.map(|link| link.ranged).collect();
        match expected {
            Some(expected) => self.solver.solve_within(&ranges, Some(expected)),
            None => self.solver.solve(&ranges),
        }
    }

    /// Dead reckoning has come to a place.
    fn reckon(&mut self, now: Solution) -> Result<Option<Solution>, MethodError> {
        let (time, way_m) = (now.time, now.position_m.xy());
        self.fusion.walk(time, &way_m);
        self.reckoned = Some(now);
        self.tell(time, &way_m)
    }

    /// Puts the fused place out, where there is one.
    fn tell(&mut self, time: Time, way_m: &Vector2<f64>) -> Result<Option<Solution>, MethodError> {
        let (Some((place_m, covariance_m2)), Some(reckoned)) = (self.fusion.place(way_m), &self.reckoned)
        else {
            return Ok(None);
        };
        if !(place_m.x.is_finite() && place_m.y.is_finite() && covariance_m2.trace().is_finite()) {
            return Err(MethodError::Diverged { time });
        }
        let mut solution = reckoned.clone();
        solution.time = time;
        solution.position_m = place_m.push(self.height[0]);
        solution.covariance.fixed_view_mut::<3, 9>(0, 0).fill(0.0);
        solution.covariance.fixed_view_mut::<9, 3>(0, 0).fill(0.0);
        solution.covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&covariance_m2);
        solution.covariance[(2, 2)] = self.height[1];
        let hold_s = self.params.pdr.fixes.hold_s;
        let held = self.fixed.is_some_and(|fixed| (time - fixed).seconds() <= hold_s);
        solution.quality = if held { Quality::Fixed } else { Quality::DeadReckoning };
        Ok(self.tell_once(time, |_| Some(solution)))
    }

    fn tell_once(&mut self, time: Time, of: impl FnOnce(&Self) -> Option<Solution>) -> Option<Solution> {
        if self.told.is_some_and(|told| time <= told) {
            return None;
        }
        let solution = of(self)?;
        self.told = Some(time);
        Some(solution)
    }
}
