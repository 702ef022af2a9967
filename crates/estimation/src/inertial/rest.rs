//! Finds rest in a stream of samples: where a sensor does not move, its accelerometer tells which way is up.

use crate::inertial::alignment::RestAlignment;
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_observation::ImuSample;

/// Length of a window, s: shorter than a stance, so that a log that never rests still has some.
const WINDOW: Interval = Interval::from_nanos(250_000_000);
/// How far the length of the mean specific force may be from gravity, as a share of it: bias and scale of a poor sensor.
const GRAVITY_SHARE: f64 = 0.1;
/// Fewer samples in a window tell of no rest.
const FEWEST: u32 = 5;

/// A window without motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// When it began.
    pub time: Time,
    /// Mean specific force, m/s², body: up.
    pub specific_force_m_s2: Vector3<f64>,
}

/// Looks at one window after another.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RestFinder {
    window: RestAlignment,
    began: Option<Time>,
    samples: u32,
}

impl RestFinder {
    /// Takes a sample; at the end of a window without motion, tells of it.
    pub fn observe(&mut self, imu: &ImuSample, gravity_m_s2: f64) -> Option<Rest> {
        let began = *self.began.get_or_insert(imu.time);
        self.window.observe_imu(imu);
        self.samples += 1;
        if imu.time - began < WINDOW {
            return None;
        }
        let Self { window, samples, .. } = core::mem::take(self);
        let aligned = window.align(0.0)?;
        let share = (aligned.force_m_s2 / gravity_m_s2 - 1.0).abs();
        let at_rest = samples >= FEWEST && aligned.at_rest && share < GRAVITY_SHARE;
        at_rest.then(|| Rest { time: began, specific_force_m_s2: window.mean_force_m_s2() })
    }
}
