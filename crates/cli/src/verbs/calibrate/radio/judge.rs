//! How far the fixes of a method are from the truth, as a table and as JSON.

use super::Trial;
use adit_core::nalgebra::Vector2;
use adit_estimation::radio::PlaceFix;
use adit_evaluation::statistics::Statistics;
use anyhow::Result;
use serde::Serialize;
use std::fmt::Write as _;

/// The fixes of one method.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Its name.
    pub method: &'static str,
    errors_m: Vec<f64>,
    inside: usize,
    right_floor: usize,
    asked: usize,
}

impl Judged {
    /// Nothing yet.
    pub fn new(method: &'static str) -> Self {
        Self { method, errors_m: Vec::new(), inside: 0, right_floor: 0, asked: 0 }
    }

    /// One more scan.
    pub fn record(&mut self, fix: Option<&PlaceFix>, truth_m: &Vector2<f64>, floor: i32) {
        self.asked += 1;
        let Some(PlaceFix { fix, floor: found, .. }) = fix else { return };
        let error = (fix.position_m - truth_m).norm();
        self.inside += usize::from(error <= fix.radius_95_m());
        self.right_floor += usize::from(*found == floor);
        self.errors_m.push(error);
    }

    /// How far its fixes are from the truth, m.
    pub fn errors_m(&self) -> &[f64] {
        &self.errors_m
    }

    /// All of another.
    pub fn add(&mut self, other: &Self) {
        self.errors_m.extend(&other.errors_m);
        self.inside += other.inside;
        self.right_floor += other.right_floor;
        self.asked += other.asked;
    }

    fn summary(&self, trial_means_m: Vec<f64>) -> Option<Summary> {
        let statistics = Statistics::of(&self.errors_m)?;
        let count = self.errors_m.len() as f64;
        Some(Summary {
            mean_m: statistics.mean,
            median_m: statistics.median,
            p90_m: statistics.p90,
            max_m: statistics.max,
            inside_95: self.inside as f64 / count,
            right_floor: self.right_floor as f64 / count,
            fixes: self.errors_m.len(),
            asked: self.asked,
            trial_means_m,
        })
    }

    fn mean_m(&self) -> f64 {
        self.errors_m.iter().sum::<f64>() / self.errors_m.len().max(1) as f64
    }
}

/// Figures of one method over all trials of a kind.
#[derive(Debug, Serialize)]
struct Summary {
    mean_m: f64,
    median_m: f64,
    p90_m: f64,
    max_m: f64,
    /// Share of the truths inside the stated 95 % radius.
    inside_95: f64,
    /// Share of fixes on the right floor.
    right_floor: f64,
    /// Fixes given.
    fixes: usize,
    /// Fixes asked for.
    asked: usize,
    /// Mean of each trial.
    trial_means_m: Vec<f64>,
}

/// One table: trials of one kind.
#[derive(Debug, Serialize)]
pub struct Table {
    /// What was judged.
    of: String,
    /// The trials.
    trials: Vec<String>,
    methods: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    method: &'static str,
    #[serde(flatten)]
    summary: Summary,
}

/// Makes the tables of trials that were run: what was left out in one, each test in its own.
pub fn tables(results: &[(&Trial<'_>, Vec<Judged>)]) -> Vec<Table> {
    let left_out: Vec<_> = results.iter().filter(|(trial, _)| trial.of != "tests").collect();
    let tests = results.iter().filter(|(trial, _)| trial.of == "tests");
    let mut tables = Vec::new();
    if let Some((trial, _)) = left_out.first() {
        tables.push(table(trial.of.to_owned(), &left_out));
    }
    tables.extend(tests.map(|one| table(one.0.name.clone(), &[one])));
    tables
}

fn table(of: String, results: &[&(&Trial<'_>, Vec<Judged>)]) -> Table {
    let names = results.first().map(|(_, judged)| judged.iter().map(|one| one.method));
    let row = |method: &'static str| {
        let mut all = Judged::new(method);
        let mut means = Vec::new();
        for one in results.iter().flat_map(|(_, judged)| judged).filter(|one| one.method == method) {
            all.add(one);
            means.push(one.mean_m());
        }
        Some(Row { method, summary: all.summary(means)? })
    };
    Table {
        of,
        trials: results.iter().map(|(trial, _)| trial.name.clone()).collect(),
        methods: names.into_iter().flatten().filter_map(row).collect(),
    }
}

impl Table {
    /// As text; floors where there are several.
    pub fn write(&self, text: &mut String, floors: bool) -> Result<()> {
        writeln!(text, "\n{} ({})", self.of, self.trials.join(", "))?;
        let floor = if floors { "   floor" } else { "" };
        writeln!(
            text,
            "{:28} {:>7} {:>7} {:>7} {:>7}  in 95 %   fixes{floor}",
            "", "mean m", "median", "90 %", "max"
        )?;
        for Row { method, summary: s } in &self.methods {
            write!(
                text,
                "{method:28} {:7.2} {:7.2} {:7.2} {:7.2} {:6.1} % {:7}",
                s.mean_m,
                s.median_m,
                s.p90_m,
                s.max_m,
                100.0 * s.inside_95,
                s.fixes
            )?;
            if floors {
                write!(text, " {:5.1} %", 100.0 * s.right_floor)?;
            }
            if self.trials.len() > 1 {
                let means: Vec<String> = s.trial_means_m.iter().map(|mean| format!("{mean:.2}")).collect();
                write!(text, "   {}", means.join(" "))?;
            }
            writeln!(text)?;
        }
        Ok(())
    }
}
