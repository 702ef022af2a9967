//! Steel, cables and magnets: when not to believe the field, and when a strange field has come to stay.
//!
//! A field is judged by its norm and its dip, which do not depend on the heading that it is to correct (after Laidig & Seel
//! 2023, §3.5). A deviation is remembered for a while, the longer the larger it was, because a passing disturbance leaves
//! the norm right for moments.
//!
//! A disturbance that stays would otherwise shut the magnetometer out for good. While the tag turns, two explanations are
//! told apart by the frame in which the field stays the same: fixed to the **place**, it is the field of a new site, whose
//! direction is then measured with the heading of the moment, so that the heading does not jump; fixed to the **body**, it
//! is a new offset (a radio clipped beside the tag). Where neither stays the same, the heading is left to the gyro.

use crate::attitude::params::DisturbanceParams;
use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What one interval says of the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldEvidence {
    /// Mean field in ENU after all corrections, µT.
    pub field_ut: Vector3<f64>,
    /// Field expected there, µT.
    pub expected_ut: Vector3<f64>,
    /// Field expected at the first site, where another has been adopted since, µT.
    pub home_ut: Option<Vector3<f64>>,
    /// Offset that alone would explain the difference, body axes, µT.
    pub offset_ut: Vector3<f64>,
    /// Standard deviation of the field that comes from errors known to the filter, µT.
    pub sigma_ut: f64,
    /// Length of the interval, s.
    pub length_s: f64,
    /// The tag turns fast enough to tell body from place.
    pub turning: bool,
}

/// What to do with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// Use it, with its variance grown by this factor.
    Believe(f64),
    /// Leave it.
    Disturbed,
    /// The field of a new place, ENU, µT.
    NewSite(Vector3<f64>),
    /// The field of the first place is back.
    Home,
    /// A new offset, body axes, µT.
    NewOffset(Vector3<f64>),
}

/// Memory of the judge.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FieldJudge {
    /// Square of the largest deviation in units of what is borne, decaying.
    level: f64,
    /// The same against the first site.
    home_level: f64,
    site: Candidate,
    offset: Candidate,
}

/// A vector that may be constant.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Candidate {
    mean: Vector3<f64>,
    /// Time for which it has been, with the tag turning, s.
    held_s: f64,
    seen: u32,
}

impl Candidate {
    /// Takes a value; the mean once it has been constant for long enough.
    fn observe(
        &mut self,
        value: &Vector3<f64>,
        evidence: &FieldEvidence,
        params: &DisturbanceParams,
    ) -> Option<Vector3<f64>> {
        let deviation = value - self.mean;
        if self.seen == 0 || deviation.norm_squared() > params.adopt_spread_ut * params.adopt_spread_ut {
            *self = Self { mean: *value, held_s: 0.0, seen: 1 };
            return None;
        }
        self.seen = self.seen.saturating_add(1);
        self.mean += deviation / f64::from(self.seen.min(100));
        if evidence.turning {
            self.held_s += evidence.length_s;
        }
        (self.held_s >= params.adopt_after_s).then_some(self.mean)
    }
}

impl FieldJudge {
    /// Judges the field of one interval.
    pub fn judge(&mut self, evidence: &FieldEvidence, params: &DisturbanceParams) -> Verdict {
        let fade = libm::exp(-evidence.length_s / params.memory_s);
        self.level = (self.level * fade).max(deviation(evidence, &evidence.expected_ut, params));
        if let Some(home) = &evidence.home_ut {
            let infinite = self.home_level == 0.0;
            let now = deviation(evidence, home, params);
            // Coming home needs as much patience as any return from a disturbance.
            self.home_level = if infinite { now.max(10.0) } else { (self.home_level * fade).max(now) };
            if self.home_level < 0.5 {
                *self = Self::default();
                return Verdict::Home;
            }
        }
        if self.level < 1.0 {
            self.site = Candidate::default();
            self.offset = Candidate::default();
            return Verdict::Believe(1.0 + params.doubt * self.level);
        }
        let site = self.site.observe(&evidence.field_ut, evidence, params);
        let offset = self.offset.observe(&evidence.offset_ut, evidence, params);
        let verdict = match (site, offset) {
            // Both constant: the tag has turned about the field only.
            (Some(_), Some(_)) | (None, None) => return Verdict::Disturbed,
            (Some(field), None) => Verdict::NewSite(field),
            (None, Some(offset)) => Verdict::NewOffset(offset),
        };
        *self = Self::default();
        verdict
    }

    /// True while the field is not believed.
    pub fn is_disturbed(&self) -> bool {
        self.level >= 1.0
    }
}

/// Square of the deviation of norm and dip, in units of what is borne.
fn deviation(evidence: &FieldEvidence, expected: &Vector3<f64>, params: &DisturbanceParams) -> f64 {
    let (norm, expected_norm) = (length(&evidence.field_ut), length(expected));
    if norm <= 0.0 || expected_norm <= 0.0 {
        return f64::INFINITY;
    }
    let known = 2.0 * evidence.sigma_ut / expected_norm;
    let by_norm = (norm - expected_norm) / (expected_norm * (params.norm_share + known));
    let dip = |field: &Vector3<f64>, norm: f64| libm::asin((-field.z / norm).clamp(-1.0, 1.0));
    let by_dip = (dip(&evidence.field_ut, norm) - dip(expected, expected_norm)) / (params.dip_rad + known);
    by_norm * by_norm + by_dip * by_dip
}

fn length(v: &Vector3<f64>) -> f64 {
    libm::sqrt(v.norm_squared())
}
