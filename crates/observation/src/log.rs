//! The one door to every log: [`open`].

use crate::csv_log::CsvLog;
use crate::error::{At, LogError, Place};
use crate::files::Input;
use crate::mcap_log::{self, McapLog};
use crate::observation::Observation;
use crate::order::{DEFAULT_GAP_LIMIT, DEFAULT_LATE_LIMIT, Ordered};
use crate::plausibility::UnitChecked;
use crate::sidecar::Sidecar;
use crate::source::LogSource;
use crate::warning::{LogWarning, Warnings};
use adit_core::time::Interval;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The kind of a log, told by its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LogKind {
    /// Text with units in the header.
    Csv,
    /// Binary container with schemas.
    Mcap,
}

/// How to read a log.
#[derive(Debug, Clone)]
pub struct ReadOptions {
    /// Gap between inertial samples from which on a warning is given.
    pub gap_limit: Interval,
    /// How late an observation by radio may come (see [`crate::order`]).
    pub late_limit: Interval,
    /// Whether numbers are checked against their units (see [`crate::plausibility`]).
    pub check_units: bool,
    /// Topics of an MCAP file to read; empty for all that adit knows.
    pub topics: Vec<String>,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            gap_limit: DEFAULT_GAP_LIMIT,
            late_limit: DEFAULT_LATE_LIMIT,
            check_units: true,
            topics: Vec::new(),
        }
    }
}

type Source = Box<dyn LogSource + Send>;

/// A log being read: an iterator of observations. Those of the tag's own sensors are in order of time; what comes by radio may be
/// late (see [`crate::order`]).
///
/// After the first error the iterator ends.
pub struct LogReader {
    source: Checked,
    kind: LogKind,
    warnings: Warnings,
    progress: (Arc<AtomicU64>, Option<u64>),
    sidecar: Option<(PathBuf, Sidecar)>,
    ended: bool,
}

enum Checked {
    Units(UnitChecked<Ordered<Source>>),
    OrderOnly(Ordered<Source>),
}

/// Opens a log of any kind, with its sidecar where there is one.
///
/// The first samples are read at once, so that a wrong header, unit or file kind is an error here.
pub fn open(path: impl AsRef<Path>) -> Result<LogReader, LogError> {
    open_with(path, &ReadOptions::default())
}

/// [`open`] with other limits.
pub fn open_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<LogReader, LogError> {
    let path = path.as_ref();
    let mut log = LogReader::from_input(Input::open(path)?, options)?;
    log.sidecar = Sidecar::beside(path)?;
    Ok(log)
}

impl LogReader {
    /// Reads a log from bytes of any origin; no sidecar is looked for.
    pub fn from_input(input: Input, options: &ReadOptions) -> Result<Self, LogError> {
        let mut warnings = Warnings::default();
        let progress = input.progress();
        let (kind, source): (_, Source) = if input.start.starts_with(mcap_log::MAGIC) {
            (LogKind::Mcap, Box::new(McapLog::new(input, &options.topics)))
        } else {
            (LogKind::Csv, Box::new(CsvLog::new(input, &mut warnings)?))
        };
        let ordered = Ordered::new(source, options.gap_limit, options.late_limit);
        let source = if options.check_units {
            let mut checked = UnitChecked::new(ordered);
            if !checked.look_ahead(&mut warnings)? {
                let place = Place::new(checked.file(), At::File);
                return Err(LogError::NothingRecorded { place, expected: "observation" });
            }
            Checked::Units(checked)
        } else {
            Checked::OrderOnly(ordered)
        };
        Ok(Self { source, kind, warnings, progress, sidecar: None, ended: false })
    }

    /// What was odd so far; complete once the iterator has ended.
    pub fn warnings(&self) -> &[LogWarning] {
        self.warnings.list()
    }

    /// The sidecar found beside the log; already applied to the observations.
    pub fn sidecar(&self) -> Option<&Sidecar> {
        self.sidecar.as_ref().map(|(_, sidecar)| sidecar)
    }

    /// Where the sidecar was found.
    pub fn sidecar_file(&self) -> Option<&Path> {
        self.sidecar.as_ref().map(|(path, _)| path.as_path())
    }

    /// Applies a sidecar from elsewhere, in place of the one found.
    #[must_use]
    pub fn with_sidecar(mut self, path: impl Into<PathBuf>, sidecar: Sidecar) -> Self {
        self.sidecar = Some((path.into(), sidecar));
        self
    }

    /// The kind of file.
    pub fn kind(&self) -> LogKind {
        self.kind
    }

    /// The file, as named when it was opened.
    pub fn file(&self) -> &Path {
        match &self.source {
            Checked::Units(source) => source.file(),
            Checked::OrderOnly(source) => source.file(),
        }
    }

    /// Bytes of the file read so far (before gzip is undone), for a progress bar.
    pub fn bytes_read(&self) -> u64 {
        self.progress.0.load(Ordering::Relaxed)
    }

    /// Length of the file in bytes; `None` for a pipe.
    pub fn bytes_total(&self) -> Option<u64> {
        self.progress.1
    }

    fn next_observation(&mut self) -> Result<Option<(Observation, At)>, LogError> {
        match &mut self.source {
            Checked::Units(source) => source.next_observation(&mut self.warnings),
            Checked::OrderOnly(source) => source.next_observation(&mut self.warnings),
        }
    }
}

impl Iterator for LogReader {
    type Item = Result<Observation, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        match self.next_observation() {
            Ok(Some((observation, _))) => Some(Ok(match self.sidecar() {
                Some(sidecar) if !sidecar.leaves_samples_alone() => sidecar.apply(observation),
                _ => observation,
            })),
            Ok(None) => {
                self.ended = true;
                None
            }
            Err(error) => {
                self.ended = true;
                Some(Err(error))
            }
        }
    }
}
