//! Steps as the paper of system S1 has them: zero crossings of the low-passed, gravity-free magnitude.
//!
//! Lu, Zhao & Xu (*Positioning downhole by a micro inertial system and Wi-Fi*, §1.1) say no more than that. Here the
//! low-pass is a Butterworth of second order (bilinear transform), gravity a mean over [`ZeroCrossingParams::gravity_time_s`], and a
//! crossing counts only when the signal has been below −threshold since the last one and exceeds +threshold before the next, since
//! otherwise the noise of a tag at rest walks. It has no notion of a gait: whatever shakes the tag is a step.

use super::{BIN_S, Step, ZeroCrossingParams};
use adit_core::time::{Interval, Time};
use alloc::collections::VecDeque;
use core::f64::consts::{PI, SQRT_2};
use serde::{Deserialize, Serialize};

/// Longer than this since the last step, nobody walks, s.
const LONGEST_S: f64 = 1.5;

/// Counter of zero crossings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ZeroCrossing {
    /// Coefficients of the low-pass: of input and its past, of past output.
    b: [f64; 3],
    a: [f64; 2],
    inputs: [f64; 2],
    outputs: [f64; 2],
    gravity: Option<f64>,
    /// The value before, and the least since the last crossing.
    before: f64,
    least: f64,
    /// A crossing that has not risen above the threshold yet.
    crossed: Option<Time>,
    /// Least and greatest since the crossing, for the swing.
    range: (f64, f64),
    told: Option<Time>,
    now: Time,
}

impl ZeroCrossing {
    /// A walker of whom nothing is known.
    pub fn new(params: &ZeroCrossingParams) -> Self {
        // Butterworth, second order, bilinear with prewarping.
        let k = libm::tan(PI * params.low_pass_hz * BIN_S);
        let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
        let gain = k * k * norm;
        Self {
            b: [gain, 2.0 * gain, gain],
            a: [2.0 * (k * k - 1.0) * norm, (1.0 - SQRT_2 * k + k * k) * norm],
            inputs: [0.0; 2],
            outputs: [0.0; 2],
            gravity: None,
            before: 0.0,
            least: 0.0,
            crossed: None,
            range: (0.0, 0.0),
            told: None,
            now: Time::ZERO,
        }
    }

    /// True while the last step is not long ago.
    pub fn is_walking(&self) -> bool {
        self.told.is_some_and(|told| (self.now - told).seconds() < LONGEST_S)
    }

    /// Takes the mean norm of one bin; says until when all is settled.
    pub fn observe(
        &mut self,
        params: &ZeroCrossingParams,
        middle: Time,
        norm: f64,
        due: &mut VecDeque<Step>,
    ) -> Time {
        self.now = middle;
        let gravity = self.gravity.get_or_insert(norm);
        *gravity += (norm - *gravity) * (BIN_S / params.gravity_time_s).min(1.0);
        let input = norm - *gravity;
        let [x1, x2] = self.inputs;
        let [y1, y2] = self.outputs;
        let value = self.b[0] * input + self.b[1] * x1 + self.b[2] * x2 - self.a[0] * y1 - self.a[1] * y2;
        (self.inputs, self.outputs) = ([input, x1], [value, y1]);

        let before = core::mem::replace(&mut self.before, value);
        self.range = (self.range.0.min(value), self.range.1.max(value));
        self.least = self.least.min(value);
        if before < 0.0 && value >= 0.0 && self.least < -params.threshold_m_s2 {
            let back_s = BIN_S * value / (value - before);
            self.crossed = Some(middle - Interval::from_seconds(back_s).unwrap_or_default());
            self.least = 0.0;
        }
        if let Some(time) = self.crossed
            && value > params.threshold_m_s2
        {
            self.crossed = None;
            let since_s = self.told.map(|told| (time - told).seconds());
            if since_s.is_none_or(|since_s| since_s >= params.shortest_s) {
                let period_s = since_s.unwrap_or(LONGEST_S).min(LONGEST_S);
                let swing_m_s2 = self.range.1 - self.range.0;
                due.push_back(Step { time, period_s, swing_m_s2, seen: true });
                self.told = Some(time);
                self.range = (value, value);
            }
        }
        self.crossed.unwrap_or(middle) - Interval::from_nanos(1)
    }
}
