//! A tumble made to order: attitude, gyro, accelerometer and a magnetometer with known errors.
#![allow(dead_code, reason = "each test binary uses a part")]
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use adit_core::time::Time;
use adit_tuning::magnetometer::Tumble;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Rate of all sensors, Hz.
pub const RATE_HZ: f64 = 100.0;
pub const GRAVITY_M_S2: f64 = 9.81;

/// What is simulated.
pub struct Bench {
    /// Samples.
    pub samples: usize,
    /// Length and dip of the field.
    pub norm_ut: f64,
    pub dip_deg: f64,
    /// The reading is `distortion · rotationᵀ · field + offset`.
    pub offset_ut: Vector3<f64>,
    pub distortion: Matrix3<f64>,
    /// From magnetometer to inertial axes.
    pub rotation: Matrix3<f64>,
    /// White noise of the magnetometer, µT; of the gyro, rad/s; of the accelerometer, m/s².
    pub noise_ut: f64,
    pub gyro_noise: f64,
    pub acc_noise: f64,
    pub gyro_bias: Vector3<f64>,
    /// Error of the field that changes from place to place, σ as a share, and the samples it takes to change.
    pub place: f64,
    pub place_samples: f64,
    /// How far the attitude swings: 1 is everywhere.
    pub tilt: f64,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            samples: 6000,
            norm_ut: 50.0,
            dip_deg: 66.0,
            offset_ut: Vector3::new(-12.0, 25.0, 8.0),
            distortion: Matrix3::new(1.10, 0.03, -0.05, 0.03, 0.92, 0.04, -0.05, 0.04, 1.02),
            rotation: Matrix3::identity(),
            noise_ut: 0.2,
            gyro_noise: 0.005,
            acc_noise: 0.05,
            gyro_bias: Vector3::zeros(),
            place: 0.0,
            place_samples: 300.0,
            tilt: 1.0,
        }
    }
}

pub struct Noise(ChaCha8Rng);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    pub fn vector(&mut self, sigma: f64) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal()) * sigma
    }
}

impl Bench {
    /// Body to navigation axes (east, north, up) while a hand turns the sensor about everything, at about 1 rad/s.
    pub fn attitude(&self, time_s: f64) -> UnitQuaternion<f64> {
        let turn = |v: Vector3<f64>| attitude::exp(&v);
        let tilt = self.tilt;
        // Roll and pitch sweep the sphere on a path that does not close; the spin about z is the fastest.
        turn(Vector3::z() * (0.31 * time_s))
            * turn(Vector3::x() * (tilt * 1.7 * (0.23 * time_s).sin() + tilt * 0.19 * time_s))
            * turn(Vector3::y() * (tilt * 1.3 * (0.11 * time_s + 0.4).sin()))
            * turn(Vector3::z() * (0.83 * time_s + 0.9 * (0.7 * time_s).sin()))
    }

    /// The field in navigation axes.
    pub fn field_ut(&self) -> Vector3<f64> {
        let (sin, cos) = self.dip_deg.to_radians().sin_cos();
        Vector3::new(0.0, cos, -sin) * self.norm_ut
    }

    /// A magnetometer alone, its readings.
    pub fn readings(&self, seed: u64) -> Vec<Vector3<f64>> {
        let mut noise = Noise::new(seed);
        let mut place = Vector3::zeros();
        let keep = (-1.0 / self.place_samples).exp();
        (0..self.samples)
            .map(|i| {
                let body = self.attitude(i as f64 / RATE_HZ).inverse() * self.field_ut();
                let fresh = noise.vector(self.place * self.norm_ut * (1.0 - keep * keep).sqrt());
                place = if i == 0 { noise.vector(self.place * self.norm_ut) } else { place * keep + fresh };
                let reading = self.distortion * (self.rotation.transpose() * (body + place)) + self.offset_ut;
                reading + noise.vector(self.noise_ut)
            })
            .collect()
    }

    /// All sensors.
    pub fn tumble(&self, seed: u64) -> Tumble {
        let mut tumble = magnetometer(&self.readings(seed));
        let mut noise = Noise::new(seed ^ 0x5555);
        for i in 0..self.samples {
            let (time, before) = (i as f64 / RATE_HZ, (i as f64 - 1.0) / RATE_HZ);
            let attitude = self.attitude(time);
            let turned = attitude::log(&(self.attitude(before).inverse() * attitude));
            let rate = turned * RATE_HZ + self.gyro_bias + noise.vector(self.gyro_noise);
            let force =
                attitude.inverse() * Vector3::new(0.0, 0.0, GRAVITY_M_S2) + noise.vector(self.acc_noise);
            tumble.angular_rate_rad_s.push(stamp(i), rate).unwrap();
            tumble.specific_force_m_s2.push(stamp(i), force).unwrap();
        }
        tumble
    }

    /// The calibration that undoes the errors, at the true length.
    pub fn matrix(&self) -> Matrix3<f64> {
        self.rotation * self.distortion.try_inverse().unwrap()
    }
}

pub fn stamp(sample: usize) -> Time {
    Time::from_seconds(sample as f64 / RATE_HZ).unwrap()
}

/// A log of a magnetometer alone.
pub fn magnetometer(readings: &[Vector3<f64>]) -> Tumble {
    let mut tumble = Tumble::default();
    for (i, reading) in readings.iter().enumerate() {
        tumble.field_ut.push(stamp(i), *reading).unwrap();
    }
    tumble
}
