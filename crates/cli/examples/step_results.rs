//! Runs `adit track --method pdr` over the recorded sets with counted steps, and writes the figures as Markdown.
//!
//! `step_results ADIT DATA OUT.md` takes the program, the folder of the sets and the file to write. `ci/results.sh` calls it.
//!
//! Every recording is tracked with one setting, `adit track LOG --method pdr -o EST.tum --json REPORT.json`, and once more with
//! `[steps] detector = "zero-crossing"`. The error is that of the count, against the count of the set; the columns of the phone
//! and of the set's authors are those of `counts.csv`.

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Length of the walks of gait-lowback, m: 10 out, 10 back.
const OUT_AND_BACK_M: f64 = 20.0;

/// One recording.
struct Recording {
    name: String,
    /// Carrying position or person.
    group: String,
    truth: f64,
    gait: Report,
    crossings: Report,
    /// What others counted.
    others: [Option<f64>; 2],
}

/// What `adit track` says.
struct Report {
    steps: f64,
    distance_m: f64,
}

impl Recording {
    fn error(&self, steps: f64) -> f64 {
        100.0 * (steps - self.truth).abs() / self.truth
    }
}

fn main() -> Result<ExitCode> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, data, out] = arguments.as_slice() else { bail!("usage: step_results ADIT DATA OUT.md") };
    let scratch = tempfile::tempdir()?;
    let bench = Bench { adit, scratch: scratch.path() };
    fs::write(bench.config(), "[steps]\ndetector = \"zero-crossing\"\n")?;
    let mut text = String::new();
    for (set, table) in
        [("steps", by_position as fn(&Bench, &Path) -> Result<String>), ("gait-lowback", by_person)]
    {
        let folder = data.join(set);
        if folder.is_dir() {
            text += &table(&bench, &folder)?;
        } else {
            println!("SKIPPED (no test data): {set}");
        }
    }
    if !text.is_empty() {
        fs::write(out, text).with_context(|| out.display().to_string())?;
    }
    Ok(ExitCode::SUCCESS)
}

struct Bench<'a> {
    adit: &'a Path,
    scratch: &'a Path,
}

impl Bench<'_> {
    fn config(&self) -> PathBuf {
        self.scratch.join("crossings.toml")
    }

    /// One recording with both detectors.
    fn run(&self, folder: &Path, name: &str) -> Result<(Report, Report)> {
        let logs = ["_imu.csv.gz", "_imu.csv"].map(|end| folder.join(format!("{name}{end}")));
        let log = logs.iter().find(|log| log.exists()).with_context(|| format!("no log of {name}"))?;
        let gait = self.track(log, &[])?;
        let config = self.config();
        let crossings = self.track(log, &["--config".as_ref(), config.as_ref()])?;
        Ok((gait, crossings))
    }

    fn track(&self, log: &Path, more: &[&Path]) -> Result<Report> {
        let json = self.scratch.join("report.json");
        let mut command = Command::new(self.adit);
        command.arg("track").arg(log).args(["--method", "pdr", "-o"]).arg(self.scratch.join("path.tum"));
        let output = command.arg("--json").arg(&json).args(more).output()?;
        ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
        let report: Value = serde_json::from_slice(&fs::read(&json)?)?;
        let number = |name: &str| report["method_report"][name].as_f64().with_context(|| name.to_owned());
        Ok(Report { steps: number("steps")?, distance_m: number("distance_m")? })
    }
}

/// The rows of a table of a set, by column name.
fn rows(path: &Path) -> Result<Vec<BTreeMap<String, String>>> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let row =
        |line: &str| names.iter().map(ToString::to_string).zip(line.split(',').map(str::to_owned)).collect();
    Ok(lines.map(row).collect())
}

fn number(row: &BTreeMap<String, String>, name: &str) -> Option<f64> {
    row.get(name)?.parse().ok()
}

fn recordings(
    bench: &Bench,
    folder: &Path,
    table: &str,
    names: [&str; 2],
    others: [&str; 2],
) -> Result<Vec<Recording>> {
    let mut recordings = Vec::new();
    for row in rows(&folder.join(table))? {
        let [name, group] = names.map(|column| row.get(column).cloned().unwrap_or_default());
        let truth = number(&row, "steps_true").with_context(|| format!("no count of {name}"))?;
        let (gait, crossings) = bench.run(folder, &name)?;
        let others = others.map(|column| number(&row, column));
        recordings.push(Recording { name, group, truth, gait, crossings, others });
    }
    Ok(recordings)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// Mean and worst of the errors of one column, as far as it has numbers.
fn errors(all: &[Recording], of: impl Fn(&Recording) -> Option<f64>) -> String {
    let errors: Vec<f64> = all.iter().filter_map(|r| of(r).map(|steps| r.error(steps))).collect();
    let worst = errors.iter().fold(0.0, |worst: f64, error| worst.max(*error));
    format!("{:.2} % / {worst:.2} %", mean(errors.iter().copied()))
}

/// `steps`: a row for each carrying position.
fn by_position(bench: &Bench, folder: &Path) -> Result<String> {
    let columns = ["steps_phone_hardware", "steps_upstream_algorithm"];
    let all = recordings(bench, folder, "counts.csv", ["recording", "recording"], columns)?;
    let mut out = String::from("`steps`, a phone in six places, two persons:\n\n");
    writeln!(out, "| person, place | true | `gait` | `zero-crossing` | the phone's own | the authors' |")?;
    writeln!(out, "|---|---:|---:|---:|---:|---:|")?;
    let shown = |steps: Option<f64>| steps.map_or_else(|| "–".to_owned(), |steps| format!("{steps}"));
    for r in &all {
        let name = r.name.replace('_', ", ");
        let [phone, authors] = r.others.map(shown);
        writeln!(
            out,
            "| {name} | {} | {} | {} | {phone} | {authors} |",
            r.truth, r.gait.steps, r.crossings.steps
        )?;
    }
    writeln!(
        out,
        "| **error: mean / worst** | | **{}** | {} | {} | {} |\n",
        errors(&all, |r| Some(r.gait.steps)),
        errors(&all, |r| Some(r.crossings.steps)),
        errors(&all, |r| r.others[0]),
        errors(&all, |r| r.others[1]),
    )?;
    Ok(out)
}

/// `gait-lowback`: a row for each person.
fn by_person(bench: &Bench, folder: &Path) -> Result<String> {
    let all = recordings(bench, folder, "trials.csv", ["trial", "subject"], ["", ""])?;
    let mut persons: BTreeMap<u32, Vec<&Recording>> = BTreeMap::new();
    for r in &all {
        persons.entry(r.group.parse()?).or_default().push(r);
    }
    let mut out = String::from("`gait-lowback`, a tag on the lower back, 10 m out, turn, 10 m back:\n\n");
    writeln!(
        out,
        "| person | runs | steps a run | `gait`: error, bias | `zero-crossing`: error, bias | way, m (about 20) |"
    )?;
    writeln!(out, "|---|---:|---:|---:|---:|---:|")?;
    let cells = |runs: &[&Recording]| {
        let over = |of: &dyn Fn(&Recording) -> f64| mean(runs.iter().map(|r| of(r)));
        format!(
            "{} | {:.1} | {:.2} %, {:+.2} | {:.2} %, {:+.2} | {:.1}",
            runs.len(),
            over(&|r| r.truth),
            over(&|r| r.error(r.gait.steps)),
            over(&|r| r.gait.steps - r.truth),
            over(&|r| r.error(r.crossings.steps)),
            over(&|r| r.crossings.steps - r.truth),
            over(&|r| r.gait.distance_m),
        )
    };
    for (person, runs) in &persons {
        writeln!(out, "| {person} | {} |", cells(runs))?;
    }
    let every: Vec<&Recording> = all.iter().collect();
    writeln!(out, "| **all** | {} |\n", cells(&every))?;
    let share = |r: &&&Recording| (r.gait.distance_m / OUT_AND_BACK_M - 1.0).abs();
    let off = 100.0 * mean(every.iter().map(|r| share(&r)));
    writeln!(
        out,
        "The way differs from 20 m by {off:.1} % in the mean; what the turn itself adds is not taken out."
    )?;
    Ok(out)
}
