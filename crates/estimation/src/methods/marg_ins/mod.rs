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

mod compass;
mod marg_filter;
mod method;
mod params;

pub use compass::CompassFigures;
pub use marg_filter::MargFilter;
pub use params::{GateKind, HeadingParams, MargInsParams, StartParams};

use crate::inertial::alignment::RestAlignment;
use crate::magnetic::gate::ReferenceField;
use crate::methods::{MethodError, MethodWarning};
use crate::pedestrian::stance::{Stance, StanceDetector};
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
    detector: StanceDetector,
    alignment: RestAlignment,
    first: Option<Time>,
    latest: Option<Time>,
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
            detector: StanceDetector::new(params.stance.clone(), params.gravity_m_s2),
            params,
            alignment: RestAlignment::default(),
            first: None,
            latest: None,
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
        size_of::<Self>() + self.detector.heap_bytes() + compass
    }

    /// Checks an observation and hands it to alignment, compass and detector; returns the sample that is now due.
    fn take(&mut self, observation: &Observation) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        let imu = match observation {
            Observation::Imu(imu) => imu,
            Observation::Magnetic(magnetic) => {
                if magnetic.field_ut.iter().all(|v| v.is_finite()) {
                    match &mut self.filter {
                        Some(filter) => filter.push_magnetic(*magnetic),
                        None => self.alignment.observe_magnetic(magnetic),
                    }
                }
                return Ok(None);
            }
        };
        if !imu.angular_rate_rad_s.iter().chain(imu.specific_force_m_s2.iter()).all(|v| v.is_finite()) {
            return Err(MethodError::NotFinite { time: imu.time });
        }
        if let Some(before) = self.latest
            && imu.time <= before
        {
            return Err(MethodError::TimeNotRising { found: imu.time, before });
        }
        self.latest = Some(imu.time);
        self.detector.push(*imu);
        if self.filter.is_none() {
            let elapsed = (imu.time - *self.first.get_or_insert(imu.time)).seconds();
            if elapsed < self.params.alignment_s {
                self.alignment.observe_imu(imu);
                return Ok(None);
            }
            self.align()?;
        }
        Ok(self.detector.pop())
    }

    fn drain(&mut self) -> Result<Option<(ImuSample, Stance)>, MethodError> {
        if self.filter.is_none() {
            self.align()?;
        }
        Ok(self.detector.drain())
    }

    /// Levels the sensor, takes its heading and starts the filter at the first sample.
    fn align(&mut self) -> Result<(), MethodError> {
        let first = self.first.ok_or(MethodError::Empty)?;
        let gravity = self.params.gravity_m_s2;
        let aligned = self.alignment.align(self.params.declination_rad).ok_or(MethodError::NoForce)?;
        if aligned.at_rest {
            if !(0.5..=1.5).contains(&(aligned.force_m_s2 / gravity)) {
                return Err(MethodError::NotGravity { found: aligned.force_m_s2, expected: gravity });
            }
            self.detector.set_rest_force(aligned.force_m_s2);
        } else {
            self.warn(MethodWarning::NoRestAtStart);
        }
        match &aligned.field {
            None => self.warn(MethodWarning::NoMagnetometer),
            Some(_) => self.report.magnetic_heading = true,
        }
        let filter = MargFilter::new(&self.params, first, &aligned);
        if let (Some(field), true) = (&aligned.field, filter.starts_disturbed()) {
            self.warn(MethodWarning::DisturbedAtStart { norm_ut: field.norm_ut });
        }
        self.filter = Some(filter);
        Ok(())
    }

    /// Predict, in stance update, feed back: the method.
    fn advance(&mut self, imu: &ImuSample, stance: &Stance) -> Result<Option<Solution>, MethodError> {
        let filter = self.filter.as_mut().ok_or(MethodError::Empty)?;
        let gap = filter.gap_before(imu);
        filter.predict(imu);
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
            self.warn(MethodWarning::Gap { time: imu.time, length_s });
        }
        if let Some(offset_rad) = opened {
            self.warn(MethodWarning::HeadingOpened { time: imu.time, offset_deg: offset_rad.to_degrees() });
        }
        Ok(Some(solution))
    }

    fn warn(&mut self, warning: MethodWarning) {
        if self.report.warnings.len() < WARNINGS_KEPT {
            self.report.warnings.push(warning);
        }
    }
}
