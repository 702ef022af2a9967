//! Rows of a sensor log as they stand in the file, also of logs with an accelerometer or a magnetometer alone.

use super::header::{Column, Header};
use super::radio_columns;
use super::table::Table;
use super::units::Quantity;
use crate::error::{At, LogError};
use crate::files::Input;
use crate::names::Names;
use crate::observation::Observation;
use crate::warning::Warnings;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;

/// What the sensors of the tag itself say in one line of a log, in adit's units.
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
    /// Air pressure, Pa, where the row has it.
    pub pressure_pa: Option<f64>,
}

impl Row {
    /// Nothing said at a time.
    pub(crate) const fn empty(time: Time) -> Self {
        Self { time, specific_force_m_s2: None, angular_rate_rad_s: None, field_ut: None, pressure_pa: None }
    }

    /// Whether any sensor said something.
    pub(crate) const fn says_something(&self) -> bool {
        self.specific_force_m_s2.is_some()
            || self.angular_rate_rad_s.is_some()
            || self.field_ut.is_some()
            || self.pressure_pa.is_some()
    }
}

/// Reads a sensor log row by row, any sensor missing or not; order and units are not checked here.
///
/// This is for logs that are no inertial log: an accelerometer or a magnetometer alone. Everyone else
/// wants [`crate::open`], a calibration [`crate::SensorRows`].
pub struct RowReader {
    table: Table,
    header: Header,
    names: Names,
}

impl RowReader {
    /// Reads the header.
    pub fn new(input: Input, warnings: &mut Warnings) -> Result<Self, LogError> {
        let (table, names) = Table::new(input, "a header such as time_s,acc_x_m_s2,…")?;
        let header = Header::parse(&names, &table.place(), warnings)?;
        Ok(Self { table, header, names: Names::default() })
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
            pressure_pa: match &self.header.pressure {
                Some(column) if !self.table.field(column.index).is_empty() => Some(self.value(column)?),
                _ => None,
            },
        };
        Ok(Some((row, self.table.at())))
    }

    /// Appends what other devices say in the line of the row read last.
    pub(super) fn radio(&mut self, time: Time, into: &mut VecDeque<Observation>) -> Result<(), LogError> {
        self.header.radio.read(&self.table, &self.header.names, &mut self.names, time, into)
    }

    /// The observation of the row read last, or the error that says what cannot be right with it.
    pub(super) fn possible(&self, observation: Observation) -> Result<Observation, LogError> {
        radio_columns::possible(observation, &self.table)
    }

    #[inline]
    fn triple(&self, columns: &[Column; 3]) -> Result<Vector3<f64>, LogError> {
        let [x, y, z] = columns;
        Ok(Vector3::new(self.value(x)?, self.value(y)?, self.value(z)?))
    }

    #[inline]
    fn value(&self, column: &Column) -> Result<f64, LogError> {
        let value = column.gain.apply(self.table.number(column.index, &self.header.names)?);
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.table.not_a_number(column.index, &self.header.names))
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
