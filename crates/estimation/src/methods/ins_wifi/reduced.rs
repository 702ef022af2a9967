//! The reduced mechanisation: one gyro about the vertical, two level accelerometers, ten error states.
//!
//! Luo & Yang (2015), eq. 1, with the attitude that the paper leaves open. `T = C_b^n` is kept by quaternion; `t` is its
//! third column, the gyro's axis; `ω_in` the Earth's rate plus the transport rate; `ε`, `∇` the estimated biases:
//!
//! ```text
//! q̇  = ½ q ∘ (0, 0, 0, r)        r = ω_z − ε − t·ω_in
//! V̇e = T11 fx + T12 fy + k Vn     k = 2 ω_ie sin L + Ve tan L / R_N
//! V̇n = T21 fx + T22 fy − k Ve     L̇ = Vn / R_M     λ̇ = Ve / (R_N cos L)
//! ```
//!
//! The rates about the two axes without a gyro are those of level walking: none against the level frame. With the paper's
//! own eq. 2 and 3 (which belong to three gyros) the platform would tilt with the Earth, 3° in 1000 s.
//!
//! One step takes the mean rate and force of its interval, turns the force by half of the turn, and the velocity by the
//! midpoint rule; [`Reduced::carry`] is the exact derivative of that step, proven in `tests/ins_wifi_jacobian.rs`.
//!
//! Error states, truth minus estimate: `[φe φn φu δVe δVn δL δλ ε ∇x ∇y]`; rad, m/s, rad/s, m/s².

use super::earth::Curvature;
use super::{InsWifiParams, Mechanisation, NavigationStart, StateMap, variance};
use adit_core::attitude::{self, Attitude};
use adit_core::geodesy::{EARTH_RATE_RAD_S, Geodetic};
use adit_core::nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};
use adit_observation::ImuSample;
use serde::{Deserialize, Serialize};

/// Number of error states.
pub const STATES: usize = 10;
const PHI: usize = 0;
const VELOCITY: usize = 3;
const LATITUDE: usize = 5;
const LONGITUDE: usize = 6;
const GYRO: usize = 7;
const FORCE: usize = 8;

/// What the mechanisation integrates and the filter corrects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reduced {
    /// Body to level.
    pub attitude: Attitude,
    /// Velocity (east, north), m/s.
    pub velocity_m_s: Vector2<f64>,
    /// Position; the height stays.
    pub position: Geodetic,
    /// Gyro bias, rad/s.
    pub gyro_bias_rad_s: f64,
    /// Accelerometer biases (x, y), m/s².
    pub acc_bias_m_s2: Vector2<f64>,
}

/// One step, as its linearisation needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReducedStep {
    interval_s: f64,
    earth: Curvature,
    rotation_mid: Matrix3<f64>,
    axis: Vector3<f64>,
    rate_in: Vector3<f64>,
    force: Vector3<f64>,
    velocity: [Vector2<f64>; 3],
}

/// `k` of the module's head.
#[inline]
fn turn_rate(earth: &Curvature, east_m_s: f64) -> f64 {
    2.0 * EARTH_RATE_RAD_S * earth.sin + east_m_s * earth.sin / (earth.cos * earth.vertical_m)
}

/// Coriolis and centrifugal terms of eq. 1.
#[inline]
fn coriolis(earth: &Curvature, v: &Vector2<f64>) -> Vector2<f64> {
    let k = turn_rate(earth, v.x);
    Vector2::new(k * v.y, -k * v.x)
}

/// What errors of velocity and latitude do to them.
#[inline]
fn coriolis_error(earth: &Curvature, v: &Vector2<f64>, dv: &Vector2<f64>, latitude: f64) -> Vector2<f64> {
    let k = turn_rate(earth, v.x);
    let (tan, eastward) = (earth.sin / earth.cos, v.x / earth.vertical_m);
    let by_latitude = 2.0 * EARTH_RATE_RAD_S * earth.cos + eastward / (earth.cos * earth.cos)
        - eastward * tan * earth.vertical_slope_m / earth.vertical_m;
    let dk = tan / earth.vertical_m * dv.x + by_latitude * latitude;
    Vector2::new(k * dv.y + dk * v.y, -k * dv.x - dk * v.x)
}

impl Mechanisation<STATES> for Reduced {
    type Step = ReducedStep;

    const NAME: &'static str = "reduced-ins-wifi";
    const HEIGHT: Option<usize> = None;
    const LATITUDE: usize = LATITUDE;
    const LONGITUDE: usize = LONGITUDE;

    fn start(start: &NavigationStart, params: &InsWifiParams) -> (Self, SVector<f64, STATES>) {
        let sigma = start.attitude_sigma_rad;
        let (velocity, force) = (params.velocity_sigma_m_s, params.acc_bias_sigma_m_s2);
        let [latitude, longitude] = start.position_sigma_rad;
        let sigmas = [
            sigma,
            sigma,
            sigma,
            velocity,
            velocity,
            latitude,
            longitude,
            params.gyro_bias_sigma_rad_s,
            force,
            force,
        ];
        let state = Self {
            attitude: start.attitude,
            velocity_m_s: Vector2::zeros(),
            position: start.position,
            gyro_bias_rad_s: 0.0,
            acc_bias_m_s2: Vector2::zeros(),
        };
        (state, SVector::from(sigmas))
    }

    #[inline]
    fn step(&mut self, imu: &ImuSample, interval_s: f64) -> ReducedStep {
        let earth = Curvature::at(self.position.latitude_rad);
        let v = self.velocity_m_s;
        let rate_in = earth.earth_rate() + earth.transport_rate(&v.push(0.0), 0.0);
        let rotation = self.attitude.to_rotation_matrix().into_inner();
        let axis: Vector3<f64> = rotation.column(2).into_owned();
        let turn = (imu.angular_rate_rad_s.z - self.gyro_bias_rad_s - axis.dot(&rate_in)) * interval_s;

        let (sin, cos) = libm::sincos(0.5 * turn);
        let half = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        let rotation_mid = rotation * half;
        let measured = imu.specific_force_m_s2.xy() - self.acc_bias_m_s2;
        let force = rotation_mid * measured.push(0.0);

        let half_way = v + (force.xy() + coriolis(&earth, &v)) * (0.5 * interval_s);
        self.velocity_m_s += (force.xy() + coriolis(&earth, &half_way)) * interval_s;
        let mean = 0.5 * (v + self.velocity_m_s);
        self.position.latitude_rad += mean.y * interval_s / earth.meridian_m;
        self.position.longitude_rad += mean.x * interval_s / (earth.vertical_m * earth.cos);
        self.attitude = attitude::turn_body(&self.attitude, &Vector3::new(0.0, 0.0, turn));
        let velocity = [v, half_way, mean];
        ReducedStep { interval_s, earth, rotation_mid, axis, rate_in, force, velocity }
    }

    #[inline]
    fn carry(step: &ReducedStep, x: &SVector<f64, STATES>) -> SVector<f64, STATES> {
        let ReducedStep { interval_s: dt, earth, rotation_mid, axis, rate_in, force, velocity } = step;
        let [before, half_way, mean] = velocity;
        let phi: Vector3<f64> = x.fixed_rows::<3>(PHI).into_owned();
        let dv: Vector2<f64> = x.fixed_rows::<2>(VELOCITY).into_owned();
        let (latitude, force_bias) = (x[LATITUDE], x.fixed_rows::<2>(FORCE));

        let rate_in_error = earth.earth_rate_error(latitude)
            + earth.transport_rate_error(&before.push(0.0), 0.0, &dv.push(0.0), [latitude, 0.0]);
        // Of the rate about the gyro's axis: δt = φ × t, so that δt·ω_in = φ·(t × ω_in).
        let rate_error = -x[GYRO] - phi.dot(&axis.cross(rate_in)) - axis.dot(&rate_in_error);
        let turn_error = axis * (rate_error * dt);

        let tilted = phi + 0.5 * turn_error;
        let sensed = rotation_mid.fixed_view::<2, 2>(0, 0) * force_bias;
        let force_error = tilted.cross(force).xy() - sensed;
        let dv_half = dv + (force_error + coriolis_error(earth, before, &dv, latitude)) * (0.5 * dt);
        let dv_after = dv + (force_error + coriolis_error(earth, half_way, &dv_half, latitude)) * *dt;
        let dv_mean = 0.5 * (dv + dv_after);

        let parallel_m = earth.vertical_m * earth.cos;
        let northward = dv_mean.y - mean.y * earth.meridian_slope_m / earth.meridian_m * latitude;
        let stretch = earth.sin / earth.cos - earth.vertical_slope_m / earth.vertical_m;
        let eastward = dv_mean.x + mean.x * stretch * latitude;

        let mut after = *x;
        after.fixed_rows_mut::<3>(PHI).copy_from(&(phi + turn_error));
        after.fixed_rows_mut::<2>(VELOCITY).copy_from(&dv_after);
        after[LATITUDE] += northward * dt / earth.meridian_m;
        after[LONGITUDE] += eastward * dt / parallel_m;
        after
    }

    #[inline]
    fn add_noise(step: &ReducedStep, params: &InsWifiParams, covariance: &mut SMatrix<f64, STATES, STATES>) {
        let ReducedStep { interval_s: dt, earth, rotation_mid, axis, .. } = step;
        let noise = &params.noise;
        let angle = variance(noise.angle_random_walk_rad_sqrt_s, *dt);
        let mut attitude = covariance.fixed_view_mut::<3, 3>(PHI, PHI);
        attitude += axis * axis.transpose() * angle;
        // Two accelerometers, each into velocity at once and into position over half of the step.
        let root = noise.velocity_random_walk_m_s_sqrt_s * libm::sqrt(*dt);
        for sensor in 0..2 {
            let (east, north) = (rotation_mid[(0, sensor)] * root, rotation_mid[(1, sensor)] * root);
            let latitude = north * 0.5 * dt / earth.meridian_m;
            let longitude = east * 0.5 * dt / (earth.vertical_m * earth.cos);
            let into = [east, north, latitude, longitude];
            for (row, a) in into.iter().enumerate() {
                for (column, b) in into.iter().enumerate() {
                    covariance[(VELOCITY + row, VELOCITY + column)] += a * b;
                }
            }
        }
        covariance[(GYRO, GYRO)] += variance(noise.gyro_bias_walk_rad_s_sqrt_s, *dt);
        for index in FORCE..STATES {
            covariance[(index, index)] += variance(noise.acc_bias_walk_m_s2_sqrt_s, *dt);
        }
    }

    fn feed_back(&mut self, x: &SVector<f64, STATES>) {
        self.attitude = attitude::turn_navigation(&self.attitude, &x.fixed_rows::<3>(PHI).into_owned());
        self.velocity_m_s += x.fixed_rows::<2>(VELOCITY);
        self.position.latitude_rad += x[LATITUDE];
        self.position.longitude_rad += x[LONGITUDE];
        self.gyro_bias_rad_s += x[GYRO];
        self.acc_bias_m_s2 += x.fixed_rows::<2>(FORCE);
    }

    fn position(&self) -> &Geodetic {
        &self.position
    }

    fn velocity_m_s(&self) -> Vector3<f64> {
        self.velocity_m_s.push(0.0)
    }

    fn attitude(&self) -> &Attitude {
        &self.attitude
    }

    fn map() -> StateMap {
        [
            Some(LONGITUDE),
            Some(LATITUDE),
            None,
            Some(VELOCITY),
            Some(VELOCITY + 1),
            None,
            Some(0),
            Some(1),
            Some(2),
        ]
    }

    fn is_finite(&self) -> bool {
        let numbers = [self.position.latitude_rad, self.position.longitude_rad, self.gyro_bias_rad_s];
        let vectors = self.velocity_m_s.iter().chain(&self.acc_bias_m_s2).chain(self.attitude.coords.iter());
        numbers.iter().chain(vectors).all(|v| v.is_finite())
    }
}
