//! How ranges err, learnt from ranges of which the distance is known: a [`RangeCorrection`].
//!
//! ```text
//! known ranges ─ folds ─ offsets ─┬─ all ──────── nothing, a constant, a curve ─┐
//!                                 ├─ straight ─── nothing, a constant, a curve ─┼─ RangeCorrection
//!                                 └─ not ──────── …, a polynomial, a curve ─────┘
//! ```
//!
//! Each step is a choice among candidates from plain to rich ([`choice`]), made by ranges of groups (places, geometries, walks) that the candidate has not
//! seen, never by random rows: ranges of one place are near copies, and whatever has seen one knows the others. A richer kind of candidate has to beat a
//! plainer one by more than the standard error of the difference over the groups (Breiman, Friedman, Olshen & Stone 1984, the one-standard-error
//! rule); the plainest is to take nothing off. So a correction that does not generalise is not made. Among equally rich ones the best is taken.
//!
//! Fits minimise absolute errors, which a range that came round three corners does not move, and each link (group and anchor) weighs the same.
//! Standard deviations are those of the ranges held out.
//!
//! Limits: what differs from hall to hall (power, materials) is as well known as the groups are many; two at least are needed.

pub mod choice;
pub mod curve;
mod folds;
pub mod measures;
pub mod offsets;
pub mod polynomial;

use crate::error::TuningError;
use adit_estimation::ranging::correction::{CorrectedRange, RangeCorrection};
use adit_observation::RangeSample;
use adit_observation::csv_log::labelled::LinkClass;
use choice::{Choice, Kind};
use folds::Rows;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;

/// A range of which the distance is known.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownRange {
    /// The range.
    pub range: RangeSample,
    /// The distance, m.
    pub true_m: f64,
    /// The place, geometry, room or walk that it is from: held out as a whole.
    pub group: usize,
    /// How the signal came, where that is told.
    pub class: Option<LinkClass>,
}

impl KnownRange {
    /// What it reads too long, m.
    pub fn too_long_m(&self) -> f64 {
        self.range.range_m - self.true_m
    }

    fn is_straight(&self) -> bool {
        self.class == Some(LinkClass::Los)
    }

    fn is_not_straight(&self) -> bool {
        self.class.is_some_and(|class| class != LinkClass::Los)
    }
}

/// A correction and how it was chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Learnt {
    /// How the ranges err.
    pub correction: RangeCorrection,
    /// Which offsets.
    pub offsets: Choice,
    /// Which model of signals that nobody has judged.
    pub unjudged: Choice,
    /// Of signals that came straight, where that is told.
    pub straight: Option<Choice>,
    /// Of signals that did not.
    pub nlos: Option<Choice>,
}

/// A range held out and the distance that a correction tells which has not seen its group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Without judgement of the signal.
    pub unjudged: CorrectedRange,
    /// With the class that is told, where it is.
    pub judged: Option<CorrectedRange>,
}

/// Learns a correction from ranges of two groups or more.
pub fn learn(known: &[KnownRange]) -> Result<Learnt, TuningError> {
    if let Some(found) = known.iter().flat_map(|one| [one.range.range_m, one.true_m]).find(|v| !v.is_finite())
    {
        return Err(TuningError::Range { found });
    }
    let all = Rows::of(known, |_| true);
    if all.groups() < 2 {
        return Err(TuningError::FewGroups { found: all.groups(), expected: 2 });
    }
    let straight = Rows::of(known, KnownRange::is_straight);
    let nlos = Rows::of(known, KnownRange::is_not_straight);
    // Offsets are those of clean ranges, where these are told.
    let (offsets, chosen) = offsets::choose(if straight.groups() > 1 { &straight } else { &all });
    let learn =
        |rows: &Rows<'_>, kind: Kind| (rows.groups() > 1).then(|| choice::choose(rows, &offsets, kind));
    let (unjudged, of_all) = choice::choose(&all, &offsets, Kind::Unjudged);
    let (straight, of_straight) = learn(&straight, Kind::Straight).unzip();
    let (nlos, of_nlos) = learn(&nlos, Kind::Nlos).unzip();
    Ok(Learnt {
        correction: offsets.with(unjudged, straight, nlos),
        offsets: chosen,
        unjudged: of_all,
        straight: of_straight,
        nlos: of_nlos,
    })
}

/// Corrects every range by what is learnt from other groups; everything, the choices too, is made anew without them. Of three groups or
/// more.
pub fn held_out(known: &[KnownRange]) -> Result<Vec<HeldOut>, TuningError> {
    let folds = folds::of_groups(known);
    if folds.len() < 3 {
        return Err(TuningError::FewGroups { found: folds.len(), expected: 3 });
    }
    let learnt = folds.par_iter().map(|fold| {
        let kept: Vec<KnownRange> = known.iter().filter(|one| !fold.contains(&one.group)).cloned().collect();
        Ok((fold, learn(&kept)?.correction))
    });
    let learnt = learnt.collect::<Result<Vec<_>, TuningError>>()?;
    let correct = |one: &KnownRange| {
        let (_, correction) = learnt.iter().find(|(fold, _)| fold.contains(&one.group))?;
        Some(corrected(correction, one))
    };
    Ok(known.iter().filter_map(correct).collect())
}

/// What a correction makes of a range, with and without knowing how the signal came.
pub fn corrected(correction: &RangeCorrection, one: &KnownRange) -> HeldOut {
    let with = |line_of_sight| correction.correct(&RangeSample { line_of_sight, ..one.range.clone() });
    let judged = one.class.map(|class| with(Some(if class == LinkClass::Los { 1.0 } else { 0.0 })));
    HeldOut { unjudged: with(None), judged }
}
