//! What is wrong, with file and line.

use super::Found;
use super::tree::{Node, Value, shown};
use crate::finding::{Finding, Severity, Step};
use serde::{Serialize, Serializer, ser::SerializeStruct as _};
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// Notices shown of one file; the rest is counted by the errors that remain after these are mended.
const MOST: usize = 1000;

/// Something wrong in a file; shown as `mine.toml:12: error: roadway main: …; what to do about it`.
#[derive(Debug, Clone, PartialEq)]
pub struct Notice {
    /// The file.
    pub file: Arc<Path>,
    /// The line, from 1.
    pub line: u64,
    /// The entry, as people call it: `roadway main`; none for what is wrong with the file as a whole.
    pub subject: Option<String>,
    /// What is wrong.
    pub finding: Finding,
}

impl Notice {
    /// Error or warning?
    pub fn severity(&self) -> Severity {
        self.finding.severity()
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity() {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{}:{}: {severity}: ", self.file.display(), self.line)?;
        // Names in a file may hold anything; a message is one line.
        let mut text = self.subject.as_ref().map_or_else(String::new, |subject| format!("{subject}: "));
        text += &self.finding.to_string();
        text.chars().try_for_each(|c| {
            if c.is_control() { write!(f, "{}", c.escape_debug()) } else { write!(f, "{c}") }
        })
    }
}

impl Serialize for Notice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut notice = serializer.serialize_struct("Notice", 7)?;
        notice.serialize_field("line", &self.line)?;
        notice.serialize_field("severity", &self.severity())?;
        notice.serialize_field("place", &self.finding.place)?;
        notice.serialize_field("subject", &self.subject)?;
        notice.serialize_field("problem", &self.finding.problem)?;
        notice.serialize_field("message", &self.finding.problem.to_string())?;
        notice.serialize_field("remedy", &self.finding.problem.remedy())?;
        notice.end()
    }
}

/// Where the lines of a file begin.
pub struct Lines {
    file: Arc<Path>,
    starts: Vec<usize>,
}

impl Lines {
    pub fn new(file: Arc<Path>, bytes: &[u8]) -> Self {
        let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
        Self { file, starts: std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect() }
    }

    /// Bytes become lines, and order that of the file.
    pub fn notices(&self, tree: Option<&Node>, mut found: Vec<Found>) -> Vec<Notice> {
        // Of too many, no error is left out for a warning.
        found.sort_by_key(|found| (found.finding.severity(), found.at));
        found.truncate(MOST);
        found.sort_by_key(|found| found.at);
        let notice = |found: Found| Notice {
            file: Arc::clone(&self.file),
            line: self.starts.partition_point(|start| *start <= found.at) as u64,
            subject: tree.and_then(|tree| subject(tree, &found.finding)),
            finding: found.finding,
        };
        found.into_iter().map(notice).collect()
    }
}

/// The entry that a finding is about, as people call it.
fn subject(tree: &Node, finding: &Finding) -> Option<String> {
    let [Step::Key(list), Step::Entry(index), ..] = finding.place.0.as_slice() else { return None };
    let called = match list.as_ref() {
        "access_points" => "access point",
        "rfid_portals" => "RFID portal",
        "vehicle_routes" => "vehicle route",
        plural => plural.strip_suffix('s')?,
    };
    let entry = tree.get(list)?.entry(*index)?;
    match entry.get("id").map(|id| &id.value) {
        Some(Value::Text(id)) if !id.is_empty() => Some(format!("{called} {}", shown(id))),
        _ => Some(format!("{called} {}", index + 1)),
    }
}
