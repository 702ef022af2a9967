//! `adit compare`: methods against each other on a scenario over many seeds, or on a folder of recorded runs.

mod conduct;
mod contest;
mod lessons;
mod ranges;
mod suite;
mod survey;

use crate::args::CompareArgs;
use crate::output::{self, Target};
use crate::progress::{self, Progress, Unit};
use crate::scenario_file::{Contender, Contest};
use crate::suite_file::Suite;
use crate::verbs::trials::Trials;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::compare::{Comparison, Moments, html};
use anyhow::{Result, bail};
use conduct::{Rules, Stamps};
use ranges::RangeReport;
use serde::Serialize;
use std::collections::BTreeMap;

/// Runs of a scenario, where nothing is said.
const DEFAULT_SEEDS: u32 = 20;

/// Runs everything and shows it.
pub fn run(args: &CompareArgs) -> Result<()> {
    if Suite::is_one(&args.source) {
        return suite::run(args);
    }
    let trials = Trials::of(&args.source, args.seeds.unwrap_or(DEFAULT_SEEDS))?;
    let contest = contest(&trials, args)?;
    let rules = Rules {
        stamps: Stamps::Solutions,
        alignment: args.align.or(contest.align).unwrap_or(Alignment::Se2),
        moments: Moments { from_s: args.from.unwrap_or(contest.moments.from_s), ..contest.moments },
    };
    let progress = Progress::new("comparing", Unit::Samples, Some(trials.len() as u64));
    let conducted = conduct::run_all(&trials, &contest, &rules, &|| progress.more(1))?;
    drop(progress);
    let source = args.source.display().to_string();
    let (comparison, ranges) = conducted.summed_up(source, &trials, &contest, &rules)?;
    progress::warn(&conducted.warnings());
    if let Some(path) = &args.out {
        output::write_file(path, &html(&comparison, &conducted.first.curves(&contest.contenders))?)?;
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
