//! `pdr` as one of the methods, and what it says of a run.

use super::walker::{FACTOR, OFFSET, Walker};
use super::{Direction, NAME, Pdr, PdrParams, params};
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, Nis, NoiseParameter, RadioUse,
};
use crate::pedestrian::steps::Step;
use crate::radio::{HeardReport, RadioSite};
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Warnings kept in a report; later ones of a broken log are only counted by their effect.
const WARNINGS_KEPT: usize = 100;
/// Dimension of a level fix.
const FIX_DIMENSION: usize = 2;

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PdrReport {
    /// Samples of the accelerometer processed.
    pub samples: u64,
    /// Steps walked.
    pub steps: u64,
    /// Of these, steps that were not seen but told by the rhythm of those around them.
    pub unseen_steps: u64,
    /// Length of the way, m.
    pub distance_m: f64,
    /// Time spent in steps, s.
    pub walking_s: f64,
    /// Factor of the step length, and its standard deviation, at the last step.
    pub length_factor: f64,
    /// Standard deviation of that factor.
    pub length_factor_sigma: f64,
    /// Angle from the tag's heading to forward at the last step, deg.
    pub offset_deg: f64,
    /// Standard deviation of that angle, deg.
    pub offset_sigma_deg: f64,
    /// True when the heading came from the magnetometer.
    pub magnetic_heading: bool,
    /// True when the log has an accelerometer without a gyro: no direction is known.
    pub no_gyro: bool,
    /// Times that the tag was turned over on the way.
    pub turned_over: u64,
    /// Fixes in the log.
    pub fixes: u64,
    /// Fixes that told where the walk lies on the map.
    pub searched_fixes: u64,
    /// Fixes that corrected the state.
    pub used_fixes: u64,
    /// Of these, outliers whose pull was limited.
    pub bounded_fixes: u64,
    /// Fixes older than the state: left out.
    pub late_fixes: u64,
    /// Sum of the normalised innovations squared of the used ones that are no outliers (2 degrees of freedom each).
    pub nis_sum: f64,
    /// What was heard by radio, where it was used.
    pub heard: Option<HeardReport>,
    /// Warnings, at most the first hundred.
    pub warnings: Vec<MethodWarning>,
}

impl PdrReport {
    pub(super) fn note_step(&mut self, step: &Step, walker: &Walker) {
        self.steps += 1;
        self.unseen_steps += u64::from(!step.seen);
        self.walking_s += step.period_s;
        self.length_factor = walker.factor;
        self.length_factor_sigma = libm::sqrt(walker.covariance[(FACTOR, FACTOR)]);
        self.offset_deg = walker.offset_rad.to_degrees();
        self.offset_sigma_deg = libm::sqrt(walker.covariance[(OFFSET, OFFSET)]).to_degrees();
    }

    pub(super) fn note_fix(&mut self, nis: f64, bound: f64) {
        self.used_fixes += 1;
        if nis > bound {
            self.bounded_fixes += 1;
        } else {
            self.nis_sum += nis;
        }
    }

    pub(super) fn note_radio(&mut self, heard: &HeardReport) {
        if self.heard.is_none()
            && let Some(warning) = heard.warning()
        {
            self.warn(warning);
        }
        self.heard = Some(heard.clone());
    }

    pub(super) fn warn(&mut self, warning: MethodWarning) {
        if self.warnings.len() < WARNINGS_KEPT {
            self.warnings.push(warning);
        }
    }
}

impl Method for Pdr {
    type Report = PdrReport;

    #[inline]
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Ok(Self::next_due(self))
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::finish_next(self)
    }

    fn report(&self) -> &PdrReport {
        Self::report(self)
    }
}

impl MethodSettings for PdrParams {
    type Report = PdrReport;

    const NAME: &'static str = NAME;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&params::NOISE];
    const RADIO: RadioUse = RadioUse::Optional;

    fn knowing(mut self, known: &Known) -> Self {
        self.attitude = self.attitude.knowing(known);
        self.start = known.start.or(self.start);
        if known.mounted {
            self.direction = Direction::Mounted;
        }
        self
    }

    fn at_site(self, radio: &Arc<RadioSite>) -> Self {
        Self { site: Some(Arc::clone(radio)), ..self }
    }

    fn start(self) -> Result<Box<dyn Method<Report = PdrReport>>, MethodError> {
        Ok(Box::new(Pdr::new(self)?))
    }
}

impl MethodReport for PdrReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }

    fn nis(&self) -> Option<Nis> {
        let count = self.used_fixes - self.bounded_fixes;
        (count > 0).then_some(Nis { dimension: FIX_DIMENSION, count, sum: self.nis_sum })
    }

    fn outliers(&self) -> u64 {
        self.bounded_fixes
    }
}
