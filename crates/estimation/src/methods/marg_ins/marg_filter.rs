//! The filter of `marg-ins`: what one sample with its stance does to the estimate.

use super::compass::{Compass, Outcome, UNKNOWN_HEADING_RAD};
use super::params::{GateKind, MargInsParams};
use crate::inertial::alignment::Aligned;
use crate::inertial::error_quaternion::{ErrorQuaternionFilter, StartSigma};
use crate::inertial::filter::FilterState;
use crate::inertial::reference_attitude::{HeldContact, ReferenceAttitude, reference_attitude};
use crate::inertial::strapdown::NavigationState;
use crate::kalman::Innovation;
use crate::magnetic::heading::{LevelField, tilt_compensated};
use crate::pedestrian::gap::UnknownMotion;
use crate::pedestrian::stance::Stance;
use crate::pedestrian::stance_updates::{LONG_AGO_S, SLACK_S, StanceUpdates};
use crate::pedestrian::zero_velocity::{ContactVelocity, ZeroRate};
use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_observation::{ImuSample, MagneticSample};
use serde::{Deserialize, Serialize};

/// Time over which the rate at rest is averaged, s.
const MEAN_RATE_S: f64 = 0.5;
/// Heading that defines north itself, for want of a magnetometer, standard deviation, rad.
const RELATIVE_HEADING_RAD: f64 = 1e-3;

/// Estimate of one walker, with the little memory that the updates need.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MargFilter {
    params: MargInsParams,
    filter: ErrorQuaternionFilter,
    compass: Compass,
    updates: StanceUpdates,
    /// True from a start in motion until the first stance.
    awaiting_stance: bool,
    time: Time,
    interval_s: f64,
    /// Mean rate at rest beside the drift, rad/s.
    mean_rate_rad_s: Vector3<f64>,
    /// Time since the last zero-rate and the last tilt update, s.
    since_rate_s: f64,
    since_tilt_s: f64,
}

impl MargFilter {
    pub(super) fn new(params: &MargInsParams, time: Time, aligned: &Aligned) -> Self {
        let navigation = NavigationState {
            attitude: aligned.attitude,
            velocity_m_s: Vector3::zeros(),
            position_m: Vector3::zeros(),
            gyro_bias_rad_s: aligned.gyro_bias_rad_s,
            acc_bias_m_s2: Vector3::zeros(),
        };
        let state = FilterState { navigation, contact_m: Vector3::zeros() };
        let start = &params.initial;
        let heading_sigma_rad =
            if aligned.field.is_some() { UNKNOWN_HEADING_RAD } else { RELATIVE_HEADING_RAD };
        let sigma = StartSigma {
            attitude_rad: Vector3::new(start.tilt_rad, start.tilt_rad, heading_sigma_rad),
            drift_rad_s: start.drift_rad_s,
            velocity_m_s: start.velocity_m_s,
            position_m: start.position_m,
            acc_bias_m_s2: start.acc_bias_m_s2,
            contact_m: start.contact_m,
            hard_iron_ut: match params.magnetic_gate {
                GateKind::None => 0.0,
                GateKind::Disturbance => params.heading.hard_iron_ut,
            },
        };
        let mut started = Self {
            filter: ErrorQuaternionFilter::new(state, &sigma, params.gravity_m_s2),
            compass: Compass::new(params),
            updates: StanceUpdates::default(),
            awaiting_stance: !aligned.at_rest,
            time,
            interval_s: 0.0,
            mean_rate_rad_s: Vector3::zeros(),
            since_rate_s: LONG_AGO_S,
            since_tilt_s: LONG_AGO_S,
            params: params.clone(),
        };
        if let Some(field) = aligned.field.filter(|_| aligned.at_rest) {
            started.begin_heading(&field, start.tilt_rad);
        }
        started
    }

    /// Length of the gap before a sample when it is too long to integrate over, s.
    pub fn gap_before(&self, imu: &ImuSample) -> Option<f64> {
        let interval_s = (imu.time - self.time).seconds();
        (interval_s > self.params.gap_s).then_some(interval_s)
    }

    /// Takes a reading of the magnetometer; it is used when the sample of its time is.
    pub(super) fn push_magnetic(&mut self, magnetic: &MagneticSample) {
        if magnetic.is_reading() {
            self.compass.push(*magnetic);
        }
    }

    /// Carries the estimate to the time of the sample.
    pub fn predict(&mut self, imu: &ImuSample, stance: &Stance) {
        let gap = self.gap_before(imu);
        let interval_s = if gap.is_some() { 0.0 } else { (imu.time - self.time).seconds() };
        self.time = imu.time;
        self.interval_s = interval_s;
        self.updates.advance(interval_s);
        self.since_rate_s += interval_s;
        self.since_tilt_s += interval_s;
        if let Some(gap_s) = gap {
            self.cross_gap(gap_s);
        }
        if self.awaiting_stance {
            self.filter.inflate_motion(0.0, UnknownMotion::over(interval_s).position);
            return;
        }
        let turning = self.is_turning(imu, stance, interval_s);
        self.filter.predict(imu, interval_s, &self.params.noise, self.params.drift_correlation_s, turning);
    }

    /// False for a foot that has rested for a while and whose mean rate is its drift.
    fn is_turning(&mut self, imu: &ImuSample, stance: &Stance, interval_s: f64) -> bool {
        let z = &self.params.zero_velocity;
        let resting = self.updates.is_resting(z) && stance.statistic < z.rest_statistic;
        let rate = imu.angular_rate_rad_s - self.filter.state.navigation.gyro_bias_rad_s;
        let share = if resting { (interval_s / MEAN_RATE_S).min(1.0) } else { 1.0 };
        self.mean_rate_rad_s += (rate - self.mean_rate_rad_s) * share;
        let still =
            self.mean_rate_rad_s.norm_squared() < self.params.turning_rad_s * self.params.turning_rad_s;
        !(resting && still)
    }

    /// In stance: zero velocity, then, of a foot that is still enough, zero rate and the reference `q(ε)`.
    ///
    /// Returns the innovation of the velocity, used or not, and the offset of a heading that had to be opened.
    pub fn correct(&mut self, imu: &ImuSample, stance: &Stance) -> (Option<Innovation>, Option<f64>) {
        if self.awaiting_stance && !self.start_in_stance(imu, stance) {
            return (None, None);
        }
        self.updates.observe(stance, self.interval_s, &self.params.zero_velocity);
        let (attitude, hard_iron_ut) = (self.filter.state.navigation.attitude, self.filter.hard_iron_ut);
        let settle_s = self.params.heading.settle_s;
        let level = |field_ut: &Vector3<f64>| attitude * (field_ut - hard_iron_ut);
        self.compass.gather(self.time, self.interval_s, stance.is_still(), level, settle_s);
        if !stance.is_still() {
            return (None, None);
        }
        let innovation = self.hold_velocity(imu, stance);
        let confirmed = innovation.is_some_and(|innovation| innovation.accepted);
        if !confirmed && !self.updates.is_resting(&self.params.zero_velocity) {
            return (innovation, None);
        }
        self.hold_rate(imu, stance);
        self.hold_tilt(imu, stance);
        (innovation, self.hold_heading())
    }

    /// The estimate as a solution.
    pub fn solution(&self) -> Solution {
        self.filter.solution(self.time, self.quality())
    }

    /// True while the position is a number.
    pub fn is_finite(&self) -> bool {
        self.filter.state.navigation.position_m.iter().all(|v| v.is_finite())
    }

    /// How far the estimate can be trusted.
    pub fn quality(&self) -> Quality {
        if self.awaiting_stance || self.updates.since_accepted_s() > self.params.lost_after_s {
            Quality::Lost
        } else {
            Quality::DeadReckoning
        }
    }

    /// The error-quaternion filter: estimate and covariance.
    pub fn filter(&self) -> &ErrorQuaternionFilter {
        &self.filter
    }

    /// True when the field at the start cannot be the Earth's, or not that of the reference.
    pub(super) fn starts_disturbed(&self) -> bool {
        self.compass.is_disturbed()
    }

    pub(super) fn compass(&self) -> &Compass {
        &self.compass
    }

    /// Velocity of the standing foot, when it is due.
    fn hold_velocity(&mut self, imu: &ImuSample, stance: &Stance) -> Option<Innovation> {
        let z = &self.params.zero_velocity;
        let gate = self.updates.due(stance, z)?;
        let contact = ContactVelocity {
            angular_rate_rad_s: imu.angular_rate_rad_s,
            sigma_m_s: z.sigma_m_s(stance),
            lever_sigma_m: z.lever_sigma_m,
        };
        let innovation = self.filter.update(&HeldContact(contact), gate)?;
        self.updates.note(&innovation, stance, z);
        Some(innovation)
    }

    /// At rest the gyro reads its drift.
    fn hold_rate(&mut self, imu: &ImuSample, stance: &Stance) {
        let r = &self.params.zero_rate;
        if stance.statistic >= r.statistic || self.since_rate_s < r.interval_s - SLACK_S {
            return;
        }
        self.since_rate_s = 0.0;
        let rate = imu.angular_rate_rad_s - self.filter.state.navigation.gyro_bias_rad_s;
        let zero_rate =
            ZeroRate { angular_rate_rad_s: imu.angular_rate_rad_s, sigma_rad_s: r.sigma_rad_s(&rate) };
        self.filter.update(&zero_rate, f64::INFINITY);
        self.filter.anchor_drift();
    }

    /// Near rest the accelerometer gives the tilt of `q(ε)`.
    fn hold_tilt(&mut self, imu: &ImuSample, stance: &Stance) {
        let t = &self.params.rest_gravity;
        if stance.statistic >= t.statistic || self.since_tilt_s < t.interval_s - SLACK_S {
            return;
        }
        self.since_tilt_s = 0.0;
        let navigation = &self.filter.state.navigation;
        let force = imu.specific_force_m_s2 - navigation.acc_bias_m_s2;
        let reference = ReferenceAttitude {
            attitude: reference_attitude(&navigation.attitude, Some(&force), None),
            gravity_m_s2: self.params.gravity_m_s2,
            tilt_sigma_rad: Some(t.sigma_m_s2 / self.params.gravity_m_s2),
            heading_sigma_rad: None,
            heading_by_iron: Vector3::zeros(),
        };
        self.filter.update(&reference, f64::INFINITY);
    }

    /// The levelled field of the stance gives the heading of `q(ε)`, if it is to be believed.
    fn hold_heading(&mut self) -> Option<f64> {
        let position_m = self.filter.state.navigation.position_m;
        let sighting = self.compass.sight(&self.params, &position_m)?;
        if !self.compass.is_started() {
            // The first reading of a magnetometer that was silent at the start: what was north before is not.
            self.compass.start(&sighting.field, self.filter.tilt_sigma_rad(), &self.params);
            self.inflate_heading(UNKNOWN_HEADING_RAD);
        }
        let tilt_sigma_rad = libm::hypot(self.params.heading.tilt_sigma_rad, self.filter.tilt_sigma_rad());
        let sigma_rad = self.compass.sigma_rad(&sighting.field, tilt_sigma_rad, &self.params);
        let heading = self.heading_of(&sighting.field, sigma_rad);
        let (offset, predicted) = (sighting.heading_offset_rad, self.filter.predicted(&heading)[(2, 2)]);
        let agrees = offset * offset <= self.params.heading.gate_nis * (predicted + sigma_rad * sigma_rad);
        let (outcome, used_sigma_rad) = match self.params.magnetic_gate {
            GateKind::None => (Outcome::Used, Some(sigma_rad)),
            GateKind::Disturbance if !self.compass.judge(&sighting) => (Outcome::Disturbed, None),
            GateKind::Disturbance if !agrees => (Outcome::Disagreed, None),
            GateKind::Disturbance => {
                let news = self.compass.news_sigma_rad(&position_m, predicted, sigma_rad, &self.params);
                (if news.is_some() { Outcome::Used } else { Outcome::Agreed }, news)
            }
        };
        if used_sigma_rad.is_some() {
            let heading = ReferenceAttitude { heading_sigma_rad: used_sigma_rad, ..heading };
            self.filter.update(&heading, f64::INFINITY);
        }
        let opened = self.compass.note(&sighting, outcome, &position_m)?;
        self.inflate_heading(opened);
        Some(opened)
    }

    /// `q(ε)` with the tilt of the estimate and the heading of a field in its level frame.
    fn heading_of(&self, field: &LevelField, sigma_rad: f64) -> ReferenceAttitude {
        let attitude = &self.filter.state.navigation.attitude;
        let offset = field.heading_offset_rad(self.params.declination_rad);
        ReferenceAttitude {
            attitude: reference_attitude(attitude, None, Some(offset)),
            gravity_m_s2: self.params.gravity_m_s2,
            tilt_sigma_rad: None,
            heading_sigma_rad: Some(sigma_rad),
            heading_by_iron: attitude.inverse_transform_vector(&field.azimuth_gradient()),
        }
    }

    /// The heading of the start, which the field of the alignment has given: as uncertain as that field, and with its hard iron.
    fn begin_heading(&mut self, field: &LevelField, tilt_rad: f64) {
        let sigma_rad = self.compass.start(field, tilt_rad, &self.params);
        if sigma_rad < UNKNOWN_HEADING_RAD {
            let level = LevelField { azimuth_rad: self.params.declination_rad, ..*field };
            self.filter.update(&self.heading_of(&level, sigma_rad), f64::INFINITY);
        }
    }

    fn inflate_heading(&mut self, sigma_rad: f64) {
        let variance = Vector3::new(0.0, 0.0, sigma_rad * sigma_rad);
        self.filter.inflate_attitude(&Matrix3::from_diagonal(&variance));
    }

    /// Levels the sensor in the middle of the first stance, as still as the statistic says; false while there is none.
    fn start_in_stance(&mut self, imu: &ImuSample, stance: &Stance) -> bool {
        let reading = self.compass.reading(imu.time);
        if !stance.is_still() || stance.statistic > stance.least {
            return false;
        }
        let force = &imu.specific_force_m_s2;
        let sway_rad = self.params.stance.acc_scale_m_s2 / self.params.gravity_m_s2;
        let tilt_rad = libm::hypot(self.params.initial.tilt_rad, sway_rad * libm::sqrt(stance.statistic));
        let compass = tilt_compensated(force, &reading.unwrap_or_default(), self.params.declination_rad);
        let (attitude, heading_rad) = match &compass {
            Some(compass) => (compass.attitude, UNKNOWN_HEADING_RAD),
            None => match attitude::level(force, 0.0) {
                Some(level) => (level, RELATIVE_HEADING_RAD),
                None => return false,
            },
        };
        self.awaiting_stance = false;
        self.filter.restart_attitude(attitude, &Vector3::new(tilt_rad, tilt_rad, heading_rad));
        if let Some(compass) = compass {
            self.begin_heading(&compass.field, tilt_rad);
        }
        true
    }

    /// Nothing is known of the motion over a gap: the uncertainty says so, and the gate opens.
    fn cross_gap(&mut self, gap_s: f64) {
        let unknown = UnknownMotion::over(gap_s);
        self.filter.state.navigation.velocity_m_s = Vector3::zeros();
        self.filter.inflate_motion(unknown.velocity, unknown.position);
        self.filter.inflate_attitude(&(Matrix3::identity() * unknown.attitude));
        self.updates.cross_gap();
    }
}
