//! Tables of the recorded sets: columns by name, plain or gzip.

use super::Outcome;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A table in memory.
pub struct Rows {
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Rows {
    /// Reads a file; `.gz` is unpacked.
    pub fn read(path: &Path) -> Outcome<Self> {
        let file = File::open(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let packed = path.extension().is_some_and(|end| end == "gz");
        let input: Box<dyn Read> =
            if packed { Box::new(flate2::read::GzDecoder::new(file)) } else { Box::new(file) };
        let mut reader = csv::Reader::from_reader(input);
        let header = reader.headers()?.iter().map(str::to_owned).collect();
        let rows = reader.records().collect::<Result<_, _>>()?;
        Ok(Self { header, rows })
    }

    /// The place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|h| h == name)
    }

    /// Names of all columns.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// How many rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Text of a field; empty where it is missing.
    pub fn text(&self, row: usize, name: &str) -> &str {
        self.column(name).and_then(|c| self.rows.get(row)?.get(c)).unwrap_or("")
    }

    /// Number of a field; not a number where it is missing.
    pub fn number(&self, row: usize, name: &str) -> f64 {
        self.text(row, name).parse().unwrap_or(f64::NAN)
    }

    /// All numbers of a column.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        (0..self.len()).map(|row| self.number(row, name)).collect()
    }
}
