//! What several test files share: random numbers, small vectors and matrices of them.
#![allow(dead_code, reason = "every test file uses its own part")]

pub mod strides;
pub mod turning;
pub mod walk;

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix3, SMatrix, Vector3};
use adit_core::time::Time;
use adit_estimation::inertial::covariance::{BLOCKS, Covariance, STATES};
use adit_estimation::inertial::strapdown::{NavigationState, Step};
use adit_observation::ImuSample;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Dense covariance or transition.
pub type Dense = SMatrix<f64, STATES, STATES>;

/// Seeded normal draws.
pub struct Draws(ChaCha8Rng);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    pub fn vector(&mut self, sigma: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.normal() * sigma)
    }

    pub fn matrix(&mut self) -> Matrix3<f64> {
        Matrix3::from_fn(|_, _| self.normal())
    }

    /// Symmetric, positive definite.
    pub fn variance(&mut self, scale: f64) -> Matrix3<f64> {
        let root = self.matrix();
        (root * root.transpose() + Matrix3::identity() * 0.1) * scale
    }

    /// Any attitude, upside down as likely as not.
    pub fn attitude(&mut self) -> Attitude {
        attitude::exp(&self.vector(1.5))
    }

    /// What a foot does in `interval_s`, from quiet to violent.
    pub fn step(&mut self, interval_s: f64) -> Step {
        let rotation = self.attitude().to_rotation_matrix().into_inner();
        let force = Vector3::z() * 9.8 + self.vector(20.0);
        Step { rotation, velocity_gained: force * interval_s, interval_s }
    }
}

/// At the origin, unbiased, with the given attitude.
pub fn at_rest(attitude: Attitude) -> NavigationState {
    NavigationState {
        attitude,
        velocity_m_s: Vector3::zeros(),
        position_m: Vector3::zeros(),
        gyro_bias_rad_s: Vector3::zeros(),
        acc_bias_m_s2: Vector3::zeros(),
    }
}

pub fn sample(time_s: f64, rate: Vector3<f64>, force: Vector3<f64>) -> ImuSample {
    let time = Time::from_seconds(time_s).unwrap_or_default();
    ImuSample { time, angular_rate_rad_s: rate, specific_force_m_s2: force }
}

/// Transition of the error state as the head of `inertial::covariance` writes it.
pub fn transition(step: &Step) -> Dense {
    let blocks = |f: &mut Dense, row: usize, column: usize, value: Matrix3<f64>| {
        f.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&value);
    };
    let mut f = Dense::identity();
    let bias = -step.rotation * step.interval_s;
    blocks(&mut f, 0, 3, bias);
    blocks(&mut f, 1, 0, -attitude::skew(&step.velocity_gained));
    blocks(&mut f, 1, 4, bias);
    blocks(&mut f, 2, 1, Matrix3::identity() * step.interval_s);
    f
}

/// Largest difference of two covariances, in units of the standard deviations of `scale`.
pub fn difference(a: &Dense, b: &Dense, scale: &Dense) -> f64 {
    (0..STATES)
        .flat_map(|i| (0..STATES).map(move |j| (i, j)))
        .map(|(i, j)| (a[(i, j)] - b[(i, j)]).abs() / (scale[(i, i)] * scale[(j, j)]).sqrt())
        .fold(0.0, f64::max)
}

/// Diagonal covariance with the spread of units that a foot's filter has.
pub fn initial_covariance(draws: &mut Draws) -> Covariance {
    let sigmas = [0.02, 0.05, 0.1, 1e-3, 0.2, 0.1];
    let variances: [Vector3<f64>; BLOCKS] = core::array::from_fn(|block| {
        Vector3::from_fn(|_, _| (sigmas[block] * (0.3 + draws.normal().abs())).powi(2))
    });
    Covariance::from_variances(&variances)
}
