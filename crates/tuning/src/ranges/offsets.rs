//! What antennas and clocks add to ranges: nothing, the same for all anchors, or each anchor its own.
//!
//! The median of the medians of links, common to all; of an anchor the median of those of its links, shrunk to the common one by how much
//! links of one anchor differ (`s²`) against how much anchors do (`τ²`):
//!
//! ```text
//! o_a = c + n_a τ² / (n_a τ² + s²) (m_a − c)
//! ```
//!
//! (the empirical Bayes of Efron & Morris 1975, by the method of moments).

use super::choice::{Choice, Tried, pick};
use super::folds::Rows;
use crate::robust::{median, spread_about};
use adit_estimation::ranging::correction::{ErrorModel, RangeCorrection};
use std::collections::BTreeMap;

/// Offsets, m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Offsets {
    /// Of anchors not listed.
    pub common_m: f64,
    /// Of anchors.
    pub anchors: BTreeMap<String, f64>,
}

impl Offsets {
    /// Of an anchor.
    pub fn of(&self, anchor: &str) -> f64 {
        self.anchors.get(anchor).copied().unwrap_or(self.common_m)
    }

    /// The correction of these and the models.
    pub fn with(
        &self,
        unjudged: ErrorModel,
        straight: Option<ErrorModel>,
        nlos: Option<ErrorModel>,
    ) -> RangeCorrection {
        let (offset_m, anchors) = (self.common_m, self.anchors.clone());
        RangeCorrection { offset_m, anchors, unjudged, straight, nlos }
    }
}

/// Finds offsets.
type Fit = fn(&Rows<'_>) -> Offsets;

/// From plain to rich.
const CANDIDATES: [(&str, Fit); 3] =
    [("none", |_| Offsets::default()), ("common", common), ("each anchor", of_anchors)];

/// The offsets that ranges held out ask for.
pub(super) fn choose(rows: &Rows<'_>) -> (Offsets, Choice) {
    let folds = rows.folds();
    let judge = |candidate: Fit| {
        let of_fold = |(kept, held): &(Rows<'_>, Rows<'_>)| {
            let offsets = candidate(kept);
            let off = held.rows.iter().map(|row| {
                let known = row.known;
                (known.too_long_m() - offsets.of(known.range.anchor.as_str())).abs()
            });
            held.group_means(&off.collect::<Vec<_>>())
        };
        folds.iter().flat_map(of_fold).collect::<Vec<f64>>()
    };
    let several = rows.rows.iter().any(|row| row.known.range.anchor != rows.rows[0].known.range.anchor);
    let tried =
        CANDIDATES.iter().take(if several { 3 } else { 2 }).enumerate().map(|(tier, (name, candidate))| {
            Tried { name: (*name).to_owned(), tier, errors_m: judge(*candidate) }
        });
    let choice = pick(tried.collect());
    let (_, candidate) = CANDIDATES[choice.index];
    (candidate(rows), choice)
}

/// Medians of the links, by anchor.
fn link_medians<'a>(rows: &Rows<'a>) -> BTreeMap<&'a str, Vec<f64>> {
    let mut by_link: BTreeMap<(&str, usize), Vec<f64>> = BTreeMap::new();
    for row in &rows.rows {
        by_link.entry((row.known.range.anchor.as_str(), row.link)).or_default().push(row.known.too_long_m());
    }
    let mut by_anchor: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for ((anchor, _), values) in by_link {
        by_anchor.entry(anchor).or_default().extend(median(values));
    }
    by_anchor
}

fn common(rows: &Rows<'_>) -> Offsets {
    let all = link_medians(rows).into_values().flatten().collect();
    Offsets { common_m: median(all).unwrap_or(0.0), anchors: BTreeMap::new() }
}

fn of_anchors(rows: &Rows<'_>) -> Offsets {
    let by_anchor = link_medians(rows);
    let common_m = common(rows).common_m;
    let medians: BTreeMap<&str, (f64, f64)> = by_anchor
        .iter()
        .filter_map(|(anchor, values)| Some((*anchor, (median(values.clone())?, values.len() as f64))))
        .collect();
    let within = by_anchor.iter().filter(|(_, values)| values.len() > 1).flat_map(|(anchor, values)| {
        let own = medians.get(anchor).map_or(common_m, |(own, _)| *own);
        // The median of n values lies nearer to them than the truth does.
        let freedom = (values.len() as f64 / (values.len() as f64 - 1.0)).sqrt();
        values.iter().map(move |value| (value - own) * freedom)
    });
    let Some(within) = spread_about(within, 0.0) else { return common(rows) };
    let anchors = medians.len() as f64;
    let between = medians.values().map(|(own, _)| (own - common_m).powi(2)).sum::<f64>() / anchors;
    let of_chance = medians.values().map(|(_, count)| within * within / count).sum::<f64>() / anchors;
    let true_between = (between - of_chance).max(0.0);
    let shrunk = |(anchor, (own, count)): (&str, (f64, f64))| {
        let share = count * true_between / (count * true_between + within * within).max(f64::MIN_POSITIVE);
        (anchor.to_owned(), common_m + share * (own - common_m))
    };
    Offsets { common_m, anchors: medians.into_iter().map(shrunk).collect() }
}
