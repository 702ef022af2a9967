//! `adit compare`: methods against each other on a scenario over many seeds, or on a folder of recorded runs.

mod contest;
mod lessons;
mod ranges;

use crate::args::CompareArgs;
use crate::interrupt;
use crate::output::{self, Target};
use crate::progress::{self, Progress, Unit};
use crate::scenario_file::{Contender, Contest};
use crate::verbs::trials::{Trial, Trials};
use adit_core::trajectory::Trajectory;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::compare::{Comparison, Moments, RunOptions, RunOutcome, html, summarise};
use adit_evaluation::plot::{PathCurve, Role};
use anyhow::{Result, bail};
use contest::Entered;
use lessons::Lessons;
use ranges::{RangeRecord, RangeReport};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// Runs everything and shows it.
pub fn run(args: &CompareArgs) -> Result<()> {
    let trials = Trials::of(&args.source, args.seeds)?;
    let contest = contest(&trials, args)?;
    let rules = Rules {
        alignment: args.align.or(contest.align).unwrap_or(Alignment::Se2),
        moments: Moments { from_s: args.from.unwrap_or(contest.moments.from_s), ..contest.moments },
    };
    let (runs, mut first) = run_all(&trials, &contest, &rules)?;
    let mut methods = Vec::with_capacity(contest.contenders.len());
    let mut ranges = Vec::new();
    for (nth, contender) in contest.contenders.iter().enumerate() {
        let outcomes: Vec<Option<RunOutcome>> = runs.iter().map(|run| run[nth].outcome.clone()).collect();
        let summary = summarise(contender.method.name(), &outcomes, contender.in_figures)?;
        methods.push((contender.name.clone(), summary));
        let report = RangeReport::of(runs.iter().map(|run| &run[nth].ranges));
        ranges.extend(report.map(|report| (contender.name.clone(), report)));
    }
    let comparison = Comparison {
        scenario: args.source.display().to_string(),
        seeds: trials.len(),
        first_seed: trials.first_seed(),
        alignment: rules.alignment.to_string(),
        judged_from_s: rules.moments.from_s,
        judged_every_s: rules.moments.every_s,
        judged_above_m_s: rules.moments.above_m_s,
        methods,
    };
    let mut warnings: Vec<String> = runs.iter().flatten().flat_map(|run| run.warnings.clone()).collect();
    warnings.sort();
    warnings.dedup();
    progress::warn(&warnings);
    if let Some(path) = &args.out {
        output::write_file(path, &html(&comparison, &first.curves(&contest.contenders))?)?;
    }
    if let Some(target) = &args.json {
        let report = Report { comparison: &comparison, ranges: ranges.iter().cloned().collect() };
        target.write(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    let text = comparison.to_string() + &ranges::table(&ranges);
    if args.json == Some(Target::Stdout) {
        output::tell(&text);
        return Ok(());
    }
    output::print(&text)
}

/// What `--json` writes.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    /// Of contenders whose ranges are judged or corrected.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    ranges: BTreeMap<String, RangeReport>,
}

/// How runs are judged.
struct Rules {
    alignment: Alignment,
    moments: Moments,
}

/// Who competes: those of the scenario, of which `--methods` chooses and to which it adds.
fn contest(trials: &Trials, args: &CompareArgs) -> Result<Contest> {
    let mut contest = trials.contest()?;
    if !args.methods.is_empty() {
        contest.contenders.retain(|contender| args.methods.contains(&contender.method));
        for method in &args.methods {
            if !contest.contenders.iter().any(|contender| contender.method == *method) {
                contest.contenders.push(Contender::plain(*method));
            }
        }
    }
    if contest.contenders.is_empty() {
        bail!("{}: no methods to compare, name some with --methods", args.source.display());
    }
    Ok(contest)
}

/// Every contender on every trial; the order is that of the trials, whatever the threads do.
fn run_all(trials: &Trials, contest: &Contest, rules: &Rules) -> Result<(Vec<Vec<Entered>>, Paths)> {
    let contenders = &contest.contenders;
    let progress = Progress::new("comparing", Unit::Samples, Some(trials.len() as u64));
    let done = AtomicU64::new(0);
    let judged = |index: usize| -> Result<(Vec<Entered>, Option<Paths>)> {
        interrupt::check()?;
        let trial = trials.of_person(index, contest.person)?;
        let mut lessons = Lessons::before(trials, contest, index);
        let mut paths = (index == 0).then(|| Paths::of(&trial)).transpose()?;
        let mut entered = Vec::with_capacity(contenders.len());
        for contender in contenders {
            let (taught, site) = (lessons.taught(contender)?, lessons.site(contender, &trial)?);
            let options = rules.options(&trial, contender);
            let (mut run, estimate) = contest::enter(&trial, &taught, site.as_ref(), &options)?;
            if contender.nlos.is_some() || contender.calibrate.is_some() {
                run.ranges = RangeRecord::of(&trial, contender, site.as_deref());
            }
            if let Some(paths) = &mut paths {
                paths.estimates.push(estimate);
            }
            entered.push(run);
        }
        progress.at(done.fetch_add(1, Ordering::Relaxed) + 1);
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
    Ok((runs, first))
}

impl Rules {
    fn options(&self, trial: &Trial, contender: &Contender) -> RunOptions {
        let positions = trial.has_position && contender.method.estimates_path();
        RunOptions {
            alignment: if positions { self.alignment } else { Alignment::None },
            moments: self.moments,
            positions,
            attitudes: trial.has_attitude,
        }
    }
}

/// Truth and estimates of the first trial, for the figure.
#[derive(Default)]
struct Paths {
    truth: Trajectory,
    estimates: Vec<Option<Trajectory>>,
}

impl Paths {
    fn of(trial: &Trial) -> Result<Self> {
        Ok(Self { truth: trial.path()?, estimates: Vec::new() })
    }

    fn curves<'a>(&'a mut self, contenders: &'a [Contender]) -> Vec<PathCurve<'a>> {
        let mut curves = vec![PathCurve { label: "truth", role: Role::Truth, trajectory: &self.truth }];
        let shown = contenders.iter().zip(&self.estimates).filter(|(contender, _)| contender.in_figures);
        for (number, (contender, estimate)) in shown.enumerate() {
            if let Some(trajectory) = estimate {
                curves.push(PathCurve { label: &contender.name, role: Role::Estimate(number), trajectory });
            }
        }
        curves
    }
}
