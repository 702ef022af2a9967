//! Runs `adit` over the recorded foot-mounted sets, as anybody would, and writes the figures as Markdown.
//!
//! `recorded_results ADIT DATA OUT` takes the program, the folder of the sets and the folder for the results:
//! `sets.md`, a row for each set with truth, `loops.md`, a row for each walk without, and `trials.md`, a row for each
//! trial. `ci/results.sh` calls it.
//!
//! Every trial of every set is tracked with one setting, `adit track LOG --method foot-ins -o EST.tum`, and once more with
//! `--smooth`. Figures are those of `adit eval`: RMSE after an SE(2) fit over the run, end errors after matching position
//! and heading at the start. Shares and ratios leave out trials whose true path is no longer than 2 m.

use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// A set with truth, and how far its walkers have to be from the start before their direction is taken.
const SETS_WITH_TRUTH: [(&str, &str); 2] = [("foot-vicon", "1"), ("foot-hallway", "2")];
/// The set whose walks are judged by where they end.
const LOOPS: &str = "foot-loops";
/// A shorter path gives no share and no ratio, m.
const SHORTEST_PATH_M: f64 = 2.0;

#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Streaming,
    Smoothed,
}

impl Mode {
    const ALL: [Self; 2] = [Self::Streaming, Self::Smoothed];

    fn name(self) -> &'static str {
        match self {
            Self::Streaming => "streaming",
            Self::Smoothed => "`--smooth`",
        }
    }
}

/// Figures of one trial with truth.
struct Trial {
    name: String,
    mode: Mode,
    rmse_2d_m: f64,
    end_2d_m: f64,
    end_vertical_m: f64,
    path_truth_m: f64,
    path_estimate_m: f64,
}

/// Figures of one walk without truth.
struct Walk {
    name: String,
    mode: Mode,
    distance_m: f64,
    end_2d_m: f64,
    end_up_m: f64,
}

fn main() -> Result<ExitCode> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, data, out] = arguments.as_slice() else { bail!("usage: recorded_results ADIT DATA OUT") };
    let scratch = tempfile::tempdir()?;
    let bench = Bench { adit, estimate: scratch.path().join("estimate.tum") };
    let (mut sets, mut trials, mut loops) = (String::new(), String::new(), String::new());
    let (mut complete, mut runs) = (true, 0);

    for (set, start_distance_m) in SETS_WITH_TRUTH {
        let folder = data.join(set);
        let Some(logs) = logs_of(&folder)? else { continue };
        let rows =
            run_all(&logs, &mut complete, |log, mode| bench.against_truth(log, mode, start_distance_m));
        if runs == 0 {
            sets.push_str(SETS_HEADING);
        }
        runs += rows.len();
        summarise(&mut sets, set, &rows)?;
        list_trials(&mut trials, set, &rows)?;
    }
    if let Some(logs) = logs_of(&data.join(LOOPS))? {
        let rows = run_all(&logs, &mut complete, |log, mode| bench.walk(log, mode));
        runs += rows.len();
        list_walks(&mut loops, &rows)?;
    }
    if runs == 0 {
        bail!("{}: no recorded set could be judged", data.display());
    }
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    std::fs::write(out.join("sets.md"), sets)?;
    std::fs::write(out.join("loops.md"), loops)?;
    std::fs::write(out.join("trials.md"), format!("{TRIALS_HEADING}{trials}"))?;
    Ok(if complete { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The inertial logs of a set in order of name; a set that is not there is said to be skipped.
fn logs_of(folder: &Path) -> Result<Option<Vec<PathBuf>>> {
    if !folder.is_dir() {
        println!("SKIPPED (no test data): {}", folder.file_name().unwrap_or_default().display());
        return Ok(None);
    }
    let mut logs = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if trial_name(&path).is_some() {
            logs.push(path);
        }
    }
    logs.sort();
    Ok(Some(logs))
}

/// `NAME` of `NAME_imu.csv` or `NAME_imu.csv.gz`.
fn trial_name(log: &Path) -> Option<String> {
    let name = log.file_name()?.to_str()?;
    let stem = name.strip_suffix(".gz").unwrap_or(name).strip_suffix("_imu.csv")?;
    Some(stem.to_owned())
}

/// Every log in every mode; one that fails is named and left out of the figures.
fn run_all<T>(logs: &[PathBuf], complete: &mut bool, run: impl Fn(&Path, Mode) -> Result<T>) -> Vec<T> {
    let mut rows = Vec::new();
    for mode in Mode::ALL {
        for log in logs {
            match run(log, mode) {
                Ok(row) => rows.push(row),
                Err(error) => {
                    *complete = false;
                    eprintln!("not scored ({}): {error:#}", mode.name());
                }
            }
        }
    }
    rows
}

struct Bench<'a> {
    adit: &'a Path,
    estimate: PathBuf,
}

impl Bench<'_> {
    /// Tracks a log and returns the report of `adit track --json`.
    fn track(&self, log: &Path, mode: Mode) -> Result<Value> {
        let mut command = Command::new(self.adit);
        command.arg("track").arg(log).args(["--method", "foot-ins", "--json", "-", "-o"]).arg(&self.estimate);
        if mode == Mode::Smoothed {
            command.arg("--smooth");
        }
        json_of(&mut command)
    }

    fn eval(&self, truth: &Path, alignment: &[&str]) -> Result<Value> {
        let mut command = Command::new(self.adit);
        command.arg("eval").arg(&self.estimate).arg("--truth").arg(truth).arg("--json").args(alignment);
        json_of(&mut command)
    }

    fn against_truth(&self, log: &Path, mode: Mode, start_distance_m: &str) -> Result<Trial> {
        let name = trial_name(log).context("not a log")?;
        let plain = log.with_file_name(format!("{name}_truth.csv"));
        let truth = if plain.exists() { plain } else { log.with_file_name(format!("{name}_truth.csv.gz")) };
        self.track(log, mode)?;
        let run = self.eval(&truth, &["--align", "se2"])?;
        let start = self.eval(&truth, &["--align", "start", "--start-distance", start_distance_m])?;
        Ok(Trial {
            name,
            mode,
            rmse_2d_m: number(&run, "rmse_2d_m")?,
            end_2d_m: number(&start, "end_2d_m")?,
            end_vertical_m: number(&start, "end_vertical_m")?,
            path_truth_m: number(&run, "path_truth_m")?,
            path_estimate_m: number(&run, "path_estimate_m")?,
        })
    }

    fn walk(&self, log: &Path, mode: Mode) -> Result<Walk> {
        let name = trial_name(log).context("not a log")?;
        let report = self.track(log, mode)?;
        Ok(Walk {
            name,
            mode,
            distance_m: number(&report, "distance_m")?,
            end_2d_m: number(&report, "end_from_start_2d_m")?,
            end_up_m: number(&report, "end_from_start_up_m")?,
        })
    }
}

fn json_of(command: &mut Command) -> Result<Value> {
    let output = command.output().with_context(|| format!("{command:?}"))?;
    if !output.status.success() {
        bail!("{}", String::from_utf8_lossy(&output.stderr).trim());
    }
    serde_json::from_slice(&output.stdout).with_context(|| format!("{command:?}"))
}

fn number(report: &Value, name: &str) -> Result<f64> {
    report[name].as_f64().with_context(|| format!("no number {name} in the JSON report"))
}

const SETS_HEADING: &str = "\
| set | mode | runs | 2D RMSE, m: mean / median / worst | end error, m: mean (share of path) | vertical end error, m: mean | path ratio: mean (least–most) |
|---|---|---|---|---|---|---|
";

const TRIALS_HEADING: &str = "\
# Trial by trial

Written by `make results`; what the columns mean stands in [the results page](README.md).
";

fn summarise(out: &mut String, set: &str, rows: &[Trial]) -> Result<()> {
    for mode in Mode::ALL {
        let rows: Vec<&Trial> = rows.iter().filter(|row| row.mode == mode).collect();
        let long: Vec<&Trial> =
            rows.iter().filter(|row| row.path_truth_m > SHORTEST_PATH_M).copied().collect();
        let all = |figure: fn(&Trial) -> f64| Figures::of(rows.iter().map(|row| figure(row)));
        let of_long = |figure: fn(&Trial) -> f64| Figures::of(long.iter().map(|row| figure(row)));
        let (rmse, end) = (all(|t| t.rmse_2d_m), all(|t| t.end_2d_m));
        let (share, ratio) = (of_long(|t| t.end_2d_m / t.path_truth_m), of_long(Trial::path_ratio));
        writeln!(
            out,
            "| {set} | {} | {} | {:.3} / {:.3} / {:.3} | {:.3} ({:.2} %) | {:.3} | {:.3} ({:.3}–{:.3}) |",
            mode.name(),
            rows.len(),
            rmse.mean,
            rmse.median,
            rmse.most,
            end.mean,
            100.0 * share.mean,
            all(|t| t.end_vertical_m).mean,
            ratio.mean,
            ratio.least,
            ratio.most,
        )?;
    }
    Ok(())
}

fn list_trials(out: &mut String, set: &str, rows: &[Trial]) -> Result<()> {
    writeln!(out, "\n## {set}\n")?;
    writeln!(
        out,
        "| trial | mode | 2D RMSE, m | end error, m | vertical end error, m | true path, m | path ratio |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|---|")?;
    for row in rows {
        let Trial { name, mode, rmse_2d_m, end_2d_m, end_vertical_m, path_truth_m, .. } = row;
        let (mode, ratio) = (mode.name(), row.path_ratio());
        writeln!(
            out,
            "| {name} | {mode} | {rmse_2d_m:.3} | {end_2d_m:.3} | {end_vertical_m:.3} | {path_truth_m:.2} | {ratio:.3} |"
        )?;
    }
    Ok(())
}

fn list_walks(out: &mut String, rows: &[Walk]) -> Result<()> {
    writeln!(out, "| {LOOPS} | mode | path, m | end from start in space, m | level, m | height, m |")?;
    writeln!(out, "|---|---|---|---|---|---|")?;
    for Walk { name, mode, distance_m, end_2d_m, end_up_m } in rows {
        let (mode, end_3d_m) = (mode.name(), end_2d_m.hypot(*end_up_m));
        writeln!(
            out,
            "| {name} | {mode} | {distance_m:.2} | {end_3d_m:.3} | {end_2d_m:.3} | {end_up_m:+.3} |"
        )?;
    }
    Ok(())
}

impl Trial {
    fn path_ratio(&self) -> f64 {
        self.path_estimate_m / self.path_truth_m
    }
}

/// A figure over trials; NaN when there are none.
struct Figures {
    mean: f64,
    median: f64,
    least: f64,
    most: f64,
}

impl Figures {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let at = |index: usize| values.get(index).copied().unwrap_or(f64::NAN);
        let count = values.len();
        Self {
            mean: values.iter().sum::<f64>() / count as f64,
            median: 0.5 * (at(count.saturating_sub(1) / 2) + at(count / 2)),
            least: at(0),
            most: at(count.saturating_sub(1)),
        }
    }
}
