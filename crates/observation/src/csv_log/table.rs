//! Lines of a CSV file with a header, one record reused for all: what every CSV reader of adit stands on.

use crate::error::{At, LogError, Place, shown};
use crate::files::decimal::{parse_number, parse_time};
use crate::files::{Input, LineLimit, read_error};
use adit_core::time::Time;
use csv::{ByteRecord, ReaderBuilder};
use std::path::Path;
use std::sync::Arc;

const BUFFER: usize = 1 << 16;

/// A CSV file: comma between fields, `#` starts a comment line, no quotes inside fields, every line as long as the header.
pub(crate) struct Table {
    reader: csv::Reader<LineLimit>,
    record: ByteRecord,
    file: Arc<Path>,
    gzip: bool,
    columns: usize,
    line: u64,
}

impl Table {
    /// Reads the header line; `expected` says what a file of this kind starts with.
    pub(crate) fn new(input: Input, expected: &'static str) -> Result<(Self, ByteRecord), LogError> {
        let Input { file, start, reader, gzip, .. } = input;
        let mut table = Self {
            reader: ReaderBuilder::new()
                .has_headers(false)
                .flexible(true)
                .quoting(false)
                .buffer_capacity(BUFFER)
                .from_reader(LineLimit::new(reader)),
            record: ByteRecord::new(),
            file,
            gzip,
            columns: 0,
            line: 0,
        };
        if start.is_empty() || !table.advance()? {
            return Err(LogError::Empty { place: Place::new(&table.file, At::File), expected });
        }
        table.columns = table.record.len();
        let header = table.record.clone();
        Ok((table, header))
    }

    /// Moves to the next line; `false` at the end.
    pub(crate) fn next(&mut self) -> Result<bool, LogError> {
        if !self.advance()? {
            return Ok(false);
        }
        if self.record.len() != self.columns {
            return Err(LogError::FieldCount {
                place: self.place(),
                found: self.record.len(),
                expected: format!("{}, as in the header", self.columns),
            });
        }
        Ok(true)
    }

    /// The next line that is no comment. Comments are not left to the csv crate: it gives a record the line of the comment before.
    fn advance(&mut self) -> Result<bool, LogError> {
        while self.read()? {
            if !self.record.get(0).is_some_and(|field| field.starts_with(b"#")) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn read(&mut self) -> Result<bool, LogError> {
        match self.reader.read_byte_record(&mut self.record) {
            Ok(more) => {
                self.line = self.record.position().map_or(self.line, csv::Position::line);
                Ok(more)
            }
            Err(error) => {
                let place = self.place();
                Err(match error.into_kind() {
                    csv::ErrorKind::Io(source) => read_error(place, self.gzip, source),
                    other => LogError::BadValue {
                        place,
                        what: "line".to_owned(),
                        found: format!("{other:?}"),
                        expected: "comma-separated fields".to_owned(),
                    },
                })
            }
        }
    }

    pub(crate) fn file(&self) -> &Arc<Path> {
        &self.file
    }

    pub(crate) fn at(&self) -> At {
        At::Line(self.line)
    }

    pub(crate) fn place(&self) -> Place {
        Place::line(&self.file, self.line)
    }

    /// The field, blanks trimmed.
    #[inline]
    pub(crate) fn field(&self, index: usize) -> &[u8] {
        self.record.get(index).unwrap_or_default().trim_ascii()
    }

    #[inline]
    pub(crate) fn number(&self, index: usize, names: &[String]) -> Result<f64, LogError> {
        parse_number(self.field(index)).map_err(|_| self.not_a_number(index, names))
    }

    /// A number of single precision, rounded once.
    #[inline]
    pub(crate) fn single(&self, index: usize, names: &[String]) -> Result<f32, LogError> {
        let field = self.field(index);
        let number = std::str::from_utf8(field).ok().and_then(|text| text.parse::<f32>().ok());
        number.filter(|value| value.is_finite()).ok_or_else(|| self.not_a_number(index, names))
    }

    #[cold]
    pub(super) fn not_a_number(&self, index: usize, names: &[String]) -> LogError {
        LogError::NotANumber {
            place: self.place(),
            column: names.get(index).cloned().unwrap_or_default(),
            found: shown(self.field(index)),
        }
    }

    #[inline]
    pub(crate) fn time(&self, index: usize, exponent: i32, names: &[String]) -> Result<Time, LogError> {
        let field = self.field(index);
        parse_time(field, exponent).ok_or_else(|| LogError::NotATime {
            place: self.place(),
            column: names.get(index).cloned().unwrap_or_default(),
            found: shown(field),
        })
    }
}
