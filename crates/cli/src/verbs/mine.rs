//! `adit mine`: what is wrong with a mine file, what is in it, and other forms of it.

use crate::args::mine::{MineArgs, MineCheckArgs, MineConvertArgs, MineVerb};
use crate::output::{self, Target, tell};
use adit_mine::file::{self, Checked, Notice};
use adit_mine::{Summary, plan_view};
use anyhow::{Result, bail};
use serde::Serialize;
use std::path::Path;

/// Checks or converts.
pub fn run(args: &MineArgs) -> Result<()> {
    match &args.verb {
        MineVerb::Check(args) => check(args),
        MineVerb::Convert(args) => convert(args),
    }
}

/// `adit mine check --json`.
#[derive(Serialize)]
struct Report<'c> {
    file: String,
    errors: Vec<&'c Notice>,
    warnings: Vec<&'c Notice>,
    /// Missing when there are errors.
    summary: Option<Summary>,
}

fn check(args: &MineCheckArgs) -> Result<()> {
    let checked = file::check(&args.file)?;
    let summary = checked.mine.as_ref().map(Summary::of);
    if let (Some(path), Some(mine)) = (&args.plot, &checked.mine) {
        output::write_file(path, &plan_view::draw(mine))?;
    }
    if args.json {
        let (errors, warnings) = (checked.errors().collect(), checked.warnings().collect());
        let report = Report { file: args.file.display().to_string(), errors, warnings, summary };
        output::print(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    } else {
        tell_all(&checked);
        if let Some(summary) = summary {
            output::print(&format!("{summary}findings    no errors, {}\n", warnings(&checked)))?;
        }
    }
    refuse_errors(&args.file, &checked)
}

fn convert(args: &MineConvertArgs) -> Result<()> {
    let checked = file::check(&args.file)?;
    tell_all(&checked);
    let Some(mine) = &checked.mine else { return refuse_errors(&args.file, &checked) };
    let text = match &args.out {
        Target::Stdout => file::to_toml(mine.plan())?,
        Target::File(path) => match path.extension().and_then(|end| end.to_str()) {
            Some("toml") => file::to_toml(mine.plan())?,
            Some("json") => file::to_json(mine.plan())?,
            Some("geojson") => file::to_geojson(mine.plan())?,
            _ => bail!("{}: unknown form of a mine, expected .toml, .json or .geojson", path.display()),
        },
    };
    args.out.write(&text)
}

fn tell_all(checked: &Checked) {
    for notice in &checked.notices {
        tell(&format!("{notice}\n"));
    }
}

fn refuse_errors(path: &Path, checked: &Checked) -> Result<()> {
    match checked.errors().count() {
        0 => Ok(()),
        1 => bail!("{}: 1 error, {}", path.display(), warnings(checked)),
        count => bail!("{}: {count} errors, {}", path.display(), warnings(checked)),
    }
}

fn warnings(checked: &Checked) -> String {
    match checked.warnings().count() {
        0 => "no warnings".to_owned(),
        1 => "1 warning".to_owned(),
        count => format!("{count} warnings"),
    }
}
