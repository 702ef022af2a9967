//! A part of a suite without tracks: locators on scans at known spots.

use crate::interrupt;
use crate::method::MethodName;
use crate::suite_file::{Part, RadioSurvey, SpotChoice};
use crate::truth_beside;
use crate::verbs::calibrate::radio::{JudgedSpots, SpotErrors, judge_survey};
use adit_evaluation::compare::{Comparison, JudgedPart, Merit, RunErrors, RunOutcome, SuitePart, summarise};
use adit_evaluation::plot::DistributionCurve;
use adit_evaluation::statistics::Distribution;
use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use std::fs;
use std::path::PathBuf;

/// The method whose locators these are.
const METHOD: MethodName = MethodName::Wifi;

/// What is fitted and judged together.
pub struct SurveyRuns {
    runs: Vec<SurveyRun>,
}

struct SurveyRun {
    name: String,
    fit: PathBuf,
    list: PathBuf,
    judged: SpotsOf,
}

enum SpotsOf {
    File(PathBuf),
    LeftOut(f64, u64),
}

impl SurveyRuns {
    /// Those of a survey, by site and draw; `None` where its folder is not there.
    pub fn find(survey: &RadioSurvey) -> Result<Option<Self>> {
        let RadioSurvey { folder, fit, judged, .. } = survey;
        if !folder.is_dir() {
            return Ok(None);
        }
        let place = || format!("{}: cannot read this folder", folder.display());
        let csv = |stem: String| {
            [".csv", ".csv.gz"]
                .map(|end| folder.join(format!("{stem}{end}")))
                .into_iter()
                .find(|file| file.is_file())
        };
        let mut runs = Vec::new();
        for entry in fs::read_dir(folder).with_context(place)? {
            let file = entry.with_context(place)?.path();
            let stem = truth_beside::stem(&file);
            let Some(site) = stem.strip_suffix(fit.as_str()).and_then(|name| name.strip_suffix('_')) else {
                continue;
            };
            let Some(list) = csv(format!("{site}_access_points")) else { continue };
            let run = |name, judged| SurveyRun { name, fit: file.clone(), list: list.clone(), judged };
            match judged {
                SpotChoice::Test(ending) => {
                    let test = csv(format!("{site}_{ending}"));
                    runs.extend(test.map(|test| run(site.to_owned(), SpotsOf::File(test))));
                }
                SpotChoice::LeftOut(share, draws) => {
                    let draw = |seed| run(format!("{site}, draw {seed}"), SpotsOf::LeftOut(*share, seed));
                    runs.extend((1..=*draws).map(draw));
                }
            }
        }
        if runs.is_empty() {
            bail!(
                "{}: no survey here, expected NAME_{fit}.csv with NAME_access_points.csv",
                folder.display()
            );
        }
        // By site; draws stay in their order.
        runs.sort_by(|a, b| a.fit.cmp(&b.fit));
        Ok(Some(Self { runs }))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.runs.len()
    }
}

/// Every locator on every run; `step` is called after each.
pub fn compared(
    part: &Part,
    runs: &SurveyRuns,
    step: &(dyn Fn() + Sync),
) -> Result<(SuitePart, Vec<DistributionCurve>)> {
    let judged = |run: &SurveyRun| -> Result<SpotErrors> {
        interrupt::check()?;
        let spots = match &run.judged {
            SpotsOf::File(test) => JudgedSpots::Of(test),
            SpotsOf::LeftOut(share, seed) => JudgedSpots::LeftOut(*share, *seed),
        };
        let judged = judge_survey(&run.fit, &run.list, spots).with_context(|| run.name.clone())?;
        step();
        Ok(judged)
    };
    let all = runs.runs.par_iter().map(judged).collect::<Result<Vec<_>>>()?;
    let names: Vec<&'static str> =
        all.first().into_iter().flat_map(|run| &run.locators).map(|(name, _)| *name).collect();
    for chosen in &part.table {
        if !names.contains(&chosen.as_str()) {
            bail!("no locator is called \"{chosen}\", expected {}", names.join(", "));
        }
    }
    let (mut methods, mut merit, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for name in names {
        let of_run = |run: &SpotErrors| {
            run.locators.iter().find(|(known, _)| *known == name).map(|(_, errors_m)| outcome(errors_m))
        };
        let outcomes: Vec<Option<RunOutcome>> = all.iter().map(of_run).collect();
        let errors = |outcome: &Option<RunOutcome>| part.figure.of(&outcome.as_ref()?.errors);
        let in_figures = part.table.is_empty() || part.table.iter().any(|chosen| chosen == name);
        merit.push((name.to_owned(), Merit::of(outcomes.iter().map(errors).collect())));
        let pooled: Vec<f64> =
            outcomes.iter().flatten().flat_map(|run| part.figure.errors(&run.errors)).collect();
        if let Some(distribution) = Distribution::of(&pooled) {
            curves.push(DistributionCurve { label: name.to_owned(), distribution });
        }
        methods.push((name.to_owned(), summarise(METHOD.name(), &outcomes, in_figures)?));
    }
    let comparison = Comparison {
        scenario: part.name.clone(),
        seeds: runs.len(),
        first_seed: None,
        alignment: "none".to_owned(),
        judged_from_s: 0.0,
        judged_every_s: None,
        judged_above_m_s: 0.0,
        methods,
    };
    let chosen = part.table.first().or(merit.first().map(|(name, _)| name)).cloned();
    let table = chosen.map(|name| (METHOD.name().to_owned(), name)).into_iter().collect();
    let mut warnings: Vec<String> = all.iter().flat_map(|run| run.warnings.clone()).collect();
    warnings.sort();
    warnings.dedup();
    let run_names = runs.runs.iter().map(|run| run.name.clone()).collect();
    let judged = SuitePart {
        name: part.name.clone(),
        about: part.about.clone(),
        figure: part.figure,
        figure_words: part.figure.words(),
        unit: part.figure.unit(),
        skipped: None,
        judged: Some(JudgedPart::new(comparison, run_names, merit, table, warnings)),
    };
    Ok((judged, curves))
}

/// Errors of fixes that have no time.
fn outcome(errors_m: &[f64]) -> RunOutcome {
    #[expect(clippy::cast_possible_truncation, reason = "errors are kept in single precision")]
    let level_m: Vec<[f32; 2]> = errors_m.iter().map(|error| [*error as f32, 0.0]).collect();
    let errors = RunErrors { time_s: vec![0.0; level_m.len()], level_m, ..RunErrors::default() };
    RunOutcome { errors, nis: None, time_per_step_ns: 0.0 }
}
