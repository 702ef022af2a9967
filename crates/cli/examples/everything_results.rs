//! Writes the figures of a suite as Markdown: `everything_results REPORT.json OUT`.
//!
//! Of the report of `adit compare SUITE.toml --json REPORT.json`: `everything.md`, the opening table in short, `everything-parts.md`, every part with all its
//! contenders, and `everything-matrix.md`, a row for each part and a column for each method. Called by `ci/results.sh`.

use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::fmt::Write;
use std::path::PathBuf;

/// A smaller share of the time is told.
const WHOLE: f64 = 0.95;

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [report, out] = arguments.as_slice() else { bail!("usage: everything_results REPORT.json OUT") };
    let text = std::fs::read_to_string(report).with_context(|| report.display().to_string())?;
    let report: Value = serde_json::from_str(&text)?;
    std::fs::write(out.join("everything.md"), opening(&report)?)?;
    std::fs::write(out.join("everything-matrix.md"), matrix(&report)?)?;
    std::fs::write(out.join("everything-parts.md"), parts(&report)?)?;
    Ok(())
}

fn list<'a>(value: &'a Value, name: &str) -> Result<&'a Vec<Value>> {
    value[name].as_array().with_context(|| format!("no list {name} in the report"))
}

fn text<'a>(value: &'a Value, name: &str) -> Result<&'a str> {
    value[name].as_str().with_context(|| format!("no text {name} in the report"))
}

/// A number as the report shows it.
fn shown(value: f64) -> String {
    let decimals = match value.abs() {
        v if v < 1.0 => 3,
        v if v < 100.0 => 2,
        _ => 0,
    };
    format!("{value:.decimals$}")
}

/// The figure of a part with its unit, and how many runs.
fn figure(part: &Value) -> Result<String> {
    Ok(format!("{}, {}", text(part, "figure_words")?, text(part, "unit")?))
}

fn is_best(part: &Value, name: &str) -> bool {
    part["best"].as_array().is_some_and(|best| best.iter().any(|one| one == name))
}

/// What a method reaches in a part: its mean, marked where it is the best, and on how many runs where not on all.
fn cell(part: &Value, method: &str) -> Option<String> {
    let name = part["table"][method].as_str()?;
    let merit = &part["merit"][name];
    let Some(mean) = merit["mean"].as_f64() else { return Some("–".to_owned()) };
    let (runs, of) = (merit["runs"].as_u64()?, part["seeds"].as_u64()?);
    let mut some = if runs < of { format!(" ({runs} of {of})") } else { String::new() };
    if let Some(share) = merit["covered_share"].as_f64().filter(|share| *share < WHOLE) {
        write!(some, " ({:.0} % of the time)", 100.0 * share).ok()?;
    }
    let best = is_best(part, name);
    Some(if best { format!("**{}**{some}", shown(mean)) } else { format!("{}{some}", shown(mean)) })
}

/// The others of a part, best first, each with its method.
fn others(part: &Value, columns: &[&str], but: &[&str]) -> Vec<(f64, String)> {
    let other = |method: &&str| {
        let mean = part["merit"][part["table"][*method].as_str()?]["mean"].as_f64();
        Some((mean.unwrap_or(f64::INFINITY), format!("`{method}` {}", cell(part, method)?)))
    };
    let mut all: Vec<(f64, String)> =
        columns.iter().filter(|method| !but.contains(method)).filter_map(other).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// One row to a part: `fused` where it competes, and the others from the best on.
fn opening(report: &Value) -> Result<String> {
    let columns: Vec<&str> = list(report, "columns")?.iter().filter_map(Value::as_str).collect();
    let has_fused = columns.contains(&"fused");
    let mut out = String::from(if has_fused {
        "| | runs | figure | `fused` | the others, best first |\n|---|---:|---|---:|---|\n"
    } else {
        "| | runs | figure | methods, best first |\n|---|---:|---|---|\n"
    });
    for part in list(report, "parts")? {
        let name = text(part, "name")?;
        if let Some(why) = part["skipped"].as_str() {
            writeln!(out, "| {name} | | {} |{} {why} |", figure(part)?, if has_fused { " |" } else { "" })?;
            continue;
        }
        write!(out, "| {name} | {} | {} |", part["seeds"], figure(part)?)?;
        if has_fused {
            write!(out, " {} |", cell(part, "fused").unwrap_or_default())?;
        }
        let others: Vec<String> =
            others(part, &columns, &["fused"]).into_iter().map(|(_, other)| other).collect();
        writeln!(out, " {} |", others.join(" · "))?;
    }
    Ok(out)
}

/// A row for each part, a column for each method.
fn matrix(report: &Value) -> Result<String> {
    let columns: Vec<&str> = list(report, "columns")?.iter().filter_map(Value::as_str).collect();
    let mut out = String::from("| | runs | figure |");
    for method in &columns {
        write!(out, " `{method}` |")?;
    }
    writeln!(out, "\n|---|---:|---|{}", "---:|".repeat(columns.len()))?;
    for part in list(report, "parts")?.iter().filter(|part| part["skipped"].is_null()) {
        write!(out, "| {} | {} | {} |", text(part, "name")?, part["seeds"], figure(part)?)?;
        for method in &columns {
            write!(out, " {} |", cell(part, method).unwrap_or_default())?;
        }
        out.push('\n');
    }
    Ok(out)
}

/// Every part: its protocol, and all its contenders.
fn parts(report: &Value) -> Result<String> {
    let mut out = String::new();
    for part in list(report, "parts")? {
        writeln!(out, "### {}\n\n{}\n", text(part, "name")?, text(part, "about")?)?;
        if let Some(why) = part["skipped"].as_str() {
            writeln!(out, "{why}\n")?;
            continue;
        }
        let against = part["differences"][0]["minus"].as_str();
        writeln!(
            out,
            "| {} | method | mean | median | worst run | runs | more than {} [95 %] |\n|---|---|---:|---:|---:|---:|---:|",
            figure(part)?,
            against.unwrap_or("the best")
        )?;
        let merit = part["merit"].as_object().context("merit in the report")?;
        let mut rows: Vec<(&String, &Value)> = merit.iter().collect();
        rows.sort_by(|a, b| mean(a.1).total_cmp(&mean(b.1)));
        for (name, merit) in rows {
            let number = |at: &str| merit[at].as_f64().map_or_else(|| "–".to_owned(), shown);
            let best = if is_best(part, name) { "**" } else { "" };
            let method = part["methods"][name]["method"].as_str().unwrap_or_default();
            writeln!(
                out,
                "| {name} | `{method}` | {best}{}{best} | {} | {} | {} of {} | {} |",
                number("mean"),
                number("median"),
                number("worst"),
                merit["runs"],
                part["seeds"],
                if against == Some(name) { String::new() } else { difference(part, name) }
            )?;
        }
        out.push('\n');
    }
    Ok(out)
}

/// Those without any come last.
fn mean(merit: &Value) -> f64 {
    merit["mean"].as_f64().unwrap_or(f64::INFINITY)
}

fn difference(part: &Value, name: &str) -> String {
    let found = part["differences"].as_array().and_then(|all| all.iter().find(|d| d["one"] == name));
    let Some(found) = found else { return "–".to_owned() };
    let signed = |at: &str| {
        found[at]
            .as_f64()
            .map(|value| format!("{}{}", if value < 0.0 { "−" } else { "+" }, shown(value.abs())))
    };
    let interval = signed("lower")
        .zip(signed("upper"))
        .map_or_else(String::new, |(low, high)| format!(" [{low}, {high}]"));
    signed("mean").map_or_else(|| "–".to_owned(), |mean| mean + &interval)
}
