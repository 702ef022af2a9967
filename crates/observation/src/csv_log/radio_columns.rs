//! The columns of what other devices say: position fixes, signal strengths, ranges, sightings.
//!
//! | columns | what |
//! |---|---|
//! | `rssi_dBm` | signal strength |
//! | `transmitter`, or `access_point` (Wi-Fi), `beacon` (BLE), `receiver` | of which device |
//! | `radio` | a name of [`Radio`], of signal strengths and ranges |
//! | `reader` | the reader that saw the tag; empty where none did |
//!
//! Position fixes: [`super::fix_columns`]; ranges: [`super::range_columns`].

use super::finder::Finder;
use super::fix_columns::FixColumns;
use super::header::Column;
use super::range_columns::RangeColumns;
use super::table::Table;
use super::units::POWER_UNITS;
use crate::device::DeviceId;
use crate::error::{LogError, shown};
use crate::names::{EXPECTED_NAME, Names};
use crate::observation::Observation;
use crate::radio::{Radio, Sighting, SignalStrength};
use adit_core::time::Time;
use std::collections::VecDeque;

/// What the other end of a signal may be called, and the radio that goes with the word.
const TRANSMITTER: [(&str, Radio); 4] = [
    ("transmitter", Radio::Unknown),
    ("access_point", Radio::Wifi),
    ("beacon", Radio::Ble),
    ("receiver", Radio::Unknown),
];

/// Where everything that comes by radio stands in a row.
#[derive(Debug, Clone)]
pub(super) struct RadioColumns {
    fix: Option<FixColumns>,
    signal: Option<SignalColumns>,
    range: Option<RangeColumns>,
    radio: Option<usize>,
    reader: Option<usize>,
}

#[derive(Debug, Clone, Copy)]
struct SignalColumns {
    rssi: Column,
    transmitter: usize,
    radio: Radio,
}

impl RadioColumns {
    /// Finds the columns and marks them as used.
    pub fn find(finder: &mut Finder) -> Result<Self, LogError> {
        let fix = FixColumns::find(finder.names, finder.used, finder.place)?;
        let signal = match finder.measured("rssi", &POWER_UNITS)? {
            Some(rssi) => {
                let transmitter = finder.needed(&TRANSMITTER.map(|(name, _)| name))?;
                let word = |known: &&(&str, Radio)| known.0 == finder.names[transmitter];
                let radio = TRANSMITTER.iter().find(word).map_or(Radio::Unknown, |(_, radio)| *radio);
                Some(SignalColumns { rssi, transmitter, radio })
            }
            None => None,
        };
        let range = RangeColumns::find(finder)?;
        let radio = if signal.is_some() || range.is_some() { finder.one(&["radio"])? } else { None };
        Ok(Self { fix, signal, range, radio, reader: finder.one(&["reader"])? })
    }

    /// Whether there are any.
    pub fn any(&self) -> bool {
        self.fix.is_some() || self.signal.is_some() || self.range.is_some() || self.reader.is_some()
    }

    /// Appends what the present row says.
    pub fn read(
        &self,
        table: &Table,
        columns: &[String],
        names: &mut Names,
        time: Time,
        into: &mut VecDeque<Observation>,
    ) -> Result<(), LogError> {
        if let Some(columns_of_fix) = &self.fix
            && let Some(fix) = columns_of_fix.read(table, columns, time)?
        {
            into.push_back(possible(Observation::Fix(fix), table)?);
        }
        let radio = |usual| self.radio.map_or(Ok(usual), |index| radio(table, index, usual));
        if let Some(SignalColumns { rssi, transmitter, radio: usual }) = &self.signal
            && !table.field(rssi.index).is_empty()
        {
            let signal = SignalStrength {
                time,
                transmitter: device(table, *transmitter, columns, names)?,
                rssi_dbm: rssi.gain.apply(table.number(rssi.index, columns)?),
                radio: radio(*usual)?,
            };
            into.push_back(possible(Observation::Signal(signal), table)?);
        }
        if let Some(range) = &self.range {
            range.read(table, columns, names, time, || radio(Radio::Unknown), into)?;
        }
        if let Some(reader) = self.reader
            && !table.field(reader).is_empty()
        {
            let reader = device(table, reader, columns, names)?;
            into.push_back(Observation::Sighting(Sighting { time, reader }));
        }
        Ok(())
    }
}

/// The observation, or the error that says what cannot be right with it.
pub(super) fn possible(observation: Observation, table: &Table) -> Result<Observation, LogError> {
    match observation.fault() {
        None => Ok(observation),
        Some(fault) => Err(fault_of(fault, table)),
    }
}

/// The error for what cannot be right: (name of the quantity, its value, what is expected).
pub(super) fn fault_of((what, found, expected): (&str, f64, &str), table: &Table) -> LogError {
    LogError::BadValue {
        place: table.place(),
        what: what.to_owned(),
        found: found.to_string(),
        expected: expected.to_owned(),
    }
}

/// The device named in a field.
pub(super) fn device(
    table: &Table,
    index: usize,
    columns: &[String],
    names: &mut Names,
) -> Result<DeviceId, LogError> {
    let field = table.field(index);
    let name = std::str::from_utf8(field).unwrap_or_default();
    names.device(name).ok_or_else(|| LogError::BadValue {
        place: table.place(),
        what: columns.get(index).cloned().unwrap_or_default(),
        found: format!("\"{}\"", shown(field)),
        expected: EXPECTED_NAME.to_owned(),
    })
}

fn radio(table: &Table, index: usize, usual: Radio) -> Result<Radio, LogError> {
    let field = table.field(index);
    if field.is_empty() {
        return Ok(usual);
    }
    let name = std::str::from_utf8(field).unwrap_or_default();
    Radio::from_name(name).ok_or_else(|| LogError::BadValue {
        place: table.place(),
        what: "radio".to_owned(),
        found: shown(field),
        expected: Radio::ALL.map(Radio::name).join(", "),
    })
}
