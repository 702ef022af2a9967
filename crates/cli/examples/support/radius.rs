//! How often the truth is within the stated 95 % radius, scenario by scenario.
//!
//! Of each scenario the run of the method that its `[compare]` has, or the method as it comes; the same person and alignment. All moments
//! count, every 0.1 s from the first solution on. NIS is the method's own word.

use crate::tracked::{Laid, Moment, Nis, Scenario};
use adit_core::solution::Quality;
use adit_evaluation::statistics::Distribution;
use anyhow::Result;
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use toml::Value;

/// Those that ship, by name.
const SCENARIOS: [&str; 9] =
    ["s0", "s1", "s2", "s3", "s4", "blackout", "blackout-waist", "survival", "fused"];
/// What a path without fixes is laid on the truth by where a scenario forgives nothing: so much of the way in the first minutes.
const ALIGNED: Laid = Laid::Before { until_s: 300.0, walked_m: 150.0 };

/// The table of a method over these scenarios, or all.
pub fn table(
    adit: &Path,
    scenarios: &Path,
    method: &str,
    (first, last): (u64, u64),
    names: &[String],
) -> Result<String> {
    let seeds = last - first + 1;
    let names: Vec<&str> =
        if names.is_empty() { SCENARIOS.to_vec() } else { names.iter().map(String::as_str).collect() };
    let mut text = format!(
        "| {method}, {seeds} seeds | within the 95 % radius | worst run | median radius | mean error | 95 % | said to be lost | dead reckoning | NEES (2) | NIS (1) |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    for name in names {
        let file = scenarios.join(format!("{name}.toml"));
        let scenario = Scenario::open(&file)?;
        let runs: Vec<Option<Run>> =
            (first..=last).into_par_iter().map(|seed| one(adit, &scenario, method, seed)).collect();
        let runs: Vec<Run> = runs.into_iter().flatten().collect();
        text += &row(name, &runs, seeds)?;
    }
    Ok(text)
}

/// A run: what it said, and its innovations.
type Run = (Vec<Moment>, Nis);

/// A run that fails is told and left out.
fn one(adit: &Path, scenario: &Scenario, method: &str, seed: u64) -> Option<Run> {
    let run = || -> Result<Run> {
        let contenders = scenario.contenders(&[method.to_owned()])?;
        let laid = match scenario.of_compare("align").and_then(Value::as_str) {
            Some("start") => Laid::Start,
            _ => ALIGNED,
        };
        scenario.simulate(adit, seed)?.track(adit, &contenders[0], laid)
    };
    run().map_err(|error| eprintln!("seed {seed}: {error:#}")).ok()
}

fn row(name: &str, runs: &[Run], seeds: u64) -> Result<String> {
    let of_quality = |moment: &Moment, quality| f64::from(u8::from(moment.quality == quality));
    let within = |moment: &Moment| f64::from(u8::from(moment.error_m.norm() <= moment.radius_m));
    let all = || runs.iter().flat_map(|(moments, _)| moments);
    let sure = || all().filter(|moment| moment.quality != Quality::Lost);
    let quantiles = |of: fn(&Moment) -> f64| {
        Distribution::of(&all().map(of).filter(|value| value.is_finite()).collect::<Vec<_>>())
    };
    let (Some(radii), Some(errors)) = (quantiles(|m| m.radius_m), quantiles(|m| m.error_m.norm())) else {
        return Ok(format!("| {name} | – | – | – | – | – | – | – | – | – |\n"));
    };
    let share = |(moments, _): &Run| mean(moments.iter().filter(|m| m.quality != Quality::Lost).map(within));
    let worst = runs.iter().filter_map(share).fold(f64::INFINITY, f64::min);
    let percent =
        |share: Option<f64>| share.map_or("–".to_owned(), |share| format!("{:.1} %", 100.0 * share));
    let (count, sum) = runs.iter().fold((0.0, 0.0), |(n, s), (_, nis)| (n + nis.count, s + nis.sum));
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
    let failed = seeds - runs.len() as u64;
    let mut line =
        format!("| {name}{} ", if failed > 0 { format!(", {failed} failed") } else { String::new() });
    write!(
        line,
        "| {} | {} ",
        percent(mean(sure().map(within))),
        percent(worst.is_finite().then_some(worst))
    )?;
    write!(line, "| {:.2} m | {} m ", radii.quantile(0.5), number(mean(all().map(|m| m.error_m.norm()))))?;
    write!(line, "| {:.2} m ", errors.quantile(0.95))?;
    write!(line, "| {} ", percent(mean(all().map(|m| of_quality(m, Quality::Lost)))))?;
    write!(line, "| {} ", percent(mean(all().map(|m| of_quality(m, Quality::DeadReckoning)))))?;
    write!(line, "| {} ", number(mean(sure().filter_map(|m| m.nees))))?;
    writeln!(line, "| {} |", number((count > 0.0).then(|| sum / count)))?;
    Ok(line)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_u64, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / count as f64)
}
