//! Writes the figures of system S0 as Markdown: `s0_results ADIT SCENARIOS OUT.md FIGURE.svg`.
//!
//! `adit compare` over 100 seeds next to the paper and the limits, the same over 500, with the sensor that the paper names, and
//! what the ten states learn on a walk. Called by `ci/results.sh`.

use adit_estimation::methods::Known;
use adit_estimation::methods::MethodSettings;
use adit_estimation::methods::ins_wifi::{InsWifiParams, ReducedInsWifi, ReducedInsWifiParams};
use adit_observation::open;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Seeds of the table that the acceptance of S0 asks for, and of the one that says how much 100 seeds scatter.
const SEEDS: [&str; 2] = ["100", "500"];

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [adit, scenarios, out, figure] = arguments.as_slice() else {
        bail!("usage: s0_results ADIT SCENARIOS OUT.md FIGURE.svg")
    };
    let folder = TempDir::new()?;
    let compare = |scenario: &str, seeds: &str| -> Result<Value> {
        let (json, page) = (folder.path().join("c.json"), folder.path().join("c.html"));
        adit_runs(
            adit,
            &["compare", &path(scenarios, scenario)?, "--seeds", seeds],
            &[("-o", &page), ("--json", &json)],
        )?;
        if seeds == SEEDS[0] && scenario == "s0.toml" {
            std::fs::write(figure, second_figure(&std::fs::read_to_string(&page)?)?)?;
        }
        Ok(serde_json::from_str(&std::fs::read_to_string(&json)?)?)
    };
    let (hundred, many) = (compare("s0.toml", SEEDS[0])?, compare("s0.toml", SEEDS[1])?);
    let named = compare("s0-mpu6050.toml", SEEDS[0])?;
    let mut text = acceptance(&hundred)?;
    text += "\n";
    text +=
        &methods_table(&[("100 seeds", &hundred), ("500 seeds", &many), ("MPU-6050, 100 seeds", &named)])?;
    text += "\n";
    text += &states_table(adit, scenarios, folder.path())?;
    std::fs::write(out, text).with_context(|| out.display().to_string())
}

fn path(scenarios: &Path, name: &str) -> Result<String> {
    scenarios.join(name).to_str().map(str::to_owned).context("a path that is text")
}

fn adit_runs(adit: &Path, args: &[&str], files: &[(&str, &Path)]) -> Result<()> {
    let mut command = Command::new(adit);
    command.args(args);
    for (flag, file) in files {
        command.arg(flag).arg(file);
    }
    let output = command.output().context("adit cannot be run")?;
    if !output.status.success() {
        bail!("adit {}: {}", args.join(" "), String::from_utf8_lossy(&output.stderr));
    }
    Ok(())
}

/// The figure after the path: position errors over time.
fn second_figure(page: &str) -> Result<String> {
    let figure = page.split("<svg").nth(2).and_then(|rest| rest.split("</svg>").next());
    Ok(format!("<svg{}</svg>\n", figure.context("a page with two figures")?))
}

fn number(report: &Value, method: &str, at: &str) -> Result<f64> {
    let value = &report["methods"][method];
    value.pointer(at).and_then(Value::as_f64).with_context(|| format!("{method}{at} in the report"))
}

const REDUCED: &str = "reduced-ins-wifi";
const FULL: &str = "full-ins-wifi";
const ALONE: &str = "reduced, INS alone";

/// The rows of the acceptance of S0.
fn acceptance(report: &Value) -> Result<String> {
    let of = |method: &str, at: &str| number(report, method, at);
    let mut text = String::from(
        "| figure, 95th percentile over 100 seeds, after the third fix | paper | limit | 10 states | 18 states |\n|---|---:|---:|---:|---:|\n",
    );
    let rows = [
        ("INS alone: longitude error at 1000 s", "36 m", "report", "end_east_m", " m", 0, true),
        ("INS alone: heading error at 1000 s", "9.8°", "report", "end_heading_deg", "°", 2, true),
        ("INS alone: velocity error at 1000 s", "5.8 m/s", "report", "end_velocity_m_s", " m/s", 2, true),
        (
            "largest longitude error between fixes",
            "0.5 m",
            "≤ 0.5 m (goal 0.25)",
            "largest_east_m",
            " m",
            2,
            false,
        ),
        ("largest heading error between fixes", "2.3°", "≤ 1.0°", "largest_heading_deg", "°", 2, false),
        (
            "largest velocity error between fixes",
            "2.8 m/s",
            "≤ 0.10 m/s",
            "largest_velocity_m_s",
            " m/s",
            3,
            false,
        ),
    ];
    for (name, paper, limit, key, unit, decimals, alone) in rows {
        let at = format!("/over_seeds/{key}/p95");
        let (reduced, full) = if alone { (ALONE, "full, INS alone") } else { (REDUCED, FULL) };
        let (reduced, full) = (of(reduced, &at)?, of(full, &at)?);
        writeln!(
            text,
            "| {name} | {paper} | {limit} | {reduced:.decimals$}{unit} | {full:.decimals$}{unit} |"
        )?;
    }
    let rmse = |method| of(method, "/position_m/rmse");
    let ratio = rmse(REDUCED)? / rmse(FULL)?;
    writeln!(
        text,
        "| position RMSE | \"no accuracy lost\" | ≤ 1.10 of 18 states | {:.3} m ({ratio:.2}) | {:.3} m |",
        rmse(REDUCED)?,
        rmse(FULL)?
    )?;
    let nees = |method: &str| -> Result<String> {
        let part = |key: &str| of(method, &format!("/consistency/joint/{key}"));
        let inside = 100.0 * part("share_inside")?;
        let (mean, lower, upper) = (part("mean")?, part("lower")?, part("upper")?);
        Ok(format!("{mean:.2} [{lower:.2}–{upper:.2}], {inside:.0} % inside"))
    };
    writeln!(
        text,
        "| NEES of position, velocity, heading (5) | – | inside its 95 % interval | {} | {} |",
        nees(REDUCED)?,
        nees(FULL)?
    )?;
    let time = |method| of(method, "/time_per_step_ns");
    let (reduced, full) = (time(REDUCED)?, time(FULL)?);
    writeln!(
        text,
        "| time of one step | \"faster\" | report | {reduced:.0} ns | {full:.0} ns ({:.1} ×) |",
        full / reduced
    )?;
    Ok(text)
}

/// Both methods in each comparison.
fn methods_table(reports: &[(&str, &Value)]) -> Result<String> {
    let mut text = String::from(
        "| runs | method | position RMSE | 95 % | largest east, 95 % of runs | heading | velocity | NEES position (2) | heading (1) | NIS (2) |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for (runs, report) in reports {
        for method in [REDUCED, FULL] {
            let of = |at: &str| number(report, method, at);
            writeln!(
                text,
                "| {runs} | `{method}` | {:.3} m | {:.3} m | {:.2} m | {:.2}° | {:.3} m/s | {:.2} | {:.2} | {:.2} |",
                of("/position_m/rmse")?,
                of("/position_m/p95")?,
                of("/over_seeds/largest_east_m/p95")?,
                of("/over_seeds/largest_heading_deg/p95")?,
                of("/over_seeds/largest_velocity_m_s/p95")?,
                of("/consistency/position/mean")?,
                of("/consistency/heading/mean")?,
                of("/nis/mean")?,
            )?;
        }
    }
    Ok(text)
}

/// What each of the ten states is known to at the start, after the third fix and at the end of the first walk.
fn states_table(adit: &Path, scenarios: &Path, folder: &Path) -> Result<String> {
    let run = folder.join("run");
    adit_runs(adit, &["simulate", &path(scenarios, "s0.toml")?], &[("-o", &run)])?;
    let mut log = open(run.join("log.mcap"))?;
    let sidecar = log.sidecar().context("a sidecar beside the log")?;
    let known =
        Known { specification: sidecar.noise, site: sidecar.site, start: sidecar.start, ..Known::default() };
    let ReducedInsWifiParams(params): ReducedInsWifiParams = ReducedInsWifiParams::default().knowing(&known);
    let sigmas = |method: &ReducedInsWifi| method.covariance().diagonal().map(f64::sqrt);
    let mut method = ReducedInsWifi::new(InsWifiParams { ..params })?;
    let mut columns = vec![sigmas(&method)];
    for observation in log.by_ref() {
        let observation = observation?;
        if columns.len() == 1 && observation.time().seconds() > 60.05 {
            columns.push(sigmas(&method));
        }
        method.observe(&observation)?;
    }
    columns.push(sigmas(&method));
    let degrees = 1f64.to_degrees();
    let states = [
        ("tilt φe", degrees, "°", 3),
        ("tilt φn", degrees, "°", 3),
        ("heading φu", degrees, "°", 3),
        ("velocity δVe", 1.0, "m/s", 4),
        ("velocity δVn", 1.0, "m/s", 4),
        ("latitude δL", 6.37e6, "m", 3),
        ("longitude δλ", 4.46e6, "m", 3),
        ("gyro ε", degrees * 3600.0, "°/h", 4),
        ("accelerometer ∇x", 1e6 / 9.80665, "µg", 1),
        ("accelerometer ∇y", 1e6 / 9.80665, "µg", 1),
    ];
    let mut text = String::from(
        "| state, 1 σ | at the start | after the third fix | after 1000 s | learnt |\n|---|---:|---:|---:|---|\n",
    );
    for (index, (name, gain, unit, decimals)) in states.into_iter().enumerate() {
        let [start, third, end] = [0, 1, 2].map(|column: usize| columns[column][index] * gain);
        let share = end / start;
        let learnt = if index == 3 || index == 4 {
            "held by the fixes"
        } else if share > 0.5 {
            "no"
        } else {
            "yes"
        };
        writeln!(
            text,
            "| {name}, {unit} | {start:.decimals$} | {third:.decimals$} | {end:.decimals$} | {learnt} |"
        )?;
    }
    Ok(text)
}
