//! When a magnetic field is the Earth's, and how far its direction can be off.
//!
//! Steel, cables and motors add a field `d` to the Earth's. Its parts along the field and in the dip show as a wrong
//! norm and a wrong dip against a reference `N₀, I₀` (Afzal, Renaudin & Lachapelle 2011 use the same two):
//!
//! ```text
//! d̂² = (N − N₀)² + (N₀ (I − I₀))²
//! ```
//!
//! The third part, across the meridian, turns the heading by `d_e / H` and shows in neither: with `H = 20 µT` and a dip of
//! 66°, 11 µT to the east turn the heading by 29° and the dip by 3°. Three things stand against it:
//! 1. its size is taken to be that of the two seen, `E[d_e²] = d̂²/2` (no direction of `d` is likelier than another), so
//!    that a field that is a little off counts less long before it is refused ([`MagneticGate::across_ut`]); and a reading
//!    that looks good counts no more than its surroundings allow: the mean of `d̂²` over the last 10 m is its least;
//! 2. beyond `norm_share` or `dip_rad` the field is refused, until it has been within 0.7 of both for `settle_s`;
//! 3. the caller compares the heading with the gyro's, which knows the last minutes to a degree, and says whether they agreed
//!    ([`MagneticGate::note`]).
//!
//! # No lock-out, and no wrong lesson
//! The Earth's field is the same over hundreds of metres, that of steel changes within a few. So a field is believed by the
//! distance over which it has been seen steady. One that is refused becomes the reference, and the heading is opened to it,
//! when norm, dip and offset from the gyro's heading have been steady over `relearn_m` of walking and over more than the
//! reference itself was confirmed for. A start beside steel is so corrected after some metres; a car that stands beside a
//! resting walker for an hour, or a long steel-lined roadway after a good start, teaches nothing. Time alone never does.
//! A reference that was given (not learnt) is never replaced.

use crate::magnetic::heading::LevelField;
use adit_core::attitude::angle_difference;
use serde::{Deserialize, Serialize};

/// Norms that the Earth's field has somewhere at its surface, µT (WMM 2025: 22 to 67), with the scale errors of a sensor.
const EARTH_UT: core::ops::RangeInclusive<f64> = 18.0..=75.0;
/// Distance over which the disturbance of the surroundings is averaged, m.
const SURROUNDINGS_M: f64 = 10.0;
/// Share of the limits within which a disturbed field has to be to count as good again.
const RETURN: f64 = 0.7;
/// Share of the limits within which a field is steady.
const STEADY: f64 = 0.5;

/// Norm and dip of the undisturbed field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceField {
    /// Norm, µT.
    pub norm_ut: f64,
    /// Angle below the horizontal, rad.
    pub dip_rad: f64,
}

/// Limits of the gate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MagneticGateParams {
    /// Largest deviation of the norm, as a share of it.
    pub norm_share: f64,
    /// Largest deviation of the dip, rad.
    pub dip_rad: f64,
    /// Time within the limits after which a field that was disturbed is believed again, s.
    pub settle_s: f64,
    /// Largest change of the offset between magnetic and gyro heading over which a field counts as steady, rad.
    pub steady_heading_rad: f64,
    /// Distance over which a refused field has to be steady to be believed after all, m.
    pub relearn_m: f64,
}

impl Default for MagneticGateParams {
    fn default() -> Self {
        Self { norm_share: 0.08, dip_rad: 0.087, settle_s: 2.0, steady_heading_rad: 0.087, relearn_m: 15.0 }
    }
}

/// A field seen once: the mean of a stance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// The field in the level frame of the estimate.
    pub field: LevelField,
    /// Magnetic heading minus heading of the estimate, rad.
    pub heading_offset_rad: f64,
    /// Distance walked since the start, m.
    pub walked_m: f64,
    /// Time since the sighting before, s.
    pub interval_s: f64,
}

/// A refused field that may be the right one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Candidate {
    norm_ut: f64,
    dip_rad: f64,
    heading_offset_rad: f64,
    count: u32,
    since_m: f64,
}

/// The gate and what it has learnt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MagneticGate {
    params: MagneticGateParams,
    reference: Option<ReferenceField>,
    given: bool,
    disturbed: bool,
    /// Time within the limits since the last sighting beyond them, s.
    settled_s: f64,
    /// Distance over which field and heading have agreed with the reference, m.
    confirmed_m: f64,
    last_walked_m: f64,
    /// Mean of `d̂²` over the surroundings, µT².
    surroundings_ut2: f64,
    candidate: Option<Candidate>,
}

impl MagneticGate {
    /// A gate with a reference that is known, or to be learnt.
    pub fn new(params: MagneticGateParams, reference: Option<ReferenceField>) -> Self {
        Self {
            params,
            given: reference.is_some(),
            reference,
            disturbed: false,
            settled_s: 0.0,
            confirmed_m: 0.0,
            last_walked_m: 0.0,
            surroundings_ut2: 0.0,
            candidate: None,
        }
    }

    /// The field taken to be the Earth's.
    pub fn reference(&self) -> Option<ReferenceField> {
        self.reference
    }

    /// Shows the field at the start, which is disturbed when it cannot be the Earth's, or not that of the reference.
    ///
    /// Without a reference it becomes the reference, for want of a better one.
    pub fn start(&mut self, field: &LevelField) {
        if self.reference.is_none() && EARTH_UT.contains(&field.norm_ut) {
            self.reference = Some(ReferenceField { norm_ut: field.norm_ut, dip_rad: field.dip_rad });
        }
        self.disturbed = !self.within(field, 1.0);
    }

    /// True while the field is refused.
    pub fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// Whether this field is to be believed.
    pub fn judge(&mut self, sighting: &Sighting) -> bool {
        if !self.within(&sighting.field, 1.0) {
            self.disturbed = true;
            self.settled_s = 0.0;
        } else if self.disturbed {
            let inside = self.within(&sighting.field, RETURN);
            self.settled_s = if inside { self.settled_s + sighting.interval_s } else { 0.0 };
            self.disturbed = self.settled_s < self.params.settle_s;
        }
        !self.disturbed
    }

    /// Hears whether the sighting was believed and agreed with the gyro's heading.
    ///
    /// Returns the offset of the heading when a refused field has proven to be the right one: the heading of the estimate
    /// is then off by about so much.
    pub fn note(&mut self, sighting: &Sighting, agreed: bool) -> Option<f64> {
        let walked_m = sighting.walked_m - core::mem::replace(&mut self.last_walked_m, sighting.walked_m);
        // By distance, not time: a place seen for an hour is one place.
        let share = 1.0 - libm::exp(-walked_m / SURROUNDINGS_M);
        self.surroundings_ut2 += (self.seen_ut2(&sighting.field) - self.surroundings_ut2) * share;
        if agreed {
            self.confirmed_m += walked_m;
            self.candidate = None;
            return None;
        }
        let candidate = self.follow(sighting);
        let steady_m = sighting.walked_m - candidate.since_m;
        let reference = ReferenceField { norm_ut: candidate.norm_ut, dip_rad: candidate.dip_rad };
        let same_field = self.near(&reference, 1.0);
        let needed_m = if same_field { 0.0 } else { self.confirmed_m };
        if steady_m < self.params.relearn_m.max(needed_m) || (self.given && !same_field) {
            return None;
        }
        if !self.given {
            self.reference = Some(reference);
        }
        self.disturbed = false;
        self.surroundings_ut2 = 0.0;
        self.confirmed_m = steady_m;
        self.candidate = None;
        Some(candidate.heading_offset_rad)
    }

    /// Standard deviation of the part of a disturbance that neither norm nor dip shows, µT.
    ///
    /// The sensor itself is off by `sensor_sigma_ut` an axis in this attitude and was so in that of the reference: of `d̂²`,
    /// four times its square is no disturbance.
    pub fn across_ut(&self, field: &LevelField, sensor_sigma_ut: f64) -> f64 {
        let seen_ut2 = self.seen_ut2(field).max(self.surroundings_ut2);
        libm::sqrt(0.5 * (seen_ut2 - 4.0 * sensor_sigma_ut * sensor_sigma_ut).max(0.0))
    }

    /// `d̂²`: what norm and dip show of a disturbance, µT²; all of the field while there is no reference.
    fn seen_ut2(&self, field: &LevelField) -> f64 {
        let Some(reference) = self.reference else { return field.norm_ut * field.norm_ut };
        let norm = field.norm_ut - reference.norm_ut;
        let dip = reference.norm_ut * angle_difference(field.dip_rad, reference.dip_rad);
        norm * norm + dip * dip
    }

    /// Adds a refused sighting to the candidate, or begins a new one with it.
    fn follow(&mut self, sighting: &Sighting) -> Candidate {
        let LevelField { norm_ut, dip_rad, .. } = sighting.field;
        let steady = |c: &Candidate| {
            (norm_ut - c.norm_ut).abs() <= STEADY * self.params.norm_share * c.norm_ut
                && (dip_rad - c.dip_rad).abs() <= STEADY * self.params.dip_rad
                && angle_difference(sighting.heading_offset_rad, c.heading_offset_rad).abs()
                    <= self.params.steady_heading_rad
        };
        let candidate = match self.candidate.filter(steady) {
            Some(c) => {
                let count = c.count.saturating_add(1);
                let share = 1.0 / f64::from(count);
                Candidate {
                    norm_ut: c.norm_ut + (norm_ut - c.norm_ut) * share,
                    dip_rad: c.dip_rad + (dip_rad - c.dip_rad) * share,
                    heading_offset_rad: c.heading_offset_rad
                        + angle_difference(sighting.heading_offset_rad, c.heading_offset_rad) * share,
                    count,
                    since_m: c.since_m,
                }
            }
            None => Candidate {
                norm_ut,
                dip_rad,
                heading_offset_rad: sighting.heading_offset_rad,
                count: 1,
                since_m: sighting.walked_m,
            },
        };
        self.candidate = Some(candidate);
        candidate
    }

    fn within(&self, field: &LevelField, share: f64) -> bool {
        self.near(&ReferenceField { norm_ut: field.norm_ut, dip_rad: field.dip_rad }, share)
    }

    /// Whether a field is within a share of the limits around the reference.
    fn near(&self, field: &ReferenceField, share: f64) -> bool {
        self.reference.is_some_and(|reference| {
            let norm_ut = (field.norm_ut - reference.norm_ut).abs();
            let dip_rad = angle_difference(field.dip_rad, reference.dip_rad).abs();
            norm_ut <= share * self.params.norm_share * reference.norm_ut
                && dip_rad <= share * self.params.dip_rad
        })
    }
}
