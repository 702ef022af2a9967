//! Ranges of a comparison on a simulated mine: how far they err where nothing came straight, before and after correction, and what was told of the way.

use crate::judged_ranges::JudgedRanges;
use crate::scenario_file::Contender;
use crate::verbs::trials::Trial;
use adit_estimation::radio::RadioSite;
use adit_nlos::measures::Measures;
use adit_observation::{InTheWay, Observation, RangeSample};
use adit_simulation::radio::{LinkClass, RangeTruth};
use serde::Serialize;
use std::fmt::Write;

/// What became of the ranges of one run on the way to one contender.
#[derive(Debug, Clone, Default)]
pub struct RangeRecord {
    /// |Error| of each range that did not come straight: as measured and as corrected, m.
    nlos_m: Vec<[f64; 2]>,
    /// Of each judged range the true class and the probabilities told.
    judged: Vec<(usize, Vec<f32>)>,
}

/// The same over all runs.
#[derive(Debug, Clone, Serialize)]
pub struct RangeReport {
    /// Ranges that did not come straight.
    pub nlos_ranges: usize,
    /// Mean of their |error| as measured, m.
    pub nlos_error_before_m: f64,
    /// The same as corrected, m.
    pub nlos_error_after_m: f64,
    /// What was told of the way.
    pub recognition: Option<Measures>,
}

impl RangeRecord {
    /// Of the ranges of a trial as this contender gets them.
    pub fn of(trial: &Trial, contender: &Contender, site: Option<&RadioSite>) -> Self {
        let mut record = Self::default();
        let mut judge = contender.nlos.as_ref().map(JudgedRanges::by);
        let ranges = trial.observations.iter().filter(|o| matches!(o, Observation::Range(_)));
        for (observation, truth) in ranges.zip(&trial.range_truths) {
            let mut observation = observation.clone();
            if let Some(judge) = &mut judge {
                judge.see(&mut observation);
            }
            if let Observation::Range(range) = &observation {
                record.note(range, truth, site);
            }
        }
        record
    }

    fn note(&mut self, range: &RangeSample, truth: &RangeTruth, site: Option<&RadioSite>) {
        let class = usize::from(truth.class != LinkClass::Los);
        if class > 0 {
            let correction = site.and_then(|site| site.ranges.as_ref());
            let after_m = correction.map_or(range.range_m, |correction| correction.correct(range).distance_m);
            self.nlos_m.push([range.range_m, after_m].map(|told_m| (told_m - truth.distance_m).abs()));
        }
        if let Some(told) = &range.in_the_way {
            self.judged.push((truth.in_the_way() as usize, told.to_vec()));
        } else if let Some(p) = range.line_of_sight {
            #[expect(clippy::cast_possible_truncation, reason = "a probability")]
            let p = p as f32;
            self.judged.push((class, vec![p, 1.0 - p]));
        }
    }
}

impl RangeReport {
    /// Of all runs; `None` where there were no such ranges.
    pub fn of<'a>(records: impl Iterator<Item = &'a RangeRecord> + Clone) -> Option<Self> {
        let errors: Vec<[f64; 2]> = records.clone().flat_map(|record| &record.nlos_m).copied().collect();
        let judged: Vec<(usize, &[f32])> =
            records.flat_map(|record| &record.judged).map(|(class, p)| (*class, &p[..])).collect();
        if errors.is_empty() {
            return None;
        }
        let mean = |which: usize| errors.iter().map(|error| error[which]).sum::<f64>() / errors.len() as f64;
        let four = judged.first().is_some_and(|(_, told)| told.len() == InTheWay::COUNT);
        let classes: Vec<&'static str> =
            if four { InTheWay::ALL.map(InTheWay::name).to_vec() } else { vec!["clear", "not clear"] };
        Some(Self {
            nlos_ranges: errors.len(),
            nlos_error_before_m: mean(0),
            nlos_error_after_m: mean(1),
            recognition: (!judged.is_empty()).then(|| Measures::of(&classes, judged.iter().copied())),
        })
    }
}

/// The table of ranges, of those contenders that have something to tell.
pub fn table(reports: &[(String, RangeReport)]) -> String {
    if reports.is_empty() {
        return String::new();
    }
    let width = reports.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(6);
    let mut text = format!(
        "\n{:width$}  |error| of ranges that did not come straight   clear or not        every class against the rest, mean\n\
         {:width$}  measured  corrected  ranges                  accuracy  F1       classes  accuracy  recall   F1\n",
        "", "method"
    );
    for (name, report) in reports {
        let RangeReport { nlos_ranges, nlos_error_before_m, nlos_error_after_m, recognition } = report;
        let _ = write!(
            text,
            "{name:width$}  {nlos_error_before_m:6.2} m  {nlos_error_after_m:7.2} m  {nlos_ranges:<22}"
        );
        if let Some(told) = recognition {
            let Measures { binary, mean, classes, .. } = told;
            let percent = |share: f64| format!("{:5.1} %", 100.0 * share);
            let _ = write!(
                text,
                "  {}  {}  {:<7}  {}  {}  {}",
                percent(binary.accuracy),
                percent(binary.f1),
                classes.len(),
                percent(mean.accuracy),
                percent(mean.recall),
                percent(mean.f1)
            );
        }
        text.push('\n');
    }
    text
}
