//! The filter of `foot-ins`: what one sample with its stance does to the estimate.

use super::params::{FootInsParams, HeadingAid};
use crate::inertial::alignment::Aligned;
use crate::inertial::covariance::{ATTITUDE, Covariance, POSITION, VELOCITY};
use crate::inertial::filter::{FilterState, InertialFilter};
use crate::inertial::smoother::Recorder;
use crate::inertial::strapdown::{NavigationState, Step};
use crate::kalman::Innovation;
use crate::pedestrian::gap::UnknownMotion;
use crate::pedestrian::heading::StraightLegs;
use crate::pedestrian::stance::Stance;
use crate::pedestrian::stance_updates::{LONG_AGO_S, SLACK_S, StanceUpdates};
use crate::pedestrian::zero_velocity::{ContactVelocity, RestGravity, ZeroRate};
use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_observation::ImuSample;
use serde::{Deserialize, Serialize};

/// Estimate of one walker, with the little memory that the updates need.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FootFilter {
    params: FootInsParams,
    inertial: InertialFilter,
    /// True from a start in motion until the first stance: before it there is nothing to level or to integrate from.
    awaiting_stance: bool,
    time: Time,
    /// Length of the last prediction, s.
    interval_s: f64,
    updates: StanceUpdates,
    /// Time since the last zero-rate and the last gravity update, s.
    since_rate_s: f64,
    since_gravity_s: f64,
    straight_legs: Option<StraightLegs>,
}

impl FootFilter {
    pub(super) fn new(params: &FootInsParams, time: Time, aligned: &Aligned) -> Self {
        let sigma = &params.initial;
        let all = |sigma: f64| Vector3::repeat(sigma * sigma);
        let tilt = sigma.tilt_rad * sigma.tilt_rad;
        let covariance = Covariance::from_variances(&[
            Vector3::new(tilt, tilt, sigma.heading_rad * sigma.heading_rad),
            all(sigma.velocity_m_s),
            all(sigma.position_m),
            all(sigma.gyro_bias_rad_s),
            all(sigma.acc_bias_m_s2),
            all(sigma.contact_m),
        ]);
        let navigation = NavigationState {
            attitude: aligned.attitude,
            velocity_m_s: Vector3::zeros(),
            position_m: Vector3::zeros(),
            gyro_bias_rad_s: aligned.gyro_bias_rad_s,
            acc_bias_m_s2: Vector3::zeros(),
        };
        let state = FilterState { navigation, contact_m: Vector3::zeros() };
        Self {
            inertial: InertialFilter::new(state, covariance, params.gravity_m_s2),
            awaiting_stance: !aligned.at_rest,
            time,
            interval_s: 0.0,
            updates: StanceUpdates::default(),
            since_rate_s: LONG_AGO_S,
            since_gravity_s: LONG_AGO_S,
            straight_legs: (params.heading_aid == HeadingAid::StraightLegs).then(StraightLegs::default),
            params: params.clone(),
        }
    }

    /// Length of the gap before a sample when it is too long to integrate over, s.
    pub fn gap_before(&self, imu: &ImuSample) -> Option<f64> {
        let interval_s = (imu.time - self.time).seconds();
        (interval_s > self.params.gap_s).then_some(interval_s)
    }

    /// What led here is no longer corrected: the way goes on from here.
    pub(super) fn set_origin(&mut self) {
        self.inertial.covariance.set_origin();
    }

    /// Length of the last prediction, s.
    pub(super) fn interval_s(&self) -> f64 {
        self.interval_s
    }

    /// Carries the estimate to the time of the sample.
    pub fn predict(&mut self, imu: &ImuSample) -> Step {
        let gap = self.gap_before(imu);
        let interval_s = if gap.is_some() { 0.0 } else { (imu.time - self.time).seconds() };
        self.time = imu.time;
        self.interval_s = interval_s;
        self.updates.advance(interval_s);
        self.since_rate_s += interval_s;
        self.since_gravity_s += interval_s;
        if let Some(gap_s) = gap {
            self.cross_gap(gap_s);
        }
        if self.awaiting_stance {
            let unknown = UnknownMotion::over(interval_s);
            self.inertial.covariance.inflate(POSITION, &(Matrix3::identity() * unknown.position));
            return Step::default();
        }
        self.inertial.predict(imu, interval_s, &self.params.noise)
    }

    /// In stance: velocity of the contact, then zero rate and gravity if the foot is still enough.
    ///
    /// Returns the innovation of the contact velocity, used or not; `recorder` hears of every update.
    pub fn correct(
        &mut self,
        imu: &ImuSample,
        stance: &Stance,
        recorder: &mut impl Recorder,
    ) -> Option<Innovation> {
        if self.awaiting_stance && !self.start_in_stance(imu, stance) {
            return None;
        }
        let z = &self.params.zero_velocity;
        self.updates.observe(stance, self.interval_s, z);
        if !stance.is_still() {
            return None;
        }
        let innovation = self.hold_contact(imu, stance, recorder);
        // Only a foot whose stillness the velocity has just confirmed tells of rate, gravity and heading.
        let confirmed = innovation.is_some_and(|innovation| innovation.accepted);
        if confirmed || self.updates.is_resting(&self.params.zero_velocity) {
            self.hold_rate(imu, stance, recorder);
            self.hold_gravity(imu, stance, recorder);
            self.hold_heading(recorder);
        }
        innovation
    }

    /// Velocity of the contact, when it is due.
    #[inline]
    fn hold_contact(
        &mut self,
        imu: &ImuSample,
        stance: &Stance,
        recorder: &mut impl Recorder,
    ) -> Option<Innovation> {
        let z = &self.params.zero_velocity;
        let gate = self.updates.due(stance, z)?;
        let contact = ContactVelocity {
            angular_rate_rad_s: imu.angular_rate_rad_s,
            sigma_m_s: z.sigma_m_s(stance),
            lever_sigma_m: z.lever_sigma_m,
        };
        let innovation = self.inertial.update(&contact, gate, |update| recorder.contact(update))?;
        self.updates.note(&innovation, stance, z);
        Some(innovation)
    }

    /// At rest the gyro reads its bias; the more it reads beside, the less that is worth, for people sway.
    #[inline]
    fn hold_rate(&mut self, imu: &ImuSample, stance: &Stance, recorder: &mut impl Recorder) {
        let r = &self.params.zero_rate;
        if stance.statistic >= r.statistic || self.since_rate_s < r.interval_s - SLACK_S {
            return;
        }
        self.since_rate_s = 0.0;
        let rate = imu.angular_rate_rad_s - self.inertial.state.navigation.gyro_bias_rad_s;
        let zero_rate =
            ZeroRate { angular_rate_rad_s: imu.angular_rate_rad_s, sigma_rad_s: r.sigma_rad_s(&rate) };
        self.inertial.update(&zero_rate, f64::INFINITY, |update| recorder.rate(update));
    }

    /// At rest the accelerometer reads gravity.
    #[inline]
    fn hold_gravity(&mut self, imu: &ImuSample, stance: &Stance, recorder: &mut impl Recorder) {
        let g = &self.params.rest_gravity;
        if stance.statistic >= g.statistic || self.since_gravity_s < g.interval_s - SLACK_S {
            return;
        }
        self.since_gravity_s = 0.0;
        let gravity = RestGravity {
            specific_force_m_s2: imu.specific_force_m_s2,
            sigma_m_s2: g.sigma_m_s2,
            gravity_m_s2: self.params.gravity_m_s2,
        };
        self.inertial.update(&gravity, f64::INFINITY, |update| recorder.gravity(update));
    }

    /// A leg that goes on straight keeps its heading, if the settings say so.
    #[inline]
    fn hold_heading(&mut self, recorder: &mut impl Recorder) {
        if let Some(legs) = &mut self.straight_legs
            && let Some(heading) = legs.observe(self.time, &self.inertial.state.navigation.position_m)
        {
            self.inertial.update(&heading, f64::INFINITY, |update| recorder.heading(update));
        }
    }

    /// The estimate as a solution.
    #[inline]
    pub fn solution(&self) -> Solution {
        self.inertial.state.solution(self.time, &self.inertial.covariance, self.quality())
    }

    /// True while the position is a number.
    pub fn is_finite(&self) -> bool {
        self.inertial.state.navigation.position_m.iter().all(|v| v.is_finite())
    }

    /// True while the walk has begun in motion and no stance has been seen yet.
    pub fn is_awaiting_stance(&self) -> bool {
        self.awaiting_stance
    }

    /// How far the estimate can be trusted.
    pub fn quality(&self) -> Quality {
        if self.awaiting_stance || self.updates.since_accepted_s() > self.params.lost_after_s {
            Quality::Lost
        } else {
            Quality::DeadReckoning
        }
    }

    /// Everything estimated, biases and lever included.
    pub fn state(&self) -> &FilterState {
        &self.inertial.state
    }

    /// Covariance of everything estimated.
    pub fn covariance(&self) -> &Covariance {
        &self.inertial.covariance
    }

    /// Levels the sensor in the middle of the first stance, as still as the statistic says; false while there is none.
    fn start_in_stance(&mut self, imu: &ImuSample, stance: &Stance) -> bool {
        if !stance.is_still() || stance.statistic > stance.least {
            return false;
        }
        let Some(attitude) = attitude::level(&imu.specific_force_m_s2, 0.0) else { return false };
        self.awaiting_stance = false;
        self.inertial.state.navigation.attitude = attitude;
        let sway_rad = self.params.stance.acc_scale_m_s2 / self.params.gravity_m_s2;
        let tilt = sway_rad * sway_rad * stance.statistic;
        self.inertial.covariance.inflate(ATTITUDE, &Matrix3::from_diagonal(&Vector3::new(tilt, tilt, 0.0)));
        true
    }

    /// Nothing is known of the motion over a gap: the uncertainty says so, and the gate opens.
    fn cross_gap(&mut self, gap_s: f64) {
        let unknown = UnknownMotion::over(gap_s);
        self.inertial.state.navigation.velocity_m_s = Vector3::zeros();
        self.inertial.covariance.inflate(VELOCITY, &(Matrix3::identity() * unknown.velocity));
        self.inertial.covariance.inflate(POSITION, &(Matrix3::identity() * unknown.position));
        self.inertial.covariance.inflate(ATTITUDE, &(Matrix3::identity() * unknown.attitude));
        self.updates.cross_gap();
    }
}
