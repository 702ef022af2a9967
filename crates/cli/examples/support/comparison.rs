//! What examples that tabulate `adit compare` share.

#[path = "binary.rs"]
pub mod binary;

use anyhow::{Context, Result};
use binary::{path, run};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// `adit compare` of a scenario: its report, and the figure of the distributions.
pub fn compare(adit: &Path, scenario: &Path, seeds: &str) -> Result<(Value, String)> {
    let folder = TempDir::new()?;
    let (json, page) = (folder.path().join("c.json"), folder.path().join("c.html"));
    run(
        adit,
        &["compare", &path(scenario)?, "--seeds", seeds, "-o", &path(&page)?, "--json", &path(&json)?],
    )?;
    let report = serde_json::from_str(&std::fs::read_to_string(&json)?)?;
    Ok((report, distribution(&std::fs::read_to_string(&page)?)?))
}

/// A number of the report.
pub fn number(report: &Value, at: &str) -> Result<f64> {
    report.pointer(at).and_then(Value::as_f64).with_context(|| format!("{at} in the report"))
}

/// The figure under the heading of the distributions.
fn distribution(page: &str) -> Result<String> {
    let after = page.split("Distribution of the position errors").nth(1);
    let figure =
        after.and_then(|rest| rest.split("<svg").nth(1)).and_then(|rest| rest.split("</svg>").next());
    Ok(format!("<svg{}</svg>\n", figure.context("a page with distributions")?))
}
