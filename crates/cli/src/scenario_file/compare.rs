//! The table `[compare]`: which methods run on the scenario, how each is configured, and how they are judged.

use super::Scenario;
use crate::config;
use crate::method::MethodName;
use adit_evaluation::alignment::Alignment;
use anyhow::Result;
use serde::Deserialize;
use std::path::{Path, PathBuf};
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
    /// The methods.
    runs: Vec<Spanned<RunEntry>>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct RunEntry {
    name: Option<String>,
    method: MethodName,
    #[serde(default)]
    config: toml::Table,
    config_file: Option<PathBuf>,
    #[serde(default = "yes")]
    figures: bool,
}

/// How methods are judged, and which.
#[derive(Debug, Clone, Default)]
pub struct Contest {
    /// What is forgiven before errors are taken, where something is said of it.
    pub align: Option<Alignment>,
    /// Judged from this time on, s.
    pub judged_from_s: f64,
    /// Who competes.
    pub contenders: Vec<Contender>,
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
}

impl Contender {
    /// A method as it comes.
    pub fn plain(method: MethodName) -> Self {
        Self { name: method.name().to_owned(), method, config: toml::Table::new(), in_figures: true }
    }
}

impl Scenario {
    /// What the scenario says of a comparison.
    pub fn contest(&self) -> Result<Contest> {
        let Some(entry) = &self.entries.compare else { return Ok(Contest::default()) };
        let contenders = entry.runs.iter().map(|run| self.contender(run)).collect::<Result<Vec<_>>>()?;
        for (nth, run) in entry.runs.iter().enumerate() {
            let name = &contenders[nth].name;
            if contenders[..nth].iter().any(|other| other.name == *name) {
                let what = format!("two runs are called \"{name}\": give one another name");
                return Err(self.source.error(&run.span(), &what));
            }
        }
        Ok(Contest { align: entry.align, judged_from_s: entry.judged_from_s, contenders })
    }

    fn contender(&self, entry: &Spanned<RunEntry>) -> Result<Contender> {
        let RunEntry { name, method, config, config_file, figures } = entry.get_ref();
        let mut settings = match config_file {
            None => toml::Table::new(),
            Some(file) => {
                let path = self.source.folder().join(file);
                config::parse(&path, &config::text(&path)?)?
            }
        };
        config::merge(&mut settings, config.clone());
        Ok(Contender {
            name: name.clone().unwrap_or_else(|| method.name().to_owned()),
            method: *method,
            config: settings,
            in_figures: *figures,
        })
    }
}

impl super::Source {
    /// The folder of the file.
    pub fn folder(&self) -> &Path {
        self.file().parent().unwrap_or(Path::new(""))
    }
}

fn yes() -> bool {
    true
}
