//! Running the binary.

use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;

/// As text for a command line.
pub fn path(path: &Path) -> Result<String> {
    path.to_str().map(str::to_owned).context("a path that is text")
}

/// Runs adit.
pub fn run(adit: &Path, args: &[&str]) -> Result<()> {
    let output = Command::new(adit).args(args).output().context("adit cannot be run")?;
    if !output.status.success() {
        bail!("adit {}: {}", args.join(" "), String::from_utf8_lossy(&output.stderr));
    }
    Ok(())
}
