//! Rows of a sensor log as they stand in the file, also of logs with an accelerometer or a magnetometer alone.

use super::header::{Column, Header};
use super::table::Table;
use super::units::Quantity;
use crate::error::{At, LogError};
use crate::files::Input;
use crate::fix::PositionFix;
use crate::warning::Warnings;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use std::path::Path;
use std::sync::Arc;

/// One line of a sensor log, in adit's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time of the reading.
    pub time: Time,
    /// Specific force, m/s², where the log has it.
    pub specific_force_m_s2: Option<Vector3<f64>>,
    /// Angular rate, rad/s, where the log has it.
    pub angular_rate_rad_s: Option<Vector3<f64>>,
    /// Magnetic flux density, µT, where the row has it.
    pub field_ut: Option<Vector3<f64>>,
    /// Position from outside, where the row has it.
    pub fix: Option<PositionFix>,
}

/// Reads a sensor log row by row, any sensor missing or not; order and units are not checked here.
///
/// This is for logs that are no inertial log: an accelerometer or a magnetometer alone. Everyone else
/// wants [`crate::open`], a calibration [`crate::SensorRows`].
pub struct RowReader {
    table: Table,
    header: Header,
}

impl RowReader {
    /// Reads the header.
    pub fn new(input: Input, warnings: &mut Warnings) -> Result<Self, LogError> {
        let (table, names) = Table::new(input, "a header such as time_s,acc_x_m_s2,…")?;
        let header = Header::parse(&names, &table.place(), warnings)?;
        Ok(Self { table, header })
    }

    /// What the log holds.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The next row and its line; `None` after the last.
    pub fn next_row(&mut self) -> Result<Option<(Row, At)>, LogError> {
        if !self.table.next()? {
            return Ok(None);
        }
        let time = self.table.time(self.header.time_index, self.header.time_exponent, &self.header.names)?;
        let [acceleration, rate, field] = &self.header.triples;
        let row = Row {
            time,
            specific_force_m_s2: acceleration.as_ref().map(|c| self.triple(c)).transpose()?,
            angular_rate_rad_s: rate.as_ref().map(|c| self.triple(c)).transpose()?,
            field_ut: match field {
                Some(columns) if columns.iter().all(|c| !self.table.field(c.index).is_empty()) => {
                    Some(self.triple(columns)?)
                }
                _ => None,
            },
            fix: match &self.header.fix {
                Some(columns) => columns.read(&self.table, &self.header.names, time)?,
                None => None,
            },
        };
        Ok(Some((row, self.table.at())))
    }

    #[inline]
    fn triple(&self, columns: &[Column; 3]) -> Result<Vector3<f64>, LogError> {
        let [x, y, z] = columns;
        Ok(Vector3::new(self.value(x)?, self.value(y)?, self.value(z)?))
    }

    #[inline]
    fn value(&self, column: &Column) -> Result<f64, LogError> {
        let value = column.gain.apply(self.table.number(column.index, &self.header.names)?);
        if value.is_finite() { Ok(value) } else { Err(self.too_large(column)) }
    }

    #[cold]
    fn too_large(&self, column: &Column) -> LogError {
        LogError::NotANumber {
            place: self.table.place(),
            column: self.header.names[column.index].clone(),
            found: crate::error::shown(self.table.field(column.index)),
        }
    }

    /// The file.
    pub fn file(&self) -> &Arc<Path> {
        self.table.file()
    }

    /// The error for a log in which a whole sensor is missing.
    pub(super) fn missing(&self, quantities: &[Quantity]) -> LogError {
        let absent = quantities.iter().filter(|q| !self.header.has(**q));
        let names = absent.flat_map(|q| (0..3).map(|axis| super::header::expected_name(*q, axis)));
        super::header::missing(names.collect(), &self.header.names, &self.table.place())
    }
}
