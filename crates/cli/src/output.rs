//! Where results go: a file that appears when complete, or stdout.

use adit_observation::files::AtomicFile;
use anyhow::{Context, Result};
use std::convert::Infallible;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use tempfile::TempDir;

/// A place that a user named for a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// `-`
    Stdout,
    /// A file.
    File(PathBuf),
}

impl FromStr for Target {
    type Err = Infallible;
    fn from_str(name: &str) -> Result<Self, Infallible> {
        Ok(if name == "-" { Self::Stdout } else { Self::File(PathBuf::from(name)) })
    }
}

impl Target {
    /// Writes a short text whole.
    pub fn write(&self, text: &str) -> Result<()> {
        match self {
            Self::Stdout => print(text),
            Self::File(path) => write_file(path, text),
        }
    }
}

/// Writes a short text file whole or not at all.
pub fn write_file(path: &Path, text: &str) -> Result<()> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(text.as_bytes()).with_context(|| format!("{}: cannot write it", path.display()))?;
    Ok(file.finish()?)
}

/// Writes to stdout; an error, not a panic, when nobody reads.
pub fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).context("stdout: cannot write it")
}

/// Writes to stderr; nothing can be done when nobody listens.
pub fn tell(text: &str) {
    let _ = io::stderr().write_all(text.as_bytes());
}

/// Makes a folder for results.
pub fn make_folder(path: &Path) -> Result<()> {
    fs::create_dir_all(path).with_context(|| format!("{}: cannot make this folder", path.display()))
}

/// Where a long result is written while it grows: the target itself when that is a file (whose writer is atomic), else a
/// temporary file that is copied to stdout at the end, so that a pipe too gets all or nothing.
pub struct Staged {
    path: PathBuf,
    copied_from: Option<TempDir>,
}

impl Staged {
    /// Prepares the place.
    pub fn new(target: &Target) -> Result<Self> {
        match target {
            Target::File(path) => Ok(Self { path: path.clone(), copied_from: None }),
            Target::Stdout => {
                let folder = tempfile::Builder::new().prefix("adit-").tempdir();
                let folder = folder.context("cannot make a temporary folder")?;
                Ok(Self { path: folder.path().join("stdout"), copied_from: Some(folder) })
            }
        }
    }

    /// The file to write.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Hands the complete file over.
    pub fn deliver(self) -> Result<()> {
        if self.copied_from.is_some() {
            let mut file = File::open(&self.path).context("cannot read the temporary file again")?;
            let mut stdout = io::stdout().lock();
            io::copy(&mut file, &mut stdout)
                .and_then(|_| stdout.flush())
                .context("stdout: cannot write it")?;
        }
        Ok(())
    }
}
