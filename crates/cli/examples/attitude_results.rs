//! Runs `adit` and VQF over the recorded attitude trials, scores both by `adit eval`, and writes the figures as Markdown.
//!
//! `attitude_results ADIT DATA PYTHON OUT.md` takes the program, the folder of the sets, a Python with the package `vqf` of
//! VQF's authors, and the file to write. `ci/results.sh` calls it.
//!
//! Every trial is tracked with one setting, `adit track LOG --method ahrs -o EST.tum`, once more with `--smooth`, and by VQF
//! with its defaults, online and offline (`ci/rival/vqf_attitude.py`); then the same without the magnetometer. Figures are
//! those of `adit eval EST.tum --truth TRUTH`: root mean squares over the rows that the truth marks, nothing aligned.

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const SET: &str = "attitude-broad";
/// Beside the repository's root, from the folder of this crate.
const RIVAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../ci/rival/vqf_attitude.py");
/// The four that are compared, in the order of the columns; the rival's script writes files of the last two names.
const COLUMNS: [&str; 4] = ["adit", "adit `--smooth`", "VQF online", "VQF offline"];

/// Root mean square errors of one estimate, degrees.
#[derive(Clone, Copy)]
struct Errors {
    total: f64,
    heading: f64,
    inclination: f64,
}

/// One trial, by the columns: with the magnetometer, and without.
struct Trial {
    name: String,
    nine_axis: [Errors; 4],
    six_axis: [Errors; 4],
}

fn main() -> Result<ExitCode> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, data, python, out] = arguments.as_slice() else {
        bail!("usage: attitude_results ADIT DATA PYTHON OUT.md")
    };
    let folder = data.join(SET);
    if !folder.is_dir() {
        println!("SKIPPED (no test data): {SET}");
        return Ok(ExitCode::SUCCESS);
    }
    let scratch = tempfile::tempdir()?;
    let bench = Bench { adit, python, scratch: scratch.path() };
    let (mut trials, mut complete) = (Vec::new(), true);
    for log in logs_of(&folder)? {
        match bench.run(&log) {
            Ok(trial) => trials.push(trial),
            Err(error) => {
                complete = false;
                eprintln!("not scored: {}: {error:#}", log.display());
            }
        }
    }
    ensure!(!trials.is_empty(), "{}: no trial could be judged", folder.display());
    fs::write(out, tables(&trials)?).with_context(|| out.display().to_string())?;
    Ok(if complete { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The inertial logs of a set in order of name.
fn logs_of(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    let mut logs: Vec<PathBuf> = paths.into_iter().filter(|path| trial_name(path).is_some()).collect();
    logs.sort();
    Ok(logs)
}

/// `NAME` of `NAME_imu.csv` or `NAME_imu.csv.gz`.
fn trial_name(log: &Path) -> Option<&str> {
    let name = log.file_name()?.to_str()?;
    name.strip_suffix(".gz").unwrap_or(name).strip_suffix("_imu.csv")
}

struct Bench<'a> {
    adit: &'a Path,
    python: &'a Path,
    scratch: &'a Path,
}

impl Bench<'_> {
    fn run(&self, log: &Path) -> Result<Trial> {
        let name = trial_name(log).context("not a log")?.to_owned();
        let truth = [".csv", ".csv.gz"].map(|end| log.with_file_name(format!("{name}_truth{end}")));
        let truth = truth.iter().find(|path| path.exists()).context("no truth")?;
        let six = self.scratch.join("six_imu.csv");
        fs::write(&six, without_magnetometer(&text_of(log)?))?;
        Ok(Trial { nine_axis: self.compare(log, truth)?, six_axis: self.compare(&six, truth)?, name })
    }

    /// The errors of the four on one log.
    fn compare(&self, log: &Path, truth: &Path) -> Result<[Errors; 4]> {
        let path = |name: &str| self.scratch.join(name);
        let (online, smoothed) = (path("online.tum"), path("smoothed.tum"));
        let track = |out: &Path, more: &[&str]| {
            let mut command = Command::new(self.adit);
            run(command.arg("track").arg(log).args(["--method", "ahrs", "-o"]).arg(out).args(more))
        };
        track(&online, &[])?;
        track(&smoothed, &["--smooth"])?;
        let rivals = [path("vqf_online.tum"), path("vqf_offline.tum")];
        run(Command::new(self.python).arg(RIVAL).arg(log).args(&rivals))?;
        let [theirs_online, theirs_offline] = &rivals;
        Ok([
            self.eval(&online, truth)?,
            self.eval(&smoothed, truth)?,
            self.eval(theirs_online, truth)?,
            self.eval(theirs_offline, truth)?,
        ])
    }

    fn eval(&self, estimate: &Path, truth: &Path) -> Result<Errors> {
        let mut command = Command::new(self.adit);
        let json = run(command.arg("eval").arg(estimate).arg("--truth").arg(truth).arg("--json"))?;
        let report: Value = serde_json::from_slice(&json)?;
        let number = |name: &str| report[name].as_f64().with_context(|| format!("no number {name}"));
        Ok(Errors {
            total: number("rmse_attitude_deg")?,
            heading: number("rmse_heading_deg")?,
            inclination: number("rmse_inclination_deg")?,
        })
    }
}

/// What a command prints.
fn run(command: &mut Command) -> Result<Vec<u8>> {
    let output = command.output().with_context(|| format!("{command:?}"))?;
    if !output.status.success() {
        bail!("{}", String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(output.stdout)
}

/// A log as text, plain or gzip.
fn text_of(log: &Path) -> Result<String> {
    let raw = fs::read(log).with_context(|| log.display().to_string())?;
    if !raw.starts_with(b"\x1f\x8b") {
        return Ok(String::from_utf8(raw)?);
    }
    let mut text = String::new();
    MultiGzDecoder::new(raw.as_slice()).read_to_string(&mut text)?;
    Ok(text)
}

/// The same log without the columns of the magnetometer.
fn without_magnetometer(log: &str) -> String {
    let header = log.lines().next().unwrap_or_default();
    let kept: Vec<bool> = header.split(',').map(|name| !name.starts_with("mag_")).collect();
    let mut text = String::with_capacity(log.len());
    for line in log.lines() {
        let fields: Vec<&str> =
            line.split(',').zip(&kept).filter(|(_, kept)| **kept).map(|(field, _)| field).collect();
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}

fn tables(trials: &[Trial]) -> Result<String> {
    let mut out = String::new();
    let parts = |e: &Errors| format!("{:.2} / {:.2} / {:.2}", e.total, e.heading, e.inclination);
    writeln!(out, "RMSE in degrees where `moving` = 1: total / heading / inclination.\n")?;
    table(&mut out, trials, |trial| &trial.nine_axis, parts)?;
    writeln!(out, "\nWithout the magnetometer, inclination alone (the heading has no reference):\n")?;
    table(&mut out, trials, |trial| &trial.six_axis, |e| format!("{:.2}", e.inclination))?;
    Ok(out)
}

fn table(
    out: &mut String,
    trials: &[Trial],
    figures: fn(&Trial) -> &[Errors; 4],
    shown: fn(&Errors) -> String,
) -> Result<()> {
    writeln!(out, "| trial | {} |", COLUMNS.join(" | "))?;
    writeln!(out, "|---|---|---|---|---|")?;
    for trial in trials {
        writeln!(out, "| {} | {} |", trial.name, figures(trial).each_ref().map(shown).join(" | "))?;
    }
    let mean = |column: usize| {
        let mean = |part: fn(&Errors) -> f64| {
            trials.iter().map(|trial| part(&figures(trial)[column])).sum::<f64>() / trials.len() as f64
        };
        Errors {
            total: mean(|e| e.total),
            heading: mean(|e| e.heading),
            inclination: mean(|e| e.inclination),
        }
    };
    let means = [0, 1, 2, 3].map(|column| format!("**{}**", shown(&mean(column))));
    writeln!(out, "| **mean of {}** | {} |", trials.len(), means.join(" | "))?;
    Ok(())
}
