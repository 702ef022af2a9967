//! Every contender on every trial.

use super::contest::{self, Entered};
use super::lessons::Lessons;
use super::ranges::{RangeRecord, RangeReport};
use crate::interrupt;
use crate::scenario_file::{Contender, Contest};
use crate::verbs::trials::{Trial, Trials};
use adit_core::trajectory::Trajectory;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::compare::{Comparison, Moments, RunOptions, RunOutcome, summarise};
use adit_evaluation::plot::{PathCurve, Role};
use anyhow::Result;
use rayon::prelude::*;

/// How runs are judged.
pub struct Rules {
    /// At which moments.
    pub stamps: Stamps,
    /// What is forgiven before errors are taken.
    pub alignment: Alignment,
    /// Which moments, where they are those of the solutions.
    pub moments: Moments,
}

/// At which moments errors are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stamps {
    /// At solutions on a grid.
    Solutions,
    /// At the stamps of the truth; what cannot be judged there has failed.
    Truth,
    /// At the last solution, against the first.
    End,
}

/// What came of it.
pub struct Conducted {
    /// For each trial every contender, in order.
    pub runs: Vec<Vec<Entered>>,
    /// Truth and estimates of the first trial.
    pub first: Paths,
}

/// Every contender on every trial; the order is that of the trials, whatever the threads do. `step` is called after each trial.
pub fn run_all(
    trials: &Trials,
    contest: &Contest,
    rules: &Rules,
    step: &(dyn Fn() + Sync),
) -> Result<Conducted> {
    let contenders = &contest.contenders;
    let judged = |index: usize| -> Result<(Vec<Entered>, Option<Paths>)> {
        interrupt::check()?;
        let trial = trials.of_person(index, contest.person)?;
        let mut lessons = Lessons::before(trials, contest, index);
        let mut paths = (index == 0).then(|| Paths::of(&trial)).transpose()?;
        let mut entered = Vec::with_capacity(contenders.len());
        for contender in contenders {
            let (taught, site) = (lessons.taught(contender)?, lessons.site(contender, &trial)?);
            let options = rules.options(&trial, contender);
            let (mut run, estimate) =
                contest::enter(&trial, &taught, site.as_ref(), (rules.stamps, &options))?;
            if contender.nlos.is_some() || contender.calibrate.is_some() {
                run.ranges = RangeRecord::of(&trial, contender, site.as_deref());
            }
            if let Some(paths) = &mut paths {
                paths.estimates.push(estimate);
            }
            entered.push(run);
        }
        step();
        Ok((entered, paths))
    };
    let all = (0..trials.len()).into_par_iter().map(judged).collect::<Result<Vec<_>>>()?;
    let mut first = Paths::default();
    let mut runs = Vec::with_capacity(all.len());
    for (entered, paths) in all {
        if let Some(paths) = paths {
            first = paths;
        }
        runs.push(entered);
    }
    Ok(Conducted { runs, first })
}

impl Conducted {
    /// All runs in a few numbers, and what became of ranges.
    pub fn summed_up(
        &self,
        scenario: String,
        trials: &Trials,
        contest: &Contest,
        rules: &Rules,
    ) -> Result<(Comparison, Vec<(String, RangeReport)>)> {
        let mut methods = Vec::with_capacity(contest.contenders.len());
        let mut ranges = Vec::new();
        for (nth, contender) in contest.contenders.iter().enumerate() {
            let outcomes = self.outcomes(nth);
            let summary = summarise(contender.method.name(), &outcomes, contender.in_figures)?;
            methods.push((contender.name.clone(), summary));
            let report = RangeReport::of(self.runs.iter().map(|run| &run[nth].ranges));
            ranges.extend(report.map(|report| (contender.name.clone(), report)));
        }
        let on_grid = rules.stamps == Stamps::Solutions;
        let comparison = Comparison {
            scenario,
            seeds: trials.len(),
            first_seed: trials.first_seed(),
            alignment: rules.alignment.to_string(),
            judged_from_s: rules.moments.from_s,
            judged_every_s: on_grid.then_some(rules.moments.every_s),
            judged_above_m_s: rules.moments.above_m_s,
            methods,
        };
        Ok((comparison, ranges))
    }

    /// What every run of a contender gave.
    pub fn outcomes(&self, nth: usize) -> Vec<Option<RunOutcome>> {
        self.runs.iter().map(|run| run[nth].outcome.clone()).collect()
    }

    /// What was odd, once each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> =
            self.runs.iter().flatten().flat_map(|run| run.warnings.clone()).collect();
        warnings.sort();
        warnings.dedup();
        warnings
    }
}

impl Rules {
    fn options(&self, trial: &Trial, contender: &Contender) -> RunOptions {
        let positions = trial.has_position && contender.method.estimates_path();
        RunOptions {
            alignment: if positions { self.alignment } else { Alignment::None },
            moments: self.moments,
            positions,
            heights: trial.has_height,
            attitudes: trial.has_attitude,
        }
    }
}

/// Truth and estimates of the first trial, for the figure.
#[derive(Default)]
pub struct Paths {
    truth: Trajectory,
    estimates: Vec<Option<Trajectory>>,
}

impl Paths {
    fn of(trial: &Trial) -> Result<Self> {
        Ok(Self { truth: trial.path()?, estimates: Vec::new() })
    }

    /// The truth and the estimates of those in the figures.
    pub fn curves<'a>(&'a self, contenders: &'a [Contender]) -> Vec<PathCurve<'a>> {
        let mut curves = Vec::new();
        if !self.truth.is_empty() {
            curves.push(PathCurve { label: "truth", role: Role::Truth, trajectory: &self.truth });
        }
        let shown = contenders.iter().zip(&self.estimates).filter(|(contender, _)| contender.in_figures);
        for (number, (contender, estimate)) in shown.enumerate() {
            if let Some(trajectory) = estimate {
                curves.push(PathCurve { label: &contender.name, role: Role::Estimate(number), trajectory });
            }
        }
        curves
    }
}
