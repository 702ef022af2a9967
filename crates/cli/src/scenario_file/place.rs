//! Where in a file something stands, so that errors found after reading still name their line.

use crate::config::line;
use adit_simulation::SimulationError;
use anyhow::{Error, anyhow};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A file and its text.
#[derive(Debug, Clone)]
pub struct Source {
    file: PathBuf,
    text: String,
}

impl Source {
    /// A file of this text.
    pub fn new(file: &Path, text: &str) -> Self {
        Self { file: file.to_path_buf(), text: text.to_owned() }
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// An error at the line on which `span` starts.
    pub fn error(&self, span: &Range<usize>, what: &str) -> Error {
        anyhow!("{}:{}: {what}", self.file.display(), line(&self.text, span.start))
    }

    /// An error of the simulator: at the line that gives the parameter this value, else at one that names it, else where
    /// `span` starts.
    pub fn refused(&self, span: &Range<usize>, error: &SimulationError) -> Error {
        let region = self.region(span);
        let at = match error {
            SimulationError::Parameter { name, found, .. } => {
                let keys = || keys(region, name.strip_suffix("_rad").unwrap_or(name));
                let exact = keys().find(|(_, value)| value.is_some_and(|value| stands_for(value, *found)));
                exact.or_else(|| keys().next()).map(|(at, _)| at)
            }
            SimulationError::Unknown { found, .. } => region.find(&format!("\"{found}\"")),
        };
        let at = at.map_or(span.start, |at| span.start + at);
        self.error(&(at..at), &error.to_string())
    }

    /// The text of an entry. The span of a table under a header is that of its header; the table goes on to the next one
    /// that is not inside it.
    fn region(&self, span: &Range<usize>) -> &str {
        let inside = self.text.get(span.clone()).unwrap_or_default();
        let rest = self.text.get(span.start..).unwrap_or_default();
        let name = inside.trim_matches(['[', ']']);
        let header = inside.starts_with('[') && inside.ends_with(']') && !name.contains(['{', '\n', ',']);
        if !header {
            return inside;
        }
        let next = rest.match_indices("\n[").map(|(at, _)| at + 1).find(|at| {
            let below = rest[*at..].trim_start_matches('[');
            !below.strip_prefix(name).is_some_and(|below| below.starts_with('.'))
        });
        &rest[..next.unwrap_or(rest.len())]
    }
}

/// Where `name`, with any unit of angle, stands as a key, and the number that it is given.
fn keys<'a>(text: &'a str, name: &'a str) -> impl Iterator<Item = (usize, Option<f64>)> + 'a {
    text.match_indices(name).filter_map(move |(at, _)| {
        let before = text[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
            return None;
        }
        let after = &text[at + name.len()..];
        let after = after.strip_prefix("_deg").or_else(|| after.strip_prefix("_rad")).unwrap_or(after);
        let value = after.trim_start().strip_prefix('=')?;
        let value = value.split([',', '}', '\n', '#']).next().unwrap_or_default();
        Some((at, value.trim().parse().ok()))
    })
}

/// The simulator's number is that of the file, or the same angle in rad.
fn stands_for(written: f64, found: f64) -> bool {
    written.to_bits() == found.to_bits()
        || written.to_radians().to_bits() == found.to_bits()
        || (written.is_nan() && found.is_nan())
}
