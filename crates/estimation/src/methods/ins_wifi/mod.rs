//! `reduced-ins-wifi` (system S0) and its yardstick `full-ins-wifi`: dead reckoning held by position fixes.
//!
//! ```text
//! sample → mechanisation → covariance of its error state ─┐
//! fix    → latitude and longitude against the state ──────┴→ correction, fed back at once
//! ```
//!
//! After Luo & Yang (2015). [`Reduced`] has one gyro, two accelerometers and 10 error states, [`Full`] six axes and 18; the
//! filter around them is this one file. A fix between two samples splits the later sample at the fix's time. The
//! solution of a sample stands before a fix of the same time.
//!
//! Frames: body → level; solutions in the [`LevelFrame`] of the site. Velocity and attitude are in the level axes at the
//! walker, which differ from those at the origin by 1e-4 rad in 600 m.
//! Limits: needs site, position and heading at the start; a walk, not a fall: one angle of 90° is turned in no less than
//! some samples.

mod earth;
pub mod full;
mod method;
mod params;
pub mod reduced;

pub use full::Full;
pub use method::{FullInsWifiParams, InsWifiReport, ReducedInsWifiParams};
pub use params::InsWifiParams;
pub use reduced::Reduced;

use crate::kalman::dense::{propagate, update_selected};
use crate::methods::{MethodError, MethodWarning};
use adit_core::attitude::Attitude;
use adit_core::geodesy::{Geodetic, meridian_radius_m, prime_vertical_radius_m};
use adit_core::level_frame::LevelFrame;
use adit_core::nalgebra::{Matrix1, Matrix2, SMatrix, SVector, Vector1, Vector2, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_observation::{HeightFix, ImuSample, Observation, PositionFix};
use alloc::vec::Vec;
use core::fmt::Debug;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Fixes that may wait for the inertial sample after them; with no sample for so long the oldest are dropped.
const MOST_HELD: usize = 32;

/// A prediction this many times less sure than a fix does not judge it.
const UNSURE: f64 = 10.0;

/// Index of the error state behind each state of a solution (east, north, up, velocity, attitude), where there is one.
pub type StateMap = [Option<usize>; 9];

/// A strapdown mechanisation with its exact linearisation; `N` error states, truth minus estimate.
pub trait Mechanisation<const N: usize>: Clone + Debug + Serialize + DeserializeOwned {
    /// What a step leaves for its linearisation.
    type Step;

    /// Name of the method.
    const NAME: &'static str;
    /// Error state of the latitude, rad.
    const LATITUDE: usize;
    /// Error state of the longitude, rad.
    const LONGITUDE: usize;
    /// Error state of the height, m, where there is one.
    const HEIGHT: Option<usize>;

    /// State at the start, and the standard deviations of its error.
    fn start(start: &NavigationStart, params: &InsWifiParams) -> (Self, SVector<f64, N>);
    /// Integrates the mean rate and force of an interval.
    fn step(&mut self, imu: &ImuSample, interval_s: f64) -> Self::Step;
    /// What becomes of an error over the step: `Φ x`.
    fn carry(step: &Self::Step, error: &SVector<f64, N>) -> SVector<f64, N>;
    /// Adds the noise of the step.
    fn add_noise(step: &Self::Step, params: &InsWifiParams, covariance: &mut SMatrix<f64, N, N>);
    /// Variance that terms of second order give to latitude and longitude, rad²: none where they are small.
    fn second_order(&self, covariance: &SMatrix<f64, N, N>) -> Matrix2<f64> {
        let _ = covariance;
        Matrix2::zeros()
    }
    /// What a large correction changes in the meaning of the error states; `before` is the covariance before the update.
    fn reset(
        &self,
        before: &SMatrix<f64, N, N>,
        correction: &SVector<f64, N>,
        covariance: &mut SMatrix<f64, N, N>,
    ) {
        let _ = (before, correction, covariance);
    }
    /// Takes an estimated error into the state.
    fn feed_back(&mut self, error: &SVector<f64, N>);
    /// Position.
    fn position(&self) -> &Geodetic;
    /// Velocity, level axes, m/s.
    fn velocity_m_s(&self) -> Vector3<f64>;
    /// Body to level.
    fn attitude(&self) -> &Attitude;
    /// Where the states of a solution stand.
    fn map() -> StateMap;
    /// No number has been lost.
    fn is_finite(&self) -> bool;
}

/// What is known at the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavigationStart {
    /// Position.
    pub position: Geodetic,
    /// Standard deviation of latitude and longitude, rad.
    pub position_sigma_rad: [f64; 2],
    /// Body to level.
    pub attitude: Attitude,
    /// Standard deviation of the attitude about each axis, rad.
    pub attitude_sigma_rad: f64,
}

/// One walker, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct InsWifi<M: Mechanisation<N>, const N: usize> {
    params: InsWifiParams,
    frame: LevelFrame,
    mechanisation: M,
    covariance: SMatrix<f64, N, N>,
    time: Option<Time>,
    /// Fixes newer than the state, in order of time.
    held: Vec<PositionFix>,
    report: InsWifiReport,
}

/// The method with ten error states.
pub type ReducedInsWifi = InsWifi<Reduced, { reduced::STATES }>;
/// The method with eighteen.
pub type FullInsWifi = InsWifi<Full, { full::STATES }>;

impl<M: Mechanisation<N>, const N: usize> InsWifi<M, N> {
    /// A walker at the start that the settings tell of.
    pub fn new(params: InsWifiParams) -> Result<Self, MethodError> {
        let unusable = |name| MethodError::Setting { method: M::NAME, name };
        if let Some(name) = params.unusable() {
            return Err(unusable(name));
        }
        let site = params.site.and_then(|site| site.point()).ok_or_else(|| unusable("site"))?;
        let frame = LevelFrame::new(site);
        let start = params.start.ok_or_else(|| unusable("start"))?;
        let position = frame.point(&Vector2::from(start.position_m), 0.0).ok_or_else(|| unusable("start"))?;
        let [east, north] = start.position_sigma_m;
        let [latitude_m, longitude_m] = metres_per_rad(&position);
        let (mechanisation, sigmas) = M::start(
            &NavigationStart {
                position,
                position_sigma_rad: [north / latitude_m, east / longitude_m],
                attitude: start.attitude(),
                attitude_sigma_rad: start.attitude_sigma_deg.to_radians(),
            },
            &params,
        );
        Ok(Self {
            params,
            frame,
            mechanisation,
            covariance: SMatrix::from_diagonal(&sigmas.component_mul(&sigmas)),
            time: None,
            held: Vec::with_capacity(MOST_HELD),
            report: InsWifiReport::default(),
        })
    }

    /// One observation in; a solution out for every inertial sample.
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match observation {
            Observation::Imu(imu) => self.advance(imu).map(Some),
            Observation::Fix(fix) => {
                self.take(fix);
                Ok(None)
            }
            _ => Ok(None),
        }
    }

    /// What the run did so far.
    pub fn report(&self) -> &InsWifiReport {
        &self.report
    }

    /// The state under way.
    pub fn mechanisation(&self) -> &M {
        &self.mechanisation
    }

    /// Covariance of the error state.
    pub fn covariance(&self) -> &SMatrix<f64, N, N> {
        &self.covariance
    }

    /// Predict up to each fix on the way and correct, predict to the sample: the method.
    fn advance(&mut self, imu: &ImuSample) -> Result<Solution, MethodError> {
        if !imu.is_reading() {
            return Err(MethodError::NoReading { time: imu.time });
        }
        if let Some(before) = self.time {
            if imu.time <= before {
                return Err(MethodError::TimeNotRising { found: imu.time, before });
            }
            let interval_s = (imu.time - before).seconds();
            if interval_s > self.params.gap_s {
                self.bridge(imu.time, interval_s);
            } else {
                while let Some(fix) = self.next_held(imu.time) {
                    self.predict(imu, fix.time);
                    self.correct(&fix);
                }
                self.predict(imu, imu.time);
            }
        } else {
            let held = self.held.len();
            self.held.retain(|fix| fix.time >= imu.time);
            self.report.late_fixes += (held - self.held.len()) as u64;
        }
        self.time = Some(imu.time);
        self.report.samples += 1;
        while let Some(fix) = self.next_held(imu.time) {
            self.correct(&fix);
        }
        if self.mechanisation.is_finite() && self.covariance.trace().is_finite() {
            Ok(self.solution(imu.time))
        } else {
            Err(MethodError::Diverged { time: imu.time })
        }
    }

    /// Uses a fix at once when it is as new as the state, leaves it when it is older, keeps a newer one until the state is as new.
    fn take(&mut self, fix: &PositionFix) {
        self.report.fixes += 1;
        if fix.fault().is_some() || !self.params.use_fixes {
            return;
        }
        match self.time {
            Some(time) if fix.time < time => self.report.late_fixes += 1,
            Some(time) if fix.time == time => self.correct(fix),
            _ => {
                if self.held.len() == MOST_HELD {
                    self.held.remove(0);
                    self.report.late_fixes += 1;
                }
                let place = self.held.partition_point(|held| held.time <= fix.time);
                self.held.insert(place, *fix);
            }
        }
    }

    /// The oldest fix held that is not newer than `time`.
    fn next_held(&mut self, time: Time) -> Option<PositionFix> {
        let first = self.held.first().filter(|fix| fix.time <= time)?;
        let fix = *first;
        self.held.remove(0);
        Some(fix)
    }

    /// Carries state and covariance to `until` with this sample's rate and force.
    #[inline]
    fn predict(&mut self, imu: &ImuSample, until: Time) {
        let interval_s = self.time.map_or(0.0, |time| (until - time).seconds());
        if interval_s <= 0.0 {
            return;
        }
        let step = self.mechanisation.step(imu, interval_s);
        propagate(&mut self.covariance, |error| M::carry(&step, error));
        M::add_noise(&step, &self.params, &mut self.covariance);
        self.time = Some(until);
    }

    /// Compares a fix with the state in latitude and longitude (and height), and feeds back what it says.
    fn correct(&mut self, fix: &PositionFix) {
        let up_m = fix.height.map_or(0.0, |height| height.up_m);
        let Some(point) = self.frame.point(&fix.level_m, up_m) else { return };
        let here = *self.mechanisation.position();
        let [latitude_m, longitude_m] = metres_per_rad(&here);
        let p = &fix.covariance_m2;
        let cross = p[(0, 1)] / (latitude_m * longitude_m);
        let noise = Matrix2::new(
            p[(1, 1)] / (latitude_m * latitude_m),
            cross,
            cross,
            p[(0, 0)] / (longitude_m * longitude_m),
        );
        let residual =
            Vector2::new(point.latitude_rad - here.latitude_rad, point.longitude_rad - here.longitude_rad);
        // Who is ten times less sure than the fix cannot call it an outlier.
        let predicted_m2 = self.covariance[(M::LATITUDE, M::LATITUDE)] * latitude_m * latitude_m
            + self.covariance[(M::LONGITUDE, M::LONGITUDE)] * longitude_m * longitude_m;
        let sure = predicted_m2 < UNSURE * UNSURE * fix.covariance_m2.trace();
        let bound = if sure { self.params.fix_nis_bound } else { f64::INFINITY };
        let noise = noise + self.mechanisation.second_order(&self.covariance);
        let measured = [M::LATITUDE, M::LONGITUDE];
        let before = self.covariance;
        let Some(update) = update_selected(&mut self.covariance, measured, &residual, &noise, bound) else {
            return;
        };
        self.report.note(update.nis, bound);
        self.mechanisation.reset(&before, &update.correction, &mut self.covariance);
        self.mechanisation.feed_back(&update.correction);
        if let Some(index) = M::HEIGHT {
            let HeightFix { up_m, sigma_m } =
                fix.height.unwrap_or(HeightFix { up_m: 0.0, sigma_m: self.params.level_sigma_m });
            let height_m = self.frame.origin().height_m + up_m;
            let residual = Vector1::new(height_m - self.mechanisation.position().height_m);
            let noise = Matrix1::new(sigma_m * sigma_m);
            let update = update_selected(&mut self.covariance, [index], &residual, &noise, bound);
            if let Some(update) = update {
                self.mechanisation.feed_back(&update.correction);
            }
        }
    }

    /// Nothing is known of a gap but how people move: position, velocity and heading become uncertain.
    fn bridge(&mut self, time: Time, length_s: f64) {
        self.report.warn(MethodWarning::Gap { time, length_s });
        let [latitude_m, longitude_m] = metres_per_rad(self.mechanisation.position());
        let (speed, turn) = (self.params.gap_speed_m_s, self.params.gap_turn_rad_s * length_s);
        let distance_m = speed * length_s;
        let map = M::map();
        let gained =
            [distance_m / longitude_m, distance_m / latitude_m, 0.0, speed, speed, 0.0, 0.0, 0.0, turn];
        for (index, sigma) in map.into_iter().zip(gained) {
            if let Some(index) = index {
                self.covariance[(index, index)] += sigma * sigma;
            }
        }
    }

    fn solution(&self, time: Time) -> Solution {
        let position = self.mechanisation.position();
        let [latitude_m, longitude_m] = metres_per_rad(position);
        let gains = [longitude_m, latitude_m, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        let map = M::map();
        let covariance = SolutionCovariance::from_fn(|row, column| match (map[row], map[column]) {
            (Some(i), Some(j)) => self.covariance[(i, j)] * gains[row] * gains[column],
            _ => 0.0,
        });
        Solution {
            time,
            position_m: self.frame.position_m(position),
            velocity_m_s: self.mechanisation.velocity_m_s(),
            attitude: *self.mechanisation.attitude(),
            covariance,
            quality: if self.report.used_fixes > 0 { Quality::Fixed } else { Quality::DeadReckoning },
        }
    }
}

/// Metres in a radian of latitude and of longitude.
#[inline]
fn metres_per_rad(point: &Geodetic) -> [f64; 2] {
    let latitude = meridian_radius_m(point.latitude_rad) + point.height_m;
    let longitude =
        (prime_vertical_radius_m(point.latitude_rad) + point.height_m) * libm::cos(point.latitude_rad);
    [latitude, longitude]
}

/// Variance that white noise of this density gains over an interval.
#[inline]
fn variance(density: f64, interval_s: f64) -> f64 {
    density * density * interval_s
}
