//! The full mechanisation: six axes, 18 error states; the yardstick of the reduced one.
//!
//! Strapdown in geodetic coordinates (Groves 2013, §5.4, in ENU form; error equations §14.2.4 in this form), with the same
//! midpoint step as [`super::reduced`]:
//!
//! ```text
//! ω = (ω_m − b_g) / (1 + s)                     f = f_m − b_a
//! q ← exp(−ω_in dt) ∘ q ∘ exp(ω dt)             v̇ = C f − (2 ω_ie + ω_en) × v − g(L, h)
//! L̇ = Vn / (R_M + h)     λ̇ = Ve / ((R_N + h) cos L)     ḣ = Vu
//! ```
//!
//! Error states, truth minus estimate: attitude φ (ENU), velocity (ENU), `δL δλ δh`, gyro bias, accelerometer bias, gyro
//! scale factor; rad, m/s, rad and m, rad/s, m/s², 1. The vertical channel of an INS runs away by itself: the height is held
//! by what is known of the level ([`InsWifiParams::level_sigma_m`]).
//!
//! Limits: no coning and no sculling inside an interval, as in the reduced one: for walks, not for a foot.

use super::earth::Curvature;
use super::{InsWifiParams, Mechanisation, NavigationStart, StateMap, metres_per_rad, variance};
use crate::kalman::dense::propagate;
use adit_core::attitude::{self, Attitude};
use adit_core::geodesy::{
    EARTH_RATE_RAD_S, FLATTENING, GM_M3_S2, GRAVITY_EQUATOR_M_S2, GRAVITY_POLE_M_S2, Geodetic,
    SEMI_MAJOR_AXIS_M, SEMI_MINOR_AXIS_M, gravity_at_height_m_s2,
};
use adit_core::nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector3};
use adit_observation::ImuSample;
use serde::{Deserialize, Serialize};

/// Number of error states.
pub const STATES: usize = 18;
const PHI: usize = 0;
const VELOCITY: usize = 3;
const LATITUDE: usize = 6;
const LONGITUDE: usize = 7;
const HEIGHT: usize = 8;
const GYRO: usize = 9;
const FORCE: usize = 12;
const SCALE: usize = 15;

/// What the mechanisation integrates and the filter corrects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Full {
    /// Body to level.
    pub attitude: Attitude,
    /// Velocity (east, north, up), m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Position.
    pub position: Geodetic,
    /// Gyro bias, rad/s.
    pub gyro_bias_rad_s: Vector3<f64>,
    /// Accelerometer bias, m/s².
    pub acc_bias_m_s2: Vector3<f64>,
    /// Gyro scale factor errors.
    pub gyro_scale: Vector3<f64>,
}

/// One step, as its linearisation needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FullStep {
    interval_s: f64,
    earth: Curvature,
    height_m: f64,
    /// By latitude, m/s² per rad, and by height, m/s² per m.
    gravity_slope: [f64; 2],
    rotation_mid: Matrix3<f64>,
    rate_in: Vector3<f64>,
    gain: Vector3<f64>,
    rate: Vector3<f64>,
    force: Vector3<f64>,
    velocity: [Vector3<f64>; 3],
}

/// Derivatives of [`gravity_at_height_m_s2`] by latitude (to 1 % of it) and by height (to 1e-6 of it).
#[inline]
fn gravity_slope(earth: &Curvature, gravity: f64, height_m: f64) -> [f64; 2] {
    const M: f64 =
        EARTH_RATE_RAD_S * EARTH_RATE_RAD_S * SEMI_MAJOR_AXIS_M * SEMI_MAJOR_AXIS_M * SEMI_MINOR_AXIS_M
            / GM_M3_S2;
    let by_latitude = 2.0 * earth.sin * earth.cos * (GRAVITY_POLE_M_S2 - GRAVITY_EQUATOR_M_S2);
    let gradient = 2.0 * (1.0 + FLATTENING + M - 2.0 * FLATTENING * earth.sin * earth.sin);
    let by_height = (-gradient + 2.0 * height_m / SEMI_MAJOR_AXIS_M) * gravity / SEMI_MAJOR_AXIS_M;
    [by_latitude, by_height]
}

/// `(2 ω_ie + ω_en) × v`.
#[inline]
fn coriolis(earth: &Curvature, v: &Vector3<f64>, height_m: f64) -> Vector3<f64> {
    (2.0 * earth.earth_rate() + earth.transport_rate(v, height_m)).cross(v)
}

/// What errors of velocity, latitude and height do to it.
#[inline]
fn coriolis_error(
    earth: &Curvature,
    v: &Vector3<f64>,
    height_m: f64,
    dv: &Vector3<f64>,
    [latitude, height]: [f64; 2],
) -> Vector3<f64> {
    let rate = 2.0 * earth.earth_rate() + earth.transport_rate(v, height_m);
    let rate_error = 2.0 * earth.earth_rate_error(latitude)
        + earth.transport_rate_error(v, height_m, dv, [latitude, height]);
    rate.cross(dv) + rate_error.cross(v)
}

impl Mechanisation<STATES> for Full {
    type Step = FullStep;

    const NAME: &'static str = "full-ins-wifi";
    const HEIGHT: Option<usize> = Some(HEIGHT);
    const LATITUDE: usize = LATITUDE;
    const LONGITUDE: usize = LONGITUDE;

    fn start(start: &NavigationStart, params: &InsWifiParams) -> (Self, SVector<f64, STATES>) {
        let [latitude, longitude] = start.position_sigma_rad;
        let mut sigmas = SVector::<f64, STATES>::zeros();
        let mut set = |at: usize, sigma: f64| sigmas.fixed_rows_mut::<3>(at).fill(sigma);
        set(PHI, start.attitude_sigma_rad);
        set(VELOCITY, params.velocity_sigma_m_s);
        set(GYRO, params.gyro_bias_sigma_rad_s);
        set(FORCE, params.acc_bias_sigma_m_s2);
        set(SCALE, params.gyro_scale_sigma);
        (sigmas[LATITUDE], sigmas[LONGITUDE], sigmas[HEIGHT]) = (latitude, longitude, params.level_sigma_m);
        let state = Self {
            attitude: start.attitude,
            velocity_m_s: Vector3::zeros(),
            position: start.position,
            gyro_bias_rad_s: Vector3::zeros(),
            acc_bias_m_s2: Vector3::zeros(),
            gyro_scale: Vector3::zeros(),
        };
        (state, sigmas)
    }

    #[inline]
    fn step(&mut self, imu: &ImuSample, interval_s: f64) -> FullStep {
        let Geodetic { latitude_rad, height_m, .. } = self.position;
        let earth = Curvature::at(latitude_rad);
        let v = self.velocity_m_s;
        let rate_in = earth.earth_rate() + earth.transport_rate(&v, height_m);
        let gain = self.gyro_scale.map(|scale| 1.0 / (1.0 + scale));
        let rate = (imu.angular_rate_rad_s - self.gyro_bias_rad_s).component_mul(&gain);
        let turn = rate * interval_s;

        // Half of the step: the level frame turns under the body, the body turns in itself.
        let level_half = attitude::exp(&(rate_in * (-0.5 * interval_s)));
        let half = level_half * self.attitude * attitude::exp(&(turn * 0.5));
        let rotation_mid = half.to_rotation_matrix().into_inner();
        let force = rotation_mid * (imu.specific_force_m_s2 - self.acc_bias_m_s2);
        let gravity = gravity_at_height_m_s2(latitude_rad, height_m);
        let driven = force - Vector3::new(0.0, 0.0, gravity);

        let half_way = v + (driven - coriolis(&earth, &v, height_m)) * (0.5 * interval_s);
        self.velocity_m_s += (driven - coriolis(&earth, &half_way, height_m)) * interval_s;
        let mean = 0.5 * (v + self.velocity_m_s);
        self.position.latitude_rad += mean.y * interval_s / (earth.meridian_m + height_m);
        self.position.longitude_rad += mean.x * interval_s / ((earth.vertical_m + height_m) * earth.cos);
        self.position.height_m += mean.z * interval_s;
        let level = attitude::exp(&(rate_in * -interval_s));
        self.attitude = attitude::turn_body(&(level * self.attitude), &turn);
        FullStep {
            interval_s,
            earth,
            height_m,
            gravity_slope: gravity_slope(&earth, gravity, height_m),
            rotation_mid,
            rate_in,
            gain,
            rate,
            force,
            velocity: [v, half_way, mean],
        }
    }

    #[inline]
    fn carry(step: &FullStep, x: &SVector<f64, STATES>) -> SVector<f64, STATES> {
        let FullStep { interval_s: dt, earth, height_m, rotation_mid, force, velocity, .. } = step;
        let [before, half_way, mean] = velocity;
        let part = |at: usize| -> Vector3<f64> { x.fixed_rows::<3>(at).into_owned() };
        let (phi, dv, gyro, sensed, scale) =
            (part(PHI), part(VELOCITY), part(GYRO), part(FORCE), part(SCALE));
        let (latitude, height) = (x[LATITUDE], x[HEIGHT]);
        let place = [latitude, height];

        let rate_in_error =
            earth.earth_rate_error(latitude) + earth.transport_rate_error(before, *height_m, &dv, place);
        let rate_error = -(gyro + step.rate.component_mul(&scale)).component_mul(&step.gain);
        let turned = (rotation_mid * rate_error - rate_in_error) * *dt;
        let level_turned = step.rate_in.cross(&phi) * *dt;

        // Half way, what the gyros have done wrong lies in the axes of a quarter of the turn.
        let lag = step.rate.cross(&rate_error) * (0.25 * dt);
        let tilted = phi + 0.5 * (turned - level_turned - rotation_mid * lag * *dt);
        let force_error = tilted.cross(force)
            - rotation_mid * sensed
            - Vector3::z() * (step.gravity_slope[0] * latitude + step.gravity_slope[1] * height);
        let change = |v: &Vector3<f64>, dv: &Vector3<f64>| {
            force_error - coriolis_error(earth, v, *height_m, dv, place)
        };
        let dv_half = dv + change(before, &dv) * (0.5 * dt);
        let dv_after = dv + change(half_way, &dv_half) * *dt;
        let dv_mean = 0.5 * (dv + dv_after);

        let (meridian, vertical) = (earth.meridian_m + height_m, earth.vertical_m + height_m);
        let northward = dv_mean.y - mean.y / meridian * (earth.meridian_slope_m * latitude + height);
        let eastward = dv_mean.x + mean.x * earth.sin / earth.cos * latitude
            - mean.x / vertical * (earth.vertical_slope_m * latitude + height);

        let mut after = *x;
        after.fixed_rows_mut::<3>(PHI).copy_from(&(phi + turned - level_turned));
        after.fixed_rows_mut::<3>(VELOCITY).copy_from(&dv_after);
        after[LATITUDE] += northward * dt / meridian;
        after[LONGITUDE] += eastward * dt / (vertical * earth.cos);
        after[HEIGHT] += dv_mean.z * dt;
        after
    }

    #[inline]
    fn add_noise(step: &FullStep, params: &InsWifiParams, covariance: &mut SMatrix<f64, STATES, STATES>) {
        let FullStep { interval_s: dt, earth, height_m, .. } = step;
        let noise = &params.noise;
        let velocity = variance(noise.velocity_random_walk_m_s_sqrt_s, *dt);
        let per_metre = [
            (LATITUDE, 1, 1.0 / (earth.meridian_m + height_m)),
            (LONGITUDE, 0, 1.0 / ((earth.vertical_m + height_m) * earth.cos)),
            (HEIGHT, 2, 1.0),
        ];
        for (position, axis, gain) in per_metre {
            // The same noise moves the position over half of the step.
            let shift = 0.5 * dt * gain;
            covariance[(position, position)] += velocity * shift * shift;
            covariance[(position, VELOCITY + axis)] += velocity * shift;
            covariance[(VELOCITY + axis, position)] += velocity * shift;
        }
        let walks = [
            (PHI, variance(noise.angle_random_walk_rad_sqrt_s, *dt)),
            (VELOCITY, velocity),
            (GYRO, variance(noise.gyro_bias_walk_rad_s_sqrt_s, *dt)),
            (FORCE, variance(noise.acc_bias_walk_m_s2_sqrt_s, *dt)),
        ];
        for (block, variance) in walks {
            for index in block..block + 3 {
                covariance[(index, index)] += variance;
            }
        }
    }

    /// Gravity turned by a heading error φu and tilts φe, φn together: an acceleration of `½ g φu (φe, φn)`, and so a shift of
    /// `½ φu ẑ × r`, with `r` what the tilts do to the position (as far as the covariance says so). With 0.6° each that is 0.1 m
    /// in the first 20 s, as much as a fix is worth (a second-order filter's term: Jazwinski 1970, §9.3).
    fn second_order(&self, covariance: &SMatrix<f64, STATES, STATES>) -> Matrix2<f64> {
        let tilts: Matrix2<f64> = covariance.fixed_view::<2, 2>(PHI, PHI).into_owned();
        let with_position = covariance.fixed_view::<2, 2>(LATITUDE, PHI);
        let Some(inverse) = tilts.try_inverse() else { return Matrix2::zeros() };
        let by_tilt = with_position * inverse * with_position.transpose();
        let [latitude_m, longitude_m] = metres_per_rad(&self.position);
        // A quarter turn: what lies north moves east.
        let turn = Matrix2::new(0.0, longitude_m / latitude_m, -latitude_m / longitude_m, 0.0);
        turn * by_tilt * turn.transpose() * (0.25 * covariance[(PHI + 2, PHI + 2)])
    }

    /// A tilt corrected by `Δ` has moved velocity and position by `B Δ`, in the direction of a wrong gravity; with it goes what
    /// a heading error was held to do to them: `δv ← δv + φ × B_v Δ`, `δr ← δr + φ × B_r Δ`. Without this the filter believes
    /// to have seen the heading in the turn of a gravity that was never level (Barrau & Bonnabel 2017: the error carried over
    /// is the invariant one).
    fn reset(
        &self,
        before: &SMatrix<f64, STATES, STATES>,
        correction: &SVector<f64, STATES>,
        covariance: &mut SMatrix<f64, STATES, STATES>,
    ) {
        let tilts: Matrix2<f64> = before.fixed_view::<2, 2>(PHI, PHI).into_owned();
        let Some(inverse) = tilts.try_inverse() else { return };
        let tilt = inverse * correction.fixed_rows::<2>(PHI);
        let velocity = before.fixed_view::<2, 2>(VELOCITY, PHI) * tilt;
        let shift = before.fixed_view::<2, 2>(LATITUDE, PHI) * tilt;
        let [latitude_m, longitude_m] = metres_per_rad(&self.position);
        let (north, east) = (shift[0] * latitude_m, shift[1] * longitude_m);
        propagate(covariance, |x| {
            let heading = x[PHI + 2];
            let mut after = *x;
            after[VELOCITY] -= heading * velocity.y;
            after[VELOCITY + 1] += heading * velocity.x;
            after[LONGITUDE] -= heading * north / longitude_m;
            after[LATITUDE] += heading * east / latitude_m;
            after
        });
    }

    fn feed_back(&mut self, x: &SVector<f64, STATES>) {
        self.attitude = attitude::turn_navigation(&self.attitude, &x.fixed_rows::<3>(PHI).into_owned());
        self.velocity_m_s += x.fixed_rows::<3>(VELOCITY);
        self.position.latitude_rad += x[LATITUDE];
        self.position.longitude_rad += x[LONGITUDE];
        self.position.height_m += x[HEIGHT];
        self.gyro_bias_rad_s += x.fixed_rows::<3>(GYRO);
        self.acc_bias_m_s2 += x.fixed_rows::<3>(FORCE);
        self.gyro_scale += x.fixed_rows::<3>(SCALE);
    }

    fn position(&self) -> &Geodetic {
        &self.position
    }

    fn velocity_m_s(&self) -> Vector3<f64> {
        self.velocity_m_s
    }

    fn attitude(&self) -> &Attitude {
        &self.attitude
    }

    fn map() -> StateMap {
        [LONGITUDE, LATITUDE, HEIGHT, VELOCITY, VELOCITY + 1, VELOCITY + 2, 0, 1, 2].map(Some)
    }

    fn is_finite(&self) -> bool {
        let Geodetic { latitude_rad, longitude_rad, height_m } = self.position;
        let vectors = [&self.velocity_m_s, &self.gyro_bias_rad_s, &self.acc_bias_m_s2, &self.gyro_scale];
        let numbers = [latitude_rad, longitude_rad, height_m];
        let vectors = vectors.into_iter().flatten().chain(self.attitude.coords.iter());
        vectors.chain(&numbers).all(|v| v.is_finite())
    }
}
