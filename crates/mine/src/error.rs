//! Why there is no mine.

#[cfg(feature = "std")]
use crate::file::Notice;
use crate::finding::Finding;
use alloc::vec::Vec;
#[cfg(feature = "std")]
use std::path::PathBuf;

/// Why there is no mine.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MineError {
    /// The plan has errors.
    #[error("{}", first(findings))]
    Unsound {
        /// All of them.
        findings: Vec<Finding>,
    },
    /// The operating system refused.
    #[cfg(feature = "std")]
    #[error("{}: cannot read it: {source}", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file larger than any mine's.
    #[cfg(feature = "std")]
    #[error("{}: longer than {limit} bytes: not a mine", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// The limit, bytes.
        limit: u64,
    },
    /// The file has errors.
    #[cfg(feature = "std")]
    #[error("{}", first_notice(file, notices))]
    Invalid {
        /// The file.
        file: PathBuf,
        /// All of them, in order of line.
        notices: Vec<Notice>,
    },
    /// A mine could not be written in a form.
    #[cfg(feature = "std")]
    #[error("cannot write the mine: {what}")]
    CannotWrite {
        /// Why.
        what: String,
    },
}

fn first(findings: &[Finding]) -> alloc::string::String {
    findings.first().map_or_else(
        || "numbers too odd to work with".into(),
        |finding| alloc::format!("{}: {finding}{}", finding.place, more(findings.len())),
    )
}

#[cfg(feature = "std")]
fn first_notice(file: &std::path::Path, notices: &[Notice]) -> String {
    notices
        .first()
        .map_or_else(|| file.display().to_string(), |notice| format!("{notice}{}", more(notices.len())))
}

fn more(count: usize) -> alloc::string::String {
    match count {
        0 | 1 => alloc::string::String::new(),
        2 => " (and 1 more error)".into(),
        _ => alloc::format!(" (and {} more errors)", count - 1),
    }
}
