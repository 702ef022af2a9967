//! A tag that is turned and carried about in closed form, and what its sensors read.

use super::Draws;
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_estimation::methods::MethodError;
use adit_estimation::methods::ahrs::{Ahrs, AhrsParams, AhrsReport};
use adit_observation::{ImuSample, MagneticSample, Observation};

/// Rate of the samples where a tag does not say otherwise, Hz.
pub const RATE_HZ: f64 = 200.0;
/// Gravity, m/s².
pub const GRAVITY_M_S2: f64 = 9.81;
/// Field of the site: norm 48 µT, dip 65°, ENU.
pub fn field_ut() -> Vector3<f64> {
    let dip = 65_f64.to_radians();
    Vector3::new(0.0, dip.cos(), -dip.sin()) * 48.0
}

/// A tag, its motion and the errors of its sensors.
#[derive(Clone)]
pub struct Tag {
    /// At rest until then, s.
    pub rest_s: f64,
    /// Largest angles about x, y, z, rad: the tag swings through them.
    pub swing_rad: Vector3<f64>,
    /// How fast, as a factor on about half a turn per second.
    pub speed: f64,
    /// Largest excursion of its position, m.
    pub carry_m: f64,
    /// Length of the log, s.
    pub duration_s: f64,
    /// Rate of all samples, Hz.
    pub rate_hz: f64,
    pub gyro_bias_rad_s: Vector3<f64>,
    pub gyro_scale: f64,
    pub offset_ut: Vector3<f64>,
    pub delay_s: f64,
    /// White noise of one sample: rad/s, m/s², µT.
    pub noise: (f64, f64, f64),
    /// Field added to that of the site at a time: fixed to the place (ENU), fixed to the body, µT.
    pub site_ut: fn(f64) -> Vector3<f64>,
    pub body_ut: fn(f64) -> Vector3<f64>,
    /// Mounting: body to the axes of the motion.
    pub mounting: Attitude,
}

impl Default for Tag {
    fn default() -> Self {
        Self {
            rest_s: 10.0,
            swing_rad: Vector3::new(0.9, 0.7, 2.5),
            speed: 1.0,
            carry_m: 0.3,
            duration_s: 90.0,
            rate_hz: RATE_HZ,
            gyro_bias_rad_s: Vector3::new(0.004, -0.006, 0.003),
            gyro_scale: 0.002,
            offset_ut: Vector3::zeros(),
            delay_s: 0.0,
            noise: (0.003, 0.03, 0.4),
            site_ut: |_| Vector3::zeros(),
            body_ut: |_| Vector3::zeros(),
            mounting: Attitude::identity(),
        }
    }
}

impl Tag {
    /// Body to ENU at a time.
    pub fn attitude(&self, time_s: f64) -> Attitude {
        let t = (time_s - self.rest_s).max(0.0);
        // The swing sets in smoothly.
        let grown = (t / 2.0).min(1.0).powi(2) * (3.0 - 2.0 * (t / 2.0).min(1.0));
        let angle = |axis: usize, rate: f64| grown * self.swing_rad[axis] * (rate * self.speed * t).sin();
        let about = |axis: Vector3<f64>, angle: f64| attitude::exp(&(axis * angle));
        about(Vector3::z(), 0.4 + angle(2, 0.83))
            * about(Vector3::y(), angle(1, 1.37))
            * about(Vector3::x(), angle(0, 1.91))
            * self.mounting
    }

    fn acceleration(&self, time_s: f64) -> Vector3<f64> {
        let t = time_s - self.rest_s;
        if t <= 0.0 {
            return Vector3::zeros();
        }
        let one = |rate: f64| -self.carry_m * rate * rate * (rate * t).sin() * (t / 2.0).min(1.0);
        Vector3::new(one(2.1), one(1.7), one(2.9))
    }

    /// The log, and the truth at each inertial sample.
    pub fn record(&self, seed: u64) -> (Vec<Observation>, Vec<Attitude>) {
        let mut draws = Draws::new(seed);
        let dt = 1.0 / self.rate_hz;
        let (mut log, mut truth) = (Vec::new(), Vec::new());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "some minutes of samples"
        )]
        let samples = (self.duration_s * self.rate_hz) as usize;
        for k in 1..=samples {
            let (before, now) = ((k - 1) as f64 * dt, k as f64 * dt);
            let (start, end) = (self.attitude(before), self.attitude(now));
            let rate = attitude::log(&(start.inverse() * end)) / dt;
            let middle = 0.5 * (before + now);
            let force = self.acceleration(middle) + Vector3::z() * GRAVITY_M_S2;
            let field = field_ut() + (self.site_ut)(now);
            let seen = self.attitude(now - self.delay_s).inverse() * field;
            let time = Time::from_seconds(now).unwrap_or_default();
            log.push(Observation::Imu(ImuSample {
                time,
                angular_rate_rad_s: rate * (1.0 + self.gyro_scale)
                    + self.gyro_bias_rad_s
                    + draws.vector(self.noise.0),
                specific_force_m_s2: self.attitude(middle).inverse() * force + draws.vector(self.noise.1),
            }));
            log.push(Observation::Magnetic(MagneticSample {
                time,
                field_ut: seen + self.offset_ut + (self.body_ut)(now) + draws.vector(self.noise.2),
            }));
            truth.push(end);
        }
        (log, truth)
    }
}

/// Runs a log through the streaming method.
pub fn run(params: AhrsParams, log: &[Observation]) -> Result<(Vec<Solution>, AhrsReport), MethodError> {
    let mut ahrs = Ahrs::new(params)?;
    let mut solutions = Vec::new();
    for observation in log {
        let mut solution = ahrs.observe(observation)?;
        while let Some(now) = solution {
            solutions.push(now);
            solution = ahrs.next_due()?;
        }
    }
    while let Some(last) = ahrs.finish_next()? {
        solutions.push(last);
    }
    Ok((solutions, ahrs.report().clone()))
}

/// Errors of heading and inclination, degrees.
pub fn error_deg(solution: &Solution, truth: &Attitude) -> (f64, f64) {
    let error = (truth * solution.attitude.inverse()).into_inner();
    let heading = 2.0 * (error.k / error.w).atan();
    let inclination = 2.0 * error.i.hypot(error.j).atan2(error.w.hypot(error.k));
    (heading.to_degrees(), inclination.to_degrees())
}

/// Largest errors of heading and inclination from a time on, degrees.
pub fn worst_deg(solutions: &[Solution], truth: &[Attitude], from_s: f64) -> (f64, f64) {
    solutions.iter().zip(truth).filter(|(s, _)| s.time.seconds() > from_s).fold(
        (0.0_f64, 0.0_f64),
        |(heading, inclination), (solution, truth)| {
            let (h, i) = error_deg(solution, truth);
            (heading.max(h.abs()), inclination.max(i))
        },
    )
}
