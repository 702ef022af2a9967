//! What is told of errors of ranges.

use super::{HeldOut, KnownRange};
use crate::robust::{median, quantile};
use adit_estimation::ranging::correction::CorrectedRange;
use adit_observation::csv_log::labelled::LinkClass;
use serde::Serialize;

/// Errors of ranges, measured less true, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Mean.
    pub mean_m: f64,
    /// Mean of their absolute values.
    pub mae_m: f64,
    /// Root of the mean of their squares.
    pub rmse_m: f64,
    /// Median.
    pub median_m: f64,
    /// 95 % of the absolute values are below.
    pub p95_m: f64,
}

/// Before and after, of one class or of all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ClassErrors {
    /// Which class; `None` of all.
    pub class: Option<LinkClass>,
    /// How many ranges.
    pub ranges: usize,
    /// As measured.
    pub raw: Errors,
    /// Corrected, nobody having judged the signal.
    pub corrected: Errors,
    /// Mean square of error over its standard deviation, 1 where that is honest.
    pub normalised_square: f64,
    /// Corrected knowing the class that the set tells: what a faultless judge of signals would give.
    pub class_known: Option<Errors>,
}

impl Errors {
    /// Of errors; `None` of none.
    pub fn of(errors: &[f64]) -> Option<Self> {
        let count = errors.len() as f64;
        let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
        Some(Self {
            median_m: median(errors.to_vec())?,
            mean_m: errors.iter().sum::<f64>() / count,
            mae_m: sizes.iter().sum::<f64>() / count,
            rmse_m: (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt(),
            p95_m: quantile(&mut sizes, 0.95)?,
        })
    }
}

/// Of all ranges, then of each class that there is. `corrected` has one for each of `known`.
pub fn of(known: &[KnownRange], corrected: &[HeldOut]) -> Vec<ClassErrors> {
    let classes =
        LinkClass::ALL.into_iter().filter(|class| known.iter().any(|one| one.class == Some(*class)));
    let all = [None].into_iter().chain(classes.map(Some));
    all.filter_map(|class| {
        let pairs =
            || known.iter().zip(corrected).filter(move |(one, _)| class.is_none() || one.class == class);
        let off = |one: &KnownRange, corrected: CorrectedRange| corrected.distance_m - one.true_m;
        let raw: Vec<f64> = pairs().map(|(one, _)| one.too_long_m()).collect();
        let unjudged: Vec<f64> = pairs().map(|(one, held)| off(one, held.unjudged)).collect();
        let judged: Option<Vec<f64>> = pairs().map(|(one, held)| Some(off(one, held.judged?))).collect();
        let normalised = pairs().map(|(one, held)| (off(one, held.unjudged) / held.unjudged.sigma_m).powi(2));
        Some(ClassErrors {
            class,
            ranges: raw.len(),
            raw: Errors::of(&raw)?,
            normalised_square: normalised.sum::<f64>() / raw.len() as f64,
            corrected: Errors::of(&unjudged)?,
            class_known: judged.and_then(|errors| Errors::of(&errors)),
        })
    })
    .collect()
}
