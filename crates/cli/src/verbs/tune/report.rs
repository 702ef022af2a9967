//! What is said of a search: as JSON, as a table, as a figure.

use super::parameters::{Bound, Parameters};
use super::runs::{Judgement, Rules, mean_cost};
use super::search::Searched;
use crate::args::TuneArgs;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::plot::{ConvergenceCurve, convergence_figure};
use anyhow::Result;
use serde::Serialize;
use std::fmt;

/// What `--json` writes.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Name of the method.
    pub method: &'static str,
    /// What was judged.
    pub judged: Judgement,
    /// What was forgiven.
    pub alignment: Alignment,
    judged_from_s: f64,
    optimizer: &'static str,
    seed: u64,
    agents: u32,
    evaluations: usize,
    evaluations_per_s: f64,
    elapsed_s: f64,
    /// Mean over the training runs of their mean squared errors with the settings as they were, m² or deg².
    pub cost_before: f64,
    /// The same with those found.
    pub cost_after: f64,
    /// False where nothing better than the settings as they were was found: then they were written.
    pub improved: bool,
    /// What was searched.
    pub parameters: Vec<FoundParameter>,
    /// The runs searched on.
    pub train: Vec<JudgedRun>,
    /// The runs only judged.
    pub validate: Vec<JudgedRun>,
    /// Evaluations and least cost at each improvement.
    improvements: Vec<(usize, f64)>,
}

/// One parameter.
#[derive(Debug, Serialize)]
pub struct FoundParameter {
    name: String,
    default: f64,
    /// What was found.
    pub found: f64,
    least: f64,
    largest: f64,
    at_bound: Option<Bound>,
}

impl FoundParameter {
    /// Nothing better than the setting as it was.
    pub fn is_as_it_was(&self) -> bool {
        self.found.to_bits() == self.default.to_bits()
    }
}

/// One run: root of its mean squared error, m or deg; none where the method failed.
#[derive(Debug, Serialize)]
pub struct JudgedRun {
    log: String,
    rmse_before: Option<f64>,
    rmse_after: Option<f64>,
}

/// Mean squared errors of runs, none where the method failed.
pub struct BeforeAfter {
    /// Names of the runs.
    pub logs: Vec<String>,
    /// With the settings as they were.
    pub before: Vec<Option<f64>>,
    /// With those found.
    pub after: Vec<Option<f64>>,
}

impl BeforeAfter {
    fn runs(&self) -> Vec<JudgedRun> {
        let both = self.before.iter().zip(&self.after).zip(&self.logs);
        both.map(|((before, after), log)| JudgedRun {
            log: log.clone(),
            rmse_before: before.map(f64::sqrt),
            rmse_after: after.map(f64::sqrt),
        })
        .collect()
    }
}

impl Report {
    /// All of it.
    pub fn new(
        args: &TuneArgs,
        rules: &Rules,
        parameters: &Parameters,
        values: Option<&[f64]>,
        searched: Searched,
        (train, validate): (&BeforeAfter, Option<&BeforeAfter>),
    ) -> Self {
        let defaults = parameters.defaults();
        let found = parameters.0.iter().zip(values.unwrap_or(&defaults));
        Self {
            method: args.method.name(),
            judged: rules.what,
            alignment: rules.alignment,
            judged_from_s: rules.from_s,
            optimizer: args.optimizer.0.name(),
            seed: args.seed,
            agents: args.agents,
            evaluations: searched.found.evaluations,
            evaluations_per_s: searched.evaluations_now as f64 / searched.elapsed_s.max(f64::MIN_POSITIVE),
            elapsed_s: searched.elapsed_s,
            cost_before: mean_cost(&train.before),
            cost_after: mean_cost(&train.after),
            improved: values.is_some(),
            parameters: found
                .map(|(parameter, found)| FoundParameter {
                    name: parameter.name.clone(),
                    default: parameter.default,
                    found: *found,
                    least: parameter.least,
                    largest: parameter.largest,
                    at_bound: parameter.at_bound(*found),
                })
                .collect(),
            train: train.runs(),
            validate: validate.map(BeforeAfter::runs).unwrap_or_default(),
            improvements: searched.found.improvements,
        }
    }

    /// Unit of an error; of a cost its square.
    pub fn unit(&self) -> &'static str {
        self.judged.unit()
    }

    /// The least cost so far over the evaluations.
    pub fn figure(&self) -> Result<String> {
        let curve = ConvergenceCurve {
            label: format!("{}, seed {}", self.optimizer, self.seed),
            improvements: self.improvements.clone(),
            evaluations: self.evaluations,
        };
        let title = format!("Search of {} noise parameters of {}", self.parameters.len(), self.method);
        let unit = format!("{}²", self.unit());
        Ok(convergence_figure(&[curve], Some(("before", self.cost_before)), &title, &unit)?)
    }

    /// What was searched, where it was and where it is.
    pub fn parameter_table(&self) -> String {
        let width = self.parameters.iter().map(|parameter| parameter.name.len()).max().unwrap_or_default();
        let row = |name: &str, cells: [&str; 4], note: &str| {
            let [default, found, least, largest] = cells;
            let row = format!("{name:<width$}  {default:>9}  {found:>9}  {least:>9}  {largest:>9}  {note}");
            row.trim_end().to_owned() + "\n"
        };
        let mut table = row("", ["before", "found", "least", "largest"], "");
        for parameter in &self.parameters {
            let FoundParameter { name, default, found, least, largest, at_bound } = parameter;
            let note = match at_bound {
                None if parameter.is_as_it_was() => "as it was",
                None => "",
                Some(Bound::Least) => "at its least",
                Some(Bound::Largest) => "at its largest",
            };
            let cells = [default, found, least, largest].map(|value| number(*value));
            table += &row(name, cells.each_ref().map(String::as_str), note);
        }
        table
    }

    fn run_table(&self, f: &mut fmt::Formatter<'_>, what: &str, runs: &[JudgedRun]) -> fmt::Result {
        let title = format!("{what}, RMSE in {}", self.unit());
        let width = runs.iter().map(|run| run.log.chars().count()).max().unwrap_or(0).max(title.len());
        writeln!(f, "\n{title:<width$}  {:>9}  {:>9}", "before", "after")?;
        for JudgedRun { log, rmse_before, rmse_after } in runs {
            let [before, after] =
                [rmse_before, rmse_after].map(|rmse| rmse.map_or_else(|| "failed".to_owned(), number));
            writeln!(f, "{log:<width$}  {before:>9}  {after:>9}")?;
        }
        let together = |of: fn(&JudgedRun) -> Option<f64>| -> Option<f64> {
            let squares =
                runs.iter().map(|run| of(run).map(|rmse| rmse * rmse)).collect::<Option<Vec<_>>>()?;
            Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        };
        let [before, after] = [together(|run| run.rmse_before), together(|run| run.rmse_after)]
            .map(|rmse| rmse.map_or_else(|| "–".to_owned(), number));
        writeln!(f, "{:<width$}  {before:>9}  {after:>9}", "together")
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.unit();
        writeln!(f, "method      {}, {} noise parameters", self.method, self.parameters.len())?;
        writeln!(
            f,
            "judged      {}, aligned {}, from {} s on",
            self.judged.words(),
            self.alignment,
            self.judged_from_s
        )?;
        writeln!(f, "search      {}, seed {}, {} evaluations", self.optimizer, self.seed, self.evaluations)?;
        writeln!(
            f,
            "cost        {} {unit}² before, {} {unit}² after",
            number(self.cost_before),
            number(self.cost_after)
        )?;
        writeln!(f, "speed       {:.1} evaluations a second", self.evaluations_per_s)?;
        write!(f, "\n{}", self.parameter_table())?;
        self.run_table(f, "train", &self.train)?;
        if !self.validate.is_empty() {
            self.run_table(f, "validate", &self.validate)?;
        }
        Ok(())
    }
}

/// A number in four digits at most.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let scientific = format!("{value:.3e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| -> String {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text.to_owned()
        }
    };
    match usize::try_from(3 - exponent) {
        Ok(decimals) if exponent >= -3 => trimmed(&format!("{value:.decimals$}")),
        _ => format!("{}e{exponent}", trimmed(digits)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (0.1, "0.1"),
            (0.12345, "0.1235"),
            (2e-4, "2e-4"),
            (2.3456e-7, "2.346e-7"),
            (0.0012, "0.0012"),
            (30.0, "30"),
            (9999.6, "1e4"),
            (1e12, "1e12"),
            (0.0, "0"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
