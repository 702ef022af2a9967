//! Stance: when does the foot stand still?
//!
//! Every detector reduces the samples of a short window around a sample to one statistic `T` and calls the foot still
//! while `T` is below a threshold (Skog, Händel, Nilsson & Rantakokko 2010, *Zero-velocity detection — an algorithm
//! evaluation*). With window length `W`, mean specific force `f̄`, gravity `g`, scales `σ_a`, `σ_ω`:
//!
//! | detector | statistic |
//! |---|---|
//! | [`Detector::Magnitude`] | largest of `(‖f‖ − g)²/σ_a²` and `‖ω‖²/σ_ω²` in the window: the threshold test of S2 (Kang 2023, §3) |
//! | [`Detector::MovingVariance`] | `1/W Σ ‖f − f̄‖² / σ_a²` |
//! | [`Detector::Ared`] | `1/W Σ ‖ω‖² / σ_ω²` (angular rate energy) |
//! | [`Detector::Shoe`] | `1/W Σ (‖f − g f̄/‖f̄‖‖² / σ_a² + ‖ω‖² / σ_ω²)`: generalised likelihood ratio |
//! | [`Detector::Adaptive`] | the statistic of SHOE, against a threshold that follows the gait |
//!
//! # The adaptive threshold
//! One fixed threshold cannot serve a walker and a runner: a walker's foot rests with `T` of 0.1–10, a runner's never
//! falls below some hundreds, where a walker's foot is already in the air. What all gaits share is that a foot comes
//! to its own least motion once a stride. So the threshold is tied to the least `T` within `reach` before and `look_ahead` after:
//!
//! ```text
//! threshold = gain · T_least,   kept within [floor, ceiling]
//! ```
//!
//! `reach` is a little longer than half of the longest ordinary stride, so that every window holds a stance; below
//! `floor` the foot is still whatever its neighbours do. A foot that hangs or is lifted slowly also has a least
//! motion; that case is caught by the innovation gate of the method, which knows the velocity.
//! Looking ahead delays solutions by the same time; without it (`look_ahead = 0`, and a `reach` of about 1 s) the
//! detector is causal and knows only the stances before.

use crate::settings::{first_unusable, not_negative, positive};
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_observation::ImuSample;
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Which statistic and which kind of threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detector {
    /// Magnitudes against their values at rest, as S2 describes it.
    Magnitude,
    /// Variance of the specific force.
    MovingVariance,
    /// Energy of the angular rate.
    Ared,
    /// Stance hypothesis optimal estimation: both sensors, fixed threshold.
    Shoe,
    /// Both sensors, threshold that follows the gait.
    Adaptive,
}

/// Settings of the stance detector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StanceParams {
    /// Detector.
    pub detector: Detector,
    /// Length of the window, s.
    pub window_s: f64,
    /// Scale of the specific force `σ_a`, m/s².
    pub acc_scale_m_s2: f64,
    /// Scale of the angular rate `σ_ω`, rad/s.
    pub gyro_scale_rad_s: f64,
    /// Threshold of the fixed detectors.
    pub threshold: f64,
    /// Adaptive: how far before a sample its least statistic is looked for, s.
    pub reach_s: f64,
    /// Adaptive: how far after it, s; solutions come later by as much.
    pub look_ahead_s: f64,
    /// Adaptive: threshold over least statistic.
    pub gain: f64,
    /// Adaptive: least threshold.
    pub floor: f64,
    /// Adaptive: greatest threshold.
    pub ceiling: f64,
}

impl Default for StanceParams {
    fn default() -> Self {
        Self {
            detector: Detector::Adaptive,
            window_s: 0.025,
            acc_scale_m_s2: 0.19,
            gyro_scale_rad_s: 0.1,
            threshold: 20.0,
            reach_s: 0.55,
            look_ahead_s: 0.55,
            gain: 1.7,
            floor: 0.75,
            ceiling: 3e4,
        }
    }
}

impl StanceParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("stance.window_s", not_negative(self.window_s)),
            ("stance.acc_scale_m_s2", positive(self.acc_scale_m_s2)),
            ("stance.gyro_scale_rad_s", positive(self.gyro_scale_rad_s)),
            ("stance.threshold", positive(self.threshold)),
            ("stance.reach_s", not_negative(self.reach_s)),
            ("stance.look_ahead_s", not_negative(self.look_ahead_s)),
            ("stance.gain", positive(self.gain)),
            ("stance.floor", positive(self.floor)),
            ("stance.ceiling", positive(self.ceiling)),
        ])
    }
}

/// What the detector says of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stance {
    /// Statistic of the window around the sample.
    pub statistic: f64,
    /// Threshold it is held against.
    pub threshold: f64,
    /// Least statistic within reach (the statistic itself for fixed thresholds).
    pub least: f64,
}

impl Stance {
    /// True when the foot is taken to be still.
    pub fn is_still(&self) -> bool {
        self.statistic < self.threshold
    }
}

/// A sample in the queue.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Entry {
    sample: ImuSample,
    /// `‖f‖²` and `‖ω‖²`, needed once for every window that holds the sample.
    force_squared: f64,
    rate_squared: f64,
    /// Statistic of the window around it, zero until it is judged.
    statistic: f64,
}

/// Streaming detector: samples in, samples with their stance out, `look_ahead + window/2` later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StanceDetector {
    params: StanceParams,
    gravity_m_s2: f64,
    half_window: Interval,
    reach: Interval,
    look_ahead: Interval,
    /// Samples from half a window before the next to leave.
    samples: VecDeque<Entry>,
    /// Samples of the queue that have left already and serve only as window.
    departed: usize,
    /// Samples of the queue whose statistic is known.
    judged: usize,
    /// Samples of the queue that have entered `minima`.
    entered: usize,
    /// Candidates for the least statistic: (time, statistic), both rising.
    minima: VecDeque<(Time, f64)>,
}

impl StanceDetector {
    /// Detector for a site with the given gravity.
    ///
    /// Times outside 0–10 s are taken as the nearer end of that range.
    pub fn new(params: StanceParams, gravity_m_s2: f64) -> Self {
        let span = |seconds: f64| Interval::from_seconds(seconds.clamp(0.0, 10.0)).unwrap_or_default();
        let adaptive = params.detector == Detector::Adaptive;
        Self {
            half_window: span(params.window_s / 2.0),
            reach: span(params.reach_s),
            look_ahead: if adaptive { span(params.look_ahead_s) } else { Interval::ZERO },
            gravity_m_s2,
            params,
            samples: VecDeque::new(),
            departed: 0,
            judged: 0,
            entered: 0,
            minima: VecDeque::new(),
        }
    }

    /// Sets the length of the specific force at rest as this sensor reads it, and judges all waiting samples anew.
    ///
    /// An accelerometer that is off by 50 mg would otherwise never look at rest.
    pub fn set_rest_force(&mut self, force_m_s2: f64) {
        self.gravity_m_s2 = force_m_s2;
        let latest = self.samples.back().map(|entry| entry.sample.time);
        self.judged = self.departed;
        self.entered = self.departed;
        self.minima.clear();
        self.judge(latest);
    }

    /// Takes one sample; times must rise.
    #[inline]
    pub fn push(&mut self, sample: ImuSample) {
        self.samples.push_back(Entry {
            sample,
            force_squared: sample.specific_force_m_s2.norm_squared(),
            rate_squared: sample.angular_rate_rad_s.norm_squared(),
            statistic: 0.0,
        });
        self.judge(Some(sample.time));
    }

    /// The next sample whose window and reach are complete, with its stance.
    #[inline]
    pub fn pop(&mut self) -> Option<(ImuSample, Stance)> {
        let latest = self.samples.back()?.sample.time;
        self.pop_until(Some(latest))
    }

    /// The next sample at the end of the log, with windows cut short there.
    pub fn drain(&mut self) -> Option<(ImuSample, Stance)> {
        self.judge(None);
        self.pop_until(None)
    }

    /// The samples still waiting to leave, oldest first.
    pub fn waiting(&self) -> impl Iterator<Item = &ImuSample> {
        self.samples.iter().skip(self.departed).map(|entry| &entry.sample)
    }

    /// Memory held by the queues, bytes.
    pub fn heap_bytes(&self) -> usize {
        self.samples.capacity() * size_of::<Entry>() + self.minima.capacity() * size_of::<(Time, f64)>()
    }

    /// Computes the statistics whose windows are complete at `latest` (`None`: at the end of the log).
    fn judge(&mut self, latest: Option<Time>) {
        while let Some(entry) = self.samples.get(self.judged) {
            let (start, end) = (entry.sample.time - self.half_window, entry.sample.time + self.half_window);
            if latest.is_some_and(|latest| latest < end) {
                return;
            }
            let mut first = self.judged;
            while first > 0 && self.samples[first - 1].sample.time >= start {
                first -= 1;
            }
            let mut past = self.judged + 1;
            while past < self.samples.len() && self.samples[past].sample.time <= end {
                past += 1;
            }
            let statistic = self.statistic(first, past);
            self.samples[self.judged].statistic = statistic;
            self.judged += 1;
        }
    }

    fn statistic(&self, first: usize, past: usize) -> f64 {
        let window = || self.samples.range(first..past);
        let count = (past - first) as f64;
        let acc_weight = 1.0 / (self.params.acc_scale_m_s2 * self.params.acc_scale_m_s2);
        let gyro_weight = 1.0 / (self.params.gyro_scale_rad_s * self.params.gyro_scale_rad_s);
        let g = self.gravity_m_s2;
        if self.params.detector == Detector::Magnitude {
            return window().fold(0.0, |largest: f64, s| {
                let excess = libm::sqrt(s.force_squared) - g;
                largest.max(excess * excess * acc_weight).max(s.rate_squared * gyro_weight)
            });
        }
        let (mut force, mut force_squared, mut rate_squared) = (Vector3::zeros(), 0.0, 0.0);
        for s in window() {
            force += s.sample.specific_force_m_s2;
            force_squared += s.force_squared;
            rate_squared += s.rate_squared;
        }
        // Σ‖f − u‖² = Σ‖f‖² − 2 u·Σf + W‖u‖² for u = f̄ and for u = g f̄/‖f̄‖.
        let force_norm = libm::sqrt(force.norm_squared());
        let variance = (force_squared - force_norm * force_norm / count).max(0.0);
        let off_gravity = (force_squared - 2.0 * g * force_norm + count * g * g).max(0.0);
        let (acc, gyro) = match self.params.detector {
            Detector::Magnitude | Detector::MovingVariance => (variance, 0.0),
            Detector::Ared => (0.0, rate_squared),
            Detector::Shoe | Detector::Adaptive => (off_gravity, rate_squared),
        };
        (acc * acc_weight + gyro * gyro_weight) / count
    }

    #[inline]
    fn pop_until(&mut self, latest: Option<Time>) -> Option<(ImuSample, Stance)> {
        let &Entry { sample, statistic, .. } = self.samples.get(self.departed)?;
        if self.departed >= self.judged {
            return None;
        }
        let stance = if self.params.detector == Detector::Adaptive {
            let horizon = sample.time + self.look_ahead;
            if latest.is_some_and(|latest| latest < horizon + self.half_window) {
                return None;
            }
            self.enter_minima(horizon);
            let oldest = sample.time - self.reach;
            while self.minima.front().is_some_and(|(time, _)| *time < oldest) {
                self.minima.pop_front();
            }
            let least = self.minima.front().map_or(statistic, |(_, least)| *least);
            Stance { statistic, threshold: self.adaptive_threshold(least), least }
        } else {
            Stance { statistic, threshold: self.params.threshold, least: statistic }
        };
        self.departed += 1;
        self.forget(sample.time);
        Some((sample, stance))
    }

    /// Enters all judged samples up to `horizon` into the sliding minimum (monotonic queue: O(1) per sample).
    fn enter_minima(&mut self, horizon: Time) {
        while self.entered < self.judged {
            let Entry { sample, statistic, .. } = self.samples[self.entered];
            if sample.time > horizon {
                return;
            }
            while self.minima.back().is_some_and(|(_, least)| *least >= statistic) {
                self.minima.pop_back();
            }
            self.minima.push_back((sample.time, statistic));
            self.entered += 1;
        }
    }

    fn adaptive_threshold(&self, least: f64) -> f64 {
        let p = &self.params;
        // Not `clamp`: a ceiling below the floor must not panic.
        (p.gain * least).max(p.floor).min(p.ceiling)
    }

    /// Drops departed samples that no window needs any more.
    fn forget(&mut self, left: Time) {
        let oldest = left - self.half_window;
        while self.departed > 1 && self.samples[0].sample.time < oldest {
            self.samples.pop_front();
            self.departed -= 1;
            self.judged -= 1;
            self.entered = self.entered.saturating_sub(1);
        }
    }
}
