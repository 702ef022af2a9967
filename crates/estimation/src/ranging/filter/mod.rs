//! Filters on single ranges: where a tag is, how it moves, and by what its ranges are off.
//!
//! ```text
//! x = [p 3 | v 3 | b | δ k | c 12 | n 12]
//! r = ‖p − p_i‖ + b + c_i + n_i + e
//! ```
//!
//! Ranges of UWB err in common first (b: the antenna of the tag), then by anchor (c), then by what is beside the path just now (n, which passes within a second);
//! what is left as noise e is a few centimetres. A filter that takes all of it for noise believes itself far too much, since the next
//! hundred ranges have the same error. Offsets are of [`SLOTS`] links at once, an anchor and a tag each. Motion is that of people ([`MotionParams`], [`HeightParams`]), or the steps
//! of dead reckoning, turned by δ and stretched by k.
//!
//! Weightings and gates are settings of the same filter: [`weighting`], [`gate`]. The start: several robust fits in a row that agree.
//! Mirror images are both followed until one explains the ranges better than the other by a margin; until then the covariance holds both. So are both sides of the plane, wall or
//! row of the anchors when the estimate comes to lie across it: a normal distribution over both is parted into two with the same moments (`DeMars`, Bishop & Jah 2013).
//!
//! Frame: that of the anchors, z up. Units: m, s, m/s.
//! Limits: offsets can only be told from a place that is off where the tag walks about among the anchors; anchors in one plane leave the sign of the height
//! over it open; one of several anchors behind a wall for minutes becomes its offset, half of them behind walls become the place.

mod account;
pub mod gate;
mod motion;
mod params;
mod start;
mod state;
pub mod weighting;

pub use account::{FilterReport, FoundOffset};
pub use params::{ErrorParams, FilterParams, HeightParams, MotionParams, ReckoningParams, StartParams};
pub use state::{OffsetFound, SLOTS, STATES};

use super::listener::Link;
use crate::weighed::{LastWeighed, Weighed, WeighedKind};
use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Matrix3, Vector2, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use gate::{Gate, Verdict};
use serde::{Deserialize, Serialize};
use start::{Start, Starter};
use state::State;
use weighting::{Adaptation, Weighting};

/// Any attitude: standard deviation of the uniform distribution over a turn, rad.
const ANY_ANGLE_RAD: f64 = 1.8138;
/// After so long without a range the place is dead reckoning, s.
const HELD_S: f64 = 2.0;
/// Degrees of freedom of Student's t by which two places are compared: one wrong range must not decide.
const DOF: f64 = 4.0;
/// Two places are compared for so long at least, s: errors that pass must not decide.
const LEAST_UNDECIDED_S: f64 = 10.0;
/// Only after this does an estimate lie across a mirror, s: anchors not yet heard may tell the sides apart.
const FIRST_LOOK_S: f64 = 2.0;
/// By so much the other place has to be more likely, difference of logarithms, to be believed: noise must not make the solution jump to and fro.
const CHANGE_OF_MIND: f64 = 2.0;
/// Largest factor by which a prediction is believed less at once.
const MOST_FADING: f64 = 4.0;
/// How old a range may be, s, when a later one was taken already: those of two tags on one carrier come so.
pub const OLDEST_S: f64 = 1.0;

/// What became of a range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Taken {
    /// Measured minus predicted, m.
    pub innovation_m: f64,
    /// Its variance as predicted, m².
    pub variance_m2: f64,
    /// Share of its weight that it counted with; 0 of one that was refused.
    pub weight: f64,
}

impl Taken {
    fn weighed(&self, link: &Link, verdict: Verdict) -> Weighed {
        let nis = self.innovation_m * self.innovation_m / self.variance_m2;
        let believed = verdict == Verdict::Taken && self.weight >= 1.0;
        Weighed::new((WeighedKind::Range, link.anchor), link.time, (self.innovation_m, nis), believed)
    }
}

/// A place that explains the ranges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Hypothesis {
    state: State,
    gate: Gate,
    adaptation: Adaptation,
    /// Minus the logarithm of the likelihood of its ranges.
    cost: f64,
}

/// One tag.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RangeFilter {
    params: FilterParams,
    weighting: Weighting,
    starter: Starter,
    believed: Option<Hypothesis>,
    /// Its mirror image.
    other: Option<Hypothesis>,
    /// When that was begun with, or the only place was.
    parted: Time,
    /// Time of the last range that counted.
    held: Option<Time>,
    report: FilterReport,
    /// The last innovation of each anchor.
    #[serde(default)]
    weighed: LastWeighed,
}

impl Hypothesis {
    fn new(state: State) -> Self {
        Self { state, gate: Gate::default(), adaptation: Adaptation::default(), cost: 0.0 }
    }

    /// Takes a range.
    fn observe(
        &mut self,
        link: &Link,
        tag: usize,
        params: &FilterParams,
        weighting: &Weighting,
    ) -> (Verdict, Taken) {
        self.state.propagate(link.time, params);
        let mut innovation = self.state.compare(link, tag, params);
        if innovation.fresh {
            self.adaptation.forget(innovation.slot);
        }
        let told_m2 = innovation.noise_m2;
        innovation.noise_m2 *= self.adaptation.share(innovation.slot);
        let variance = innovation.variance_m2();
        let value = innovation.value_m;
        let squared = value * value / variance;
        self.cost += 0.5 * (libm::log(variance) + (DOF + 1.0) * libm::log1p(squared / DOF));
        let e = libm::sqrt(squared);
        let weight = weighting.weight(e);
        let verdict = self.gate.judge(e, weight, &params.gate);
        let weight = match verdict {
            Verdict::Taken => {
                self.state.correct(&innovation, variance / weight);
                let shown = (value * value - innovation.predicted_m2) / told_m2;
                self.adaptation.learn(innovation.slot, shown, weighting);
                if let Some(fading) = self.adaptation.judge(squared, weighting) {
                    self.state.fade_memory(fading.min(MOST_FADING));
                }
                weight
            }
            Verdict::Relaxed => {
                self.state.doubt(value.abs(), params);
                let anew = self.state.compare(link, tag, params);
                self.state.correct(&anew, anew.variance_m2());
                1.0
            }
            Verdict::Refused => 0.0,
        };
        (verdict, Taken { innovation_m: value, variance_m2: variance, weight })
    }
}

impl RangeFilter {
    /// Nothing heard yet; fails with the name of the first setting that cannot be worked with.
    pub fn new(params: FilterParams, weighting: Weighting) -> Result<Self, &'static str> {
        if let Some(name) = params.unusable().or_else(|| weighting.unusable()) {
            return Err(name);
        }
        Ok(Self {
            params,
            weighting,
            starter: Starter::default(),
            believed: None,
            other: None,
            parted: Time::default(),
            held: None,
            report: FilterReport::default(),
            weighed: LastWeighed::default(),
        })
    }

    /// Starts at a place that is told, with its covariance, m².
    pub fn start_at(&mut self, time: Time, place_m: Vector3<f64>, covariance_m2: &Matrix3<f64>) {
        self.believed = Some(Hypothesis::new(State::at(time, place_m, covariance_m2, &self.params)));
        self.other = None;
        self.parted = time;
        self.held = Some(time);
    }

    /// Takes a range; `None` before the start, and of one that is too old.
    ///
    /// `tag` tells the tags of a carrier apart, by any number. Ranges may come up to [`OLDEST_S`] after others of a later time.
    pub fn observe(&mut self, link: &Link, tag: usize) -> Option<Taken> {
        if !link.ranged.range_m.is_finite() {
            return None;
        }
        self.starter.hear(link, &self.params);
        let Some(believed) = &mut self.believed else {
            self.report.before_start += 1;
            self.begin();
            return None;
        };
        if (believed.state.time - link.time).seconds() > OLDEST_S {
            self.report.too_old += 1;
            return None;
        }
        let (verdict, taken) = believed.observe(link, tag, &self.params, &self.weighting);
        self.report.count(verdict, &taken);
        self.weighed.note(taken.weighed(link, verdict));
        if verdict != Verdict::Refused {
            self.held = self.held.max(Some(link.time));
        }
        let doubts = believed.gate.doubts(&self.params.gate);
        if let Some(other) = &mut self.other {
            other.observe(link, tag, &self.params, &self.weighting);
            self.decide();
        }
        self.part();
        if doubts {
            self.recover();
        } else {
            self.starter.reset();
        }
        Some(taken)
    }

    /// To a later time, by what is known of how people move.
    pub fn propagate(&mut self, to: Time) {
        for hypothesis in [&mut self.believed, &mut self.other].into_iter().flatten() {
            hypothesis.state.propagate(to, &self.params);
        }
    }

    /// To a later time, along a way that dead reckoning tells, m (east, north as it takes them).
    pub fn propagate_by(&mut self, way_m: &Vector2<f64>, to: Time) {
        for hypothesis in [&mut self.believed, &mut self.other].into_iter().flatten() {
            hypothesis.state.propagate_by(way_m, to, &self.params);
        }
    }

    fn begin(&mut self) {
        let unknown = OffsetFound { offset_m: 0.0, sigma_m: self.params.errors.common_offset_sigma_m };
        let Some(start) = self.starter.look(unknown, &self.params) else { return };
        self.start_at(start.time, start.place_m, &start.covariance_m2);
        self.follow_image(&start);
    }

    fn follow_image(&mut self, start: &Start) {
        self.parted = start.time;
        self.other = start.other_m.map(|place_m| {
            self.report.ambiguous_starts += 1;
            Hypothesis::new(State::at(start.time, place_m, &start.covariance_m2, &self.params))
        });
    }

    /// Where fits agree with each other and not with the filter, it goes there.
    fn recover(&mut self) {
        let Some(believed) = &mut self.believed else { return };
        let common = believed.state.common_offset();
        let Some(start) = self.starter.look(common, &self.params) else { return };
        if !self.starter.is_better(&start, &believed.state.place_m(), common, &self.params) {
            believed.gate.calm(&self.params.gate);
            return;
        }
        believed.state.moved_to(&start.place_m, &start.covariance_m2, &self.params);
        believed.gate.reset();
        believed.adaptation = Adaptation::default();
        believed.cost = 0.0;
        self.report.recovered += 1;
        self.follow_image(&start);
        self.starter.reset();
    }

    /// Which of both places explains the ranges better.
    fn decide(&mut self) {
        let (Some(believed), Some(other)) = (&mut self.believed, &mut self.other) else { return };
        let same = believed.state.is_as(&other.state);
        if other.cost < believed.cost - CHANGE_OF_MIND && !same {
            core::mem::swap(believed, other);
            self.report.other_sides += 1;
        }
        let for_s = (believed.state.time - self.parted).seconds();
        let decided =
            (other.cost - believed.cost).abs() > self.params.start.margin && for_s > LEAST_UNDECIDED_S;
        if same || decided {
            self.other = None;
        }
    }

    /// Where the estimate lies across the mirror of its anchors, both sides are followed.
    fn part(&mut self) {
        if self.other.is_some() {
            return;
        }
        let Some(believed) = &mut self.believed else { return };
        if (believed.state.time - self.parted).seconds() < FIRST_LOOK_S {
            return;
        }
        if let Some(image) = believed.state.part(&self.params.errors) {
            self.parted = believed.state.time;
            self.other = Some(Hypothesis { state: image, ..believed.clone() });
            self.report.partings += 1;
        }
    }

    /// Where the tag is; `None` before the start, and where the estimate has left the range of numbers.
    pub fn solution(&self) -> Option<Solution> {
        let Hypothesis { state, gate, cost, .. } = self.believed.as_ref()?;
        if !state.is_finite() {
            return None;
        }
        let mut covariance = SolutionCovariance::zeros();
        covariance.fixed_view_mut::<6, 6>(0, 0).copy_from(&state.motion_covariance());
        if let Some(other) = &self.other {
            let share = 1.0 / (1.0 + libm::exp((other.cost - cost).max(0.0)));
            let away = other.state.place_m() - state.place_m();
            let place = state.place_covariance_m2() * (1.0 - share)
                + (other.state.place_covariance_m2() + away * away.transpose()) * share;
            covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&place);
        }
        let any = Matrix3::identity() * (ANY_ANGLE_RAD * ANY_ANGLE_RAD);
        covariance.fixed_view_mut::<3, 3>(6, 6).copy_from(&any);
        let fresh = self.held.is_some_and(|held| (state.time - held).seconds() <= HELD_S);
        let sure = fresh && !gate.doubts(&self.params.gate);
        Some(Solution {
            time: state.time,
            position_m: state.place_m(),
            velocity_m_s: state.velocity_m_s(),
            attitude: Attitude::identity(),
            covariance,
            quality: if sure { Quality::Fixed } else { Quality::DeadReckoning },
        })
    }

    /// Whether the estimate has left the range of numbers.
    pub fn has_diverged(&self) -> bool {
        self.believed.as_ref().is_some_and(|believed| !believed.state.is_finite())
    }

    /// What became of the ranges so far; without offsets.
    pub fn report(&self) -> &FilterReport {
        &self.report
    }

    /// The last innovation of each anchor, by its number in the list of the site.
    pub(crate) fn last_weighed(&self) -> &LastWeighed {
        &self.weighed
    }

    /// What all ranges read too long.
    pub fn common_offset(&self) -> Option<OffsetFound> {
        self.believed.as_ref().map(|believed| believed.state.common_offset())
    }

    /// What the ranges of the links heard last read too long, all told: anchor by index in the list of the site, tag, offset.
    pub fn offsets(&self) -> impl Iterator<Item = (usize, usize, OffsetFound)> {
        self.believed.iter().flat_map(|believed| believed.state.offsets())
    }
}
