//! `uwb-ekf`, `uwb-rkf` and `uwb-aekf`: a tag followed by its ranges, one at a time.
//!
//! ```text
//! ranges → epochs (ranging::listener) → start: robust fits that agree → filter (ranging::filter): predict, weigh, update → a solution an epoch
//! ```
//!
//! The three differ by the weighting of a range ([`crate::ranging::filter::weighting`]): all alike (extended Kalman filter), less the farther off (robust,
//! IGG-III), by variances that follow the innovations (adaptive). No sensor of the tag is needed, and none is used.
//! Frame: that of the anchors, z up. Solutions hold position and velocity with their covariance; the attitude is any.
//! Limits: those of [`crate::ranging::filter`].

mod method;
mod params;

pub use method::UwbFilterReport;
pub use params::{
    Adaptive, Plain, Robust, UwbAekfParams, UwbEkfParams, UwbFilterParams, UwbRkfParams, Variant,
};

use crate::methods::MethodError;
use crate::ranging::epochs::Epoch;
use crate::ranging::filter::{FoundOffset, RangeFilter};
use crate::ranging::listener::RangeListener;
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UwbFilter {
    listener: RangeListener,
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
            listener: RangeListener::new(V::NAME, params.site.as_deref(), params.ranges)?,
            tags: Vec::new(),
            told: None,
            report: UwbFilterReport::default(),
        })
    }

    /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        self.listener.observe(observation);
        self.next_due()
    }

    /// A further solution that the observations so far make due, if any.
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(epoch) = self.listener.pop() {
            let solution = self.take(&epoch)?;
            if solution.is_some() {
                return Ok(solution);
            }
        }
        Ok(None)
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(epoch) = self.listener.finish() {
            let solution = self.take(&epoch)?;
            if solution.is_some() {
                return Ok(solution);
            }
        }
        self.account();
        if self.told.is_none() {
            return Err(self.report.heard.no_position());
        }
        Ok(None)
    }

    /// An epoch: its ranges one after the other, and where the tag is at the last of them.
    fn take(&mut self, epoch: &Epoch) -> Result<Option<Solution>, MethodError> {
        for range in &epoch.ranges {
            if let Some(link) = self.listener.link(range) {
                let tag = self.tag(range.tag.as_ref());
                self.filter.observe(&link, tag);
            }
        }
        if self.filter.has_diverged() {
            return Err(MethodError::Diverged { time: epoch.time() });
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

    fn account(&mut self) {
        let report = &mut self.report;
        report.heard.clone_from(self.listener.heard());
        report.filter.clone_from(self.filter.report());
        report.filter.common_offset = self.filter.common_offset();
        let anchors = self.listener.anchors();
        let named = self.filter.offsets().filter_map(|(index, tag, found)| {
            let tag = self.tags.get(tag).cloned().flatten();
            Some(FoundOffset { anchor: anchors.get(index)?.id.clone(), tag, found })
        });
        report.filter.offsets = named.collect();
        report.filter.offsets.sort_by(|a, b| (&a.anchor, &a.tag).cmp(&(&b.anchor, &b.tag)));
        report.warnings = report.heard.warning().into_iter().collect();
    }

    /// What the run did; of the offsets and of what was heard at its end.
    pub fn report(&self) -> &UwbFilterReport {
        &self.report
    }
}
