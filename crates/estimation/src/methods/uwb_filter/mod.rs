//! `uwb-ekf`, `uwb-rkf` and `uwb-aekf`: a tag followed by its ranges, one at a time.
//!
//! ```text
//! ranges → epochs (ranging::listener) → start: robust fits that agree → filter (ranging::filter): predict, weigh, update → a solution an epoch
//! steps  → way (methods::pdr), where the settings have them ── aligned (methods::alignment) ── predict ┘
//! ```
//!
//! The three differ by the weighting of a range ([`crate::ranging::filter::weighting`]): all alike (extended Kalman filter), less the farther off (robust,
//! IGG-III), by variances that follow the innovations (adaptive). No sensor of the tag is needed, and none is used but where `steps` is set.
//! Frame: that of the anchors, z up. Solutions hold position and velocity with their covariance; the attitude is any.
//! Limits: those of [`crate::ranging::filter`].

mod method;
mod params;

pub use method::UwbFilterReport;
pub use params::{
    Adaptive, Plain, Robust, UwbAekfParams, UwbEkfParams, UwbFilterParams, UwbRkfParams, Variant,
};

use crate::methods::MethodError;
use crate::methods::alignment::{Alignment, Event};
use crate::ranging::epochs::Epoch;
use crate::ranging::filter::{FoundOffset, RangeFilter};
use crate::ranging::listener::RangeListener;
use crate::weighed::SourceWeighed;
use adit_core::nalgebra::Vector2;
use adit_core::solution::{Quality, Solution};
use adit_core::time::{Interval, Time};
use adit_observation::{DeviceId, Observation};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Stamps are not later than this, s.
const MOST_LATENCY_S: f64 = 60.0;
/// Tags on one carrier that are told apart.
const MOST_TAGS: usize = 8;

/// One tag, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct UwbFilter {
    alignment: Alignment,
    /// Where dead reckoning was when the filter was last told.
    way_m: Option<Vector2<f64>>,
    filter: RangeFilter,
    latency: Interval,
    /// The tags of the carrier, at most [`MOST_TAGS`].
    tags: Vec<Option<DeviceId>>,
    /// Time of the last solution.
    told: Option<Time>,
    report: UwbFilterReport,
}

impl UwbFilter {
    /// A tag that has measured nothing.
    pub fn new<V: Variant>(params: UwbFilterParams<V>) -> Result<Self, MethodError> {
        let unusable = |name| MethodError::Setting { method: V::NAME, name };
        let latency = Some(params.latency_s).filter(|latency_s| latency_s.abs() <= MOST_LATENCY_S);
        let latency = latency.and_then(Interval::from_seconds);
        Ok(Self {
            latency: latency.ok_or_else(|| unusable("latency_s"))?,
            filter: RangeFilter::new(params.filter, params.weighting).map_err(unusable)?,
            alignment: Alignment::new(
                RangeListener::new(V::NAME, params.site.as_deref(), params.ranges)?,
                params.steps,
            )?,
            way_m: None,
            tags: Vec::new(),
            told: None,
            report: UwbFilterReport::default(),
        })
    }

    /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        self.alignment.observe(observation)?;
        self.next_due()
    }

    /// A further solution that the observations so far make due, if any.
    #[inline]
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(event) = self.alignment.pop() {
            let solution = match event {
                Event::Reckoned(now) => self.walk(&now)?,
                Event::Ranges(epoch, way_m) => self.take(&epoch, way_m)?,
            };
            if solution.is_some() {
                return Ok(solution);
            }
        }
        Ok(None)
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        self.alignment.finish()?;
        let solution = self.next_due()?;
        if solution.is_none() {
            self.account();
            if self.told.is_none() {
                return Err(self.report.heard.no_position());
            }
        }
        Ok(solution)
    }

    /// Dead reckoning has come to a place: so has the tag.
    fn walk(&mut self, now: &Solution) -> Result<Option<Solution>, MethodError> {
        let way_m = now.position_m.xy();
        self.follow(way_m, now.time);
        self.tell(now.time)
    }

    fn follow(&mut self, way_m: Vector2<f64>, to: Time) {
        if let Some(before_m) = self.way_m.replace(way_m) {
            self.filter.propagate_by(&(way_m - before_m), to);
        }
    }

    /// An epoch: its ranges one after the other, and where the tag is at the last of them.
    fn take(&mut self, epoch: &Epoch, way_m: Option<Vector2<f64>>) -> Result<Option<Solution>, MethodError> {
        let time = epoch.time();
        if let Some(way_m) = way_m {
            self.follow(way_m, time);
        }
        for range in &epoch.ranges {
            if let Some(mut link) = self.alignment.listener().link(range) {
                if way_m.is_some() {
                    // Steps tell where one is at the time of the epoch, not within it.
                    link.time = time;
                }
                let tag = self.tag(range.tag.as_ref());
                self.filter.observe(&link, tag);
            }
        }
        self.report.filter.clone_from(self.filter.report());
        self.tell(time)
    }

    /// The state as a solution, where it is later than the last.
    fn tell(&mut self, time: Time) -> Result<Option<Solution>, MethodError> {
        if self.filter.has_diverged() {
            return Err(MethodError::Diverged { time });
        }
        let Some(mut solution) = self.filter.solution() else { return Ok(None) };
        if self.told.is_some_and(|told| solution.time <= told) {
            return Ok(None);
        }
        self.told = Some(solution.time);
        self.report.solutions += 1;
        self.report.unsure_solutions += u64::from(solution.quality != Quality::Fixed);
        self.report.radius_95_sum_m += solution.radius_95_m();
        solution.time = solution.time - self.latency;
        Ok(Some(solution))
    }

    /// Number of a tag; those past the last that are counted share its number.
    fn tag(&mut self, id: Option<&DeviceId>) -> usize {
        let known = self.tags.iter().position(|known| known.as_ref() == id);
        known.unwrap_or_else(|| {
            if self.tags.len() < MOST_TAGS {
                self.tags.push(id.cloned());
            }
            self.tags.len() - 1
        })
    }

    /// The last innovation of each anchor.
    pub fn last_weighed(&self) -> Vec<SourceWeighed> {
        let anchors = self.alignment.listener().anchors();
        self.filter
            .last_weighed()
            .named(|_, number| anchors.get(number).map(|anchor| anchor.id.clone()).into_iter().collect())
    }

    fn account(&mut self) {
        let report = &mut self.report;
        report.heard.clone_from(self.alignment.listener().heard());
        report.steps = self.alignment.pdr().cloned();
        report.filter.clone_from(self.filter.report());
        report.filter.common_offset = self.filter.common_offset();
        let anchors = self.alignment.listener().anchors();
        let named = self.filter.offsets().filter_map(|(index, tag, found)| {
            let tag = self.tags.get(tag).cloned().flatten();
            Some(FoundOffset { anchor: anchors.get(index)?.id.clone(), tag, found })
        });
        report.filter.offsets = named.collect();
        report.filter.offsets.sort_by(|a, b| (&a.anchor, &a.tag).cmp(&(&b.anchor, &b.tag)));
        report.warnings = report.heard.warning().into_iter().collect();
        report.warnings.extend(report.steps.iter().flat_map(|steps| steps.warnings.clone()));
    }

    /// What the run did so far; offsets and what was heard are told at its end.
    pub fn report(&self) -> &UwbFilterReport {
        &self.report
    }
}
