//! The file that is written: settings for `adit track --config`, with a head that says where they come from.

use super::parameters::{Parameter, Parameters};
use super::report::{FoundParameter, Report, number};
use crate::args::TuneArgs;
use crate::output::Target;
use anyhow::{Context, Result, anyhow};
use std::fmt::Write as _;
use std::path::Path;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// The text: what the configuration said, with what was found in it. Without date, time and duration: the same search writes the same bytes.
pub fn text(args: &TuneArgs, config: &str, parameters: &Parameters, report: &Report) -> Result<String> {
    let mut document: DocumentMut = config.parse().context("--config")?;
    // What is as it was is left to the sidecars of the logs to come.
    let changed = |(_, found): &(&Parameter, &FoundParameter)| !found.is_as_it_was();
    for (parameter, found) in parameters.0.iter().zip(&report.parameters).filter(changed) {
        put(&mut document, &parameter.name, found.found)
            .ok_or_else(|| anyhow!("--config: {} has no place in it", parameter.name))?;
    }
    Ok(format!("{}\n{document}", head(args, report)))
}

/// Puts a number where a dotted name says, in tables that are there or made.
fn put(document: &mut DocumentMut, name: &str, value: f64) -> Option<()> {
    let (tables, last) = name.rsplit_once('.').map_or((None, name), |(tables, last)| (Some(tables), last));
    let mut table: &mut dyn TableLike = document.as_table_mut();
    for step in tables.into_iter().flat_map(|tables| tables.split('.')) {
        let mut fresh = Table::new();
        fresh.set_implicit(true);
        table = table.entry(step).or_insert(Item::Table(fresh)).as_table_like_mut()?;
    }
    let value: Value = exact(value).parse().ok()?;
    match table.get_mut(last).and_then(Item::as_value_mut) {
        Some(there) => {
            // Comments behind the number stay.
            let decor = there.decor().clone();
            *there = value;
            *there.decor_mut() = decor;
        }
        None => {
            table.insert(last, Item::Value(value));
        }
    }
    Some(())
}

/// A number as TOML, to the last bit.
fn exact(value: f64) -> String {
    if (1e-3..1e6).contains(&value) { format!("{value:?}") } else { format!("{value:e}") }
}

fn head(args: &TuneArgs, report: &Report) -> String {
    let mut head = String::new();
    let unit = report.unit();
    let train = report.train.len();
    // Writing to a String does not fail.
    let _ = writeln!(
        head,
        "# Settings of {} for adit track --config, found by\n#   {}",
        report.method,
        command(args)
    );
    let _ = writeln!(
        head,
        "# Mean over {train} run{} of the mean squared {} (aligned {}): {} {unit}² before, {} {unit}² after.",
        if train == 1 { "" } else { "s" },
        report.judged.words(),
        report.alignment,
        number(report.cost_before),
        number(report.cost_after),
    );
    for line in report.parameter_table().lines() {
        let _ = writeln!(head, "#   {line}");
    }
    head
}

/// The command that finds the same again.
fn command(args: &TuneArgs) -> String {
    let mut words = vec!["adit".to_owned(), "tune".to_owned(), args.method.name().to_owned()];
    let path = |path: &Path| quoted(&path.to_string_lossy());
    words.push("--train".to_owned());
    words.extend(args.train.iter().map(|log| path(log)));
    let mut flag = |name: &str, value: String| words.extend([name.to_owned(), value]);
    flag("--optimizer", args.optimizer.0.name().to_owned());
    flag("--budget", args.budget.to_string());
    flag("--agents", args.agents.to_string());
    flag("--seed", args.seed.to_string());
    if !args.parameters.is_empty() {
        flag("--parameters", args.parameters.join(","));
    }
    if let Some(config) = &args.config {
        flag("--config", path(config));
    }
    if let Some(mine) = &args.mine {
        flag("--mine", path(mine));
    }
    for model in &args.radio {
        flag("--radio", path(model));
    }
    if let Some(alignment) = args.align {
        flag("--align", alignment.to_string());
    }
    if args.from > 0.0 {
        flag("--from", args.from.to_string());
    }
    if let Target::File(out) = &args.out {
        flag("-o", path(out));
    }
    words.join(" ")
}

/// A word as a shell takes it, on one line.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./,+:=@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    let one_line: String = word.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
    format!("'{}'", one_line.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn with(config: &str, name: &str, value: f64) -> String {
        let mut document: DocumentMut = config.parse().unwrap();
        put(&mut document, name, value).unwrap();
        document.to_string()
    }

    #[test]
    fn numbers_find_their_place_and_comments_stay() {
        assert_eq!(with("", "noise.field_ut", 0.5), "[noise]\nfield_ut = 0.5\n");
        assert_eq!(with("", "attitude.noise.field_ut", 2.5e-7), "[attitude.noise]\nfield_ut = 2.5e-7\n");
        assert_eq!(
            with("[noise]\nfield_ut = 1.0 # µT\n", "noise.field_ut", 30.0),
            "[noise]\nfield_ut = 30.0 # µT\n"
        );
        assert_eq!(
            with("noise = { field_ut = 1.0 }\n", "noise.offset_ut", 0.001),
            "noise = { field_ut = 1.0 , offset_ut = 0.001 }\n"
        );
        assert_eq!(with("[noise]\na = 1\n", "velocity_m_s", 0.1), "velocity_m_s = 0.1\n[noise]\na = 1\n");
        assert_eq!(put(&mut "noise = 1\n".parse().unwrap(), "noise.field_ut", 1.0), None);
    }

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(quoted("runs/walk_1.csv"), "runs/walk_1.csv");
        assert_eq!(quoted("my runs/it's\n"), r"'my runs/it'\''s?'");
    }
}
