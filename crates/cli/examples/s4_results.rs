//! Writes the figures of system S4 as Markdown: `s4_results ADIT SCENARIOS OUT.md FIGURE.svg`.
//!
//! `adit compare scenarios/s4.toml` over 20 seeds next to the paper. Called by `ci/results.sh`.

#[path = "support/comparison.rs"]
mod comparison;

use anyhow::{Context, Result, bail};
use comparison::{compare, number};
use serde_json::Value;
use std::fmt::Write;
use std::path::PathBuf;

const SEEDS: &str = "20";

/// Name, and the paper's mean and largest error.
const CONTENDERS: [(&str, &str, &str); 10] = [
    ("UWB alone", "1.88 m", "3.71 m"),
    ("UWB alone, robust", "–", "–"),
    ("PDR alone", "1.72 m", "3.75 m"),
    ("uwb-pdr, as the paper", "0.31 m", "1.19 m"),
    ("uwb-pdr", "–", "–"),
    ("robust KF", "1.420 m", "–"),
    ("EKF", "0.475 m", "–"),
    ("adaptive EKF", "0.330 m", "–"),
    ("EKF, judged and corrected", "–", "–"),
    ("robust KF, judged and corrected", "–", "–"),
];

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, scenarios, out, figure] = arguments.as_slice() else {
        bail!("usage: s4_results ADIT SCENARIOS OUT.md FIGURE.svg")
    };
    let (report, distribution) = compare(adit, &scenarios.join("s4.toml"), SEEDS)?;
    std::fs::write(figure, distribution)?;
    let text = positions(&report)? + "\n" + &ranges(&report["ranges"]["uwb-pdr"])?;
    std::fs::write(out, text).with_context(|| out.display().to_string())
}

fn positions(report: &Value) -> Result<String> {
    let mut text = format!(
        "| {SEEDS} seeds | paper: mean | largest | adit: mean | 95 % | largest | mean and worst run's mean | median run's largest |\n|---|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    for (name, mean, largest) in CONTENDERS {
        let of = |at: &str| number(&report["methods"][name], at).context(name);
        writeln!(
            text,
            "| {name} | {mean} | {largest} | {:.2} m | {:.2} m | {:.2} m | {:.2} / {:.2} m | {:.2} m |",
            of("/position_m/mean")?,
            of("/position_m/p95")?,
            of("/position_m/max")?,
            of("/over_seeds/position_mean_m/mean")?,
            of("/over_seeds/position_mean_m/max")?,
            of("/over_seeds/largest_position_m/median")?,
        )?;
    }
    Ok(text)
}

fn ranges(report: &Value) -> Result<String> {
    let of = |at: &str| number(report, at);
    let percent = |at: &str| of(at).map(|share| format!("{:.1} %", 100.0 * share));
    let mut text = String::from("| ranges and their recognition | paper | adit |\n|---|---:|---:|\n");
    for (what, paper, adit) in [
        (
            "error without line of sight, as measured",
            "1.37 m",
            format!("{:.2} m", of("/nlos_error_before_m")?),
        ),
        ("– corrected", "0.78 m", format!("{:.2} m", of("/nlos_error_after_m")?)),
        (
            "four classes: accuracy of one against the rest, mean",
            "95.3 %",
            percent("/recognition/mean/accuracy")?,
        ),
        ("– recall, mean", "91.9 %", percent("/recognition/mean/recall")?),
        ("– F1, mean", "92.0 %", percent("/recognition/mean/f1")?),
        ("– right of all", "–", percent("/recognition/accuracy")?),
        ("clear or not: accuracy", "–", percent("/recognition/binary/accuracy")?),
        ("– F1 of not clear", "–", percent("/recognition/binary/f1")?),
    ] {
        writeln!(text, "| {what} | {paper} | {adit} |")?;
    }
    Ok(text)
}
