//! Runs `adit calibrate pathloss` and `adit calibrate fingerprint` over the recorded radio sets and writes what they say of every method
//! as one Markdown block.
//!
//! `radio_results ADIT DATA OUT.md` takes the program, the folder of the sets and the file to write. `ci/results.sh` calls it. One setting for all:
//! rssi-corridor with a fifth of the spots left out, ten draws; rssi-floors from its training to its test files; ble-tracks with
//! each track left out in turn.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A data set: its heading, the public baselines in words, and its parts.
struct Set {
    name: &'static str,
    protocol: &'static str,
    baseline: &'static str,
    parts: Vec<Part>,
}

/// What is fitted and judged together.
struct Part {
    name: &'static str,
    data: PathBuf,
    places: PathBuf,
    judge: Vec<String>,
}

fn main() -> Result<()> {
    let args: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, data, out] = &args[..] else { anyhow::bail!("usage: radio_results ADIT DATA OUT.md") };
    let folder = tempfile::tempdir()?;
    let mut text = String::new();
    for set in sets(data) {
        writeln!(text, "**{}**, {}; mean / median / 90 %, m. {}.\n", set.name, set.protocol, set.baseline)?;
        let reports: Vec<Vec<Value>> =
            set.parts.iter().map(|part| run(adit, part, folder.path())).collect::<Result<_>>()?;
        table(&mut text, &set, &reports)?;
    }
    std::fs::write(out, text.trim_end()).with_context(|| out.display().to_string())
}

fn sets(data: &Path) -> [Set; 3] {
    let corridor = |site: &'static str| Part {
        name: site,
        data: data.join(format!("rssi-corridor/{site}_train.csv.gz")),
        places: data.join(format!("rssi-corridor/{site}_access_points.csv")),
        judge: ["--leave-out", "0.2", "--draws", "10"].map(str::to_owned).into(),
    };
    let floors = |building: &'static str| Part {
        name: building,
        data: data.join(format!("rssi-floors/{building}_train.csv")),
        places: data.join(format!("rssi-floors/{building}_access_points.csv")),
        judge: vec![
            "--evaluate".to_owned(),
            data.join(format!("rssi-floors/{building}_test.csv")).display().to_string(),
        ],
    };
    [
        Set {
            name: "rssi-corridor",
            protocol: "a fifth of the spots left out, ten draws",
            baseline: "Public baselines: centroid 4.78, trilateration 4.72, nearest neighbours 2.14; ranges: least squares 3.32, nearest \
                       neighbours 0.91",
            parts: ["corridor", "lecture_theatre", "office"].map(corridor).into(),
        },
        Set {
            name: "rssi-floors",
            protocol: "fitted to the training file, judged on the test file",
            baseline: "Public baselines of hcxy: centroid 4.60, trilateration 3.43, nearest neighbours 3.03, its paper about 2.3",
            parts: ["hcxy", "cetc331"].map(floors).into(),
        },
        Set {
            name: "ble-tracks",
            protocol: "each track left out in turn",
            baseline: "Public baselines, mean of a track: trilateration 2.17 to 2.72, nearest neighbours 1.79 to 3.44",
            parts: vec![Part {
                name: "all tracks",
                data: data.join("ble-tracks"),
                places: data.join("ble-tracks/receivers.csv"),
                judge: ["--leave-out", "each"].map(str::to_owned).into(),
            }],
        },
    ]
}

/// Rows of both calibrations.
fn run(adit: &Path, part: &Part, folder: &Path) -> Result<Vec<Value>> {
    let mut rows = Vec::new();
    for verb in ["pathloss", "fingerprint"] {
        let output = Command::new(adit)
            .args(["calibrate", verb])
            .arg(&part.data)
            .arg("--access-points")
            .arg(&part.places)
            .arg("-o")
            .arg(folder.join("out"))
            .args(&part.judge)
            .arg("--json")
            .output()
            .with_context(|| adit.display().to_string())?;
        ensure!(output.status.success(), "{}: {}", part.name, String::from_utf8_lossy(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout)?;
        rows.extend(report["judged"][0]["methods"].as_array().cloned().unwrap_or_default());
    }
    Ok(rows)
}

fn table(text: &mut String, set: &Set, reports: &[Vec<Value>]) -> Result<()> {
    let figure = |row: &Value, name: &str| row[name].as_f64().unwrap_or(f64::NAN);
    let several = reports.len() > 1;
    let tracks = set.name == "ble-tracks";
    let floors = set.name == "rssi-floors";
    let names: Vec<&str> = set.parts.iter().map(|part| part.name).collect();
    let mean = if several && !floors { " mean |" } else { "" };
    writeln!(
        text,
        "| method | {} |{mean} in 95 % |{}",
        names.join(" | "),
        if floors { " floor |" } else { "" }
    )?;
    let columns = names.len() + usize::from(several && !floors) + 1 + usize::from(floors);
    writeln!(text, "|---{}|", "|---".repeat(columns))?;
    let Some(first) = reports.first() else { return Ok(()) };
    for method in first {
        let name = method["method"].as_str().unwrap_or_default();
        let rows: Vec<&Value> =
            reports.iter().filter_map(|rows| rows.iter().find(|row| row["method"] == name)).collect();
        write!(text, "| {name} |")?;
        for row in &rows {
            let of_tracks = row["trial_means_m"]
                .as_array()
                .map(|means| means.iter().filter_map(Value::as_f64).sum::<f64>() / means.len().max(1) as f64);
            let mean = of_tracks.filter(|_| tracks).unwrap_or(figure(row, "mean_m"));
            write!(text, " {mean:.2} / {:.2} / {:.2} |", figure(row, "median_m"), figure(row, "p90_m"))?;
        }
        let over = |name: &str| rows.iter().map(|row| figure(row, name)).sum::<f64>() / rows.len() as f64;
        if several && !floors {
            write!(text, " {:.2} |", over("mean_m"))?;
        }
        write!(text, " {:.0} % |", 100.0 * over("inside_95"))?;
        if floors {
            write!(
                text,
                " {:.1} % |",
                100.0 * rows.last().map_or(f64::NAN, |row| figure(row, "right_floor"))
            )?;
        }
        writeln!(text)?;
    }
    writeln!(text)?;
    Ok(())
}
