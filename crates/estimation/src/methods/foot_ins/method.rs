//! `foot-ins` as one of the methods.

use super::{FixedLag, FootIns, FootInsParams, FootInsReport, NAME, params, smooth};
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, Nis, NoiseParameter, foot_input,
};
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::vec::Vec;
use serde::Serialize;

impl Method for FootIns {
    type Report = FootInsReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::next_due(self)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::finish_next(self)
    }

    fn report(&self) -> &FootInsReport {
        Self::report(self)
    }
}

impl Method for FixedLag {
    type Report = FootInsReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Ok(Self::next_due(self))
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::finish_next(self)
    }

    fn report(&self) -> &FootInsReport {
        Self::report(self)
    }
}

impl MethodSettings for FootInsParams {
    type Report = FootInsReport;

    const NAME: &'static str = NAME;
    const FIXED_LAG: bool = true;
    const WHOLE_LOG: bool = true;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&foot_input::NOISE, &params::NOISE];

    fn knowing(mut self, known: &Known) -> Self {
        if let Some(noise) = &known.specification {
            self = self.with_specification(noise);
        }
        if let Some(declination_rad) = known.declination_rad {
            self.declination_rad = declination_rad;
        }
        self
    }

    fn start(self) -> Result<Box<dyn Method<Report = FootInsReport>>, MethodError> {
        Ok(Box::new(FootIns::new(self)?))
    }

    fn start_fixed_lag(self, lag_s: f64) -> Result<Box<dyn Method<Report = FootInsReport>>, MethodError> {
        Ok(Box::new(FixedLag::new(self, lag_s)?))
    }

    fn smooth(
        self,
        log: &[Observation],
        progress: &mut dyn FnMut(usize),
    ) -> Result<(Vec<Solution>, FootInsReport), MethodError> {
        smooth(self, log, progress)
    }
}

impl MethodReport for FootInsReport {
    fn details(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct Details<'a> {
            #[serde(flatten)]
            report: &'a FootInsReport,
            mean_nis: Option<f64>,
        }
        Details { report: self, mean_nis: self.mean_nis() }
    }

    fn share_at_rest(&self) -> Option<f64> {
        (self.samples > 0).then(|| self.still_samples as f64 / self.samples as f64)
    }

    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }

    fn nis(&self) -> Option<Nis> {
        let (count, sum) = (self.accepted_updates, self.accepted_nis_sum);
        (count > 0).then_some(Nis { dimension: 3, count, sum })
    }
}
