//! `adit tune`: the noise parameters of a method at which it is least far off, on logs with truth.

mod objective;
mod parameters;
mod report;
mod reports;
mod runs;
mod search;
mod settings_file;

use crate::args::TuneArgs;
use crate::config;
use crate::interrupt;
use crate::method::MethodName;
use crate::output::{self, Target};
use crate::progress;
use crate::verbs::trials::Trial;
use adit_evaluation::alignment::Alignment;
use adit_tuning::optimise::{Method as Optimiser, Search, Task};
use anyhow::Result;
use objective::Objective;
use parameters::Parameters;
use report::{BeforeAfter, Report};
use runs::{Judgement, Rules, Runs, mean_cost};
use search::RecordedSearch;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Searches, judges, writes, says what was found.
pub fn run(args: &TuneArgs) -> Result<()> {
    let text = args.config.as_deref().map(config::text).transpose()?.unwrap_or_default();
    let config = args.config.as_deref().map(|path| config::parse(path, &text)).transpose()?;
    let config: toml::Table = config.unwrap_or_default();
    let (runs, before) = read(args, &args.train, &config)?;
    let validation = match args.validate.as_slice() {
        [] => None,
        paths => Some(read(args, paths, &config)?),
    };
    let (parameters, warnings) = Parameters::choose(args.method, &args.parameters, &runs.settings())?;
    progress::warn(&warnings);

    let rules = Rules::of(args);
    let search = RecordedSearch::begin(args, &rules, &parameters, &runs, &before)?;
    let objective = objective::of(args.method, &runs, &parameters)?;
    let unit = format!("{}²", rules.what.unit());
    let searched = search.run(&parameters, objective.as_ref(), &unit)?;

    let values = parameters.rounded(&searched.found.point);
    let better = objective.cost(&values) < objective.cost(&parameters.defaults());
    interrupt::check()?;
    let values = better.then(|| settled(objective.as_ref(), &parameters, values));
    let both = |runs: &Runs, before: Vec<Option<f64>>| {
        let after = match &values {
            Some(values) => answered(runs.judge(&parameters, values)),
            None => before.clone(),
        };
        BeforeAfter { logs: runs.logs(), before, after }
    };
    let train = both(&runs, before);
    let validate = validation.map(|(runs, before)| both(&runs, before));
    interrupt::check()?;
    if values.is_some() && mean_cost(&train.after) > mean_cost(&train.before) {
        let what =
            "less is off at the reports by which it was searched, more over the whole logs: see the table";
        progress::warn(&[what]);
    }

    let report =
        Report::new(args, &rules, &parameters, values.as_deref(), searched, (&train, validate.as_ref()));
    if !report.improved {
        progress::warn(&["nothing better than the settings as they are was found: these were written"]);
    }
    args.out.write(&settings_file::text(args, &text, &parameters, &report)?)?;
    if let Some(path) = &args.plot {
        output::write_file(path, &report.figure()?)?;
    }
    if let Some(target) = &args.json {
        target.write(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    search::forget(&args.out)?;
    say(args, &report)
}

/// A search without a record: before a comparison.
pub struct TuningTask {
    /// How to search.
    pub optimiser: Optimiser,
    /// Agents of a generation.
    pub agents: usize,
    /// Evaluations in all.
    pub evaluations: usize,
    /// Seed of every random draw.
    pub seed: u64,
}

/// Settings of a method tuned on one run, over `config`: those that were searched.
pub fn on_trial(
    method: MethodName,
    trial: Trial,
    config: &toml::Table,
    task: &TuningTask,
) -> Result<toml::Table> {
    let rules = Rules { what: Judgement::Position, alignment: Alignment::None, from_s: 0.0 };
    let mut runs = Runs::of(method, vec![trial], config, rules)?;
    for error in runs.judge_as_they_are() {
        error?;
    }
    let (parameters, _) = Parameters::choose(method, &[], &runs.settings())?;
    let objective = objective::of(method, &runs, &parameters)?;
    let cost = |point: &[f64]| objective.cost(&parameters.values(point));
    let TuningTask { optimiser, agents, evaluations, seed } = *task;
    let task = Task { bounds: parameters.bounds(), agents, evaluations, seed };
    let found = Search::new(optimiser, task, &cost)?.run();
    Ok(parameters.table(&parameters.rounded(&found.point)))
}

/// Values with those taken back that are worth nothing: an error that does not depend on a parameter must not move it.
fn settled(objective: &dyn Objective, parameters: &Parameters, mut values: Vec<f64>) -> Vec<f64> {
    let mut cost = objective.cost(&values);
    for (index, default) in parameters.defaults().into_iter().enumerate() {
        let found = std::mem::replace(&mut values[index], default);
        let without = objective.cost(&values);
        if without <= cost {
            cost = without;
        } else {
            values[index] = found;
        }
    }
    values
}

/// Runs in memory, and their mean squared errors with the settings as they are.
fn read(args: &TuneArgs, paths: &[PathBuf], config: &toml::Table) -> Result<(Runs, Vec<Option<f64>>)> {
    let mut runs = Runs::read(args, paths, config)?;
    let mut errors = runs.judge_as_they_are();
    interrupt::check()?;
    if errors.iter().all(Result::is_err)
        && let Some(Err(first)) = errors.drain(..).next()
    {
        return Err(first);
    }
    for error in errors.iter().filter_map(|error| error.as_ref().err()) {
        progress::warn(&[format!("{error:#}")]);
    }
    Ok((runs, answered(errors)))
}

/// The errors of those runs that have any.
fn answered(errors: Vec<Result<f64>>) -> Vec<Option<f64>> {
    errors.into_iter().map(Result::ok).collect()
}

/// The report, to stderr where stdout is taken.
fn say(args: &TuneArgs, report: &Report) -> Result<()> {
    let mut table = report.to_string();
    if let Target::File(path) = &args.out {
        writeln!(table, "\nsettings    {}", path.display())?;
    }
    if let Some(path) = &args.plot {
        writeln!(table, "figure      {}", path.display())?;
    }
    if args.out == Target::Stdout || args.json == Some(Target::Stdout) {
        output::tell(&table);
        return Ok(());
    }
    output::print(&table)
}
