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

    /// An error at the line on which `span` starts.
    pub fn error(&self, span: &Range<usize>, what: &str) -> Error {
        anyhow!("{}:{}: {what}", self.file.display(), line(&self.text, span.start))
    }

    /// An error of the simulator: at the line that names the parameter, else where `span` starts.
    pub fn refused(&self, span: &Range<usize>, error: &SimulationError) -> Error {
        let SimulationError::Parameter { name, .. } = error;
        let inside = self.text.get(span.start..self.end(span)).unwrap_or_default();
        let at = key(inside, stem(name)).map_or(span.start, |found| span.start + found);
        self.error(&(at..at), &error.to_string())
    }

    /// Where a value ends. The span of a `[table]` is that of its header alone; its body ends at the next header.
    fn end(&self, span: &Range<usize>) -> usize {
        let (value, rest) = (self.text.get(span.clone()), self.text.get(span.end..));
        match (value, rest) {
            (Some(value), Some(rest)) if is_header(value) => {
                let body = rest.split_inclusive('\n').take_while(|line| !is_header(line));
                span.end + body.map(str::len).sum::<usize>()
            }
            _ => span.end,
        }
    }
}

/// `[name]` or `[[name]]`; a row of a matrix begins with a number.
fn is_header(line: &str) -> bool {
    let inner = line.trim_start().trim_start_matches('[');
    inner.len() < line.trim_start().len() && inner.starts_with(|c: char| c.is_alphabetic() || c == '"')
}

/// The name of a quantity without its unit of angle: files give degrees where the simulator counts in rad.
fn stem(name: &str) -> &str {
    name.strip_suffix("_rad").unwrap_or(name)
}

/// Where `name`, with any unit of angle, stands as a key.
fn key(text: &str, name: &str) -> Option<usize> {
    text.match_indices(name).map(|(at, _)| at).find(|at| {
        let line = text[..*at].rsplit('\n').next().unwrap_or_default();
        let before = line.chars().next_back();
        let after = &text[at + name.len()..];
        let after = after.strip_prefix("_deg").or_else(|| after.strip_prefix("_rad")).unwrap_or(after);
        !line.contains('#')
            && !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
            && after.trim_start().starts_with('=')
    })
}
