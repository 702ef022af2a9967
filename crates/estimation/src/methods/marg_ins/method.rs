//! `marg-ins` as one of the methods.

use super::{MargIns, MargInsParams, MargInsReport, NAME, params};
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, NoiseParameter, foot_input,
};
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;

impl Method for MargIns {
    type Report = MargInsReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match self.take(observation)? {
            Some((imu, stance)) => self.advance(&imu, &stance),
            None => Ok(None),
        }
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        match self.input.next_due() {
            Some((imu, stance)) => self.advance(&imu, &stance),
            None => Ok(None),
        }
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        match self.drain()? {
            Some((imu, stance)) => self.advance(&imu, &stance),
            None => Ok(None),
        }
    }

    fn report(&self) -> &MargInsReport {
        &self.report
    }
}

impl MethodSettings for MargInsParams {
    type Report = MargInsReport;

    const NAME: &'static str = NAME;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&foot_input::NOISE, &params::NOISE];

    fn knowing(mut self, known: &Known) -> Self {
        if let Some(noise) = &known.specification {
            self.noise = self.noise.with_specification(noise);
        }
        if let Some(declination_rad) = known.declination_rad {
            self.declination_rad = declination_rad;
        }
        if known.field.is_some() {
            self.heading.reference = known.field;
        }
        self
    }

    fn start(self) -> Result<Box<dyn Method<Report = MargInsReport>>, MethodError> {
        Ok(Box::new(MargIns::new(self)?))
    }
}

impl MethodReport for MargInsReport {
    fn share_at_rest(&self) -> Option<f64> {
        (self.samples > 0).then(|| self.still_samples as f64 / self.samples as f64)
    }

    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }
}
