//! Places by robust fits that agree, for a start and for a filter that is lost.
//!
//! What is heard in a window makes one [`fit`] with its mirror image. Fits are in a row as long as each is where a person can have come
//! to from the one before it, and explains most of its ranges.

use super::params::FilterParams;
use super::state::OffsetFound;
use crate::ranging::fit::{FitParams, fit};
use crate::ranging::listener::Link;
use crate::ranging::{Height, RangeModel, Ranged, RangingFix};
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::Time;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Ranges of a window at most; of more, the newest.
const MOST: usize = 32;
/// Share of the ranges of a window that a fit has to explain: most of them.
const EXPLAINED: f64 = 0.55;
/// Share of them by which one place is clearly better than another.
const CLEARLY: f64 = 0.2;
/// Standard deviations within which a range is explained.
const WITHIN: f64 = 3.0;

/// A range of the window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Heard {
    time: Time,
    anchor: usize,
    position_m: Vector3<f64>,
    model: RangeModel,
    range_m: f64,
}

/// Where to start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
    pub time: Time,
    pub place_m: Vector3<f64>,
    pub covariance_m2: Matrix3<f64>,
    /// The mirror image.
    pub other_m: Option<Vector3<f64>>,
    /// Ranges of the window that the place explains.
    explained: usize,
}

/// The window and the fits so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Starter {
    heard: Vec<Heard>,
    last: Option<(Time, RangingFix)>,
    agreeing: u32,
}

impl Starter {
    /// Takes a range; it is kept as long as a window.
    pub fn hear(&mut self, link: &Link, params: &FilterParams) {
        let since = |one: &Heard| (link.time - one.time).seconds();
        self.heard.retain(|one| since(one) < params.start.window_s);
        if self.heard.len() >= MOST {
            self.heard.remove(0);
        }
        let Ranged { position_m, model, range_m } = link.ranged;
        self.heard.push(Heard { time: link.time, anchor: link.anchor, position_m, model, range_m });
    }

    /// Forgets the fits so far.
    pub fn reset(&mut self) {
        self.last = None;
        self.agreeing = 0;
    }

    /// By what all ranges are off is what is known of it. A fit of the window, not more than one in a third of it; a start where enough of them agree.
    pub fn look(&mut self, common: OffsetFound, params: &FilterParams) -> Option<Start> {
        let now = self.heard.last()?.time;
        if self.last.is_some_and(|(then, _)| (now - then).seconds() < params.start.window_s / 3.0) {
            return None;
        }
        let ranges = self.ranges(common, params);
        let fresh = self.fit(&ranges, params);
        let agrees = match (&fresh, &self.last) {
            (Some(fresh), Some((then, before))) => {
                let reach = 3.0 * params.motion.speed_m_s * (now - *then).seconds();
                [Some(before.position_m), before.other_m].into_iter().flatten().any(|place| {
                    let sigma = libm::sqrt(fresh.covariance_m2.trace().min(before.covariance_m2.trace()));
                    (fresh.position_m - place).norm() < reach + WITHIN * sigma
                })
            }
            _ => false,
        };
        self.agreeing = if fresh.is_some() { if agrees { self.agreeing + 1 } else { 1 } } else { 0 };
        self.last = fresh.map(|fix| (now, fix));
        let fix = fresh.filter(|_| self.agreeing >= params.start.agreeing_fits)?;
        let own = params.start.sigma_m * params.start.sigma_m;
        Some(Start {
            time: now,
            place_m: fix.position_m,
            // Of two places the second moment holds the way between them; each alone is about as sure as people are fast.
            covariance_m2: match fix.other_m {
                Some(_) => Matrix3::identity() * own,
                None => fix.covariance_m2 + Matrix3::identity() * own,
            },
            other_m: fix.other_m,
            explained: explained(&ranges, &fix.position_m),
        })
    }

    /// Whether a start explains clearly more of the window than another place does.
    pub fn is_better(
        &self,
        start: &Start,
        place_m: &Vector3<f64>,
        common: OffsetFound,
        params: &FilterParams,
    ) -> bool {
        let ranges = self.ranges(common, params);
        let gain = start.explained as f64 - explained(&ranges, place_m) as f64;
        gain >= CLEARLY * ranges.len() as f64
    }

    /// The window, each range with all that it may be off by.
    fn ranges(&self, common: OffsetFound, params: &FilterParams) -> Vec<Ranged> {
        let errors = &params.errors;
        let sigmas = [errors.passing_sigma_m, errors.anchor_offset_sigma_m, common.sigma_m];
        let beside = sigmas.iter().map(|sigma| sigma * sigma).sum::<f64>();
        let ranged = |one: &Heard| {
            let sigma_m = libm::sqrt(one.model.sigma_m * one.model.sigma_m + beside);
            let offset_m = one.model.offset_m + one.model.scale * common.offset_m;
            let model = RangeModel { offset_m, sigma_m, ..one.model };
            Ranged { position_m: one.position_m, model, range_m: one.range_m }
        };
        self.heard.iter().map(ranged).collect()
    }

    fn fit(&self, ranges: &[Ranged], params: &FilterParams) -> Option<RangingFix> {
        let anchors = self
            .heard
            .iter()
            .enumerate()
            .filter(|(at, one)| self.heard[..*at].iter().all(|other| other.anchor != one.anchor));
        let (count, height) =
            anchors.fold((0_usize, 0.0), |(count, sum), (_, one)| (count + 1, sum + one.position_m.z));
        if count < params.start.least_anchors {
            return None;
        }
        let mean_m = params.height.mean_m(Some(height / count as f64))?;
        let height = Height::Near { mean_m, sigma_m: params.height.told_sigma_m() };
        let fix = fit(ranges, None, &FitParams { height, ..FitParams::default() })?;
        (explained(ranges, &fix.position_m) as f64 >= EXPLAINED * ranges.len() as f64).then_some(fix)
    }
}

/// How many ranges a place explains.
fn explained(ranges: &[Ranged], place_m: &Vector3<f64>) -> usize {
    let explains = |one: &&Ranged| {
        let off = (place_m - one.position_m).norm() - one.distance_m().0;
        off.abs() < WITHIN * one.model.sigma_m
    };
    ranges.iter().filter(explains).count()
}
