//! The one door to every log: [`open`].

use crate::csv_log::CsvLog;
use crate::error::{At, LogError, Place};
use crate::files::Input;
use crate::imu::Observation;
use crate::order::{DEFAULT_GAP_LIMIT, Ordered};
use crate::plausibility::UnitChecked;
use crate::source::LogSource;
use crate::warning::{LogWarning, Warnings};
use adit_core::time::Interval;
use std::path::Path;
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
    /// Whether numbers are checked against their units (see [`crate::plausibility`]).
    pub check_units: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { gap_limit: DEFAULT_GAP_LIMIT, check_units: true }
    }
}

type Source = Box<dyn LogSource + Send>;

/// A log being read: an iterator of observations in order of time.
///
/// After the first error the iterator ends.
pub struct LogReader {
    source: Checked,
    kind: LogKind,
    warnings: Warnings,
    progress: (Arc<AtomicU64>, Option<u64>),
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
    LogReader::from_input(Input::open(path)?, options)
}

impl LogReader {
    /// Reads a log from bytes of any origin; no sidecar is looked for.
    pub fn from_input(input: Input, options: &ReadOptions) -> Result<Self, LogError> {
        let mut warnings = Warnings::default();
        let progress = input.progress();
        let kind = LogKind::Csv;
        let source: Source = Box::new(CsvLog::new(input, &mut warnings)?);
        let ordered = Ordered::new(source, options.gap_limit);
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
        Ok(Self { source, kind, warnings, progress, ended: false })
    }

    /// What was odd so far; complete once the iterator has ended.
    pub fn warnings(&self) -> &[LogWarning] {
        self.warnings.list()
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
            Ok(Some((observation, _))) => Some(Ok(observation)),
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
