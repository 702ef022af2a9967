//! `fused` as one of the methods, and what it says of a run.

use super::ears::Ears;
use super::evidence::Process;
use super::{Fused, FusedParams, NAME, smooth};
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, Nis, NoiseParameter, RadioUse,
};
use crate::place::params::CarrierNoise;
use crate::radio::{HeardReport, RadioSite};
use crate::ranging::listener::RangesHeard;
use crate::weighed::SourceWeighed;
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FusedReport {
    /// How the tag was carried, once that is known.
    pub process: Option<Process>,
    /// Solutions.
    pub solutions: u64,
    /// Of these, such as only dead reckoning holds.
    pub reckoned_solutions: u64,
    /// Of these, such as are lost.
    pub lost_solutions: u64,
    /// Positions from outside that were used.
    pub fixes: u64,
    /// Observations that came too late to be used.
    pub late: u64,
    /// Times that the place was sought anew.
    pub reopened: u64,
    /// Innovations that were widened.
    pub outliers: u64,
    /// Sum of the normalised innovations squared of the others, and their degrees of freedom.
    pub nis_sum: f64,
    /// Degrees of freedom of that sum.
    pub nis_count: u64,
    /// Ranges heard beside a carrier.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ranges: Option<RangesHeard>,
    /// Signals heard beside a carrier.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signals: Option<HeardReport>,
    /// Warnings.
    pub warnings: Vec<MethodWarning>,
}

impl FusedReport {
    pub(super) fn note(&mut self, nis: f64, dimension: u64, widened: f64) {
        if widened > 1.0 {
            self.outliers += 1;
        } else {
            self.nis_sum += nis;
            self.nis_count += dimension;
        }
    }

    /// What a method alone has weighed so far.
    #[inline]
    pub(super) fn weigh_alone(&mut self, alone: &impl MethodReport) {
        self.outliers = alone.outliers();
        if let Some(nis) = alone.nis() {
            self.nis_sum = nis.sum;
            self.nis_count = nis.count * nis.dimension as u64;
        }
    }
}

impl Method for Fused {
    type Report = FusedReport;

    #[inline]
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::next_due(self)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::finish_next(self)
    }

    fn report(&self) -> &FusedReport {
        Self::report(self)
    }

    fn last_weighed(&self) -> Vec<SourceWeighed> {
        Self::last_weighed(self)
    }
}

impl MethodSettings for FusedParams {
    type Report = FusedReport;

    const NAME: &'static str = NAME;
    const WHOLE_LOG: bool = true;
    const RADIO: RadioUse = RadioUse::Optional;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&CarrierNoise::NOISE];

    fn knowing(mut self, known: &Known) -> Self {
        self.worn = known.worn.or(self.worn);
        self.start = known.start.or(self.start);
        self.compass |= known.declination_rad.is_some() || known.field.is_some();
        self.attitude = self.attitude.knowing(known);
        self.foot = self.foot.knowing(known);
        self.marg = self.marg.knowing(known);
        self.steps = self.steps.knowing(known);
        self.strapdown = self.strapdown.knowing(known);
        self
    }

    fn at_site(self, radio: &Arc<RadioSite>) -> Self {
        let mut settings = Self { site: Some(Arc::clone(radio)), ..self };
        // What cannot be made is told at the start.
        settings.ears = Ears::new(&settings).ok();
        settings
    }

    fn start(self) -> Result<Box<dyn Method<Report = FusedReport>>, MethodError> {
        Ok(Box::new(Fused::new(self)?))
    }

    fn smooth(
        self,
        log: &[Observation],
        progress: &mut dyn FnMut(usize),
    ) -> Result<(Vec<Solution>, FusedReport), MethodError> {
        smooth(self, log, progress)
    }
}

impl MethodReport for FusedReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }

    fn nis(&self) -> Option<Nis> {
        (self.nis_count > 0).then_some(Nis { dimension: 1, count: self.nis_count, sum: self.nis_sum })
    }

    fn outliers(&self) -> u64 {
        self.outliers
    }
}
