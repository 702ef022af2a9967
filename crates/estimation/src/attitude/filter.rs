//! The filter: propagate every sample, and once an interval predict, update, feed back.

use crate::attitude::disturbance::{FieldEvidence, FieldJudge, Verdict};
use crate::attitude::interval::Interval;
use crate::attitude::measurement::{BoundedVelocity, MeanField, RestRate};
use crate::attitude::params::AttitudeParams;
use crate::attitude::smoother::Recorder;
use crate::attitude::state::{
    ACC_BIAS, ATTITUDE, AttitudeState, BLOCKS, DELAY, DOWN, FIELD, GYRO_BIAS, GYRO_SCALE, HORIZONTAL, OFFSET,
    VELOCITY,
};
use crate::inertial::alignment::Aligned;
use crate::kalman::MeasurementModel;
use crate::kalman::blocks::{BlockCovariance, BlockUpdate, Coupling};
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Slack on the length of an interval, so that jitter of the stamps does not add a sample, s.
const SLACK_S: f64 = 1e-4;
/// Before the first field its direction and strength are unknown: standard deviations, rad and µT.
const UNKNOWN_HEADING_RAD: f64 = 1.0;
const UNKNOWN_FIELD_UT: f64 = 30.0;
/// Share of an interval at rest in what is known of the gyro's noise.
const SEEN_SHARE: f64 = 0.05;
/// Rate of turn over a gap in the log, standard deviation, rad/s.
const GAP_RATE_RAD_S: f64 = 0.5;

/// Block of the error state that a [`Recorder`] hears was forgotten, and which components of it.
pub type Forgotten = (usize, &'static [usize]);

/// Attitude of one tag.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttitudeFilter {
    params: AttitudeParams,
    state: AttitudeState,
    covariance: BlockCovariance<BLOCKS>,
    interval: Interval,
    rate_rad_s: Vector3<f64>,
    /// Mean specific force of the last interval.
    last_force_m_s2: Vector3<f64>,
    still_s: f64,
    at_rest: bool,
    /// Density of the gyro's white noise as seen at rest, rad²/s.
    seen_density: f64,
    magnetic: bool,
    /// Horizontal and downward strength at the first site, where another has been adopted since.
    home_ut: Option<(f64, f64)>,
    judge: FieldJudge,
}

impl AttitudeFilter {
    /// A tag turned like this at the start.
    pub fn new(params: &AttitudeParams, attitude: Attitude) -> Self {
        let sigma = &params.initial;
        let all = |sigma: f64| Vector3::repeat(sigma * sigma);
        let (tilt, heading) = (sigma.tilt_rad * sigma.tilt_rad, sigma.heading_rad * sigma.heading_rad);
        let covariance = BlockCovariance::from_variances(&[
            Vector3::new(tilt, tilt, heading),
            all(sigma.gyro_bias_rad_s),
            all(sigma.gyro_scale),
            all(params.velocity_m_s),
            all(sigma.acc_bias_m_s2),
            all(sigma.offset_ut),
            Vector3::new(0.0, 0.0, sigma.delay_s * sigma.delay_s),
        ]);
        Self {
            params: params.clone(),
            state: AttitudeState { attitude, ..AttitudeState::default() },
            covariance,
            interval: Interval::default(),
            rate_rad_s: Vector3::zeros(),
            last_force_m_s2: attitude.inverse() * Vector3::new(0.0, 0.0, params.gravity_m_s2),
            still_s: 0.0,
            at_rest: false,
            seen_density: 0.0,
            magnetic: false,
            home_ut: None,
            judge: FieldJudge::default(),
        }
    }

    /// Takes one inertial sample, `interval_s` after the one before; true when a correction is due.
    #[inline]
    pub fn propagate(
        &mut self,
        reading_rad_s: &Vector3<f64>,
        specific_force_m_s2: &Vector3<f64>,
        interval_s: f64,
    ) -> bool {
        self.interval.add_inertial(&mut self.state, reading_rad_s, specific_force_m_s2, interval_s);
        self.rate_rad_s = self.state.rate_rad_s(reading_rad_s);
        self.interval.length_s >= self.params.interval_s - SLACK_S
    }

    /// Takes one magnetometer sample, stamped `lead_s` after the last inertial one.
    #[inline]
    pub fn add_field(&mut self, reading_ut: &Vector3<f64>, lead_s: f64) {
        self.interval.add_magnetic(&self.state, &self.rate_rad_s, reading_ut, lead_s);
    }

    /// Ends an interval: predict, update, feed back. `recorder` hears of every step.
    pub fn correct(&mut self, recorder: &mut impl Recorder) {
        let interval = core::mem::take(&mut self.interval);
        if interval.length_s <= 0.0 {
            return;
        }
        self.predict(&interval, recorder);
        self.detect_rest(&interval);
        self.update_rest(&interval, recorder);
        self.update_velocity(&interval, recorder);
        self.update_field(&interval, recorder);
    }

    /// Starts again after a gap in the log, of whose motion nothing is known, with what alignment says of the tilt and,
    /// with a magnetometer, of the heading. What was learnt of the sensors and of the field is kept.
    pub fn realign(&mut self, aligned: &Aligned, gap_s: f64) {
        let heading_rad = if self.magnetic && aligned.field.is_some() {
            let local = Vector3::new(0.0, 0.0, -self.state.local_declination_rad);
            self.state.attitude = attitude::turn_navigation(&aligned.attitude, &local);
            UNKNOWN_HEADING_RAD
        } else {
            // The least turn that levels the tag.
            let up = self.state.attitude * (aligned.attitude.inverse() * Vector3::z());
            if let Some(turn) = UnitQuaternion::rotation_between(&up, &Vector3::z()) {
                self.state.attitude = turn * self.state.attitude;
            }
            (GAP_RATE_RAD_S * gap_s).min(UNKNOWN_HEADING_RAD)
        };
        let tilt = self.params.initial.tilt_rad * self.params.initial.tilt_rad;
        let heading = self.covariance.block(ATTITUDE, ATTITUDE)[(2, 2)] + heading_rad * heading_rad;
        self.covariance.forget(ATTITUDE, &[0, 1], tilt);
        self.covariance.forget(ATTITUDE, &[2], heading);
        self.covariance.forget(VELOCITY, &[0, 1, 2], self.params.velocity_m_s * self.params.velocity_m_s);
        self.state.velocity_m_s = Vector3::zeros();
        self.interval = Interval::default();
        self.still_s = 0.0;
        self.at_rest = false;
    }

    /// Everything estimated.
    pub fn state(&self) -> &AttitudeState {
        &self.state
    }

    /// Covariance of everything estimated.
    pub fn covariance(&self) -> &BlockCovariance<BLOCKS> {
        &self.covariance
    }

    /// True while the tag is at rest.
    pub fn is_at_rest(&self) -> bool {
        self.at_rest
    }

    /// True once a magnetometer has given the heading.
    pub fn is_magnetic(&self) -> bool {
        self.magnetic
    }

    /// True while the field is disturbed and the heading is left to the gyro.
    pub fn is_disturbed(&self) -> bool {
        self.judge.is_disturbed()
    }

    /// Sums over the interval under way.
    pub fn interval(&self) -> &Interval {
        &self.interval
    }

    /// Length of the interval under way, s.
    pub fn pending_s(&self) -> f64 {
        self.interval.length_s
    }

    /// `φ ← φ − ∫R dt δb − ∫R diag(ω) dt δs`, `v ← v − ∫R f dt × φ − ∫R dt δa`, and the noise of the interval.
    fn predict(&mut self, interval: &Interval, recorder: &mut impl Recorder) {
        let time = interval.length_s;
        self.state.velocity_m_s += interval.force_m_s - Vector3::z() * (self.params.gravity_m_s2 * time);
        let couplings = [
            Coupling { to: VELOCITY, from: ATTITUDE, matrix: -attitude::skew(&interval.force_m_s) },
            Coupling { to: VELOCITY, from: ACC_BIAS, matrix: -interval.rotation_s },
            Coupling { to: ATTITUDE, from: GYRO_BIAS, matrix: -interval.rotation_s },
            Coupling { to: ATTITUDE, from: GYRO_SCALE, matrix: -interval.turned_rad },
        ];
        self.covariance.propagate(&couplings);
        let noise = &self.params.noise;
        let density = |sigma: f64| Matrix3::from_diagonal_element(sigma * sigma * time);
        let angle_random_walk = noise.angle_random_walk_rad_sqrt_s * noise.angle_random_walk_rad_sqrt_s;
        let white = angle_random_walk.max(self.seen_density) * time;
        let shaken =
            noise.rate_share * noise.rate_share * noise.rate_share_time_s * interval.rate_squared_rad2_s;
        self.covariance.inflate(ATTITUDE, &Matrix3::from_diagonal_element(white + shaken));
        self.covariance.inflate(GYRO_BIAS, &density(noise.gyro_bias_walk_rad_s_sqrt_s));
        self.covariance.inflate(VELOCITY, &density(noise.velocity_random_walk_m_s_sqrt_s));
        self.covariance.inflate(ACC_BIAS, &density(noise.acc_bias_walk_m_s2_sqrt_s));
        self.covariance.inflate(OFFSET, &density(noise.offset_walk_ut_sqrt_s));
        if self.magnetic {
            let walk = noise.field_walk_ut_sqrt_s * noise.field_walk_ut_sqrt_s * time;
            self.covariance.inflate(FIELD, &Matrix3::from_diagonal(&Vector3::new(walk, walk, 0.0)));
        }
        recorder.predicted(&self.state, &self.covariance, &couplings);
    }

    /// Rest: rate and force hardly vary within the interval, and the force is that of the interval before.
    fn detect_rest(&mut self, interval: &Interval) {
        let rest = &self.params.rest;
        let ((rate, rate_spread), (force, force_spread)) = (interval.mean_rate(), interval.mean_force());
        let change = force - self.last_force_m_s2;
        let still = rate_spread < rest.rate_spread_rad_s
            && rate.norm_squared() < rest.largest_bias_rad_s * rest.largest_bias_rad_s
            && force_spread < rest.force_spread_m_s2
            && change.norm_squared() < rest.force_spread_m_s2 * rest.force_spread_m_s2;
        self.last_force_m_s2 = force;
        self.still_s = if still { self.still_s + interval.length_s } else { 0.0 };
        self.at_rest = self.still_s > rest.after_s;
    }

    fn update_rest(&mut self, interval: &Interval, recorder: &mut impl Recorder) {
        if self.at_rest {
            let (rate_rad_s, spread) = interval.mean_rate();
            let samples = f64::from(interval.samples);
            let seen = spread * spread / 3.0;
            self.seen_density += (seen * interval.length_s / samples - self.seen_density) * SEEN_SHARE;
            let sigma = self.params.rest.rate_sigma_rad_s;
            let model = RestRate { rate_rad_s, variance_rad2_s2: sigma * sigma + seen / samples };
            self.update(&model, |update| recorder.rest(update));
        }
    }

    fn update_velocity(&mut self, interval: &Interval, recorder: &mut impl Recorder) {
        let moving =
            libm::sqrt(2.0 * self.params.velocity_time_s / interval.length_s) * self.params.velocity_m_s;
        let sigma_m_s = if self.at_rest { self.params.rest.velocity_sigma_m_s } else { moving };
        // A velocity that no wearer has is a blow that the accelerometer has clipped, or a ride: it is not tilt.
        let possible = BoundedVelocity { sigma_m_s: self.params.velocity_m_s }.linearise(&self.state);
        if self.covariance.nis(&possible) > self.params.innovation_bound {
            self.state.velocity_m_s = Vector3::zeros();
            self.covariance.forget(VELOCITY, &[0, 1, 2], self.params.velocity_m_s * self.params.velocity_m_s);
            recorder.forgot((VELOCITY, &[0, 1, 2]));
        } else {
            self.update(&BoundedVelocity { sigma_m_s }, |update| recorder.velocity(update));
        }
    }

    fn update_field(&mut self, interval: &Interval, recorder: &mut impl Recorder) {
        if interval.fields == 0 {
            return;
        }
        let count = f64::from(interval.fields);
        let mut field_ut = interval.field_sum / count;
        let mut rotation = interval.field_rotation_sum / count;
        let mut by_delay_ut_s = interval.field_delay_sum / count;
        if !self.magnetic {
            let Some(turn) = self.find_north(&field_ut) else { return };
            recorder.found_north(&turn, &self.covariance);
            let turn = turn.to_rotation_matrix().into_inner();
            (field_ut, rotation, by_delay_ut_s) = (turn * field_ut, turn * rotation, turn * by_delay_ut_s);
        }
        let verdict = self.judge(interval, &field_ut, &rotation, &by_delay_ut_s);
        let doubt = match verdict {
            Verdict::Believe(doubt) => doubt,
            Verdict::Disturbed => return,
            _ => return self.adopt(verdict, recorder),
        };
        let p = &self.params;
        // A tag at rest sees the same place all the time: what it learns there is worth one more look, however long.
        let looks = self.still_s / p.field_anomaly_time_s;
        let correlated_s = p.field_anomaly_time_s * (1.0 + looks * looks);
        let anomaly = 2.0 * p.field_anomaly_ut * p.field_anomaly_ut * correlated_s / interval.length_s;
        let model = MeanField {
            field_ut,
            rotation,
            by_delay_ut_s,
            variance_ut2: p.noise.field_ut * p.noise.field_ut / count + doubt * anomaly,
            declination_rad: p.declination_rad,
        };
        self.update(&model, |update| recorder.field(update));
    }

    /// Turns the frame so that the first field points north, and takes its strength for that of the site.
    fn find_north(&mut self, field_ut: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
        let horizontal = libm::sqrt(field_ut.xy().norm_squared());
        if horizontal <= 0.0 {
            return None;
        }
        let heading = libm::atan2(field_ut.x, field_ut.y) - self.params.declination_rad;
        let turn = attitude::exp(&Vector3::new(0.0, 0.0, heading));
        let rotation = turn.to_rotation_matrix().into_inner();
        self.state.attitude = turn * self.state.attitude;
        self.state.velocity_m_s = rotation * self.state.velocity_m_s;
        (self.state.horizontal_ut, self.state.down_ut) = (horizontal, -field_ut.z);
        self.covariance.turn(ATTITUDE, &rotation);
        self.covariance.turn(VELOCITY, &rotation);
        self.covariance.forget(ATTITUDE, &[2], UNKNOWN_HEADING_RAD * UNKNOWN_HEADING_RAD);
        self.covariance.forget(FIELD, &[HORIZONTAL, DOWN], UNKNOWN_FIELD_UT * UNKNOWN_FIELD_UT);
        self.magnetic = true;
        Some(turn)
    }

    fn judge(
        &mut self,
        interval: &Interval,
        field_ut: &Vector3<f64>,
        rotation: &Matrix3<f64>,
        by_delay_ut_s: &Vector3<f64>,
    ) -> Verdict {
        let p = &self.params;
        let expected_ut = self.state.field_ut(p.declination_rad);
        let by_offset = self.covariance.block(OFFSET, OFFSET).trace() / 3.0;
        let by_delay = self.covariance.block(FIELD, FIELD)[(DELAY, DELAY)] * by_delay_ut_s.norm_squared();
        let turning = p.disturbance.turning_rad_s * p.disturbance.turning_rad_s * interval.length_s;
        let evidence = FieldEvidence {
            field_ut: *field_ut,
            expected_ut,
            home_ut: self.home_ut.map(|(horizontal, down)| Vector3::new(0.0, horizontal, -down)),
            offset_ut: self.state.offset_ut + rotation.transpose() * (field_ut - expected_ut),
            sigma_ut: libm::sqrt(by_offset + by_delay),
            length_s: interval.length_s,
            turning: interval.rate_squared_rad2_s > turning,
        };
        self.judge.judge(&evidence, &p.disturbance)
    }

    /// A strange field has come to stay, or gone.
    fn adopt(&mut self, verdict: Verdict, recorder: &mut impl Recorder) {
        let spread = self.params.disturbance.adopt_spread_ut;
        let state = &mut self.state;
        let site: Forgotten = (FIELD, &[HORIZONTAL, DOWN]);
        let forgotten: Forgotten = match verdict {
            Verdict::NewSite(field) => {
                self.home_ut.get_or_insert((state.horizontal_ut, state.down_ut));
                (state.horizontal_ut, state.down_ut) = (libm::sqrt(field.xy().norm_squared()), -field.z);
                state.local_declination_rad = libm::atan2(field.x, field.y) - self.params.declination_rad;
                site
            }
            Verdict::Home => {
                let home = self.home_ut.take().unwrap_or((state.horizontal_ut, state.down_ut));
                (state.horizontal_ut, state.down_ut) = home;
                state.local_declination_rad = 0.0;
                site
            }
            Verdict::NewOffset(offset) => {
                state.offset_ut = offset;
                (OFFSET, &[0, 1, 2])
            }
            Verdict::Believe(_) | Verdict::Disturbed => return,
        };
        self.covariance.forget(forgotten.0, forgotten.1, spread * spread);
        recorder.forgot(forgotten);
    }

    #[inline]
    fn update<const N: usize>(
        &mut self,
        model: &impl MeasurementModel<AttitudeState, N>,
        record: impl FnOnce(&BlockUpdate<BLOCKS, N>),
    ) {
        let linearised = model.linearise(&self.state);
        if let Some(update) = self.covariance.update(linearised, self.params.innovation_bound) {
            self.state.correct(&update.correction());
            record(&update);
        }
    }
}
