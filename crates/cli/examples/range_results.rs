//! Runs `adit calibrate range` over the recorded UWB sets and writes what it says of their ranges as one Markdown table.
//!
//! `range_results ADIT DATA OUT.md` takes the program, the folder of the sets and the file to write. `ci/results.sh` calls it.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name, data below the folder of the sets, what is held out.
const SETS: [(&str, &str, &str); 5] = [
    ("uwb-industrial", "uwb-industrial", "each place of the tag"),
    ("uwb-cir", "uwb-cir", "each geometry"),
    ("uwb-outdoor, static", "uwb-outdoor/static_ranges.csv.gz", "a tenth of the spots"),
    ("uwb-imu-rig, 2D", "uwb-imu-rig/loop-2d-fast_s1_ranges.csv.gz", "a fifth of the time"),
    ("uwb-imu-rig, 3D", "uwb-imu-rig/loop-3d_s5_ranges.csv", "a fifth of the time"),
];

fn main() -> Result<()> {
    let args: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, data, out] = &args[..] else { anyhow::bail!("usage: range_results ADIT DATA OUT.md") };
    let folder = tempfile::tempdir()?;
    let mut text = String::from(
        "| set, held out | ranges | as measured: MAE / RMSE / 95 % | corrected | corrected, class known | error²/σ² | offsets; model not judged |\n\
         |---|---|---|---|---|---|---|\n",
    );
    for (name, path, held) in SETS {
        let path = data.join(path);
        if !path.exists() {
            println!("SKIPPED (no test data): {name}");
            continue;
        }
        let report = run(adit, &path, folder.path())?;
        for one in report["held_out"].as_array().context("no held_out")? {
            row(&mut text, (name, held), one, &report["learnt"])?;
        }
    }
    std::fs::write(out, text.trim_end()).with_context(|| out.display().to_string())
}

fn row(text: &mut String, (name, held): (&str, &str), one: &Value, learnt: &Value) -> Result<()> {
    let errors = |kind: &str| {
        let value = |name: &str| one[kind][name].as_f64();
        let all = (value("mae_m"), value("rmse_m"), value("p95_m"));
        if let (Some(mae), Some(rmse), Some(most)) = all {
            format!("{mae:.3} / {rmse:.3} / {most:.3}")
        } else {
            String::new()
        }
    };
    let class = one["class"].as_str();
    let of = |part: &str| learnt[part]["chosen"].as_str().unwrap_or_default().to_owned();
    let all = || (format!("{name}, {held}"), format!("{}; {}", of("offsets"), of("unjudged")));
    let (label, chosen) = class.map_or_else(all, |class| (format!("– {class}"), String::new()));
    let ranges = one["ranges"].as_u64().context("no ranges")?;
    let square = one["normalised_square"].as_f64().context("no normalised_square")?;
    writeln!(
        text,
        "| {label} | {ranges} | {} | {} | {} | {square:.2} | {chosen} |",
        errors("raw"),
        errors("corrected"),
        errors("class_known")
    )?;
    Ok(())
}

fn run(adit: &Path, data: &Path, folder: &Path) -> Result<Value> {
    let mut command = Command::new(adit);
    command.args(["calibrate", "range"]).arg(data).arg("-o").arg(folder.join("ranges.toml")).arg("--json");
    let output = command.output().with_context(|| adit.display().to_string())?;
    ensure!(output.status.success(), "{}: {}", data.display(), String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).context("its report")
}
