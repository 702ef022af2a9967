//! `marg-ins` (system S3 and beyond): inertial sensor and magnetometer on the foot, an error-quaternion filter.
//!
//! ```text
//! samples → stance detector (looks ahead) → strapdown q(ω) → error-quaternion filter → solution
//!    │                   └─ still ─→ zero velocity, zero rate ──────┤
//!    │                   └─ near rest ─→ tilt of q(ε) ──────────────┤  q(ω) − q(ε)
//!    └── magnetometer ─→ levelled field of the stance ─→ gate ─→ heading of q(ε) ─┘
//! ```
//!
//! After Yu et al. (seed S3): the error of the quaternion and the drift of the gyro are estimated from the difference of
//! two attitudes, one integrated from the gyro, one from accelerometer and magnetometer, and from the velocity of a
//! standing foot ([`crate::inertial::error_quaternion`]). Beyond the paper: stance and its velocity as in
//! [`super::foot_ins`], and a gate that keeps a disturbed field from dragging the heading ([`crate::magnetic::gate`]).
//!
//! Frames: local level ENU, z up, origin at the first sample; north is true north when the declination is given, else
//! magnetic north. Without a magnetometer the body's x axis is north.

pub(crate) mod compass;
mod marg_filter;
mod method;
mod params;

pub use compass::CompassFigures;
pub use marg_filter::MargFilter;
pub use params::{GateKind, HeadingParams, MargInsParams, StartParams};

use crate::inertial::alignment::Aligned;
use crate::magnetic::gate::ReferenceField;
use crate::methods::foot_input::FootInput;
use crate::methods::{MethodError, MethodWarning};
use crate::pedestrian::stance::Stance;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_observation::{ImuSample, Observation};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "marg-ins";
/// Warnings kept in a report; later ones of a broken log are only counted by their effect.
const WARNINGS_KEPT: usize = 100;

/// Foot-mounted inertial and magnetic navigation of one walker, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MargIns {
    params: MargInsParams,
    input: FootInput,
    filter: Option<MargFilter>,
    report: MargInsReport,
}

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MargInsReport {
    /// IMU samples processed.
    pub samples: u64,
    /// Samples in stance.
    pub still_samples: u64,
    /// Zero-velocity updates used.
    pub accepted_updates: u64,
    /// Zero-velocity updates kept out by the gate.
    pub rejected_updates: u64,
    /// True when the heading at the start came from the magnetometer.
    pub magnetic_heading: bool,
    /// What became of the magnetic headings.
    pub headings: CompassFigures,
    /// The field taken to be the Earth's.
    pub reference_field: Option<ReferenceField>,
    /// Warnings, at most the first hundred.
    pub warnings: Vec<MethodWarning>,
}

impl MargIns {
    /// A walker of whom nothing is known yet.
    pub fn new(params: MargInsParams) -> Result<Self, MethodError> {
        params.check()?;
        Ok(Self {
            input: FootInput::new(&params.stance, params.site()),
            params,
            filter: None,
            report: MargInsReport::default(),
        })
    }

    /// The filter, once aligned: estimate and covariance.
    pub fn filter(&self) -> Option<&MargFilter> {
        self.filter.as_ref()
    }

    /// Memory of this walker's state, bytes.
    pub fn state_bytes(&self) -> usize {
        let compass = self.filter.as_ref().map_or(0, |filter| filter.compass().heap_bytes());
        size_of::<Self>() + self.input.heap_bytes() + compass
    }

    /// Hands an observation on; returns the sample that is now due.
    fn take(&mut self, observation: &Observation) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        let Self { params, input, filter, report } = self;
        match observation {
            Observation::Imu(imu) => input.take(imu, start(params, filter, report)),
            Observation::Magnetic(magnetic) => {
                let aligning = input.align_with(magnetic);
                if let (Some(filter), false) = (filter, aligning) {
                    filter.push_magnetic(magnetic);
                }
                Ok(None)
            }
            _ => Ok(None),
        }
    }

    fn drain(&mut self) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        let Self { params, input, filter, report } = self;
        input.drain(start(params, filter, report))
    }

    /// Predict, in stance update, feed back: the method.
    fn advance(&mut self, imu: &ImuSample, stance: &Stance) -> Result<Option<Solution>, MethodError> {
        let filter = self.filter.as_mut().ok_or(MethodError::Empty)?;
        let gap = filter.gap_before(imu);
        filter.predict(imu, stance);
        let (innovation, opened) = filter.correct(imu, stance);
        if !filter.is_finite() {
            return Err(MethodError::Diverged { time: imu.time });
        }
        let solution = filter.solution();
        self.report.samples += 1;
        self.report.still_samples += u64::from(stance.is_still());
        match innovation {
            Some(innovation) if innovation.accepted => self.report.accepted_updates += 1,
            Some(_) => self.report.rejected_updates += 1,
            None => {}
        }
        self.report.headings = filter.compass().figures();
        self.report.reference_field = filter.compass().reference();
        if let Some(length_s) = gap {
            self.report.warn(MethodWarning::Gap { time: imu.time, length_s });
        }
        if let Some(offset_rad) = opened {
            self.report
                .warn(MethodWarning::HeadingOpened { time: imu.time, offset_deg: offset_rad.to_degrees() });
        }
        Ok(Some(solution))
    }
}

impl MargInsReport {
    fn warn(&mut self, warning: MethodWarning) {
        if self.warnings.len() < WARNINGS_KEPT {
            self.warnings.push(warning);
        }
    }
}

/// Starts the filter at the first sample.
fn start(
    params: &MargInsParams,
    filter: &mut Option<MargFilter>,
    report: &mut MargInsReport,
) -> impl FnOnce(Time, &Aligned) {
    |first, aligned| {
        if !aligned.at_rest {
            report.warn(MethodWarning::NoRestAtStart);
        }
        let started = MargFilter::new(params, first, aligned);
        match &aligned.field {
            None => report.warn(MethodWarning::NoMagnetometer),
            Some(field) if started.starts_disturbed() => {
                report.warn(MethodWarning::DisturbedAtStart { norm_ut: field.norm_ut });
            }
            Some(_) => report.magnetic_heading = true,
        }
        *filter = Some(started);
    }
}
