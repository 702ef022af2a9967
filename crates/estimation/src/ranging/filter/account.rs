//! What a filter says about its run.

use super::gate::Verdict;
use super::{OffsetFound, Taken};
use adit_observation::DeviceId;
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// What became of the ranges, and what was found out.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FilterReport {
    /// Ranges that counted.
    pub used: u64,
    /// Of these, with less than half of their weight.
    pub weighed_down: u64,
    /// Of these, beyond the gate but within the widened one.
    pub relaxed: u64,
    /// Ranges that did not count.
    pub refused: u64,
    /// Ranges before the start.
    pub before_start: u64,
    /// Ranges older than the filter looks back.
    pub too_old: u64,
    /// Times that the filter was lost and began anew where robust fits agreed.
    pub recovered: u64,
    /// Starts, and new ones, with a mirror image that explained the ranges as well at first.
    pub ambiguous_starts: u64,
    /// Times that the estimate lay across the mirror of its anchors and both sides were followed.
    pub partings: u64,
    /// Times that the mirror image proved the likelier one.
    pub other_sides: u64,
    /// Sum of the normalised innovations squared of the ranges that counted in full: χ² with as many degrees of freedom.
    pub nis_sum: f64,
    /// How many.
    pub nis_count: u64,
    /// What all ranges read too long, at the end.
    pub common_offset: Option<OffsetFound>,
    /// What the ranges of each link that was heard last read too long, all told.
    pub offsets: Vec<FoundOffset>,
}

/// Offset of a link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FoundOffset {
    /// Id of the anchor.
    pub anchor: String,
    /// Id of the tag, where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tag: Option<DeviceId>,
    /// What its ranges read too long, all told.
    #[serde(flatten)]
    pub found: OffsetFound,
}

impl FilterReport {
    pub(super) fn count(&mut self, verdict: Verdict, taken: &Taken) {
        match verdict {
            Verdict::Refused => {
                self.refused += 1;
                return;
            }
            Verdict::Relaxed => self.relaxed += 1,
            Verdict::Taken if taken.weight < 0.5 => self.weighed_down += 1,
            Verdict::Taken => {}
        }
        self.used += 1;
        if verdict == Verdict::Taken && taken.weight >= 1.0 {
            self.nis_sum += taken.innovation_m * taken.innovation_m / taken.variance_m2;
            self.nis_count += 1;
        }
    }
}
