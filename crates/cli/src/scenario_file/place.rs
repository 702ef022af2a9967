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
        let SimulationError::Parameter { name, found, expected } = error;
        let inside = self.text.get(span.start..self.end(span)).unwrap_or_default();
        // Files give degrees where the simulator counts in rad.
        if let Some(angle) = name.strip_suffix("_rad").map(|stem| format!("{stem}_deg"))
            && let Some(at) = key(inside, &angle)
        {
            // Nine digits hide what the way to radians and back has rounded.
            let degrees = (found.to_degrees() * 1e6).round() * 1e-6;
            let what = format!("{angle} is {degrees} ({found:.3} rad), expected {expected}");
            return self.error(&(span.start + at..span.end), &what);
        }
        let at = span.start + key(inside, name).unwrap_or(0);
        self.error(&(at..span.end), &error.to_string())
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

/// Where `name` stands as a key, outside comments.
fn key(text: &str, name: &str) -> Option<usize> {
    text.match_indices(name).map(|(at, _)| at).find(|at| {
        let line = text[..*at].rsplit('\n').next().unwrap_or_default();
        let after = text[at + name.len()..].trim_start();
        !line.contains('#')
            && !line.ends_with(|c: char| c.is_alphanumeric() || c == '_')
            && after.starts_with('=')
    })
}
