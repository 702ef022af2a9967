//! Several comparisons as one: a row for each part, a column for each method, and what the figure is.

use super::figure::Figure;
use super::paired::PairedDifference;
use super::run::RunErrors;
use super::summary::Comparison;
use crate::statistics::Statistics;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::collections::BTreeSet;
use std::fmt;

/// The method that everything else is held against, where it competes.
const FIRST_CHOICE: &str = "fused";
/// A contender said where it was within so long, or it did not, s.
const SPAN_S: f64 = 10.0;
/// From this share of the time on it counts as all of it, as `adit eval` has it.
const WHOLE: f64 = 0.95;

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
    /// The best of these, among those that said nearly all the time where they were, and came to the end of as many runs as any; all of them where several are equal to the digits shown.
    pub best: Vec<String>,
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
    /// Share of the time in which it said where it was, of the time in which any contender did; over these runs.
    pub covered_share: Option<f64>,
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
            covered_share: None,
            of_runs,
        }
    }

    /// Whether it said where it was nearly all the time that any contender did: what is silent in the dark does not err there.
    pub fn is_whole(&self) -> bool {
        self.covered_share.is_none_or(|share| share >= WHOLE)
    }
}

/// Share of the time in which each contender gave judged moments, of the time in which any did; over the runs that it came to the end of.
/// `errors` are those of each contender, run by run.
pub fn covered_shares(errors: &[Vec<Option<&RunErrors>>]) -> Vec<Option<f64>> {
    let spans = |run: &RunErrors| -> BTreeSet<i64> {
        #[expect(clippy::cast_possible_truncation, reason = "seconds of a run")]
        let span = |time_s: &f32| (f64::from(*time_s) / SPAN_S).floor() as i64;
        run.time_s.iter().map(span).collect()
    };
    let each: Vec<Vec<Option<BTreeSet<i64>>>> =
        errors.iter().map(|runs| runs.iter().map(|run| run.map(spans)).collect()).collect();
    let runs = each.iter().map(Vec::len).max().unwrap_or(0);
    let any: Vec<usize> = (0..runs)
        .map(|run| {
            let told = each.iter().filter_map(|contender| contender.get(run)?.as_ref());
            told.flatten().collect::<BTreeSet<_>>().len()
        })
        .collect();
    let share = |contender: &Vec<Option<BTreeSet<i64>>>| {
        let of_runs = contender.iter().zip(&any).filter_map(|(told, any)| Some((told.as_ref()?.len(), *any)));
        let (told, any) = of_runs.fold((0, 0), |(told, any), (t, a)| (told + t, any + a));
        (any > 0).then(|| told as f64 / any as f64)
    };
    each.iter().map(share).collect()
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
            Self { comparison, run_names, merit, table, best: Vec::new(), differences: Vec::new(), warnings };
        part.best = part.best_of_table();
        let first =
            part.table.iter().find(|(method, _)| method == FIRST_CHOICE).map(|(_, name)| name.clone());
        if let Some(reference) = first.or_else(|| part.best.first().cloned()) {
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

    fn best_of_table(&self) -> Vec<String> {
        let entered =
            || self.table.iter().filter_map(|(_, name)| Some((name.as_str(), self.merit_of(name)?)));
        let whole = || entered().filter(|(_, merit)| merit.is_whole());
        let most = whole().map(|(_, merit)| merit.runs).max();
        let whole = whole().filter(|(_, merit)| Some(merit.runs) == most);
        let mut known: Vec<(&str, f64)> =
            whole.filter_map(|(name, merit)| Some((name, merit.mean?))).collect();
        known.sort_by(|a, b| a.1.total_cmp(&b.1));
        let least = known.first().map(|(_, mean)| shown(*mean));
        let equal = known.iter().take_while(|(_, mean)| Some(shown(*mean)) == least);
        equal.map(|(name, _)| (*name).to_owned()).collect()
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
                let best = if judged.best.contains(name) { "*" } else { "" };
                let some =
                    if merit.runs < runs { format!(" ({} of {runs})", merit.runs) } else { String::new() };
                let silent = merit.covered_share.filter(|_| !merit.is_whole());
                let silent =
                    silent.map_or_else(String::new, |share| format!(" ({:.0} % of the time)", 100.0 * share));
                write!(f, "  {method} {value}{best}{some}{silent}")?;
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

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn told(times_s: &[f32]) -> RunErrors {
        RunErrors { time_s: times_s.to_vec(), ..RunErrors::default() }
    }

    #[test]
    fn silence_is_a_share_of_the_time_that_anybody_spoke() {
        let (often, seldom, half) =
            (told(&[0.0, 5.0, 15.0, 25.0, 35.0]), told(&[9.0, 19.0, 29.0, 39.0]), told(&[1.0, 12.0]));
        let shares = covered_shares(&[
            vec![Some(&often), Some(&half)],
            vec![Some(&seldom), None],
            vec![Some(&half), Some(&half)],
        ]);
        assert_eq!(shares, [Some(1.0), Some(1.0), Some(4.0 / 6.0)]);
        assert_eq!(covered_shares(&[vec![None]]), [None]);
    }

    #[test]
    fn whoever_is_silent_is_not_the_best() {
        let merit = |mean: f64, covered_share| Merit { covered_share, ..Merit::of(vec![Some(mean)]) };
        let comparison = Comparison {
            scenario: String::new(),
            seeds: 1,
            first_seed: None,
            alignment: String::new(),
            judged_from_s: 0.0,
            judged_every_s: None,
            judged_above_m_s: 0.0,
            methods: Vec::new(),
        };
        let names = ["silent", "whole", "worse"].map(str::to_owned);
        let merits = [merit(1.0, Some(0.5)), merit(2.0, Some(0.99)), merit(3.0, None)];
        let table = names.iter().map(|name| (name.clone(), name.clone())).collect();
        let merits = names.iter().cloned().zip(merits).collect();
        let part = JudgedPart::new(comparison, vec!["only".to_owned()], merits, table, Vec::new());
        assert_eq!(part.best, ["whole"]);
        let difference = part.difference_of("silent").unwrap();
        assert_eq!((difference.minus.as_str(), difference.difference.mean), ("whole", -1.0));
    }
}
