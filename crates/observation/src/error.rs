//! Why a log, a trajectory or a sidecar could not be read or written: always with file and line or record.

use adit_core::time::Time;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum At {
    /// The file as a whole.
    File,
    /// A line of text, from 1.
    Line(u64),
    /// A record of a binary log.
    Record {
        /// Number of the record in the file, from 1.
        number: u64,
        /// Offset of its first byte in the file (a chunk's offset for what lies inside a chunk).
        byte: u64,
    },
}

/// A file and where in it; shown as `walk.csv:12` or `walk.mcap: record 7 at byte 4096`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Place {
    /// The file.
    pub file: Arc<Path>,
    /// Where in it.
    pub at: At,
}

impl Place {
    /// A place in `file`.
    pub fn new(file: &Arc<Path>, at: At) -> Self {
        Self { file: Arc::clone(file), at }
    }

    /// The line in `file`.
    pub fn line(file: &Arc<Path>, line: u64) -> Self {
        Self::new(file, At::Line(line))
    }

    /// `file` as a whole.
    pub fn file(file: impl AsRef<Path>) -> Self {
        Self { file: Arc::from(file.as_ref()), at: At::File }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        match self.at {
            At::File => Ok(()),
            At::Line(line) => write!(f, ":{line}"),
            At::Record { number, byte } => write!(f, ": record {number} at byte {byte}"),
        }
    }
}

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// The operating system refused.
    #[error("{}: cannot {doing}: {source}", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// Not one byte in the file.
    #[error("{place}: the file is empty, expected {expected}")]
    Empty {
        /// The file.
        place: Place,
        /// What should stand there.
        expected: &'static str,
    },
    /// A header but nothing below it.
    #[error("{place}: the file ends before the first {expected}")]
    NothingRecorded {
        /// Where it ends.
        place: Place,
        /// What should have come.
        expected: &'static str,
    },
    /// The gzip stream ends too early.
    #[error("{place}: the gzip file is cut: it ends after this line, before its end mark")]
    CutGzip {
        /// The line reached.
        place: Place,
    },
    /// The gzip stream is damaged.
    #[error("{place}: the gzip file is damaged after this line: {what}")]
    CorruptGzip {
        /// The line reached.
        place: Place,
        /// What the decoder said.
        what: String,
    },
    /// A line of text longer than any log has.
    #[error("{place}: a line of more than {limit} bytes follows: this is not a text log")]
    LineTooLong {
        /// The last good line.
        place: Place,
        /// The limit, bytes.
        limit: usize,
    },
    /// Columns that must be there are not.
    #[error("{place}: missing column {}; found {}", missing.join(", "), found.join(", "))]
    MissingColumn {
        /// The header line.
        place: Place,
        /// Missing, as `acc_x_<unit>`.
        missing: Vec<String>,
        /// What the header has.
        found: Vec<String>,
    },
    /// Two columns say the same.
    #[error("{place}: columns {first} and {second} give the same quantity")]
    DuplicateColumn {
        /// The header line.
        place: Place,
        /// The first of them.
        first: String,
        /// The second of them.
        second: String,
    },
    /// The unit at the end of a column name is not known.
    #[error("{place}: column {column}: unknown unit, expected {expected}")]
    UnknownUnit {
        /// The header line.
        place: Place,
        /// The column as written.
        column: String,
        /// Names accepted.
        expected: String,
    },
    /// A line with too many or too few fields.
    #[error("{place}: found {found} fields, expected {expected}")]
    FieldCount {
        /// The line.
        place: Place,
        /// Fields on the line.
        found: usize,
        /// Fields expected.
        expected: String,
    },
    /// A field that should hold a finite number does not.
    #[error("{place}: {column}: found \"{found}\", expected a finite number")]
    NotANumber {
        /// The line.
        place: Place,
        /// The column.
        column: String,
        /// Its text, shortened.
        found: String,
    },
    /// A time that cannot be read or lies past ±292 years.
    #[error("{place}: {column}: found \"{found}\", expected a time within ±292 years, as a decimal number")]
    NotATime {
        /// The line.
        place: Place,
        /// The column.
        column: String,
        /// Its text, shortened.
        found: String,
    },
    /// A value outside the set it must come from.
    #[error("{place}: {what}: found {found}, expected {expected}")]
    BadValue {
        /// The line or record.
        place: Place,
        /// Which value.
        what: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// Time runs backwards, or stands still where it must rise.
    #[error("{place}: time runs backwards: found {found} s, expected more than {before} s")]
    TimeBackwards {
        /// The line or record.
        place: Place,
        /// The time found.
        found: Time,
        /// The time before it.
        before: Time,
    },
    /// The numbers contradict the unit in the header.
    #[error("{place}: {quantity}: found {found}, expected {expected}: {verdict}")]
    ImplausibleUnit {
        /// The line or record.
        place: Place,
        /// What was measured.
        quantity: &'static str,
        /// What was found, with unit.
        found: String,
        /// What was expected, with unit.
        expected: &'static str,
        /// What it looks like.
        verdict: &'static str,
    },
    /// An MCAP file that is cut.
    #[error("{place}: the MCAP file is cut: it ends inside this record or before its end mark")]
    CutMcap {
        /// The first record that is not complete.
        place: Place,
    },
    /// An MCAP file that is damaged or uses what adit does not know.
    #[error("{place}: damaged or unknown MCAP content: {what}")]
    CorruptMcap {
        /// The record.
        place: Place,
        /// What is wrong with it.
        what: String,
    },
    /// Several channels carry the same kind of observation and none was chosen.
    #[error("{place}: {kind} observations on several topics: {}; choose one", topics.join(", "))]
    AmbiguousTopic {
        /// The record that declares the second one.
        place: Place,
        /// Which kind.
        kind: &'static str,
        /// The topics.
        topics: Vec<String>,
    },
    /// A sidecar that does not parse or contradicts itself.
    #[error("{place}: {what}")]
    Sidecar {
        /// The line.
        place: Place,
        /// What is wrong.
        what: String,
    },
    /// A file kind cannot hold what should be written.
    #[error("{}: cannot write: {what}", file.display())]
    CannotWrite {
        /// The output file.
        file: PathBuf,
        /// Why.
        what: String,
    },
}

/// Text of a field for an error message: printable, at most 40 characters.
pub(crate) fn shown(field: &[u8]) -> String {
    const LIMIT: usize = 40;
    let text = String::from_utf8_lossy(field.get(..4 * LIMIT).unwrap_or(field));
    let mut shown: String = text.chars().take(LIMIT).flat_map(char::escape_default).collect();
    if text.chars().count() > LIMIT || field.len() > 4 * LIMIT {
        shown.push('…');
    }
    shown
}

/// Words of a library about a file, on one line: it may quote what stands there.
pub(crate) fn on_one_line(text: &str) -> String {
    text.chars()
        .flat_map(|c| {
            // Letters of any alphabet stay, what would move a terminal is escaped.
            let escaped = c.is_control().then(|| c.escape_default());
            let plain = escaped.is_none().then_some(c);
            escaped.into_iter().flatten().chain(plain)
        })
        .collect()
}
