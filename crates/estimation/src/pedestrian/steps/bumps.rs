//! Smoothing, and the bumps of what is smooth.

use super::{BIN, BIN_S, StepParams};
use adit_core::time::{Interval, Time};
use core::f64::consts::PI;
use serde::{Deserialize, Serialize};

/// Bins that the smoothing looks ahead and back.
pub const REACH: usize = 10;
const TAPS: usize = 2 * REACH + 1;
/// The same as an interval.
const DELAY: Interval = Interval::from_nanos(10 * BIN.nanos());
/// A dip of less than this share of the rise before it does not part a bump in two.
const DIP: f64 = 0.25;
/// Least width, s: three bins have weight.
const LEAST_WIDTH_S: f64 = 0.16;

/// A raised cosine of changing width about the bin [`REACH`] back: no phase, whatever the width.
///
/// With the full width `w` its gain is ½ at `1/w` and zero at `2/w`: as wide as a step lasts, it leaves the rhythm of the
/// steps and takes away what makes two bumps out of one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Smoother {
    bins: [f64; TAPS],
    /// Weights of the middle bin and, each twice, of those beside it.
    weights: [f64; REACH + 1],
    empty: bool,
}

impl Smoother {
    /// Full width in s.
    pub fn new(width_s: f64) -> Self {
        let mut smoother = Self { bins: [0.0; TAPS], weights: [0.0; REACH + 1], empty: true };
        smoother.set_width(width_s);
        smoother
    }

    /// Changes the full width, s; it cannot be greater than twice [`REACH`] bins.
    pub fn set_width(&mut self, width_s: f64) {
        let width = width_s.clamp(LEAST_WIDTH_S, 2.0 * REACH as f64 * BIN_S) / BIN_S;
        let mut sum = 0.0;
        for (offset, weight) in self.weights.iter_mut().enumerate() {
            let phase = offset as f64 / width;
            let cos = libm::cos(PI * phase);
            *weight = if phase < 0.5 { cos * cos } else { 0.0 };
            sum += if offset == 0 { *weight } else { 2.0 * *weight };
        }
        for weight in &mut self.weights {
            *weight /= sum;
        }
    }

    /// Takes a bin; gives the smoothed value of the one [`REACH`] back, with its time.
    pub fn push(&mut self, middle: Time, value: f64) -> (Time, f64) {
        if self.empty {
            self.bins = [value; TAPS];
            self.empty = false;
        }
        self.bins.copy_within(1.., 0);
        self.bins[TAPS - 1] = value;
        let mut smooth = self.weights[0] * self.bins[REACH];
        for (offset, weight) in self.weights.iter().enumerate().skip(1) {
            smooth += weight * (self.bins[REACH - offset] + self.bins[REACH + offset]);
        }
        (middle - DELAY, smooth)
    }
}

/// A rise and a fall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bump {
    /// When it is highest.
    pub time: Time,
    /// From the trough before to the top, m/s².
    pub rise_m_s2: f64,
    /// From the top to the trough after, m/s².
    pub fall_m_s2: f64,
}

impl Bump {
    /// A bump that has both sides: the greater of them, but not much more than the lesser, m/s².
    pub fn height_m_s2(&self) -> f64 {
        const MOST: f64 = 2.5;
        let (rise, fall) = (self.rise_m_s2, self.fall_m_s2);
        rise.max(fall).min(MOST * rise.min(fall))
    }

    /// Greatest less least over the step, m/s².
    pub fn swing_m_s2(&self) -> f64 {
        0.5 * (self.rise_m_s2 + self.fall_m_s2)
    }
}

/// Finds bumps: tops and troughs in turn, a hysteresis apart.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Bumps {
    side: Side,
    /// The highest (lowest) since the last trough (top).
    extreme: (Time, f64),
    /// The last value, and those on both sides of the highest.
    last: f64,
    shoulders: [f64; 2],
    trough: f64,
    top: (Time, f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
enum Side {
    #[default]
    Unknown,
    Rising,
    Falling,
}

impl Bumps {
    /// Takes the next smooth value; gives a bump once the rise after it has begun, or it has been flat for too long.
    pub fn push(&mut self, params: &StepParams, time: Time, value: f64) -> Option<Bump> {
        let hysteresis = params.hysteresis_m_s2;
        let flat = |since: Time| (time - since).seconds() > params.longest_s;
        let (since, extreme) = self.extreme;
        let last = core::mem::replace(&mut self.last, value);
        match self.side {
            Side::Unknown => {
                self.rise(time, value, value);
                None
            }
            Side::Rising => {
                if value > extreme {
                    self.extreme = (time, value);
                    self.shoulders = [last, value];
                    return None;
                }
                if time - since <= BIN {
                    self.shoulders[1] = value;
                }
                if value < extreme - hysteresis.max(DIP * (extreme - self.trough)) {
                    self.side = Side::Falling;
                    self.top = (self.summit(), extreme);
                    self.extreme = (time, value);
                } else if flat(since) {
                    self.rise(time, value, value);
                }
                None
            }
            Side::Falling => {
                if value < extreme {
                    self.extreme = (time, value);
                }
                let trough = self.extreme.1;
                if value > trough + hysteresis || flat(self.top.0) {
                    let bump = self.bump(trough);
                    self.rise(time, value, trough);
                    return Some(bump);
                }
                None
            }
        }
    }

    /// The bump under way at the end of the log.
    pub fn end(&self) -> Option<Bump> {
        (self.side == Side::Falling).then(|| self.bump(self.extreme.1))
    }

    /// The earliest time that a bump still under way may have.
    pub fn undecided(&self, now: Time) -> Time {
        match self.side {
            Side::Unknown => now,
            Side::Rising => self.extreme.0 - BIN,
            Side::Falling => self.top.0,
        }
    }

    fn rise(&mut self, time: Time, value: f64, trough: f64) {
        *self = Self { side: Side::Rising, extreme: (time, value), trough, shoulders: [value; 2], ..*self };
    }

    /// Top of the parabola through the highest value and its shoulders.
    fn summit(&self) -> Time {
        let ((time, top), [before, after]) = (self.extreme, self.shoulders);
        let (slope, bend) = (after - before, 2.0 * top - before - after);
        let offset = if bend > 0.0 { (0.5 * slope / bend).clamp(-0.5, 0.5) } else { 0.0 };
        time + Interval::from_seconds(offset * BIN_S).unwrap_or_default()
    }

    fn bump(&self, trough: f64) -> Bump {
        let (time, top) = self.top;
        Bump { time, rise_m_s2: top - self.trough, fall_m_s2: top - trough }
    }
}
