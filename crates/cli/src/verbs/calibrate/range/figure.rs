//! Errors of ranges as a figure.

use super::data::RangeData;
use crate::truth_beside;
use adit_estimation::ranging::correction::{Diagnostic, RangeCorrection};
use adit_evaluation::plot::{DistributionCurve, ErrorDots, RangeErrors, range_figure};
use adit_evaluation::statistics::Distribution;
use adit_observation::csv_log::labelled::LinkClass;
use adit_tuning::ranges::{HeldOut, KnownRange};
use anyhow::{Context, Result};
use std::path::PathBuf;

/// Which ranges are of a kind.
type Wanted = fn(&KnownRange) -> bool;

/// Errors over what the model of signals that nobody has judged goes by, and their sizes before and after.
pub fn of(
    paths: &[PathBuf],
    data: &RangeData,
    correction: &RangeCorrection,
    held: &[HeldOut],
) -> Result<String> {
    let curve = correction.unjudged.curve.as_ref();
    let by = curve.map_or(Diagnostic::Range, |curve| curve.of);
    let kinds: [(&str, Wanted); 3] = [
        ("not straight", |one| one.class.is_some_and(|class| class != LinkClass::Los)),
        ("straight", |one| one.class == Some(LinkClass::Los)),
        ("ranges", |one| one.class.is_none()),
    ];
    let dots = kinds.map(|(label, wanted)| {
        let at = |one: &KnownRange| {
            Some((by.of(&one.range)?, one.too_long_m() - correction.offset_of(one.range.anchor.as_str())))
        };
        let points = data.ranges.iter().filter(|one| wanted(one)).filter_map(at).collect();
        ErrorDots { label: label.to_owned(), points }
    });
    let taken_off = curve.map_or_else(Vec::new, |curve| {
        curve.at.iter().filter_map(|at| curve.at_value(*at).map(|(mean, sigma)| (*at, mean, sigma))).collect()
    });
    let sizes = |label: &str, errors: Vec<f64>| {
        let distribution = Distribution::of(&errors).context("no ranges")?;
        anyhow::Ok(DistributionCurve { label: label.to_owned(), distribution })
    };
    let raw = data.ranges.iter().map(|one| one.too_long_m().abs()).collect();
    let pairs = data.ranges.iter().zip(held);
    let left = pairs.map(|(one, held)| (held.unjudged.distance_m - one.true_m).abs()).collect();
    let errors = RangeErrors {
        of: format!("{} ({})", by.name().replace('-', " "), by.unit()),
        dots: dots.into_iter().filter(|dots| !dots.points.is_empty()).collect(),
        taken_off,
        distributions: vec![sizes("as measured", raw)?, sizes("corrected, held out", left)?],
    };
    let names = paths.iter().map(|path| truth_beside::stem(path)).collect::<Vec<_>>().join(", ");
    Ok(range_figure(&errors, &format!("Ranges of {names}"))?)
}
