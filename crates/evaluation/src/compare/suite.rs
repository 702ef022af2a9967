//! Several comparisons as one: a row for each part, a column for each method, and what the figure is.

use super::figure::Figure;
use super::paired::PairedDifference;
use super::summary::Comparison;
use crate::statistics::Statistics;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::fmt;

/// The method that everything else is held against, where it competes.
const FIRST_CHOICE: &str = "fused";

/// All parts; JSON as `adit compare --json` documents it for a suite.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suite {
    /// The suite's file.
    pub suite: String,
    /// Its heading.
    pub title: String,
    /// What it is, in words.
    pub about: String,
    /// Methods in the order of the columns.
    pub columns: Vec<String>,
    /// The parts, in order.
    pub parts: Vec<SuitePart>,
}

/// A part: a scenario or a recorded set.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuitePart {
    /// Its name.
    pub name: String,
    /// What it is and how it is judged, in words.
    pub about: String,
    /// The figure of merit.
    pub figure: Figure,
    /// What that is, in words.
    pub figure_words: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Why it was not run, where it was not.
    pub skipped: Option<String>,
    /// What came out.
    #[serde(flatten)]
    pub judged: Option<JudgedPart>,
}

/// What came out of a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedPart {
    /// All figures of all contenders.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Names of the runs, in their order.
    pub run_names: Vec<String>,
    /// The figure of merit of each contender, by name.
    #[serde(serialize_with = "as_map")]
    pub merit: Vec<(String, Merit)>,
    /// For each method the contender that stands for it in the opening table.
    #[serde(serialize_with = "as_map")]
    pub table: Vec<(String, String)>,
    /// The best of these, among those that came to the end of as many runs as any.
    pub best: Option<String>,
    /// How much more the others err than `fused` where it competes, than the best where it does not.
    pub differences: Vec<Difference>,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// The figure of merit of one contender.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Merit {
    /// Mean over its runs; none where it came to the end of no run.
    pub mean: Option<f64>,
    /// Median over its runs.
    pub median: Option<f64>,
    /// Of the worst run.
    pub worst: Option<f64>,
    /// Runs that it came to the end of.
    pub runs: usize,
    /// Of each run, in their order.
    pub of_runs: Vec<Option<f64>>,
}

/// One contender minus another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// The one.
    pub one: String,
    /// The other, which is taken from it.
    pub minus: String,
    /// Over the runs of both.
    #[serde(flatten)]
    pub difference: PairedDifference,
}

impl Merit {
    /// Of one number of each run; none of a run that was given up.
    pub fn of(of_runs: Vec<Option<f64>>) -> Self {
        let known: Vec<f64> = of_runs.iter().flatten().copied().collect();
        let statistics = Statistics::of(&known);
        Self {
            mean: statistics.map(|s| s.mean),
            median: statistics.map(|s| s.median),
            worst: statistics.map(|s| s.max),
            runs: known.len(),
            of_runs,
        }
    }
}

impl JudgedPart {
    /// Of a comparison and the figure of merit of each contender; `table` has for each method the contender that stands for it.
    pub fn new(
        comparison: Comparison,
        run_names: Vec<String>,
        merit: Vec<(String, Merit)>,
        table: Vec<(String, String)>,
        warnings: Vec<String>,
    ) -> Self {
        let mut part =
            Self { comparison, run_names, merit, table, best: None, differences: Vec::new(), warnings };
        part.best = part.best_of_table().map(str::to_owned);
        let first =
            part.table.iter().find(|(method, _)| method == FIRST_CHOICE).map(|(_, name)| name.clone());
        if let Some(reference) = first.or_else(|| part.best.clone()) {
            part.differences = part.against(&reference);
        }
        part
    }

    /// Of a contender.
    pub fn merit_of(&self, name: &str) -> Option<&Merit> {
        self.merit.iter().find(|(known, _)| known == name).map(|(_, merit)| merit)
    }

    /// The contender that stands for a method in the opening table.
    pub fn of_method(&self, method: &str) -> Option<(&str, &Merit)> {
        let (_, name) = self.table.iter().find(|(known, _)| known == method)?;
        Some((name, self.merit_of(name)?))
    }

    fn best_of_table(&self) -> Option<&str> {
        let entered =
            || self.table.iter().filter_map(|(_, name)| Some((name.as_str(), self.merit_of(name)?)));
        let most = entered().map(|(_, merit)| merit.runs).max()?;
        let whole = entered().filter(|(_, merit)| merit.runs == most);
        let known = whole.filter_map(|(name, merit)| Some((name, merit.mean?)));
        known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(name, _)| name)
    }

    fn against(&self, reference: &str) -> Vec<Difference> {
        let Some(base) = self.merit_of(reference) else { return Vec::new() };
        let others = self.merit.iter().filter(|(name, _)| name != reference);
        let difference = |(name, merit): &(String, Merit)| {
            let difference = PairedDifference::of(&merit.of_runs, &base.of_runs)?;
            Some(Difference { one: name.clone(), minus: reference.to_owned(), difference })
        };
        others.filter_map(difference).collect()
    }

    /// How one contender differs from what everything is held against.
    pub fn difference_of(&self, name: &str) -> Option<&Difference> {
        self.differences.iter().find(|difference| difference.one == name)
    }
}

/// A number of a figure: three digits, and no more than three behind the point.
pub(super) fn shown(value: f64) -> String {
    let decimals = match value.abs() {
        v if v < 1.0 => 3,
        v if v < 100.0 => 2,
        _ => 0,
    };
    format!("{value:.decimals$}")
}

impl fmt::Display for Suite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: {} parts; mean over the runs, the best of a part with *\n",
            self.suite,
            self.parts.len()
        )?;
        let width = self.parts.iter().map(|part| part.name.chars().count()).max().unwrap_or(0);
        for part in &self.parts {
            let SuitePart { name, figure, unit, .. } = part;
            let Some(judged) = &part.judged else {
                writeln!(f, "{name:width$}  {}", part.skipped.as_deref().unwrap_or("not run"))?;
                continue;
            };
            let runs = judged.comparison.seeds;
            write!(f, "{name:width$}  {:14} {unit:2} {runs:3} runs ", figure.words())?;
            for (method, name) in &judged.table {
                let Some(merit) = judged.merit_of(name) else { continue };
                let value = merit.mean.map_or_else(|| "–".to_owned(), shown);
                let best = if judged.best.as_ref() == Some(name) { "*" } else { "" };
                let some =
                    if merit.runs < runs { format!(" ({} of {runs})", merit.runs) } else { String::new() };
                write!(f, "  {method} {value}{best}{some}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

fn as_map<T: Serialize, S: Serializer>(entries: &[(String, T)], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(entries.len()))?;
    for (name, value) in entries {
        map.serialize_entry(name, value)?;
    }
    map.end()
}
