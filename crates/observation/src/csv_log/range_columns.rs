//! The columns of ranges, one range to a row or one column for each anchor.
//!
//! | columns | what |
//! |---|---|
//! | `range_m` (`_cm`, `_mm`) with `anchor_id` or `anchor` | a range; empty where the row has none |
//! | `range_NAME_m`, without `range_m` | a range to the anchor NAME, as many columns as anchors |
//! | `tag_id` or `tag` | which tag |
//! | `range_sigma_m` | standard deviation of the row's ranges |
//! | `valid` | 0: the row has no range, whatever stands in it |
//! | `line_of_sight` | probability, 0 to 1 |
//! | `rx_power_dBm`, `first_path_power_dBm`, `first_path_index_tap`, `peak_index_tap`, `first_path_amp1` to `first_path_amp3`, `noise_std`, `noise_max`, `preamble_count` | how the signal came in ([`Reception`]), of single ranges; a power of `-inf` is not told |
//!
//! Impulse responses have no columns; MCAP holds them.

use super::finder::Finder;
use super::header::{Column, duplicate, missing};
use super::radio_columns::{device, possible};
use super::table::Table;
use super::units::{RANGE_UNITS, Unit};
use crate::device::DeviceId;
use crate::error::{LogError, shown};
use crate::names::{EXPECTED_NAME, Names};
use crate::observation::Observation;
use crate::radio::{Radio, RangeSample, Reception};
use adit_core::time::Time;
use std::collections::VecDeque;
use std::sync::Arc;

const SIGMA: &str = "range_sigma_m";
const AMPLITUDES: [&str; 3] = ["first_path_amp1", "first_path_amp2", "first_path_amp3"];

/// Where the parts of a range stand in a row.
#[derive(Debug, Clone)]
pub(super) struct RangeColumns {
    ranges: Ranges,
    tag: Option<usize>,
    sigma: Option<usize>,
    valid: Option<usize>,
}

#[derive(Debug, Clone)]
enum Ranges {
    One { range: Column, anchor: usize, line_of_sight: Option<usize>, reception: ReceptionColumns },
    EachAnchor(Vec<(Column, DeviceId)>),
}

impl RangeColumns {
    /// Finds the columns and marks them as used; `None` where the log has no ranges.
    pub fn find(finder: &mut Finder) -> Result<Option<Self>, LogError> {
        let wide = each_anchor(finder)?;
        let ranges = match (finder.measured("range", &RANGE_UNITS), wide.is_empty()) {
            (Ok(Some(range)), _) => Ranges::One {
                range,
                anchor: finder.needed(&["anchor_id", "anchor"])?,
                line_of_sight: finder.one(&["line_of_sight"])?,
                reception: ReceptionColumns::find(finder)?,
            },
            (Ok(None) | Err(LogError::UnknownUnit { .. }), false) => {
                for (column, _) in &wide {
                    finder.used[column.index] = true;
                }
                Ranges::EachAnchor(wide)
            }
            (Ok(None), true) => return Ok(None),
            (Err(error), _) => return Err(error),
        };
        Ok(Some(Self {
            ranges,
            tag: finder.one(&["tag_id", "tag"])?,
            sigma: finder.one(&[SIGMA])?,
            valid: finder.one(&["valid"])?,
        }))
    }

    /// Appends the ranges of the present row.
    pub fn read(
        &self,
        table: &Table,
        columns: &[String],
        names: &mut Names,
        time: Time,
        radio: impl FnOnce() -> Result<Radio, LogError>,
        into: &mut VecDeque<Observation>,
    ) -> Result<(), LogError> {
        if let Some(index) = self.valid
            && !valid(table, index)?
        {
            return Ok(());
        }
        let has_range = |column: &Column| !table.field(column.index).is_empty();
        if let Ranges::One { range, .. } = &self.ranges
            && !has_range(range)
        {
            return Ok(());
        }
        let given = |index: Option<usize>| index.filter(|index| !table.field(*index).is_empty());
        let number = |index: Option<usize>| given(index).map(|at| table.number(at, columns)).transpose();
        let tag = given(self.tag).map(|at| device(table, at, columns, names)).transpose()?;
        let (sigma_m, radio) = (number(self.sigma)?, radio()?);
        let mut push = |range: &Column, anchor, line_of_sight, reception| {
            let range_m = range.gain.apply(table.number(range.index, columns)?);
            let tag = tag.clone();
            let in_the_way = None;
            let range = RangeSample {
                time,
                anchor,
                tag,
                range_m,
                sigma_m,
                line_of_sight,
                in_the_way,
                radio,
                reception,
            };
            into.push_back(possible(Observation::Range(range), table)?);
            Ok(())
        };
        match &self.ranges {
            Ranges::One { range, anchor, line_of_sight, reception } => {
                let anchor = device(table, *anchor, columns, names)?;
                push(range, anchor, number(*line_of_sight)?, reception.read(table, columns)?)
            }
            Ranges::EachAnchor(ranges) => ranges
                .iter()
                .filter(|(range, _)| has_range(range))
                .try_for_each(|(range, anchor)| push(range, anchor.clone(), None, None)),
        }
    }
}

/// The columns `range_NAME_UNIT`, with the anchor of each.
fn each_anchor(finder: &Finder) -> Result<Vec<(Column, DeviceId)>, LogError> {
    let mut found: Vec<(Column, DeviceId)> = Vec::new();
    for (index, column) in finder.names.iter().enumerate() {
        let Some((name, unit)) = column.strip_prefix("range_").and_then(|rest| rest.rsplit_once('_')) else {
            continue;
        };
        let Some(Unit { gain, .. }) = Unit::of(&RANGE_UNITS, unit).filter(|_| column != SIGMA) else {
            continue;
        };
        let Some(anchor) = DeviceId::new(name) else {
            return Err(LogError::BadValue {
                place: finder.place.clone(),
                what: "anchor".to_owned(),
                found: format!("\"{}\"", shown(name.as_bytes())),
                expected: EXPECTED_NAME.to_owned(),
            });
        };
        if let Some((first, _)) = found.iter().find(|(_, known)| *known == anchor) {
            return Err(duplicate(&finder.names[first.index], column, finder.place));
        }
        found.push((Column { index, gain }, anchor));
    }
    Ok(found)
}

/// Where the parts of a reception stand in a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReceptionColumns {
    rx_power_dbm: Option<usize>,
    first_path_power_dbm: Option<usize>,
    first_path_index_tap: Option<usize>,
    peak_index_tap: Option<usize>,
    amplitudes: Option<[usize; 3]>,
    noise_std: Option<usize>,
    noise_max: Option<usize>,
    preamble_count: Option<usize>,
}

impl ReceptionColumns {
    pub fn find(finder: &mut Finder) -> Result<Self, LogError> {
        let amplitudes = match AMPLITUDES.map(|name| finder.one(&[name])) {
            [Ok(Some(first)), Ok(Some(second)), Ok(Some(third))] => Some([first, second, third]),
            [Ok(None), Ok(None), Ok(None)] => None,
            found => {
                let found = found.into_iter().collect::<Result<Vec<_>, _>>()?;
                let absent = AMPLITUDES.iter().zip(found).filter(|(_, found)| found.is_none());
                let absent = absent.map(|(name, _)| (*name).to_owned()).collect();
                return Err(missing(absent, finder.names, finder.place));
            }
        };
        Ok(Self {
            rx_power_dbm: finder.one(&["rx_power_dBm", "rx_power_dbm"])?,
            first_path_power_dbm: finder.one(&["first_path_power_dBm", "first_path_power_dbm"])?,
            first_path_index_tap: finder.one(&["first_path_index_tap"])?,
            peak_index_tap: finder.one(&["peak_index_tap"])?,
            amplitudes,
            noise_std: finder.one(&["noise_std", "pre_first_path_amplitude_std"])?,
            noise_max: finder.one(&["noise_max"])?,
            preamble_count: finder.one(&["preamble_count"])?,
        })
    }

    /// What the present row says of it; `None` where all its fields are empty.
    pub fn read(&self, table: &Table, columns: &[String]) -> Result<Option<Arc<Reception>>, LogError> {
        let given = |index: Option<usize>| index.filter(|index| !table.field(*index).is_empty());
        let single = |index: Option<usize>| given(index).map(|at| table.single(at, columns)).transpose();
        // The power of no amplitude at all: the device could not tell.
        let some = |index: &usize| !table.field(*index).eq_ignore_ascii_case(b"-inf");
        let power = |index: Option<usize>| single(index.filter(some));
        let first_path_amplitudes = match self.amplitudes {
            Some(all) if all.into_iter().any(|at| !table.field(at).is_empty()) => {
                let [first, second, third] = all.map(|at| table.single(at, columns));
                Some([first?, second?, third?])
            }
            _ => None,
        };
        let reception = Reception {
            rx_power_dbm: power(self.rx_power_dbm)?,
            first_path_power_dbm: power(self.first_path_power_dbm)?,
            first_path_index_tap: single(self.first_path_index_tap)?,
            peak_index_tap: single(self.peak_index_tap)?,
            first_path_amplitudes,
            noise_std: single(self.noise_std)?,
            noise_max: single(self.noise_max)?,
            preamble_count: given(self.preamble_count).map(|at| count(table, at)).transpose()?,
            impulse_response: None,
        };
        Ok((reception != Reception::default()).then(|| Arc::new(reception)))
    }
}

fn valid(table: &Table, index: usize) -> Result<bool, LogError> {
    match table.field(index) {
        b"0" => Ok(false),
        b"1" => Ok(true),
        other => Err(bad(table, "valid", other, "0 or 1")),
    }
}

fn count(table: &Table, index: usize) -> Result<u16, LogError> {
    let field = table.field(index);
    let number = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
    number.ok_or_else(|| bad(table, "preamble_count", field, "a whole number, 0 to 65535"))
}

fn bad(table: &Table, what: &str, found: &[u8], expected: &str) -> LogError {
    let (what, found, expected) = (what.to_owned(), format!("\"{}\"", shown(found)), expected.to_owned());
    LogError::BadValue { place: table.place(), what, found, expected }
}
