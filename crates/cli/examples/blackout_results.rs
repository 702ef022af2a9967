//! How a blackout is survived, and how honest the stated radius is; seeds as 20 (from 1 on) or 7-9.
//!
//!     blackout_results dark ADIT SCENARIO.toml SEEDS OUT.md OUT.json FIGURE.svg [METHOD …]
//!     blackout_results radius ADIT SCENARIOS METHOD SEEDS OUT.md [SCENARIO …]
//!
//! `dark`: tables as Markdown, every run as JSON, and the first contender's way on the first seed as a figure. The scenario cuts everything off
//! for a time (`[[mine.outages]]` with `dead = "everything"`; of several the longest counts). Its contenders, or those of the methods
//! named, run on so many seeds, one thread to a seed. `radius`: a line for each scenario, or for those named. Called by `ci/results.sh`.

#[path = "support/dark_figure.rs"]
mod dark_figure;
#[path = "support/dark_hour.rs"]
mod dark_hour;
#[path = "support/radius.rs"]
mod radius;
#[path = "support/tracked.rs"]
mod tracked;

use adit_evaluation::statistics::Statistics;
use anyhow::{Context, Result, bail};
use dark_hour::{Dark, DarkHour, Part};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tracked::{Contender, Laid, Scenario};

/// What a path without fixes is laid on the truth by: this much of the way before the blackout, m.
const ALIGNED_BY_M: f64 = 150.0;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let seeds = |text: &str| range(text).context("seeds as 20 or as 7-9");
    match words.as_slice() {
        ["dark", adit, scenario, count, out, json, figure, ..] => {
            let files =
                Files { adit: adit.into(), out: out.into(), json: json.into(), figure: figure.into() };
            dark(&files, scenario.as_ref(), seeds(count)?, &arguments[7..])
        }
        ["radius", adit, scenarios, method, count, out, ..] => {
            let table =
                radius::table(adit.as_ref(), scenarios.as_ref(), method, seeds(count)?, &arguments[6..])?;
            std::fs::write(out, table).with_context(|| (*out).to_owned())
        }
        _ => bail!(
            "usage: blackout_results dark ADIT SCENARIO.toml SEEDS OUT.md OUT.json FIGURE.svg [METHOD …], \
             or blackout_results radius ADIT SCENARIOS METHOD SEEDS OUT.md [SCENARIO …]"
        ),
    }
}

/// What is run and what is written.
struct Files {
    adit: PathBuf,
    out: PathBuf,
    json: PathBuf,
    figure: PathBuf,
}

fn dark(files: &Files, scenario: &Path, (first, last): (u64, u64), methods: &[String]) -> Result<()> {
    let Files { adit, out, json, figure } = files;
    let scenario = Scenario::open(scenario)?;
    let dark = Dark::of(&scenario)?;
    let contenders = scenario.contenders(methods)?;
    let one = |seed: u64| -> Result<Vec<Option<DarkHour>>> {
        let simulated = scenario.simulate(adit, seed)?;
        let judged = |contender: &Contender| -> Result<Option<DarkHour>> {
            let laid = Laid::Before { until_s: dark.from_s, walked_m: ALIGNED_BY_M };
            let moments = simulated.track(adit, contender, laid);
            match moments {
                Ok((moments, nis)) => {
                    if seed == first && contender.name == contenders[0].name {
                        let svg = dark_figure::figure(&simulated, &dark, &contender.name, &moments)?;
                        std::fs::write(figure, svg).with_context(|| figure.display().to_string())?;
                    }
                    Ok(Some(DarkHour::of(seed, &moments, nis, &simulated, &dark)))
                }
                Err(error) => {
                    eprintln!("seed {seed}, {}: {error:#}", contender.name);
                    Ok(None)
                }
            }
        };
        contenders.iter().map(judged).collect()
    };
    let runs = (first..=last).into_par_iter().map(one).collect::<Result<Vec<_>>>()?;
    let seeds = last - first + 1;
    let mut lines = [String::new(), String::new()];
    let mut all = serde_json::Map::new();
    for (index, contender) in contenders.iter().enumerate() {
        let hours: Vec<&DarkHour> = runs.iter().filter_map(|run| run[index].as_ref()).collect();
        if hours.is_empty() {
            bail!("{} came to the end of no run", contender.name);
        }
        lines[0] += &errors(&contender.name, &hours);
        lines[1] += &honesty(&contender.name, &hours)?;
        all.insert(contender.name.clone(), serde_json::json!({ "seeds": seeds, "runs": hours }));
    }
    let minutes = (dark.until_s - dark.from_s) / 60.0;
    let text = format!(
        "| {seeds} seeds, {minutes:.0} min | walked in the dark | error at the end, of the way: mean | median | 95 % | worst | largest on the way: mean | 95 % | worst | wrong level |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n{}\n\
         | truth within the 95 % radius | before | in the dark | after | lost | NEES (2): before | in the dark | after | NIS (1) | jumps over the radius | largest | back after: median | worst | fixes: median | worst |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n{}",
        lines[0], lines[1]
    );
    std::fs::write(out, text).with_context(|| out.display().to_string())?;
    std::fs::write(json, serde_json::to_string_pretty(&all)? + "\n")
        .with_context(|| json.display().to_string())
}

/// First and last seed.
fn range(text: &str) -> Option<(u64, u64)> {
    let (first, last) = text.split_once('-').unwrap_or(("1", text));
    let (first, last) = (first.parse().ok()?, last.parse().ok()?);
    (first <= last).then_some((first, last))
}

fn statistics(values: impl Iterator<Item = f64>) -> Option<Statistics> {
    Statistics::of(&values.filter(|value| value.is_finite()).collect::<Vec<_>>())
}

fn errors(name: &str, hours: &[&DarkHour]) -> String {
    let of = |value: fn(&DarkHour) -> f64| statistics(hours.iter().map(|hour| value(hour)));
    let cell =
        |value: Option<f64>, unit: &str| value.map_or("–".to_owned(), |value| format!("{value:.2}{unit}"));
    let ends = of(|hour| 100.0 * hour.end_m / hour.walked_m);
    let largest = of(|hour| 100.0 * hour.largest_m / hour.walked_m);
    let cells = [
        of(|hour| hour.walked_m).map_or("–".to_owned(), |walked| format!("{:.0} m", walked.mean)),
        cell(ends.map(|ends| ends.mean), " %"),
        cell(ends.map(|ends| ends.median), " %"),
        cell(ends.map(|ends| ends.p95), " %"),
        cell(ends.map(|ends| ends.max), " %"),
        cell(largest.map(|largest| largest.mean), " %"),
        cell(largest.map(|largest| largest.p95), " %"),
        cell(largest.map(|largest| largest.max), " %"),
        cell(of(|hour| 100.0 * hour.wrong_level_share).map(|share| share.mean), " %"),
    ];
    format!("| {name} | {} |\n", cells.join(" | "))
}

fn honesty(name: &str, hours: &[&DarkHour]) -> Result<String> {
    let mut line = format!("| {name} ");
    let parts: [fn(&DarkHour) -> &Part; 3] = [|h| &h.before, |h| &h.dark, |h| &h.after];
    let mean = |values: &mut dyn Iterator<Item = Option<f64>>| -> Option<f64> {
        statistics(values.flatten()).map(|statistics| statistics.mean)
    };
    let percent =
        |share: Option<f64>| share.map_or("–".to_owned(), |share| format!("{:.1} %", 100.0 * share));
    for part in parts {
        let within = mean(&mut hours.iter().map(|hour| part(hour).within_share));
        write!(line, "| {} ", percent(within))?;
    }
    let lost = mean(&mut hours.iter().map(|hour| Some(hour.lost_share)));
    write!(line, "| {} ", percent(lost))?;
    for part in parts {
        let nees = mean(&mut hours.iter().map(|hour| part(hour).nees));
        write!(line, "| {} ", nees.map_or("–".to_owned(), |nees| format!("{nees:.2}")))?;
    }
    let nis = mean(&mut hours.iter().map(|hour| hour.nis));
    write!(line, "| {} ", nis.map_or("–".to_owned(), |nis| format!("{nis:.2}")))?;
    let jumps: u32 = hours.iter().map(|hour| hour.jumps).sum();
    let largest = hours.iter().map(|hour| hour.largest_jump).fold(0.0, f64::max);
    write!(line, "| {jumps} | {largest:.2} × radius ")?;
    let back: Vec<_> = hours.iter().filter_map(|hour| hour.back.as_ref()).collect();
    let never = hours.len() - back.len();
    let worst = |text: String| if never > 0 { format!("never, {never} of {}", hours.len()) } else { text };
    let times = statistics(back.iter().map(|back| back.seconds));
    let fixes = statistics(back.iter().map(|back| f64::from(back.fixes)));
    match times.zip(fixes) {
        None => writeln!(line, "| – | {} | – | – |", worst(String::new()))?,
        Some((times, fixes)) => {
            let (slowest, most) = (worst(format!("{:.1} s", times.max)), worst(format!("{:.0}", fixes.max)));
            writeln!(line, "| {:.1} s | {slowest} | {:.0} | {most} |", times.median, fixes.median)?;
        }
    }
    Ok(line)
}
