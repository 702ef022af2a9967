//! A walker with a tag on the body, in closed form, and what its sensors read.

use super::Draws;
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Vector2, Vector3};
use adit_core::time::Time;
use adit_observation::{ImuSample, MagneticSample, Observation};
use core::f64::consts::{FRAC_PI_2, TAU};

/// Gravity, m/s².
pub const GRAVITY_M_S2: f64 = 9.80665;
/// Field of the site: norm 48 µT, dip 65°, ENU.
const FIELD_UT: [f64; 3] = [0.0, 20.286, -43.503];

/// Somebody who stands, walks at one speed along straight lines and bends, and stands again.
#[derive(Clone)]
pub struct Strides {
    /// Standing before and after the walk, s.
    pub rest_s: f64,
    /// Number of steps.
    pub steps: u32,
    /// Steps per second.
    pub cadence_hz: f64,
    /// Length of a step, m.
    pub step_m: f64,
    /// Vertical acceleration at the fundamental of the steps, m/s²: half of greatest less least.
    pub bounce_m_s2: f64,
    /// The same at its double: what makes two peaks of one.
    pub second_m_s2: f64,
    /// Forward acceleration and braking with every step, m/s².
    pub surge_m_s2: f64,
    /// Share by which the one foot is louder than the other.
    pub limp: f64,
    /// Heading at the start, and turns: from when on, for how long (s), by what angle (rad).
    pub heading_rad: f64,
    pub turns: Vec<(f64, f64, f64)>,
    /// Body to the axes of the person (x forward, y left, z up).
    pub mounting: Attitude,
    /// Yaw of the pelvis or of an arm, with every second step, rad.
    pub sway_rad: f64,
    pub rate_hz: f64,
    pub magnetometer: bool,
    /// White noise of one sample: rad/s, m/s², µT.
    pub noise: (f64, f64, f64),
}

impl Default for Strides {
    fn default() -> Self {
        Self {
            rest_s: 4.0,
            steps: 40,
            cadence_hz: 1.8,
            step_m: 0.7,
            bounce_m_s2: 2.5,
            second_m_s2: 0.5,
            surge_m_s2: 0.0,
            limp: 0.0,
            heading_rad: 0.4,
            turns: Vec::new(),
            mounting: Attitude::identity(),
            sway_rad: 0.08,
            rate_hz: 100.0,
            magnetometer: true,
            noise: (0.002, 0.03, 0.3),
        }
    }
}

impl Strides {
    /// Length of the log, s.
    pub fn duration_s(&self) -> f64 {
        2.0 * self.rest_s + f64::from(self.steps) / self.cadence_hz
    }

    /// Steps since the start, as a fraction.
    fn phase(&self, time_s: f64) -> f64 {
        ((time_s - self.rest_s) * self.cadence_hz).clamp(0.0, f64::from(self.steps))
    }

    fn walks(&self, time_s: f64) -> bool {
        let phase = (time_s - self.rest_s) * self.cadence_hz;
        phase > 0.0 && phase < f64::from(self.steps)
    }

    /// Specific force along the vertical, m/s².
    pub fn vertical_m_s2(&self, time_s: f64) -> f64 {
        if !self.walks(time_s) {
            return GRAVITY_M_S2;
        }
        let phase = self.phase(time_s);
        let louder = 1.0 + if phase.rem_euclid(2.0) < 1.0 { self.limp } else { -self.limp };
        // A trough before and after each step; the first and the last are those of standing.
        let step = 0.5 * self.bounce_m_s2 * 2.0 * (-(TAU * phase).cos());
        GRAVITY_M_S2 + louder * (step - self.second_m_s2 * (2.0 * TAU * phase).cos())
    }

    /// Walking direction, clockwise from north, and its rate.
    fn course(&self, time_s: f64) -> (f64, f64) {
        self.turns.iter().fold((self.heading_rad, 0.0), |(heading, rate), &(from, length, angle)| {
            let share = ((time_s - from) / length).clamp(0.0, 1.0);
            let turning = if share > 0.0 && share < 1.0 { angle / length } else { 0.0 };
            (heading + angle * share, rate + turning)
        })
    }

    /// Yaw of the tag against the walking direction, clockwise, and its rate.
    fn sway(&self, time_s: f64) -> (f64, f64) {
        if !self.walks(time_s) {
            return (0.0, 0.0);
        }
        let omega = 0.5 * TAU * self.cadence_hz;
        let angle = 0.5 * TAU * self.phase(time_s);
        (self.sway_rad * angle.sin(), self.sway_rad * omega * angle.cos())
    }

    /// Body to ENU.
    pub fn attitude(&self, time_s: f64) -> Attitude {
        let heading = self.course(time_s).0 + self.sway(time_s).0;
        attitude::exp(&(Vector3::z() * (FRAC_PI_2 - heading))) * self.mounting
    }

    /// What the sensors read, and the true position at each inertial sample.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number of samples")]
    pub fn record(&self, seed: u64) -> (Vec<Observation>, Vec<(Time, Vector2<f64>)>) {
        let mut draws = Draws::new(seed);
        let count = (self.duration_s() * self.rate_hz) as usize;
        let (mut log, mut truth) = (Vec::new(), Vec::new());
        let mut position = Vector2::zeros();
        for index in 0..=count {
            let time_s = index as f64 / self.rate_hz;
            let time = Time::from_seconds(time_s).unwrap_or_default();
            let (heading, rate) = self.course(time_s);
            let speed = if self.walks(time_s) { self.step_m * self.cadence_hz } else { 0.0 };
            let (sin, cos) = heading.sin_cos();
            // The middle of the interval that ends here.
            position += Vector2::new(sin, cos) * (speed / self.rate_hz);
            truth.push((time, position));
            let body = self.attitude(time_s).inverse();
            let across = speed * rate;
            let surge =
                if self.walks(time_s) { self.surge_m_s2 * (TAU * self.phase(time_s)).sin() } else { 0.0 };
            let force = Vector3::new(
                cos * across + sin * surge,
                -sin * across + cos * surge,
                self.vertical_m_s2(time_s),
            );
            let turn = Vector3::new(0.0, 0.0, -(rate + self.sway(time_s).1));
            let (gyro, acc, mag) = self.noise;
            log.push(Observation::Imu(ImuSample {
                time,
                angular_rate_rad_s: body * turn + draws.vector(gyro),
                specific_force_m_s2: body * force + draws.vector(acc),
            }));
            if self.magnetometer {
                let field_ut = body * Vector3::from(FIELD_UT) + draws.vector(mag);
                log.push(Observation::Magnetic(MagneticSample { time, field_ut }));
            }
        }
        (log, truth)
    }
}
