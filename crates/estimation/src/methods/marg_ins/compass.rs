//! The magnetometer of a foot: readings wait for their inertial sample, and a stance makes one heading of them.

use super::params::{GateKind, MargInsParams};
use crate::magnetic::gate::{MagneticGate, ReferenceField, Sighting};
use crate::magnetic::heading::LevelField;
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_observation::MagneticSample;
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Heading of which nothing is known, standard deviation, rad: as much as a linear update can carry.
pub(crate) const UNKNOWN_HEADING_RAD: f64 = 1.0;
/// Readings wait no longer than this; the detector delays samples by less.
const LONGEST_WAIT_S: i64 = 30;
/// A stance ends when the foot has moved for this long, s.
const SWING_S: f64 = 0.15;
/// Time between two headings of a foot that stays where it is, s.
const AGAIN_S: f64 = 0.5;

/// Readings on their way to a heading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compass {
    waiting: VecDeque<MagneticSample>,
    /// The newest reading that is due, for a filter that begins in motion.
    latest: Option<MagneticSample>,
    /// Sum of the levelled readings of this stance, µT, their number, and the time since the first, s.
    sum_ut: Vector3<f64>,
    count: u32,
    gathered_s: f64,
    since_sighting_s: f64,
    /// Time since the foot stood, and since this stance began, s.
    moving_s: f64,
    still_s: f64,
    sighted_in_stance: bool,
    /// Distance walked from stance to stance, m, and the last place.
    walked_m: f64,
    place_m: Vector3<f64>,
    /// Where the last heading was used.
    used_at_m: Option<Vector3<f64>>,
    gate: MagneticGate,
    figures: CompassFigures,
}

/// What became of the headings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompassFigures {
    /// Headings measured in stance.
    pub headings: u64,
    /// Of these, used.
    pub used: u64,
    /// Of these, refused for norm or dip.
    pub disturbed: u64,
    /// Of these, refused for disagreeing with the gyro.
    pub disagreed: u64,
    /// Times at which a refused field proved right and the heading was opened to it.
    pub reopened: u64,
}

impl Compass {
    pub fn new(params: &MargInsParams) -> Self {
        let h = &params.heading;
        Self {
            waiting: VecDeque::new(),
            latest: None,
            sum_ut: Vector3::zeros(),
            count: 0,
            gathered_s: 0.0,
            since_sighting_s: 0.0,
            moving_s: 0.0,
            still_s: 0.0,
            sighted_in_stance: false,
            walked_m: 0.0,
            place_m: Vector3::zeros(),
            used_at_m: None,
            gate: MagneticGate::new(h.disturbance.clone(), h.reference),
            figures: CompassFigures::default(),
        }
    }

    pub fn push(&mut self, magnetic: MagneticSample) {
        self.waiting.push_back(magnetic);
        let oldest = magnetic.time - Interval::from_nanos(LONGEST_WAIT_S * 1_000_000_000);
        while self.waiting.front().is_some_and(|first| first.time < oldest) {
            self.waiting.pop_front();
        }
    }

    pub fn figures(&self) -> CompassFigures {
        self.figures
    }

    pub fn reference(&self) -> Option<ReferenceField> {
        self.gate.reference()
    }

    pub fn heap_bytes(&self) -> usize {
        self.waiting.capacity() * size_of::<MagneticSample>()
    }

    /// Takes the field of the alignment; returns the standard deviation of its heading, rad.
    ///
    /// Of a field that is refused nothing is believed.
    pub fn start(&mut self, field: &LevelField, tilt_sigma_rad: f64, params: &MargInsParams) -> f64 {
        self.gate.start(field);
        self.used_at_m = Some(Vector3::zeros());
        if self.gate.is_disturbed() && params.magnetic_gate == GateKind::Disturbance {
            return UNKNOWN_HEADING_RAD;
        }
        self.sigma_rad(field, tilt_sigma_rad, params).min(UNKNOWN_HEADING_RAD)
    }

    /// True once a field has been seen at the start or in a stance.
    pub fn is_started(&self) -> bool {
        self.used_at_m.is_some()
    }

    /// True while the gate keeps the field out.
    pub fn is_disturbed(&self) -> bool {
        self.gate.is_disturbed()
    }

    /// The newest reading up to a time, body frame, µT.
    pub fn reading(&mut self, time: Time) -> Option<Vector3<f64>> {
        self.due(time, |_| ());
        self.latest.map(|magnetic| magnetic.field_ut)
    }

    /// Takes the readings up to the time of a sample; in stance they are put into the `level` frame and gathered.
    pub fn gather(
        &mut self,
        time: Time,
        interval_s: f64,
        still: bool,
        level: impl Fn(&Vector3<f64>) -> Vector3<f64>,
        settle_s: f64,
    ) {
        self.since_sighting_s += interval_s;
        let (mut sum_ut, mut count) = (Vector3::zeros(), 0);
        self.due(time, |magnetic| {
            sum_ut += level(&magnetic.field_ut);
            count += 1;
        });
        if !still {
            self.moving_s += interval_s;
            if self.moving_s > SWING_S {
                self.forget();
                self.still_s = 0.0;
                self.sighted_in_stance = false;
            }
            return;
        }
        self.moving_s = 0.0;
        self.still_s += interval_s;
        if self.still_s < settle_s {
            return;
        }
        self.sum_ut += sum_ut;
        self.count += count;
        self.gathered_s += interval_s;
    }

    /// The heading of this stance, when enough has been gathered and another is due.
    pub fn sight(&mut self, params: &MargInsParams, position_m: &Vector3<f64>) -> Option<Sighting> {
        let naive = params.magnetic_gate == GateKind::None;
        let wait_s = if self.sighted_in_stance && !naive { AGAIN_S } else { params.heading.average_s };
        if self.count == 0 || self.gathered_s < wait_s {
            return None;
        }
        let field = LevelField::new(&(self.sum_ut / f64::from(self.count)));
        self.forget();
        self.walked_m += libm::sqrt((position_m - self.place_m).xy().norm_squared());
        self.place_m = *position_m;
        self.sighted_in_stance = true;
        let interval_s = core::mem::take(&mut self.since_sighting_s);
        let field = field.filter(|field| field.horizontal_ut > 0.0)?;
        self.figures.headings += 1;
        let heading_offset_rad = field.heading_offset_rad(params.declination_rad);
        Some(Sighting { field, heading_offset_rad, walked_m: self.walked_m, interval_s })
    }

    /// Whether norm and dip let the field pass.
    pub fn judge(&mut self, sighting: &Sighting) -> bool {
        let good = self.gate.judge(sighting);
        self.figures.disturbed += u64::from(!good);
        good
    }

    /// Standard deviation with which a heading counts, rad; `None` when it says nothing new.
    ///
    /// `predicted` is the variance of its difference from the estimate without its own noise, rad².
    ///
    /// The field of one place, seen again and again, brings the heading to the certainty of that field and no further.
    pub fn news_sigma_rad(
        &self,
        position_m: &Vector3<f64>,
        predicted: f64,
        sigma_rad: f64,
        params: &MargInsParams,
    ) -> Option<f64> {
        if self.is_new(position_m, params) {
            return Some(sigma_rad);
        }
        let variance = sigma_rad * sigma_rad;
        let gained = predicted - variance;
        (gained > 0.0).then(|| libm::sqrt(variance * predicted / gained))
    }

    /// Whether this is another place than that of the last heading that was used.
    pub fn is_new(&self, position_m: &Vector3<f64>, params: &MargInsParams) -> bool {
        let place_m = params.heading.place_m;
        self.used_at_m.is_none_or(|used| (position_m - used).norm_squared() >= place_m * place_m)
    }

    /// Hears what became of a heading; returns the offset of the estimate when a refused field has proven right.
    pub fn note(&mut self, sighting: &Sighting, outcome: Outcome, position_m: &Vector3<f64>) -> Option<f64> {
        match outcome {
            Outcome::Used => {
                self.figures.used += 1;
                self.used_at_m = Some(*position_m);
            }
            Outcome::Disagreed => self.figures.disagreed += 1,
            Outcome::Agreed | Outcome::Disturbed => {}
        }
        let offset = self.gate.note(sighting, matches!(outcome, Outcome::Used | Outcome::Agreed));
        self.figures.reopened += u64::from(offset.is_some());
        offset
    }

    /// Standard deviation of a heading from a field: noise, the unseen part of a disturbance, and tilt.
    pub fn sigma_rad(&self, field: &LevelField, tilt_sigma_rad: f64, params: &MargInsParams) -> f64 {
        let field_sigma_ut = match params.magnetic_gate {
            GateKind::None => params.heading.field_sigma_ut,
            GateKind::Disturbance => libm::hypot(
                params.heading.field_sigma_ut,
                self.gate.across_ut(field, params.heading.field_sigma_ut),
            ),
        };
        field.heading_sigma_rad(field_sigma_ut, tilt_sigma_rad)
    }

    fn forget(&mut self) {
        self.sum_ut = Vector3::zeros();
        self.count = 0;
        self.gathered_s = 0.0;
    }

    fn due(&mut self, time: Time, mut take: impl FnMut(&MagneticSample)) {
        while let Some(magnetic) = self.waiting.front().filter(|magnetic| magnetic.time <= time) {
            take(magnetic);
            self.latest = self.waiting.pop_front();
        }
    }
}

/// What became of a heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// It corrected the estimate.
    Used,
    /// It agreed with the estimate and said nothing new.
    Agreed,
    /// Norm or dip were off.
    Disturbed,
    /// It disagreed with the gyro.
    Disagreed,
}
