//! `ahrs` as one of the methods.

use super::{Ahrs, AhrsParams, NAME, smooth};
use crate::attitude::AttitudeFilter;
use crate::attitude::state::AttitudeState;
use crate::methods::{
    Estimates, Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, NoiseParameter,
};
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Warnings kept in a report; later ones of a broken log are only counted by their effect.
const WARNINGS_KEPT: usize = 100;

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct AhrsReport {
    /// IMU samples processed.
    pub samples: u64,
    /// Samples at rest.
    pub still_samples: u64,
    /// Samples during which the magnetic field was disturbed.
    pub disturbed_samples: u64,
    /// True when the heading came from the magnetometer.
    pub magnetic_heading: bool,
    /// What the estimator knew at the end.
    pub state: AttitudeState,
    /// Warnings, at most the first hundred.
    pub warnings: Vec<MethodWarning>,
}

impl AhrsReport {
    #[inline]
    pub(super) fn note(&mut self, filter: &AttitudeFilter) {
        self.samples += 1;
        self.still_samples += u64::from(filter.is_at_rest());
        self.disturbed_samples += u64::from(filter.is_disturbed());
        self.magnetic_heading = filter.is_magnetic();
        self.state = *filter.state();
    }

    pub(super) fn warn(&mut self, warning: MethodWarning) {
        if self.warnings.len() < WARNINGS_KEPT {
            self.warnings.push(warning);
        }
    }
}

impl Method for Ahrs {
    type Report = AhrsReport;

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

    fn report(&self) -> &AhrsReport {
        Self::report(self)
    }
}

/// What tuning may search.
const NOISE: [NoiseParameter; 20] = [
    // Somebody who leans, and somebody who runs.
    NoiseParameter::new("velocity_m_s", 5e-2, 3.0),
    NoiseParameter::new("velocity_time_s", 0.1, 5.0),
    // Open country, and a hall of machines.
    NoiseParameter::new("field_anomaly_ut", 0.1, 20.0),
    NoiseParameter::new("field_anomaly_time_s", 0.3, 60.0),
    // From a tactical sensor to the cheapest.
    NoiseParameter::new("noise.angle_random_walk_rad_sqrt_s", 1e-5, 1e-2),
    NoiseParameter::new("noise.rate_share", 1e-4, 0.1),
    NoiseParameter::new("noise.rate_share_time_s", 1e-2, 1.0),
    NoiseParameter::new("noise.gyro_bias_walk_rad_s_sqrt_s", 1e-7, 1e-2),
    NoiseParameter::new("noise.velocity_random_walk_m_s_sqrt_s", 1e-4, 0.1),
    NoiseParameter::new("noise.acc_bias_walk_m_s2_sqrt_s", 1e-6, 1e-2),
    NoiseParameter::new("noise.field_ut", 5e-2, 10.0),
    NoiseParameter::new("noise.offset_walk_ut_sqrt_s", 1e-4, 1.0),
    NoiseParameter::new("noise.field_walk_ut_sqrt_s", 1e-4, 5.0),
    NoiseParameter::new("initial.gyro_bias_rad_s", 1e-4, 0.2),
    NoiseParameter::new("initial.gyro_scale", 1e-4, 5e-2),
    NoiseParameter::new("initial.acc_bias_m_s2", 1e-3, 0.5),
    NoiseParameter::new("initial.offset_ut", 5e-2, 30.0),
    NoiseParameter::new("initial.delay_s", 1e-4, 0.1),
    // A tag on a table, and one on a machine that runs.
    NoiseParameter::new("rest.rate_sigma_rad_s", 1e-5, 2e-2),
    NoiseParameter::new("rest.velocity_sigma_m_s", 1e-4, 0.1),
];

impl MethodSettings for AhrsParams {
    type Report = AhrsReport;

    const NAME: &'static str = NAME;
    const ESTIMATES: Estimates = Estimates::Attitude;
    const WHOLE_LOG: bool = true;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&NOISE];

    fn knowing(mut self, known: &Known) -> Self {
        if let Some(noise) = &known.specification {
            self = self.with_specification(noise);
        }
        if let Some(declination_rad) = known.declination_rad {
            self.declination_rad = declination_rad;
        }
        self
    }

    fn start(self) -> Result<Box<dyn Method<Report = AhrsReport>>, MethodError> {
        Ok(Box::new(Ahrs::new(self)?))
    }

    fn smooth(
        self,
        log: &[Observation],
        progress: &mut dyn FnMut(usize),
    ) -> Result<(Vec<Solution>, AhrsReport), MethodError> {
        smooth(self, log, progress)
    }
}

impl MethodReport for AhrsReport {
    fn share_at_rest(&self) -> Option<f64> {
        (self.samples > 0).then(|| self.still_samples as f64 / self.samples as f64)
    }

    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }
}
