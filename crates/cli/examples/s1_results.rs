//! Writes the figures of system S1 as Markdown: `s1_results ADIT SCENARIOS OUT.md FIGURE.svg`.
//!
//! `adit compare scenarios/s1.toml` over 30 seeds next to the paper, and where dead reckoning alone is after a minute. Called by `ci/results.sh`.

#[path = "support/comparison.rs"]
mod comparison;

use adit_observation::truth;
use anyhow::{Context, Result, bail};
use comparison::binary::{path, run};
use comparison::{compare, number};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const SEEDS: &str = "30";
/// Runs for the minute of dead reckoning.
const MINUTES: u32 = 10;

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, scenarios, out, figure] = arguments.as_slice() else {
        bail!("usage: s1_results ADIT SCENARIOS OUT.md FIGURE.svg")
    };
    let folder = TempDir::new()?;
    let (report, distribution) = compare(adit, &scenarios.join("s1.toml"), SEEDS)?;
    std::fs::write(figure, distribution)?;
    let text = table(&report)? + "\n" + &after_a_minute(adit, scenarios, folder.path())?;
    std::fs::write(out, text).with_context(|| out.display().to_string())
}

fn table(report: &Value) -> Result<String> {
    let paper = [
        ("weighted centroid", "3.84 m", "–", "–"),
        ("improved weighted centroid", "–", "–", "–"),
        ("PDR", "–", "–", "–"),
        ("fingerprints + PDR", "1.98 m", "–", "–"),
        ("pdr-wifi, untuned", "–", "–", "–"),
        ("pdr-wifi, BA", "–", "–", "52.75 %"),
        ("pdr-wifi, SCA", "–", "–", "55.31 %"),
        ("pdr-wifi, SCABA", "1.71 m", "2.49 m", "61.82 %"),
        ("pdr-wifi, CMA-ES", "–", "–", "–"),
    ];
    let mut text = format!(
        "| {SEEDS} seeds, all records | paper: mean | largest | below 2 m | adit: mean | largest | median run's largest | below 2 m |\n|---|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    for (name, mean, largest, share) in paper {
        let of = |at: &str| number(&report["methods"][name], at).context(name);
        writeln!(
            text,
            "| {name} | {mean} | {largest} | {share} | {:.2} m | {:.2} m | {:.2} m | {:.2} % |",
            of("/position_m/mean")?,
            of("/position_m/max")?,
            of("/over_seeds/largest_position_m/median")?,
            100.0 * of("/share_below_2m")?
        )?;
    }
    Ok(text)
}

/// Error of dead reckoning alone after the first minute of the test walk.
fn after_a_minute(adit: &Path, scenarios: &Path, folder: &Path) -> Result<String> {
    let (scenario, config) = (path(&scenarios.join("s1.toml"))?, path(&scenarios.join("s1-pdr.toml"))?);
    let mut errors = Vec::new();
    for seed in 1..=MINUTES {
        let made = folder.join("made");
        let estimate = path(&made.join("pdr.tum"))?;
        run(
            adit,
            &["simulate", &scenario, "-o", &path(&made)?, "--seed", &seed.to_string(), "--people", "2-2"],
        )?;
        let log = path(&made.join("p002/log.mcap"))?;
        run(adit, &["track", &log, "--method", "pdr", "--config", &config, "-o", &estimate])?;
        let place = |file: &Path| -> Result<_> {
            let path = truth::read(file)?.trajectory;
            let minute = path.poses().first().context("a path")?.time
                + adit_core::time::Interval::from_nanos(60_000_000_000);
            Ok(path.at(minute).context("a path of more than a minute")?.position_m.xy())
        };
        errors.push((place(Path::new(&estimate))? - place(&made.join("p002/truth.tum"))?).norm());
    }
    errors.sort_by(f64::total_cmp);
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    Ok(format!(
        "Dead reckoning alone after one minute, 90 m ({MINUTES} seeds): mean {mean:.1} m, largest {:.1} m; the paper has more than 6 m.\n",
        errors.last().copied().unwrap_or_default()
    ))
}
