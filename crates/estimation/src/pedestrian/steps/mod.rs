//! Steps of a walker from the specific force alone, wherever the tag is carried and whatever way up.
//!
//! ```text
//! ‖f‖ → means of 40 ms → smoothing → bumps → steps
//! ```
//!
//! | detector | what it is |
//! |---|---|
//! | [`Detector::Gait`] | adit's own ([`gait`]): bumps that keep the rhythm of one walker, with weak ones in between and lost ones told by the rhythm |
//! | [`Detector::ZeroCrossing`] | the paper's ([`zero_crossing`]): the gravity-free, low-passed magnitude crosses zero upwards |
//!
//! Both work on the **norm** of the specific force, which no rotation of the tag changes, and on means over [`BIN_S`]
//! ([`grid`]), which are the same whatever the rate and however uneven the stamps. A sample costs a square root and three
//! products; the rest is done 25 times a second. Nothing is allocated per sample.
//!
//! Steps come late, and in order of time: `gait` tells a step of steady walking once the bump after it has begun (about
//! 0.6 s), the first of a walk with the fifth bump, and those after a weak stretch when the walk goes on or has ended
//! (within [`StepParams::patience`] steps). [`StepDetector::settled`] says until when nothing can be added any more.
//!
//! Frames: none; the norm only. Limits: 0.8 to 3.7 steps/s; fewer than five steps in a row are no walk and not counted; a ride
//! that shakes in the rhythm of a walk is one.

pub mod bumps;
pub mod gait;
pub mod grid;
mod params;
pub mod zero_crossing;

pub use params::{Detector, StepParams, ZeroCrossingParams};

use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use alloc::collections::VecDeque;
use bumps::{Bumps, Smoother};
use gait::Gait;
use grid::NormGrid;
use serde::{Deserialize, Serialize};
use zero_crossing::ZeroCrossing;

/// Length of the bins that samples are averaged over, s.
pub const BIN_S: f64 = 0.04;
/// The same as an interval.
const BIN: Interval = Interval::from_nanos(40_000_000);

/// One step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// When the body is pushed up the hardest: about the time of foot contact.
    pub time: Time,
    /// Time since the step before; of a first step, the mean of those after it, s.
    pub period_s: f64,
    /// Greatest less least smoothed norm of the specific force over the step, m/s².
    pub swing_m_s2: f64,
    /// False where the step was not seen but is told by the rhythm of those around it.
    pub seen: bool,
}

/// How the detector does it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is one of it for each walker")]
enum Stage {
    Gait { smoother: Smoother, bumps: Bumps, gait: Gait },
    ZeroCrossing(ZeroCrossing),
}

/// Streaming step detector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepDetector {
    params: StepParams,
    grid: NormGrid,
    stage: Stage,
    due: VecDeque<Step>,
    settled: Option<Time>,
}

impl StepDetector {
    /// A walker of whom nothing is known.
    pub fn new(params: &StepParams) -> Self {
        Self {
            grid: NormGrid::default(),
            stage: Stage::new(params),
            due: VecDeque::new(),
            settled: None,
            params: params.clone(),
        }
    }

    /// Takes the specific force (body axes, m/s²) of one sample; true when the work of a bin was done, so that steps may be due.
    ///
    /// A sample that is not later than the one before, or holds a number that is not finite, is left out. After a gap longer
    /// than [`StepParams::gap_s`] the walk starts anew.
    #[inline]
    pub fn observe(&mut self, time: Time, specific_force_m_s2: &Vector3<f64>) -> bool {
        let squared = specific_force_m_s2.norm_squared();
        if !squared.is_finite() {
            return false;
        }
        if let Some(latest) = self.grid.latest() {
            if time <= latest {
                return false;
            }
            if (time - latest).seconds() > self.params.gap_s {
                self.end();
            }
        }
        if !self.grid.push(time, libm::sqrt(squared)) {
            return false;
        }
        while let Some((middle, norm)) = self.grid.pop() {
            let settled = self.stage.observe(&self.params, middle, norm, &mut self.due);
            self.settled = self.settled.max(Some(settled));
        }
        true
    }

    /// The next step, in order of time.
    pub fn pop(&mut self) -> Option<Step> {
        self.due.pop_front()
    }

    /// Until when no further step will be told; `None` at the start.
    pub fn settled(&self) -> Option<Time> {
        self.settled
    }

    /// True in the midst of a walk.
    pub fn is_walking(&self) -> bool {
        match &self.stage {
            Stage::Gait { gait, .. } => gait.is_walking(),
            Stage::ZeroCrossing(stage) => stage.is_walking(),
        }
    }

    /// The log ends or has a gap: whatever is undecided is decided, and a further sample starts anew.
    pub fn end(&mut self) {
        let Some(latest) = self.grid.latest() else { return };
        // The smoothing looks ahead: the last value goes on for as long.
        let (mut middle, norm) = self.grid.last_bin();
        for _ in 0..bumps::REACH {
            middle = middle + BIN;
            self.stage.observe(&self.params, middle, norm, &mut self.due);
        }
        self.stage.end(&self.params, &mut self.due);
        self.due.retain(|step| step.time <= latest);
        self.settled = self.settled.max(Some(latest));
        self.grid = NormGrid::default();
        self.stage = Stage::new(&self.params);
    }
}

impl Stage {
    fn new(params: &StepParams) -> Self {
        match params.detector {
            Detector::Gait => Self::Gait {
                smoother: Smoother::new(params.smoothing_s),
                bumps: Bumps::default(),
                gait: Gait::default(),
            },
            Detector::ZeroCrossing => Self::ZeroCrossing(ZeroCrossing::new(&params.zero_crossing)),
        }
    }

    /// Takes the mean of one bin, and says until when all is settled.
    fn observe(&mut self, params: &StepParams, middle: Time, norm: f64, due: &mut VecDeque<Step>) -> Time {
        match self {
            Self::Gait { smoother, bumps, gait } => {
                let (time, smooth) = smoother.push(middle, norm);
                let was = gait.period_s();
                if let Some(bump) = bumps.push(params, time, smooth) {
                    gait.observe(params, &bump, due);
                }
                let undecided = bumps.undecided(time);
                gait.rest(params, undecided, due);
                if gait.period_s() != was {
                    smoother.set_width(params.width_s(gait.period_s()));
                }
                gait.settled(params, undecided)
            }
            Self::ZeroCrossing(stage) => stage.observe(&params.zero_crossing, middle, norm, due),
        }
    }

    fn end(&mut self, params: &StepParams, due: &mut VecDeque<Step>) {
        if let Self::Gait { bumps, gait, .. } = self {
            if let Some(bump) = bumps.end() {
                gait.observe(params, &bump, due);
            }
            gait.end(params, due);
        }
    }
}
