//! The table `[compare]`: which methods run on the scenario, how each is configured, and how they are judged.

use super::{Scenario, Source};
use crate::args::OptimiserName;
use crate::config;
use crate::judged_ranges;
use crate::method::MethodName;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::compare::{GRID_S, Moments};
use adit_nlos::Model;
use adit_observation::ObservationKind;
use adit_tuning::optimise::Method as Optimiser;
use anyhow::Result;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Spanned;

/// The table as written.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CompareEntry {
    /// What is forgiven before errors are taken.
    align: Option<Alignment>,
    /// Judged from this time on, s.
    #[serde(default)]
    judged_from_s: f64,
    /// Time between judged moments, s.
    judged_every_s: Option<Spanned<f64>>,
    /// Judged only while the truth moves faster than this, m/s.
    #[serde(default)]
    judged_above_m_s: f64,
    /// Whose log, of everybody in a mine, from 1.
    #[serde(default = "first")]
    person: Spanned<usize>,
    /// How methods are tuned before they are judged.
    tuning: Option<TuningEntry>,
    /// The methods.
    runs: Vec<Spanned<RunEntry>>,
}

/// A run as written.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunEntry {
    name: Option<String>,
    method: MethodName,
    #[serde(default)]
    config: toml::Table,
    config_file: Option<PathBuf>,
    /// Table of the settings that the file is of, where the method has parts that are methods themselves.
    config_of: Option<String>,
    #[serde(default = "yes")]
    figures: bool,
    /// Optimiser that tunes it first.
    tune: Option<OptimiserName>,
    /// Person whose log makes its fingerprints, from 1.
    survey: Option<Spanned<usize>>,
    /// Person whose log tells how ranges err, from 1.
    calibrate: Option<Spanned<usize>>,
    /// Model that judges its ranges: one that ships with adit, or a file beside the scenario.
    nlos: Option<String>,
    /// The kinds of observations that it gets; all where this is none.
    only: Option<Vec<ObservationKind>>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct TuningEntry {
    person: Spanned<usize>,
    #[serde(default)]
    config: toml::Table,
    agents: usize,
    evaluations: usize,
}

/// How methods are judged, and which.
#[derive(Debug, Clone, Default)]
pub struct Contest {
    /// What is forgiven before errors are taken, where something is said of it.
    pub align: Option<Alignment>,
    /// Which moments are judged.
    pub moments: Moments,
    /// Whose log, of everybody in a mine, from 0.
    pub person: usize,
    /// How methods are tuned before they are judged.
    pub tuning: Option<Tuning>,
    /// Who competes.
    pub contenders: Vec<Contender>,
}

/// How methods are tuned on the log of one person before they are judged on another's.
#[derive(Debug, Clone)]
pub struct Tuning {
    /// Whose log, from 0.
    pub person: usize,
    /// Settings there, over those of the method.
    pub config: toml::Table,
    /// Agents of a generation.
    pub agents: usize,
    /// Evaluations in all.
    pub evaluations: usize,
}

/// A method and its settings.
#[derive(Debug, Clone)]
pub struct Contender {
    /// Name in the tables.
    pub name: String,
    /// The method.
    pub method: MethodName,
    /// Settings over its defaults.
    pub config: toml::Table,
    /// Whether it stands in the figures.
    pub in_figures: bool,
    /// Optimiser that tunes it first.
    pub tune: Option<Optimiser>,
    /// Person whose log makes its fingerprints, from 0.
    pub survey: Option<usize>,
    /// Person whose log tells how ranges err, from 0.
    pub calibrate: Option<usize>,
    /// Model that judges its ranges before they reach it.
    pub nlos: Option<Arc<Model>>,
    /// The kinds of observations that it gets; all where this is none.
    pub only: Option<Vec<ObservationKind>>,
}

impl Contender {
    /// A method as it comes.
    pub fn plain(method: MethodName) -> Self {
        let (name, config) = (method.name().to_owned(), toml::Table::new());
        Self {
            name,
            method,
            config,
            in_figures: true,
            tune: None,
            survey: None,
            calibrate: None,
            nlos: None,
            only: None,
        }
    }

    /// Those that a file lists; no two of one name.
    pub fn all(entries: &[Spanned<RunEntry>], source: &Source) -> Result<Vec<Self>> {
        let contenders = entries.iter().map(|run| Self::of(run, source)).collect::<Result<Vec<_>>>()?;
        for (nth, run) in entries.iter().enumerate() {
            let name = &contenders[nth].name;
            if contenders[..nth].iter().any(|other| other.name == *name) {
                let what = format!("two runs are called \"{name}\": give one another name");
                return Err(source.error(&run.span(), &what));
            }
        }
        Ok(contenders)
    }

    fn of(entry: &Spanned<RunEntry>, source: &Source) -> Result<Self> {
        let RunEntry {
            name,
            method,
            config,
            config_file,
            config_of,
            figures,
            tune,
            survey,
            calibrate,
            nlos,
            only,
        } = entry.get_ref();
        let mut settings = match config_file {
            None => toml::Table::new(),
            Some(file) => {
                let path = source.folder().join(file);
                config::parse(&path, &config::text(&path)?)?
            }
        };
        if let Some(part) = config_of {
            settings = toml::Table::from_iter([(part.clone(), toml::Value::Table(settings))]);
        }
        config::merge(&mut settings, config.clone());
        Ok(Self {
            name: name.clone().unwrap_or_else(|| method.name().to_owned()),
            method: *method,
            config: settings,
            in_figures: *figures,
            tune: tune.map(|name| name.0),
            survey: survey.as_ref().map(|person| source.number(person)).transpose()?,
            calibrate: calibrate.as_ref().map(|person| source.number(person)).transpose()?,
            nlos: nlos.as_deref().map(|name| judged_ranges::model(name, source.folder())).transpose()?,
            only: only.clone(),
        })
    }
}

impl Scenario {
    /// What the scenario says of a comparison.
    pub fn contest(&self) -> Result<Contest> {
        let Some(entry) = &self.entries.compare else { return Ok(Contest::default()) };
        let contenders = Contender::all(&entry.runs, &self.source)?;
        let every_s =
            entry.judged_every_s.as_ref().map(|every_s| self.source.every_s(every_s)).transpose()?;
        let moments = Moments {
            from_s: entry.judged_from_s,
            every_s: every_s.unwrap_or(GRID_S),
            above_m_s: entry.judged_above_m_s,
        };
        let tuning = entry.tuning.as_ref().map(|tuning| {
            let TuningEntry { person, config, agents, evaluations } = tuning;
            let person = self.source.number(person)?;
            Ok::<_, anyhow::Error>(Tuning {
                person,
                config: config.clone(),
                agents: *agents,
                evaluations: *evaluations,
            })
        });
        let tuning = tuning.transpose()?;
        if tuning.is_none()
            && let Some(run) = entry.runs.iter().find(|run| run.get_ref().tune.is_some())
        {
            let what = "a run that is tuned needs [compare.tuning]: person, agents, evaluations";
            return Err(self.source.error(&run.span(), what));
        }
        Ok(Contest {
            align: entry.align,
            moments,
            person: self.source.number(&entry.person)?,
            tuning,
            contenders,
        })
    }
}

impl Source {
    /// The folder of the file.
    pub fn folder(&self) -> &Path {
        self.file().parent().unwrap_or(Path::new(""))
    }

    /// A person of the mine, counted from 1 in the file and from 0 here.
    fn number(&self, person: &Spanned<usize>) -> Result<usize> {
        person
            .get_ref()
            .checked_sub(1)
            .ok_or_else(|| self.error(&person.span(), "person is 0, expected the number of a person, from 1"))
    }

    /// A time between judged moments.
    pub fn every_s(&self, every_s: &Spanned<f64>) -> Result<f64> {
        let found = *every_s.get_ref();
        if (1e-3..=1e6).contains(&found) {
            return Ok(found);
        }
        let what = format!("judged_every_s is {found}, expected 0.001 to 1e6 s");
        Err(self.error(&every_s.span(), &what))
    }
}

fn yes() -> bool {
    true
}

fn first() -> Spanned<usize> {
    Spanned::new(0..0, 1)
}
