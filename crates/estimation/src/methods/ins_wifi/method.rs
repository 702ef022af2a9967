//! Both as methods.

use super::{Full, InsWifi, InsWifiParams, Mechanisation, Reduced, full, params, reduced};
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, Nis, NoiseParameter,
};
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Warnings kept in a report; later ones of a broken log are only counted by their effect.
const WARNINGS_KEPT: usize = 100;
/// Dimension of a level fix.
const FIX_DIMENSION: usize = 2;

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InsWifiReport {
    /// IMU samples processed.
    pub samples: u64,
    /// Fixes in the log.
    pub fixes: u64,
    /// Fixes that corrected the state.
    pub used_fixes: u64,
    /// Of these, outliers whose pull was limited.
    pub bounded_fixes: u64,
    /// Fixes older than the state, or than the first sample: left out.
    pub late_fixes: u64,
    /// Sum of the normalised innovations squared of the used ones that are no outliers (2 degrees of freedom each).
    pub nis_sum: f64,
    /// Warnings, at most the first hundred.
    pub warnings: Vec<MethodWarning>,
}

impl InsWifiReport {
    pub(super) fn note(&mut self, nis: f64, bound: f64) {
        self.used_fixes += 1;
        if nis > bound {
            self.bounded_fixes += 1;
        } else {
            self.nis_sum += nis;
        }
    }

    pub(super) fn warn(&mut self, warning: MethodWarning) {
        if self.warnings.len() < WARNINGS_KEPT {
            self.warnings.push(warning);
        }
    }
}

impl MethodReport for InsWifiReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }

    fn nis(&self) -> Option<Nis> {
        let count = self.used_fixes - self.bounded_fixes;
        (count > 0).then_some(Nis { dimension: FIX_DIMENSION, count, sum: self.nis_sum })
    }
}

impl<M: Mechanisation<N>, const N: usize> Method for InsWifi<M, N> {
    type Report = InsWifiReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Ok(None)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        if self.report.samples == 0 { Err(MethodError::Empty) } else { Ok(None) }
    }

    fn report(&self) -> &InsWifiReport {
        Self::report(self)
    }
}

impl InsWifiParams {
    pub(crate) fn knowing(mut self, known: &Known) -> Self {
        self.noise = known.specification.unwrap_or(self.noise);
        self.site = known.site.or(self.site);
        self.start = known.start.or(self.start);
        self
    }
}

/// Settings of `reduced-ins-wifi`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ReducedInsWifiParams(pub InsWifiParams);

/// Settings of `full-ins-wifi`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FullInsWifiParams(pub InsWifiParams);

impl MethodSettings for ReducedInsWifiParams {
    type Report = InsWifiReport;

    const NAME: &'static str = Reduced::NAME;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&params::NOISE];

    fn knowing(self, known: &Known) -> Self {
        Self(self.0.knowing(known))
    }

    fn start(self) -> Result<Box<dyn Method<Report = InsWifiReport>>, MethodError> {
        Ok(Box::new(InsWifi::<Reduced, { reduced::STATES }>::new(self.0)?))
    }
}

impl MethodSettings for FullInsWifiParams {
    type Report = InsWifiReport;

    const NAME: &'static str = Full::NAME;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&params::NOISE, &params::FULL_NOISE];

    fn knowing(self, known: &Known) -> Self {
        Self(self.0.knowing(known))
    }

    fn start(self) -> Result<Box<dyn Method<Report = InsWifiReport>>, MethodError> {
        Ok(Box::new(InsWifi::<Full, { full::STATES }>::new(self.0)?))
    }
}
