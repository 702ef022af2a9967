//! Kalman filter on the error quaternion (system S3).
//!
//! Yu et al. (Harbin Engineering University; seed S3) estimate the additive error of the attitude quaternion and the
//! drift of the gyro, `δx = [δq, δε]`. Errors are truth minus estimate; with `Ω(ω) q = q ∘ (0, ω)` and
//! `Ξ(q) ω = q ∘ (0, ω)` the quaternion kinematics `q̇ = ½ Ω(ω_m − ε) q` and the Gauss–Markov drift give (their eq. 5–8;
//! Lefferts, Markley & Shuster 1982, eq. 65–68)
//!
//! ```text
//! δq̇ = ½ Ω(ω̂) δq − ½ Ξ(q̂) (δε + n)            F = | ½Ω(ω̂)  −½Ξ(q̂) |     G = | −½Ξ(q̂)  0 |
//! δε̇ = −β δε + w                                   |    0       −β I  |         |    0      I |
//! ```
//!
//! The paper observes a velocity error and has no state for it. Here the errors of velocity and position are carried
//! along, driven by the attitude error through `C(q) f`, and with them what a foot needs beside (see
//! [`crate::methods::foot_ins`]): the bias of the accelerometer, without which a tilt of `b/g` is believed, and the lever
//! to the point of contact. So the velocity of a standing foot corrects all of them:
//!
//! | states | block | meaning | unit |
//! |---|---|---|---|
//! | 0–3 | `δq` | quaternion, scalar first, `q_true − q̂` with the sign of `q_true` nearest to `q̂` | – |
//! | 4–6 | `δε` | gyro drift, body | rad/s |
//! | 7–9 | `δv` | velocity, n | m/s |
//! | 10–12 | `δp` | position, n | m |
//! | 13–15 | `δb_a` | accelerometer bias, body | m/s² |
//! | 16–18 | `δr` | lever from the point of contact to the sensor, body | m |
//! | 19–21 | `δm` | what a calibration leaves of the hard iron, body | µT |
//!
//! Over one interval with rotation `r = exp(ω̂ dt)` the quaternion part is linear, so that the transition is exact in it:
//!
//! ```text
//! δq ← δq ∘ r − ½ τ Ξ(q̂⁺) J_r(ω̂ dt) δε              τ = (1 − e^{−β dt})/β,   J_r right Jacobian of SO(3) (Solà 2017, eq. 143)
//! δε ← e^{−β dt} δε                                   variance of w: q_w² (1 − e^{−2β dt})/(2β)
//! δv ← δv + ∂(q ∘ Δv ∘ q*)/∂q δq − C J_l dt δb_a + ½ dt C [Δv]× δε          (Solà 2017, eq. 174)
//! δp ← δp + dt δv + ½ dt (what δv gains)
//! ```
//!
//! `J_l = I + ½[ω̂ dt]× + ⅙[ω̂ dt]×²` turns the bias as the strapdown turns the force; coning and sculling corrections are
//! not differentiated (third order in the interval).
//!
//! # Four numbers for three angles
//! `q` has length 1, so `δq` is orthogonal to `q̂` and the covariance is singular in that one direction: `P (q̂,0,0,0) = 0`.
//! It starts so (`δq = ½ (0, φ) ∘ q̂`), the transition keeps it (it turns `q̂` and the tangent together), and process noise
//! enters through `Ξ(q̂⁺)`, orthogonal to `q̂⁺`. A measurement of the quaternion `z = q(ε) − q(ω)` tells nothing along
//! `q̂`; its innovation covariance is singular there, and the gain with its pseudo-inverse is the gain of the three
//! components `2 Ξ_L(q̂)ᵀ z` that lie in the tangent (`Ξ_L(q) φ = (0, φ) ∘ q`, a rotation vector in n). So measurement
//! models speak of 3-vectors, the attitude's being `φ`, and the filter turns their derivatives into those by `δq`. After
//! an update `q̂ + δq̂` is normalised (Zanetti et al. 2009 show that this is optimal) and the covariance carried into the
//! tangent of the new quaternion by `Ξ_L(q̂⁺) Ξ_L(q̂)ᵀ`: uncertainty about an axis of the navigation frame stays about that
//! axis (the reduced representation of Lefferts, Markley & Shuster 1982, §VIII, in n). Projecting it with the derivative of
//! normalising, `I − q̂ q̂ᵀ`, is right to first order but turns that axis by half of every correction; a heading that
//! nothing observes then leaks into the tilt and is made certain by gravity, within seconds of rest.
//!
//! # What nothing observes stays unknown
//! Turn the whole walk about the vertical: no inertial sensor and no standing foot notices. In the error state that is
//! `φ = z, δv = z × v̂, δp = z × p̂`. The transition keeps it, but a correction of `v̂` and `p̂` moves the direction under the
//! covariance, and the filter would gain certainty of its heading from its own corrections. So the errors are carried over
//! a correction as those of the right-invariant filter (Barrau & Bonnabel 2017), `δv ← δv + φ × Δv̂` and likewise `δp`, and
//! the velocity of the contact is differentiated so that it does not see that direction ([`HeldContact`](crate::inertial::reference_attitude::HeldContact)).

use crate::inertial::covariance::{ACC_BIAS, ATTITUDE, BLOCKS, CONTACT, GYRO_BIAS, POSITION, VELOCITY};
use crate::inertial::filter::{FilterState, SensorNoise};
use crate::inertial::strapdown::Increment;
use crate::kalman::{Innovation, Linearised, MeasurementModel};
use adit_core::attitude::{Attitude, skew};
use adit_core::nalgebra::{
    Matrix3, Matrix3x4, Matrix4, Matrix4x3, Quaternion, SMatrix, SVector, Vector3, Vector4,
};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_observation::ImuSample;
use serde::{Deserialize, Serialize};

/// Number of error states.
pub const STATES: usize = 22;
/// First state of the error quaternion.
pub const QUATERNION: usize = 0;
/// Index of the 3-vector of the hard iron, after those of [`crate::inertial::covariance`].
pub const HARD_IRON: usize = BLOCKS;
/// First state of each 3-vector; that of the attitude stands for the quaternion's.
pub const FIRST: [usize; BLOCKS + 1] = {
    let mut first = [QUATERNION; BLOCKS + 1];
    first[GYRO_BIAS] = 4;
    first[VELOCITY] = 7;
    first[POSITION] = 10;
    first[ACC_BIAS] = 13;
    first[CONTACT] = 16;
    first[HARD_IRON] = 19;
    first
};
const DRIFT: usize = FIRST[GYRO_BIAS];

/// Covariance of the error state.
pub type ErrorCovariance = SMatrix<f64, STATES, STATES>;

/// Standard deviations at the start: attitude as a rotation vector in n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartSigma {
    /// Roll, pitch (east, north axis) and heading (up axis), rad.
    pub attitude_rad: Vector3<f64>,
    /// Gyro drift, rad/s, each axis.
    pub drift_rad_s: f64,
    /// Velocity, m/s, each axis.
    pub velocity_m_s: f64,
    /// Position, m, each axis.
    pub position_m: f64,
    /// Accelerometer bias, m/s², each axis.
    pub acc_bias_m_s2: f64,
    /// Lever to the point of contact, m, each axis.
    pub contact_m: f64,
    /// Hard iron, µT, each axis.
    pub hard_iron_ut: f64,
}

/// `q ∘ (0, v) = Ξ(q) v`: body vectors.
pub fn xi_body(q: &Attitude) -> Matrix4x3<f64> {
    let (w, v) = (q.w, q.imag());
    let lower = Matrix3::identity() * w + skew(&v);
    stack(&-v, &lower)
}

/// `(0, v) ∘ q = Ξ_L(q) v`: navigation vectors.
pub fn xi_navigation(q: &Attitude) -> Matrix4x3<f64> {
    let (w, v) = (q.w, q.imag());
    let lower = Matrix3::identity() * w - skew(&v);
    stack(&-v, &lower)
}

fn stack(first: &Vector3<f64>, lower: &Matrix3<f64>) -> Matrix4x3<f64> {
    let mut m = Matrix4x3::zeros();
    m.set_row(0, &first.transpose());
    m.fixed_view_mut::<3, 3>(1, 0).copy_from(lower);
    m
}

/// Scalar first, as the error state has it.
pub(super) fn wxyz(q: &Attitude) -> Vector4<f64> {
    Vector4::new(q.w, q.i, q.j, q.k)
}

/// `δq ∘ r = R(r) δq` (Solà 2017, eq. 18).
fn right_product(r: &Attitude) -> Matrix4<f64> {
    let (w, v) = (r.w, r.imag());
    let mut m = Matrix4::zeros();
    m[(0, 0)] = w;
    m.fixed_view_mut::<1, 3>(0, 1).copy_from(&-v.transpose());
    m.fixed_view_mut::<3, 1>(1, 0).copy_from(&v);
    m.fixed_view_mut::<3, 3>(1, 1).copy_from(&(Matrix3::identity() * w - skew(&v)));
    m
}

/// `∂(q ∘ a ∘ q*)/∂q`, 3×4 (Solà 2017, eq. 174).
fn rotated_by_quaternion(q: &Attitude, a: &Vector3<f64>) -> Matrix3x4<f64> {
    let (w, v) = (q.w, q.imag());
    let mut m = Matrix3x4::zeros();
    m.set_column(0, &(a * w + v.cross(a)));
    let rest = Matrix3::identity() * v.dot(a) + v * a.transpose() - a * v.transpose() - skew(a) * w;
    m.fixed_view_mut::<3, 3>(0, 1).copy_from(&rest);
    m * 2.0
}

/// How the errors drive each other over one interval: the blocks of the transition that are not zero or one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Transition {
    quaternion: Matrix4<f64>,
    quaternion_by_drift: Matrix4x3<f64>,
    drift: f64,
    velocity_by_quaternion: Matrix3x4<f64>,
    velocity_by_drift: Matrix3<f64>,
    velocity_by_bias: Matrix3<f64>,
    interval_s: f64,
}

impl Transition {
    /// `F M`.
    fn times(&self, m: &ErrorCovariance) -> ErrorCovariance {
        let quaternion = m.fixed_rows::<4>(QUATERNION);
        let drift = m.fixed_rows::<3>(DRIFT);
        let velocity = m.fixed_rows::<3>(FIRST[VELOCITY]);
        let bias = m.fixed_rows::<3>(FIRST[ACC_BIAS]);
        let gained = self.velocity_by_quaternion * quaternion
            + self.velocity_by_drift * drift
            + self.velocity_by_bias * bias;
        let mut out = *m;
        out.fixed_rows_mut::<4>(QUATERNION)
            .copy_from(&(self.quaternion * quaternion + self.quaternion_by_drift * drift));
        out.fixed_rows_mut::<3>(DRIFT).copy_from(&(drift * self.drift));
        out.fixed_rows_mut::<3>(FIRST[VELOCITY]).copy_from(&(velocity + gained));
        let mut position = out.fixed_rows_mut::<3>(FIRST[POSITION]);
        position += velocity * self.interval_s + gained * (0.5 * self.interval_s);
        out
    }
}

/// The filter: estimate, covariance of its error, previous increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorQuaternionFilter {
    /// Estimate; its gyro bias is the drift at rest and `ε`.
    pub state: FilterState,
    /// Estimate of the hard iron that the calibration has left, µT, body.
    pub hard_iron_ut: Vector3<f64>,
    /// Covariance of the error.
    pub covariance: ErrorCovariance,
    /// Drift at the last rest, rad/s: to it the drift returns.
    rest_drift_rad_s: Vector3<f64>,
    last: Increment,
    gravity_m_s2: f64,
}

impl ErrorQuaternionFilter {
    /// Starts from a state, whose gyro bias is what the gyro read at rest.
    pub fn new(state: FilterState, sigma: &StartSigma, gravity_m_s2: f64) -> Self {
        let square = |sigma: f64| Matrix3::identity() * (sigma * sigma);
        let mut covariance = ErrorCovariance::zeros();
        let xi = xi_navigation(&state.navigation.attitude);
        let attitude = Matrix3::from_diagonal(&sigma.attitude_rad.component_mul(&sigma.attitude_rad));
        covariance.fixed_view_mut::<4, 4>(0, 0).copy_from(&(xi * attitude * xi.transpose() * 0.25));
        for (block, sigma) in [
            (GYRO_BIAS, sigma.drift_rad_s),
            (VELOCITY, sigma.velocity_m_s),
            (POSITION, sigma.position_m),
            (ACC_BIAS, sigma.acc_bias_m_s2),
            (CONTACT, sigma.contact_m),
            (HARD_IRON, sigma.hard_iron_ut),
        ] {
            covariance.fixed_view_mut::<3, 3>(FIRST[block], FIRST[block]).copy_from(&square(sigma));
        }
        Self {
            rest_drift_rad_s: state.navigation.gyro_bias_rad_s,
            state,
            hard_iron_ut: Vector3::zeros(),
            covariance,
            last: Increment::default(),
            gravity_m_s2,
        }
    }

    /// Carries state and covariance over one sampling interval; the drift decays with `correlation_s`.
    ///
    /// A sensor that is `turning == false` keeps its attitude, whatever the gyro reads: its noise and drift add nothing then.
    pub fn predict(
        &mut self,
        imu: &ImuSample,
        interval_s: f64,
        noise: &SensorNoise,
        correlation_s: f64,
        turning: bool,
    ) {
        let state = &mut self.state.navigation;
        let before = state.attitude;
        let mut increment = state.increment(imu, interval_s);
        let turned_share = if turning { 1.0 } else { 0.0 };
        increment.angle *= turned_share;
        self.last.angle *= turned_share;
        let step = state.propagate(&increment, &self.last, interval_s, self.gravity_m_s2);
        self.last = increment;

        let beta = 1.0 / correlation_s;
        let kept = libm::exp(-beta * interval_s);
        state.gyro_bias_rad_s =
            self.rest_drift_rad_s + (state.gyro_bias_rad_s - self.rest_drift_rad_s) * kept;

        let after = state.attitude;
        let turned = skew(&increment.angle);
        let even = Matrix3::identity() + turned * turned / 6.0;
        let (right_jacobian, left_jacobian) = (even - turned * 0.5, even + turned * 0.5);
        let xi = xi_body(&after);
        let velocity_body = step.rotation.transpose() * step.velocity_gained;
        let transition = Transition {
            quaternion: right_product(&(before.inverse() * after)),
            quaternion_by_drift: xi * right_jacobian * (-0.5 * turned_share * (1.0 - kept) * correlation_s),
            drift: kept,
            velocity_by_quaternion: rotated_by_quaternion(&before, &velocity_body),
            velocity_by_drift: step.rotation * skew(&increment.velocity) * (0.5 * turned_share * interval_s),
            velocity_by_bias: step.rotation * left_jacobian * -interval_s,
            interval_s,
        };
        let half_way = transition.times(&self.covariance).transpose();
        self.covariance = transition.times(&half_way);

        let added = noise.over(imu, &step, self.gravity_m_s2);
        // Gauss–Markov: the walk of a data sheet that is pulled back.
        let drift =
            added.gyro_bias * (1.0 - kept * kept) * (0.5 * correlation_s) / interval_s.max(f64::MIN_POSITIVE);
        let xi = xi_navigation(&after);
        self.add(QUATERNION, &(xi * added.attitude * xi.transpose() * (0.25 * turned_share)));
        self.add(DRIFT, &(Matrix3::identity() * drift));
        self.add(FIRST[VELOCITY], &(Matrix3::identity() * added.velocity));
        self.add(FIRST[ACC_BIAS], &(Matrix3::identity() * added.acc_bias));
        self.symmetrise();
    }

    /// Updates with a measurement whose normalised innovation squared is at most `gate`; reports it either way.
    ///
    /// `None` when the innovation covariance cannot be inverted: the measurement is then left out.
    pub fn update<const N: usize>(
        &mut self,
        model: &impl MeasurementModel<FilterState, N>,
        gate: f64,
    ) -> Option<Innovation> {
        let measurement = model.linearise(&self.state);
        let h = self.jacobian(&measurement);
        let cross = self.covariance * h.transpose();
        let covariance = h * cross + measurement.noise;
        let inverse = covariance.try_inverse()?;
        let value = measurement.residual;
        let nis = value.dot(&(inverse * value));
        if !nis.is_finite() {
            return None;
        }
        let accepted = nis <= gate;
        if accepted {
            // Joseph's form, written so that it is symmetric: see `Covariance::update`.
            let gain = cross * inverse;
            let rest = cross - gain * (covariance * 0.5);
            self.covariance -= gain * rest.transpose() + rest * gain.transpose();
            self.feed_back(&(gain * value));
        }
        Some(Innovation { value, covariance, nis, accepted })
    }

    /// Takes the present drift for the one that the process returns to: a gyro at rest has just shown it.
    ///
    /// The mean of the paper's process is zero; that of a gyro is its turn-on bias, which no data sheet gives.
    pub fn anchor_drift(&mut self) {
        self.rest_drift_rad_s = self.state.navigation.gyro_bias_rad_s;
    }

    /// Covariance of what a measurement would differ by, without its own noise: `H P Hᵀ`.
    pub fn predicted<const N: usize>(&self, model: &impl MeasurementModel<FilterState, N>) -> Matrix3<f64> {
        let h = self.jacobian(&model.linearise(&self.state));
        h * self.covariance * h.transpose()
    }

    /// Adds to the covariance of the attitude, as a rotation vector in n, rad².
    pub fn inflate_attitude(&mut self, variance: &Matrix3<f64>) {
        let xi = xi_navigation(&self.state.navigation.attitude);
        self.add(QUATERNION, &(xi * variance * xi.transpose() * 0.25));
    }

    /// Adds to the variance of the velocity and of the position, each axis.
    pub fn inflate_motion(&mut self, velocity_m2_s2: f64, position_m2: f64) {
        self.add(FIRST[VELOCITY], &(Matrix3::identity() * velocity_m2_s2));
        self.add(FIRST[POSITION], &(Matrix3::identity() * position_m2));
    }

    /// Sets the attitude anew, as at a second alignment; what was known of the old one is forgotten.
    pub fn restart_attitude(&mut self, attitude: Attitude, sigma_rad: &Vector3<f64>) {
        self.state.navigation.attitude = attitude;
        self.covariance.fixed_rows_mut::<4>(QUATERNION).fill(0.0);
        self.covariance.fixed_columns_mut::<4>(QUATERNION).fill(0.0);
        self.inflate_attitude(&Matrix3::from_diagonal(&sigma_rad.component_mul(sigma_rad)));
    }

    /// Variance of the heading, rad².
    pub fn heading_variance(&self) -> f64 {
        let row = xi_navigation(&self.state.navigation.attitude).column(2) * 2.0;
        (row.transpose() * self.covariance.fixed_view::<4, 4>(0, 0) * row)[(0, 0)]
    }

    /// Standard deviation of the tilt about one horizontal axis, rad.
    pub fn tilt_sigma_rad(&self) -> f64 {
        let rows = xi_navigation(&self.state.navigation.attitude).fixed_columns::<2>(0) * 2.0;
        let tilt = rows.transpose() * self.covariance.fixed_view::<4, 4>(0, 0) * rows;
        libm::sqrt(0.5 * tilt.trace())
    }

    /// Estimate with the covariance of position, velocity and attitude.
    pub fn solution(&self, time: Time, quality: Quality) -> Solution {
        let mut select = SMatrix::<f64, 9, STATES>::zeros();
        select.fixed_view_mut::<3, 3>(0, FIRST[POSITION]).fill_with_identity();
        select.fixed_view_mut::<3, 3>(3, FIRST[VELOCITY]).fill_with_identity();
        let to_angle = xi_navigation(&self.state.navigation.attitude).transpose() * 2.0;
        select.fixed_view_mut::<3, 4>(6, QUATERNION).copy_from(&to_angle);
        Solution {
            time,
            position_m: self.state.navigation.position_m,
            velocity_m_s: self.state.navigation.velocity_m_s,
            attitude: self.state.navigation.attitude,
            covariance: select * self.covariance * select.transpose(),
            quality,
        }
    }

    /// Derivatives by 3-vectors made those by the states: `φ = 2 Ξ_L(q̂)ᵀ δq`.
    fn jacobian<const N: usize>(&self, measurement: &Linearised<N>) -> SMatrix<f64, 3, STATES> {
        let mut h = SMatrix::<f64, 3, STATES>::zeros();
        for (block, derivative) in &measurement.jacobian {
            let derivative = derivative.matrix();
            match *block {
                ATTITUDE => {
                    let to_angle = xi_navigation(&self.state.navigation.attitude).transpose() * 2.0;
                    let mut columns = h.fixed_columns_mut::<4>(QUATERNION);
                    columns += derivative * to_angle;
                }
                block => h.fixed_columns_mut::<3>(FIRST[block]).copy_from(&derivative),
            }
        }
        h
    }

    /// Adds the estimated error to the estimate, brings the quaternion back to length 1 and the covariance to its tangent.
    fn feed_back(&mut self, error: &SVector<f64, STATES>) {
        let state = &mut self.state.navigation;
        let before = xi_navigation(&state.attitude);
        let q = wxyz(&state.attitude) + error.fixed_rows::<4>(QUATERNION);
        state.attitude = Attitude::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3]));
        state.gyro_bias_rad_s += error.fixed_rows::<3>(DRIFT);
        state.velocity_m_s += error.fixed_rows::<3>(FIRST[VELOCITY]);
        state.position_m += error.fixed_rows::<3>(FIRST[POSITION]);
        state.acc_bias_m_s2 += error.fixed_rows::<3>(FIRST[ACC_BIAS]);
        self.state.contact_m += error.fixed_rows::<3>(FIRST[CONTACT]);
        self.hard_iron_ut += error.fixed_rows::<3>(FIRST[HARD_IRON]);

        let carried = xi_navigation(&state.attitude) * before.transpose();
        let rows = carried * self.covariance.fixed_rows::<4>(QUATERNION);
        self.covariance.fixed_rows_mut::<4>(QUATERNION).copy_from(&rows);
        let columns = self.covariance.fixed_columns::<4>(QUATERNION) * carried.transpose();
        self.covariance.fixed_columns_mut::<4>(QUATERNION).copy_from(&columns);

        let to_angle = xi_navigation(&self.state.navigation.attitude).transpose() * 2.0;
        for block in [VELOCITY, POSITION] {
            let first = FIRST[block];
            let turned = skew(&-error.fixed_rows::<3>(first)) * to_angle;
            let added = turned * self.covariance.fixed_rows::<4>(QUATERNION);
            let mut rows = self.covariance.fixed_rows_mut::<3>(first);
            rows += added;
            let added = self.covariance.fixed_columns::<4>(QUATERNION) * turned.transpose();
            let mut columns = self.covariance.fixed_columns_mut::<3>(first);
            columns += added;
        }
        self.symmetrise();
    }

    fn add<const N: usize>(&mut self, first: usize, variance: &SMatrix<f64, N, N>) {
        let mut block = self.covariance.fixed_view_mut::<N, N>(first, first);
        block += variance;
    }

    fn symmetrise(&mut self) {
        self.covariance = (self.covariance + self.covariance.transpose()) * 0.5;
    }
}
