//! The linearisation of both mechanisations is the derivative of their step: against central differences, along a walk.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::attitude;
use adit_core::geodesy::{EARTH_RATE_RAD_S, Geodetic};
use adit_core::nalgebra::{SMatrix, SVector, Vector2, Vector3};
use adit_core::time::Time;
use adit_estimation::methods::ins_wifi::{Full, Mechanisation, Reduced};
use adit_observation::ImuSample;
use proptest::prelude::*;

const INTERVAL_S: f64 = 0.1;

/// Error of `truth` against `estimate`, in the error states of each mechanisation.
trait Difference<const N: usize> {
    fn minus(&self, estimate: &Self) -> SVector<f64, N>;
}

impl Difference<10> for Reduced {
    fn minus(&self, estimate: &Self) -> SVector<f64, 10> {
        let turn = attitude::log(&(self.attitude * estimate.attitude.inverse()));
        let velocity = self.velocity_m_s - estimate.velocity_m_s;
        let force = self.acc_bias_m_s2 - estimate.acc_bias_m_s2;
        SVector::from([
            turn.x,
            turn.y,
            turn.z,
            velocity.x,
            velocity.y,
            self.position.latitude_rad - estimate.position.latitude_rad,
            self.position.longitude_rad - estimate.position.longitude_rad,
            self.gyro_bias_rad_s - estimate.gyro_bias_rad_s,
            force.x,
            force.y,
        ])
    }
}

impl Difference<18> for Full {
    fn minus(&self, estimate: &Self) -> SVector<f64, 18> {
        let mut x = SVector::<f64, 18>::zeros();
        let turn = attitude::log(&(self.attitude * estimate.attitude.inverse()));
        let blocks = [
            (0, turn),
            (3, self.velocity_m_s - estimate.velocity_m_s),
            (9, self.gyro_bias_rad_s - estimate.gyro_bias_rad_s),
            (12, self.acc_bias_m_s2 - estimate.acc_bias_m_s2),
            (15, self.gyro_scale - estimate.gyro_scale),
        ];
        for (at, block) in blocks {
            x.fixed_rows_mut::<3>(at).copy_from(&block);
        }
        x[6] = self.position.latitude_rad - estimate.position.latitude_rad;
        x[7] = self.position.longitude_rad - estimate.position.longitude_rad;
        x[8] = self.position.height_m - estimate.position.height_m;
        x
    }
}

/// Derivative of the step by the error states, and what `carry` says, both in units of `scale`: an entry says how much of a
/// unit of its row a unit of its column makes.
fn jacobians<M: Mechanisation<N> + Difference<N>, const N: usize>(
    state: &M,
    imu: &ImuSample,
    scale: &SVector<f64, N>,
) -> (SMatrix<f64, N, N>, SMatrix<f64, N, N>) {
    let mut nominal = state.clone();
    let step = nominal.step(imu, INTERVAL_S);
    let mut numeric = SMatrix::<f64, N, N>::zeros();
    let mut stated = SMatrix::<f64, N, N>::zeros();
    for column in 0..N {
        let mut unit = SVector::zeros();
        unit[column] = scale[column];
        let moved = |sign: f64| {
            let mut moved = state.clone();
            moved.feed_back(&(unit * sign));
            moved.step(imu, INTERVAL_S);
            moved.minus(&nominal)
        };
        let derivative = (moved(1.0) - moved(-1.0)) * 0.5;
        numeric.set_column(column, &derivative.component_div(scale));
        stated.set_column(column, &M::carry(&step, &unit).component_div(scale));
    }
    (numeric, stated)
}

fn sample(rate: [f64; 3], force: [f64; 3]) -> ImuSample {
    ImuSample {
        time: Time::ZERO,
        angular_rate_rad_s: Vector3::from(rate),
        specific_force_m_s2: Vector3::from(force),
    }
}

/// Units small enough that terms of second order stay below the tolerance, large enough for an f64: rad, m/s, rad (0.6 mm
/// on the ground), rad/s, m/s².
fn reduced_scale() -> SVector<f64, 10> {
    let mut scale = SVector::from_element(1e-4);
    (scale[5], scale[6], scale[7]) = (1e-7, 1e-7, 1e-5);
    scale
}

fn full_scale() -> SVector<f64, 18> {
    let mut scale = SVector::<f64, 18>::from_element(1e-4);
    (scale[6], scale[7], scale[8]) = (1e-7, 1e-7, 0.1);
    scale.fixed_rows_mut::<3>(9).fill(1e-5);
    scale
}

fn place(latitude_deg: f64) -> Geodetic {
    Geodetic::from_degrees(latitude_deg, 121.4, 0.0).unwrap()
}

proptest! {
    #[test]
    fn the_reduced_transition_is_the_derivative_of_its_step(
        latitude_deg in -70.0..70.0_f64, tilt in prop::array::uniform3(-0.02..0.02_f64), heading in -3.0..3.0_f64,
        velocity in prop::array::uniform2(-1.5..1.5_f64), rate in -1.0..1.0_f64,
        force in prop::array::uniform2(-3.0..3.0_f64), bias in -0.01..0.01_f64,
    ) {
        let state = Reduced {
            attitude: attitude::exp(&Vector3::from(tilt)) * attitude::exp(&(Vector3::z() * heading)),
            velocity_m_s: Vector2::from(velocity),
            position: place(latitude_deg),
            gyro_bias_rad_s: 1e-3 * bias,
            acc_bias_m_s2: Vector2::new(bias, -0.5 * bias),
        };
        let imu = sample([0.1, -0.2, rate], [force[0], force[1], 9.8]);
        let (numeric, stated) = jacobians(&state, &imu, &reduced_scale());
        // What a central difference leaves: third order of a unit of 1e-4, and rounding of a longitude of 2 rad by a unit of 1e-7.
        let worst = (numeric - stated).amax();
        prop_assert!(worst < 2e-8, "off by {worst:e}\n{numeric:.3e}\n{stated:.3e}");
    }

    #[test]
    fn the_full_transition_is_the_derivative_of_its_step(
        latitude_deg in -70.0..70.0_f64, turn in prop::array::uniform3(-3.0..3.0_f64),
        velocity in prop::array::uniform3(-1.5..1.5_f64), rate in prop::array::uniform3(-0.5..0.5_f64),
        force in prop::array::uniform3(-3.0..3.0_f64), bias in -0.01..0.01_f64, height_m in -2000.0..2000.0_f64,
    ) {
        let state = Full {
            attitude: attitude::exp(&Vector3::from(turn)),
            velocity_m_s: Vector3::from(velocity),
            position: Geodetic { height_m, ..place(latitude_deg) },
            gyro_bias_rad_s: Vector3::new(1e-3 * bias, 0.0, -1e-3 * bias),
            acc_bias_m_s2: Vector3::new(bias, -0.5 * bias, 0.2 * bias),
            gyro_scale: Vector3::new(0.1 * bias, 0.0, -0.1 * bias),
        };
        let force = state.attitude.inverse_transform_vector(&(Vector3::from(force) + Vector3::z() * 9.8));
        let imu = sample(rate, force.into());
        let (numeric, stated) = jacobians(&state, &imu, &full_scale());
        // What a gyro's error does is taken at the middle of the turn of ω dt (0.09 rad at most), not integrated over it: that leaves
        // (ω dt)²/24 = 3.3e-4 of a scale factor's 0.09 in the attitude, and as much of the same in a velocity gained of 1.3 m/s.
        let worst = (numeric - stated).amax();
        prop_assert!(worst < 5e-5, "off by {worst:e}");
        // Everything that no gyro error enters is exact, but for the level frame's own turn, ω_in dt = 7e-6, squared.
        let exact = numeric.fixed_columns::<9>(0) - stated.fixed_columns::<9>(0);
        prop_assert!(exact.amax() < 2e-7, "off by {:e}", exact.amax());
    }
}

/// Equations 4 and 6 of the paper, with the signs that are right: the entries that the misprints concern.
#[test]
fn the_entries_that_the_paper_misprints() {
    let (speed, latitude_deg) = (Vector2::new(0.9, -0.7), 45.7_f64);
    let state = Reduced {
        attitude: attitude::exp(&(Vector3::z() * 0.4)),
        velocity_m_s: speed,
        position: place(latitude_deg),
        gyro_bias_rad_s: 0.0,
        acc_bias_m_s2: Vector2::zeros(),
    };
    let imu = sample([0.0; 3], [0.0, 0.0, 9.8]);
    let step = state.clone().step(&imu, INTERVAL_S);
    let of = |column: usize| {
        let mut unit = SVector::<f64, 10>::zeros();
        unit[column] = 1.0;
        Reduced::carry(&step, &unit)
    };
    let (earth, radius) = (EARTH_RATE_RAD_S * latitude_deg.to_radians().cos(), 6.39e6);
    // Eq. 4 lost φe: dφu/dt = (Ve/R_N + ω_ie cos L) φe + (Vn/R_M) φn + …; radii to a percent, squared steps beside.
    let by_east = of(0)[2] / INTERVAL_S;
    assert!((by_east - (speed.x / radius + earth)).abs() < 1e-9, "{by_east:e}");
    let by_north = of(1)[2] / INTERVAL_S;
    assert!((by_north - speed.y / radius).abs() < 1e-9, "{by_north:e}");
    // Eq. 7: dδL/dt = +δVn/R_M.
    let by_velocity = of(4)[5] / INTERVAL_S;
    assert!((by_velocity * radius - 1.0).abs() < 0.01, "{by_velocity:e}");
    // One gyro about the vertical drives the heading, nothing else (eq. 2 and 3 have it in φe and φn).
    let by_gyro = of(7).fixed_rows::<3>(0) / INTERVAL_S;
    assert!((by_gyro - Vector3::new(0.0, 0.0, -1.0)).amax() < 1e-12, "{by_gyro}");
    // A tilt moves no velocity: fz is not measured.
    for tilt in [0, 1] {
        assert!(of(tilt).fixed_rows::<2>(3).amax() < 1e-12);
    }
}
