//! The ranging half of a method: ranges in, epochs of them to known anchors out, with an account of what was heard.

use super::correction::RangeCorrection;
use super::epochs::{Epoch, EpochParams, Epochs};
use super::{RangeModel, Ranged};
use crate::methods::{MethodError, MethodWarning};
use crate::radio::{RadioSite, SiteAnchor, first_names};
use crate::settings::{first_unusable, positive};
use adit_core::time::Time;
use adit_observation::{DeviceId, Observation, Radio, RangeSample};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Names of unknown anchors kept for the report.
const MOST_NAMES: usize = 100;

/// Which ranges are taken, and what is believed of them where nobody tells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RangesParams {
    /// Only the ranges of this tag, where one carrier wears several; else of all of them.
    pub tag: Option<String>,
    /// What comes within this after a first range is one epoch, s.
    pub epoch_s: f64,
    /// What is late is waited for so long, s.
    pub wait_s: f64,
    /// Standard deviation of a range where neither the device nor a calibration tells, m.
    pub sigma_m: f64,
    /// The same of a range that is judged not to have come straight, m.
    pub nlos_sigma_m: f64,
    /// What every range reads too long, m, beside the offset of its anchor.
    pub offset_m: f64,
}

impl Default for RangesParams {
    fn default() -> Self {
        let EpochParams { epoch_s, wait_s } = EpochParams::default();
        Self { tag: None, epoch_s, wait_s, sigma_m: 0.15, nlos_sigma_m: 1.0, offset_m: 0.0 }
    }
}

impl RangesParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        let own = first_unusable(&[
            ("ranges.sigma_m", positive(self.sigma_m)),
            ("ranges.nlos_sigma_m", positive(self.nlos_sigma_m)),
            ("ranges.offset_m", self.offset_m.is_finite()),
        ]);
        self.epochs().unusable().or(own)
    }

    /// Of both hypotheses, by their probability.
    fn sigma_of(&self, range: &RangeSample) -> f64 {
        let p = range.line_of_sight.unwrap_or(1.0);
        libm::sqrt(p * self.sigma_m * self.sigma_m + (1.0 - p) * self.nlos_sigma_m * self.nlos_sigma_m)
    }

    fn epochs(&self) -> EpochParams {
        EpochParams { epoch_s: self.epoch_s, wait_s: self.wait_s }
    }
}

/// Ranges of a log to the anchors of a site, streaming. Clones share the anchors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RangeListener {
    params: RangesParams,
    /// By id.
    anchors: Arc<[SiteAnchor]>,
    correction: Option<Arc<RangeCorrection>>,
    epochs: Epochs,
    heard: RangesHeard,
}

/// What was heard and what became of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RangesHeard {
    /// Ranges in the log, of the tag and of UWB.
    pub ranges: u64,
    /// Of these, to anchors that the site does not know.
    pub unknown_ranges: u64,
    /// Those anchors, at most the first hundred.
    pub unknown_anchors: Vec<DeviceId>,
    /// Ranges that came after the report of their epoch: left.
    pub late_ranges: u64,
    /// Ranges of which an epoch had too many: left.
    pub left_out_ranges: u64,
    /// Epochs.
    pub epochs: u64,
}

/// A range to an anchor whose place is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// When.
    pub time: Time,
    /// Which anchor, in [`RangeListener::anchors`].
    pub anchor: usize,
    /// Place, model and distance, less what is known that it errs.
    pub ranged: Ranged,
    /// Probability that the signal came straight, where something has judged it.
    pub line_of_sight: Option<f64>,
}

impl Link {
    /// Whether it counts as clear: judged more likely straight than not, or not judged at all.
    pub fn is_clear(&self) -> bool {
        self.line_of_sight.is_none_or(|probability| probability >= 0.5)
    }
}

impl RangeListener {
    /// Nothing heard yet; fails where a setting cannot be worked with, or the site has no anchors.
    pub fn new(
        method: &'static str,
        site: Option<&RadioSite>,
        params: RangesParams,
    ) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method, name });
        }
        let mut anchors = site.map(|site| site.anchors.clone()).unwrap_or_default();
        if anchors.is_empty() {
            return Err(MethodError::NoRadio { method, needs: "the places of the anchors (--mine)" });
        }
        anchors.sort_by(|a, b| a.id.cmp(&b.id));
        let epochs = Epochs::new(params.epochs());
        let correction = site.and_then(|site| site.ranges.clone()).map(Arc::new);
        Ok(Self { params, anchors: anchors.into(), correction, epochs, heard: RangesHeard::default() })
    }

    /// The anchors of the site, by id.
    pub fn anchors(&self) -> &[SiteAnchor] {
        &self.anchors
    }

    /// Takes what belongs to the site from another listener there: one that was read back has copies.
    pub fn share(&mut self, other: &Self) {
        self.anchors = Arc::clone(&other.anchors);
        self.correction.clone_from(&other.correction);
    }

    /// Gives up what belongs to the site, until [`Self::share`].
    pub fn detach(&mut self) {
        self.anchors = Arc::default();
        self.correction = None;
    }

    /// Takes an observation of any kind.
    #[inline]
    pub fn observe(&mut self, observation: &Observation) {
        match observation {
            Observation::Range(range) => self.take(range),
            // What comes by radio may be ahead of the tag's clock.
            other if other.kind().is_wired() => self.epochs.advance(other.time()),
            _ => {}
        }
    }

    fn take(&mut self, range: &RangeSample) {
        let RangesParams { tag, .. } = &self.params;
        let of_tag = tag.is_none() || tag.as_deref() == range.tag.as_ref().map(DeviceId::as_str);
        if !of_tag || !matches!(range.radio, Radio::Uwb | Radio::Unknown) {
            return;
        }
        self.heard.ranges += 1;
        if self.anchor(range.anchor.as_str()).is_none() {
            self.heard.unknown_ranges += 1;
            let unknown = &mut self.heard.unknown_anchors;
            if unknown.len() < MOST_NAMES && !unknown.contains(&range.anchor) {
                unknown.push(range.anchor.clone());
            }
            return;
        }
        self.epochs.observe(range);
        self.heard.late_ranges = self.epochs.late();
        self.heard.left_out_ranges = self.epochs.left_out();
    }

    fn anchor(&self, id: &str) -> Option<usize> {
        self.anchors.binary_search_by(|anchor| anchor.id.as_str().cmp(id)).ok()
    }

    /// The next epoch that is complete, if any.
    pub fn pop(&mut self) -> Option<Epoch> {
        let epoch = self.epochs.pop()?;
        self.heard.epochs += 1;
        Some(epoch)
    }

    /// After the last observation: what is left, one epoch after the other.
    pub fn finish(&mut self) -> Option<Epoch> {
        let epoch = self.epochs.finish()?;
        self.heard.epochs += 1;
        Some(epoch)
    }

    /// A range as its anchor's place and model have it; `None` of an anchor that is not known.
    pub fn link(&self, range: &RangeSample) -> Option<Link> {
        let index = self.anchor(range.anchor.as_str())?;
        let anchor = self.anchors.get(index)?;
        let (range_m, calibrated_m) = match &self.correction {
            Some(correction) => {
                let corrected = correction.correct(range);
                (corrected.distance_m, Some(corrected.sigma_m))
            }
            None => (range.range_m - anchor.range_offset_m, None),
        };
        let model = RangeModel {
            offset_m: self.params.offset_m,
            scale: 1.0,
            sigma_m: range.sigma_m.or(calibrated_m).unwrap_or_else(|| self.params.sigma_of(range)),
        };
        Some(Link {
            time: range.time,
            anchor: index,
            ranged: Ranged { position_m: anchor.position_m, model, range_m },
            line_of_sight: range.line_of_sight,
        })
    }

    /// What was heard so far.
    pub fn heard(&self) -> &RangesHeard {
        &self.heard
    }
}

impl RangesHeard {
    /// The first names of unknown anchors.
    fn names(&self) -> String {
        first_names(&self.unknown_anchors)
    }

    /// What to say where ranges were to unknown anchors.
    pub fn warning(&self) -> Option<MethodWarning> {
        (self.unknown_ranges > 0).then(|| MethodWarning::UnknownAnchors {
            anchors: self.unknown_anchors.len(),
            ranges: self.unknown_ranges,
            names: self.names(),
        })
    }

    /// Why there was no position at all.
    pub fn no_position(&self) -> MethodError {
        let names = self.names();
        let names = if names.is_empty() { names } else { alloc::format!(" ({names})") };
        MethodError::NoRangeFix { ranges: self.ranges, unknown: self.unknown_ranges, names }
    }
}
