//! The three filters as methods: their settings, and what they say of a run.

use super::{UwbFilter, UwbFilterParams, Variant};
use crate::methods::pdr::PdrReport;
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, Nis, NoiseParameter, RadioUse,
};
use crate::radio::RadioSite;
use crate::ranging::filter::{FilterParams, FilterReport};
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
pub struct UwbFilterReport {
    /// What was heard.
    #[serde(flatten)]
    pub heard: RangesHeard,
    /// What became of it.
    pub filter: FilterReport,
    /// Solutions.
    pub solutions: u64,
    /// Of these, such as no range holds.
    pub unsure_solutions: u64,
    /// Sum of the radii of 95 % of the solutions, m.
    pub radius_95_sum_m: f64,
    /// Dead reckoning, where there is any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<PdrReport>,
    /// Warnings.
    pub warnings: Vec<MethodWarning>,
}

impl Method for UwbFilter {
    type Report = UwbFilterReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::next_due(self)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::finish_next(self)
    }

    fn report(&self) -> &UwbFilterReport {
        Self::report(self)
    }

    fn last_weighed(&self) -> Vec<SourceWeighed> {
        Self::last_weighed(self)
    }
}

impl<V: Variant> MethodSettings for UwbFilterParams<V> {
    type Report = UwbFilterReport;

    const NAME: &'static str = V::NAME;
    const RADIO: RadioUse = RadioUse::Needed;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&FilterParams::NOISE];

    fn knowing(self, known: &Known) -> Self {
        Self { steps: self.steps.map(|steps| steps.knowing(known)), ..self }
    }

    fn at_site(self, radio: &Arc<RadioSite>) -> Self {
        Self { site: Some(Arc::clone(radio)), ..self }
    }

    fn start(self) -> Result<Box<dyn Method<Report = UwbFilterReport>>, MethodError> {
        Ok(Box::new(UwbFilter::new(self)?))
    }
}

impl MethodReport for UwbFilterReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }

    fn nis(&self) -> Option<Nis> {
        let FilterReport { nis_sum: sum, nis_count: count, .. } = self.filter;
        (count > 0).then_some(Nis { dimension: 1, count, sum })
    }

    fn outliers(&self) -> u64 {
        let FilterReport { used, refused, nis_count, .. } = self.filter;
        (used + refused).saturating_sub(nis_count)
    }
}
