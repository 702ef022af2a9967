//! The search: the optimiser of `adit-tuning` with a record on disk, a bar, and an end at Ctrl-C.

use super::objective::{FAILED, Objective};
use super::parameters::{Parameter, Parameters};
use super::runs::{Rules, Runs};
use crate::args::TuneArgs;
use crate::config;
use crate::interrupt;
use crate::output::{self, Target};
use crate::progress::{self, Progress, Unit};
use adit_evaluation::alignment::Alignment;
use adit_tuning::optimise::{Found, Record, Search, Task};
use anyhow::{Context, Result, anyhow, bail};
use serde::{Deserialize, Serialize};
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time between two writings of the record.
const KEEP_EVERY: Duration = Duration::from_secs(2);

/// A search that has not ended: what it is about, and what it knows.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unfinished {
    /// Name of the method.
    method: String,
    /// What is searched.
    parameters: Vec<Parameter>,
    /// What is forgiven.
    alignment: Alignment,
    /// Judged from when on, s.
    from_s: f64,
    /// The logs, for people.
    train: Vec<String>,
    /// Cost of each log with the settings as they are, bit by bit: the same for the same logs, settings and program only.
    costs_as_they_are: Vec<u64>,
    /// What the optimiser knows.
    record: Record,
}

/// What came of a search.
pub struct Searched {
    /// What was found.
    pub found: Found,
    /// Evaluations of this session.
    pub evaluations_now: usize,
    /// Time that they took, s.
    pub elapsed_s: f64,
}

/// A search and the file of its record.
pub struct RecordedSearch {
    unfinished: Unfinished,
    file: Option<PathBuf>,
}

impl RecordedSearch {
    /// A new search, or that of the record beside the result.
    pub fn begin(
        args: &TuneArgs,
        rules: &Rules,
        parameters: &Parameters,
        runs: &Runs,
        as_they_are: &[Option<f64>],
    ) -> Result<Self> {
        let new = Unfinished {
            method: args.method.name().to_owned(),
            parameters: parameters.0.clone(),
            alignment: rules.alignment,
            from_s: rules.from_s,
            train: runs.logs(),
            costs_as_they_are: as_they_are.iter().map(|cost| cost.unwrap_or(FAILED).to_bits()).collect(),
            record: Record {
                method: args.optimizer.0,
                task: Task {
                    bounds: parameters.bounds(),
                    agents: args.agents as usize,
                    evaluations: args.budget as usize,
                    seed: args.seed,
                },
                costs: Vec::new(),
            },
        };
        let file = match &args.out {
            Target::Stdout => None,
            Target::File(out) => Some(record_file(out)),
        };
        let Some(path) = file.as_deref().filter(|path| path.exists()) else {
            if args.resume {
                let path = file.as_deref().unwrap_or(Path::new("")).display();
                progress::warn(&[format!("{path}: no search to resume, beginning a new one")]);
            }
            return Ok(Self { unfinished: new, file });
        };
        if !args.resume {
            bail!(
                "{}: a search that has not ended: --resume goes on with it, or remove the file to begin anew",
                path.display()
            );
        }
        let known: Unfinished = serde_json::from_str(&config::text(path)?)
            .map_err(|error| anyhow!("{}:{}: {error}", path.display(), error.line()))?;
        if let Some(difference) = known.difference(&new) {
            bail!("{}: the record of another search: {difference}", path.display());
        }
        Ok(Self { unfinished: Unfinished { record: known.record, ..new }, file })
    }

    /// Searches to the end of the budget. At Ctrl-C what is known is kept, and that is an error.
    pub fn run(mut self, parameters: &Parameters, objective: &dyn Objective, unit: &str) -> Result<Searched> {
        let known = self.unfinished.record.costs.len();
        let budget = self.unfinished.record.task.evaluations;
        let progress = Progress::new("searching", Unit::Evaluations, Some(budget as u64));
        progress.at(known as u64);
        let cost = |point: &[f64]| {
            let cost = objective.cost(&parameters.values(point));
            progress.more(1);
            cost
        };
        let clock = Instant::now();
        // What was evaluated while somebody asked to stop may have been cut short: it does not count.
        let mut sound = known;
        let mut kept = Instant::now();
        let mut trouble = None;
        let mut watch = |now: adit_tuning::optimise::Progress<'_>| {
            if interrupt::check().is_err() {
                return ControlFlow::Break(());
            }
            sound = now.record.costs.len();
            progress.at(sound as u64);
            progress.say(format!("least cost {:.4e} {unit}", now.cost));
            if kept.elapsed() >= KEEP_EVERY {
                if let Err(error) = self.keep(now.record) {
                    trouble = Some(error);
                    return ControlFlow::Break(());
                }
                kept = Instant::now();
            }
            ControlFlow::Continue(())
        };
        let record = self.unfinished.record.clone();
        let found = Search::resume(record, &cost)?.watched_by(&mut watch).run();
        drop(progress);
        if let Some(error) = trouble {
            return Err(error);
        }
        if interrupt::check().is_err() && sound < budget {
            self.unfinished.record = found.record;
            self.unfinished.record.costs.truncate(sound);
            return Err(self.interrupted(sound, budget));
        }
        let evaluations_now = found.evaluations.saturating_sub(known);
        // Until the result is written, it stays known.
        self.keep(&found.record)?;
        Ok(Searched { found, evaluations_now, elapsed_s: clock.elapsed().as_secs_f64() })
    }

    fn interrupted(&self, sound: usize, budget: usize) -> anyhow::Error {
        let Some(path) = &self.file else { return anyhow!("interrupted: nothing was written") };
        match self.keep(&self.unfinished.record) {
            Ok(()) => anyhow!(
                "interrupted after {sound} of {budget} evaluations: {} keeps them, --resume goes on",
                path.display()
            ),
            Err(error) => error,
        }
    }

    fn keep(&self, record: &Record) -> Result<()> {
        let Some(path) = &self.file else { return Ok(()) };
        let unfinished = Unfinished { record: record.clone(), ..self.unfinished.clone() };
        output::write_file(path, &(serde_json::to_string(&unfinished)? + "\n"))
    }
}

/// Removes the record beside a result that has been written.
pub fn forget(out: &Target) -> Result<()> {
    let Target::File(out) = out else { return Ok(()) };
    let path = record_file(out);
    fs::remove_file(&path).with_context(|| format!("{}: cannot remove it", path.display()))
}

fn record_file(out: &Path) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".search.json");
    PathBuf::from(name)
}

impl Unfinished {
    /// What another search is about that this is not.
    fn difference(&self, new: &Self) -> Option<String> {
        let (was, now) = (&self.record, &new.record);
        let told = |what: &str, found: &dyn std::fmt::Display, expected: &dyn std::fmt::Display| {
            Some(format!("{what} was {found}, is {expected}"))
        };
        let names = |search: &Self| {
            search.parameters.iter().map(|parameter| parameter.name.clone()).collect::<Vec<_>>().join(", ")
        };
        if self.method != new.method {
            told("the method", &self.method, &new.method)
        } else if was.method != now.method {
            told("the optimizer", &was.method.name(), &now.method.name())
        } else if was.task.evaluations != now.task.evaluations {
            told("the budget", &was.task.evaluations, &now.task.evaluations)
        } else if was.task.agents != now.task.agents {
            told("the number of agents", &was.task.agents, &now.task.agents)
        } else if was.task.seed != now.task.seed {
            told("the seed", &was.task.seed, &now.task.seed)
        } else if self.alignment != new.alignment {
            told("the alignment", &self.alignment, &new.alignment)
        } else if self.from_s.to_bits() != new.from_s.to_bits() {
            told("the time judged from", &self.from_s, &new.from_s)
        } else if names(self) != names(new) {
            Some(format!("it searched {}", names(self)))
        } else if self.parameters != new.parameters || was.task.bounds != now.task.bounds {
            Some("its settings or their bounds were others".to_owned())
        } else if self.costs_as_they_are != new.costs_as_they_are {
            let train = self.train.join(", ");
            Some(format!(
                "the cost at its start was another, with logs {train} (or settings or a program that have changed)"
            ))
        } else {
            None
        }
    }
}
