//! Runs every method on UWB ranges over the recorded sets, and writes the figures as Markdown.
//!
//! `uwb_results ADIT DATA OUT.md` takes the program, the folder of the sets and the file to write. `ci/results.sh` calls it.
//!
//! Of each run `adit track RANGES --method M --mine ANCHORS -o EST.tum` and `adit eval EST.tum --truth TRUTH --align A`, with the defaults of
//! the methods. Made for it, in a scratch folder: anchors with their four columns alone; the heights that uwb-person does not tell (2 m); of uwb-imu-rig the truth of the
//! tag, from the rows of its ranges (the rows of `SEQ_truth.csv` at stamps of the inertial sensor are 1.43 s late against those); truths from 2 s after the first range
//! to the last one, since ranges of three runs end before their truth and no method can cover the 95 % of it that `adit eval` asks for.

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// A column of the table: its head, the method, its settings.
const METHODS: [(&str, &str, &str); 5] = [
    ("`uwb-ls`, linear", "uwb-ls", "[solver]\nkind = \"linear-3d\"\n"),
    ("`uwb-ls`, robust", "uwb-ls", ""),
    ("`uwb-ekf`", "uwb-ekf", ""),
    ("`uwb-rkf`", "uwb-rkf", ""),
    ("`uwb-aekf`", "uwb-aekf", ""),
];
/// The sets: their runs, alignment, dimensions.
const SETS: [(&str, &[&str], &str, usize); 4] = [
    ("uwb-imu-walk", &["walk1"], "se3", 3),
    ("uwb-imu-rig", &["loop-2d-fast_s1", "loop-3d_s5"], "none", 3),
    ("uwb-outdoor", &["los_a_case1", "nlos_a_case2", "los_b_case3", "nlos_b_case4"], "none", 2),
    ("uwb-person", &["lab_m1l", "lab_m3s"], "se2", 2),
];
/// After the first range, s: a filter needs a moment to begin.
const BEGINNING_S: f64 = 2.0;
const LAB_HEIGHT_M: &str = "2.0";

fn main() -> Result<ExitCode> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, data, out] = arguments.as_slice() else { bail!("usage: uwb_results ADIT DATA OUT.md") };
    let scratch = tempfile::tempdir()?;
    let mut text = String::from("| run | figure |");
    METHODS.iter().for_each(|(head, ..)| text += &format!(" {head} |"));
    text += "\n|---|---|---|---|---|---|---|\n";
    let mut complete = true;
    for (set, runs, align, dimensions) in SETS {
        let folder = data.join(set);
        if !folder.is_dir() {
            println!("SKIPPED (no test data): {set}");
            complete = false;
            continue;
        }
        for name in runs {
            let run = Run::prepare(&folder, name, scratch.path())?;
            write!(text, "| {set} {name} | {dimensions}D, `{align}` |")?;
            for (_, method, settings) in METHODS {
                text += &run.figures(adit, method, settings, align, dimensions)?;
            }
            text.push('\n');
        }
    }
    fs::write(out, text).with_context(|| out.display().to_string())?;
    Ok(if complete { ExitCode::SUCCESS } else { ExitCode::from(3) })
}

/// A log, its anchors and its truth.
struct Run<'a> {
    ranges: PathBuf,
    anchors: PathBuf,
    truth: PathBuf,
    scratch: &'a Path,
}

impl<'a> Run<'a> {
    fn prepare(folder: &Path, name: &str, scratch: &'a Path) -> Result<Self> {
        let ranges = either(folder, &format!("{name}_ranges"))?;
        let times = column(&read(&ranges)?, "time_s")?;
        let [first, last] =
            [times.iter().copied().fold(f64::INFINITY, f64::min), times.iter().copied().fold(0.0, f64::max)];
        let truth = match either(folder, &format!("{name}_ranges_truth")) {
            Ok(of_ranges) => read(&of_ranges)?.replace("tag_x_m,tag_y_m,tag_z_m", "x_m,y_m,z_m"),
            Err(_) => read(&either(folder, &format!("{name}_truth"))?)?,
        };
        let run =
            Self { ranges, anchors: scratch.join("anchors.csv"), truth: scratch.join("truth.csv"), scratch };
        fs::write(&run.truth, cut(&truth, first + BEGINNING_S, last)?)?;
        fs::write(&run.anchors, anchors(folder, name)?)?;
        Ok(run)
    }

    /// RMSE, median and largest error.
    fn figures(
        &self,
        adit: &Path,
        method: &str,
        settings: &str,
        align: &str,
        dimensions: usize,
    ) -> Result<String> {
        let (path, config) = (self.scratch.join("path.tum"), self.scratch.join("settings.toml"));
        fs::write(&config, settings)?;
        let track = Command::new(adit)
            .arg("track")
            .arg(&self.ranges)
            .args(["--method", method, "--mine"])
            .arg(&self.anchors)
            .arg("--config")
            .arg(&config)
            .arg("-o")
            .arg(&path)
            .output()?;
        if !track.status.success() {
            let told = String::from_utf8_lossy(&track.stderr);
            // Linear squares in space have no solution among anchors of one height.
            ensure!(told.contains("no position"), "{}", told.trim());
            return Ok(" – |".into());
        }
        let eval = Command::new(adit)
            .arg("eval")
            .arg(&path)
            .arg("--truth")
            .arg(&self.truth)
            .args(["--align", align, "--json"])
            .output()?;
        if !eval.status.success() {
            // It asks for 95 % of the truth: epochs without a position at the end, mostly.
            return Ok(" – |".into());
        }
        let report: Value = serde_json::from_slice(&eval.stdout)?;
        let number = |name: &str| {
            let name = format!("{name}_{dimensions}d_m");
            report[&name].as_f64().context(name)
        };
        Ok(format!(" {:.3} / {:.3} / {:.2} |", number("rmse")?, number("median")?, number("max")?))
    }
}

fn either(folder: &Path, stem: &str) -> Result<PathBuf> {
    let files = [".csv", ".csv.gz"].map(|end| folder.join(format!("{stem}{end}")));
    files.into_iter().find(|file| file.exists()).with_context(|| format!("no {stem} in {}", folder.display()))
}

fn read(path: &Path) -> Result<String> {
    let bytes = fs::read(path)?;
    let mut text = String::new();
    if path.extension().is_some_and(|end| end == "gz") {
        MultiGzDecoder::new(bytes.as_slice()).read_to_string(&mut text)?;
    } else {
        text = String::from_utf8(bytes)?;
    }
    Ok(text)
}

fn place_of(head: &str, name: &str) -> Result<usize> {
    head.split(',').position(|column| column == name).with_context(|| format!("no column {name} in {head}"))
}

fn column(text: &str, name: &str) -> Result<Vec<f64>> {
    let mut lines = text.lines();
    let at = place_of(lines.next().unwrap_or_default(), name)?;
    lines.map(|line| Ok(line.split(',').nth(at).unwrap_or_default().parse()?)).collect()
}

/// The rows of a truth within a time, in rising order of it, one at a time.
fn cut(truth: &str, from_s: f64, to_s: f64) -> Result<String> {
    let mut lines = truth.lines();
    let head = lines.next().unwrap_or_default();
    let at =
        [place_of(head, "time_s")?, place_of(head, "x_m")?, place_of(head, "y_m")?, place_of(head, "z_m")?];
    let mut rows: Vec<(f64, String)> = Vec::new();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let time_s: f64 = fields[at[0]].parse()?;
        if (from_s..=to_s).contains(&time_s) {
            rows.push((time_s, at.map(|at| fields[at]).join(",")));
        }
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.dedup_by(|a, b| a.0 == b.0);
    let rows: Vec<String> = rows.into_iter().map(|(_, row)| row).collect();
    Ok(format!("time_s,x_m,y_m,z_m\n{}\n", rows.join("\n")))
}

/// The four columns that a list of anchors has.
fn anchors(folder: &Path, name: &str) -> Result<String> {
    let mut text = String::from("anchor_id,x_m,y_m,z_m\n");
    if let Ok(own) = either(folder, &format!("{name}_anchors")) {
        for line in read(&own)?.lines().skip(1) {
            let fields: Vec<&str> = line.split(',').take(4).collect();
            writeln!(text, "{}", fields.join(","))?;
        }
        return Ok(text);
    }
    for line in read(&folder.join("anchors.csv"))?.lines().filter(|line| line.starts_with("lab,")) {
        let fields: Vec<&str> = line.split(',').collect();
        writeln!(text, "{},{},{},{LAB_HEIGHT_M}", fields[1], fields[2], fields[3])?;
    }
    Ok(text)
}
