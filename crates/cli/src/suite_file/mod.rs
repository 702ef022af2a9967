//! Suites: which scenarios and recorded sets are compared as one, with which methods, and how each is judged.
//!
//! ```toml
//! kind = "suite"
//! title = "Every method on everything"
//! about = "One paragraph over the opening table."
//! data = "../../shared/data"            # recorded sets, beside this file, where ADIT_DATA is not set
//! runs = [{ method = "fused" }]         # enters every part, before its own
//!
//! [[parts]]
//! name = "S2"
//! about = "What it is and how it is judged."
//! scenario = "s2.toml"                  # beside this file; its table [compare] names the contenders
//! seeds = 20                            # 20 when left out; --seeds goes before it
//! keep = ["foot-ins"]                   # of the scenario's contenders; all when left out
//! figure = "rmse-2d"                    # see docs/evaluation.md
//!
//! [[parts]]
//! name = "recorded walks"
//! about = "…"
//! figure = "rmse-3d"
//! align = "se3"                         # the scenario's, or se2, when left out
//! runs = [{ method = "uwb-ls", config = {} }, { method = "uwb-rkf", only = ["range"] }]
//! table = ["uwb-ls"]                    # which stand in the opening table; the first of each method when left out
//! settings = { fused = { use_pressure = false } }   # over those of a contender, by name
//! set = { folder = "uwb-imu-walk", logs = ["ranges"] }   # see [`recorded::SetEntry`]
//! ```
//!
//! Whatever is wrong is told with file and line.

mod recorded;
mod survey;

use crate::config;
use crate::scenario_file::{Contender, Contest, RunEntry, Scenario, Source};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::compare::Figure;
use anyhow::Result;
use recorded::SetEntry;
pub use recorded::{Learnt, Places, RecordedSet, RowChoice};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use survey::SurveyEntry;
pub use survey::{RadioSurvey, SpotChoice};
use toml::Spanned;

/// Runs of a scenario, where nothing is said.
const SEEDS: u32 = 20;

/// A suite, checked.
pub struct Suite {
    /// Its heading.
    pub title: String,
    /// What it is.
    pub about: String,
    /// Its parts.
    pub parts: Vec<Part>,
}

/// A scenario or a recorded set, who competes on it, and how it is judged.
pub struct Part {
    /// Its name.
    pub name: String,
    /// What it is and how it is judged.
    pub about: String,
    /// The figure of merit.
    pub figure: Figure,
    /// What is run.
    pub source: PartSource,
    /// Who competes, and how runs are judged.
    pub contest: Contest,
    /// Contenders of the opening table; the first of each method where this is empty.
    pub table: Vec<String>,
}

/// What a part runs on.
pub enum PartSource {
    /// A scenario, where its file is, and the number of seeds.
    Simulated(Box<Scenario>, PathBuf, u32),
    /// A recorded set.
    Recorded(Box<RecordedSet>),
    /// Scans at known spots.
    Survey(Box<RadioSurvey>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entries {
    #[serde(rename = "kind")]
    _kind: Kind,
    title: String,
    #[serde(default)]
    about: String,
    #[serde(default)]
    data: PathBuf,
    #[serde(default)]
    runs: Vec<Spanned<RunEntry>>,
    parts: Vec<Spanned<PartEntry>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    Suite,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PartEntry {
    name: Spanned<String>,
    about: String,
    figure: Figure,
    scenario: Option<PathBuf>,
    seeds: Option<u32>,
    #[serde(default)]
    keep: Option<Vec<Spanned<String>>>,
    set: Option<SetEntry>,
    survey: Option<SurveyEntry>,
    align: Option<Alignment>,
    judged_from_s: Option<f64>,
    judged_every_s: Option<Spanned<f64>>,
    #[serde(default)]
    runs: Vec<Spanned<RunEntry>>,
    #[serde(default)]
    table: Vec<Spanned<String>>,
    #[serde(default)]
    settings: BTreeMap<Spanned<String>, toml::Table>,
}

/// How every file that `adit compare` takes begins.
#[derive(Deserialize)]
struct Head {
    kind: Option<String>,
}

impl Suite {
    /// Whether a file is a suite, not a scenario.
    pub fn is_one(path: &Path) -> bool {
        let head = config::text(path).ok().and_then(|text| toml::from_str::<Head>(&text).ok());
        head.and_then(|head| head.kind).is_some_and(|kind| kind == "suite")
    }

    /// Reads and checks a suite and the scenarios that it names.
    pub fn read(path: &Path) -> Result<Self> {
        let text = config::text(path)?;
        let entries: Entries = config::parse(path, &text)?;
        let source = Source::new(path, &text);
        let everywhere = Contender::all(&entries.runs, &source)?;
        let data = match std::env::var_os("ADIT_DATA") {
            Some(folder) => PathBuf::from(folder),
            None => source.folder().join(&entries.data),
        };
        let mut parts: Vec<Part> = Vec::with_capacity(entries.parts.len());
        for entry in &entries.parts {
            let part = Part::of(entry, &everywhere, &data, &source)?;
            if parts.iter().any(|other| other.name == part.name) {
                let what = format!("two parts are called \"{}\": give one another name", part.name);
                return Err(source.error(&entry.get_ref().name.span(), &what));
            }
            parts.push(part);
        }
        Ok(Self { title: entries.title, about: entries.about, parts })
    }
}

impl Part {
    fn of(
        entry: &Spanned<PartEntry>,
        everywhere: &[Contender],
        data: &Path,
        source: &Source,
    ) -> Result<Self> {
        let at = entry.get_ref();
        let (what, mut contest) = match (&at.scenario, &at.set, &at.survey) {
            (Some(file), None, None) => {
                let path = source.folder().join(file);
                let scenario = Scenario::read(&path)?;
                let mut contest = scenario.contest()?;
                keep(&mut contest, at.keep.as_deref(), source)?;
                (PartSource::Simulated(Box::new(scenario), path, at.seeds.unwrap_or(SEEDS)), contest)
            }
            (None, Some(set), None) => {
                (PartSource::Recorded(Box::new(set.checked(data, source)?)), Contest::default())
            }
            (None, None, Some(survey)) => return at.of_survey(survey.checked(data, source)?, source),
            _ => {
                let what =
                    format!("part \"{}\": expected one of `scenario`, `set`, `survey`", at.name.get_ref());
                return Err(source.error(&at.name.span(), &what));
            }
        };
        if let (PartSource::Recorded(_), Some(name)) = (&what, at.keep.iter().flatten().next()) {
            let what = "`keep` chooses among the contenders of a scenario: a set has none of its own";
            return Err(source.error(&name.span(), what));
        }
        contest.align = at.align.or(contest.align);
        contest.moments.from_s = at.judged_from_s.unwrap_or(contest.moments.from_s);
        if let Some(every_s) = &at.judged_every_s {
            contest.moments.every_s = source.every_s(every_s)?;
        }
        let own = Contender::all(&at.runs, source)?;
        let replaced = |contender: &Contender| own.iter().any(|other| other.name == contender.name);
        contest.contenders.retain(|contender| !replaced(contender));
        let first = everywhere.iter().filter(|contender| !replaced(contender)).cloned();
        contest.contenders = first.chain(contest.contenders).chain(own.iter().cloned()).collect();
        if contest.contenders.is_empty() {
            let what = format!("part \"{}\" has no contenders: add `runs`", at.name.get_ref());
            return Err(source.error(&at.name.span(), &what));
        }
        let names: Vec<String> = contest.contenders.iter().map(|contender| contender.name.clone()).collect();
        for (name, settings) in &at.settings {
            known(name, &names, source)?;
            for contender in contest.contenders.iter_mut().filter(|c| c.name == *name.get_ref()) {
                config::merge(&mut contender.config, settings.clone());
            }
        }
        for name in &at.table {
            known(name, &names, source)?;
        }
        Ok(Self {
            name: at.name.get_ref().clone(),
            about: at.about.clone(),
            figure: at.figure,
            source: what,
            contest,
            table: at.table.iter().map(|name| name.get_ref().clone()).collect(),
        })
    }

    /// For each method the contender that stands for it in the opening table.
    pub fn table(&self) -> Vec<(String, String)> {
        let mut table: Vec<(String, String)> = Vec::new();
        for contender in &self.contest.contenders {
            let method = contender.method.name();
            let chosen = self.table.is_empty() || self.table.contains(&contender.name);
            if chosen && !table.iter().any(|(known, _)| known == method) {
                table.push((method.to_owned(), contender.name.clone()));
            }
        }
        table
    }
}

impl PartEntry {
    /// A part without tracks: its contenders are the locators.
    fn of_survey(&self, survey: RadioSurvey, source: &Source) -> Result<Part> {
        let runs = self.runs.first().map(Spanned::span);
        let keep = self.keep.iter().flatten().next().map(Spanned::span);
        if let Some(span) = runs.or(keep) {
            let what = "`runs` and `keep` have no use with `survey`, whose contenders are all locators";
            return Err(source.error(&span, what));
        }
        Ok(Part {
            name: self.name.get_ref().clone(),
            about: self.about.clone(),
            figure: self.figure,
            source: PartSource::Survey(Box::new(survey)),
            contest: Contest::default(),
            table: self.table.iter().map(|name| name.get_ref().clone()).collect(),
        })
    }
}

fn keep(contest: &mut Contest, names: Option<&[Spanned<String>]>, source: &Source) -> Result<()> {
    let Some(names) = names else { return Ok(()) };
    let there: Vec<String> = contest.contenders.iter().map(|contender| contender.name.clone()).collect();
    for name in names {
        known(name, &there, source)?;
    }
    contest.contenders.retain(|contender| names.iter().any(|name| *name.get_ref() == contender.name));
    Ok(())
}

fn known(name: &Spanned<String>, names: &[String], source: &Source) -> Result<()> {
    if names.contains(name.get_ref()) {
        return Ok(());
    }
    let what = format!("no contender is called \"{}\", expected {}", name.get_ref(), names.join(", "));
    Err(source.error(&name.span(), &what))
}

#[cfg(test)]
mod tests;
