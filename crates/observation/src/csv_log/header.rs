//! The header line: which column holds what, in which unit.

use super::finder::Finder;
use super::radio_columns::RadioColumns;
use super::units::{Gain, PRESSURE_UNITS, Quantity, TIME_UNITS};
use crate::error::{LogError, Place};
use crate::warning::{LogWarning, Warnings};
use csv::ByteRecord;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Said of a magnetic field divided by its usual length: a direction, not a flux density.
const DIMENSIONLESS: [&str; 2] = ["normalised", "normalized"];

/// Where a number stands and what to do with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Column {
    pub index: usize,
    pub gain: Gain,
}

/// Where everything stands in a row.
#[derive(Debug, Clone)]
pub struct Header {
    pub(super) names: Vec<String>,
    pub(super) time_index: usize,
    pub(super) time_exponent: i32,
    /// Columns x, y, z per [`Quantity`], in the order of [`Quantity::ALL`].
    pub(super) triples: [Option<[Column; 3]>; 3],
    pub(super) pressure: Option<Column>,
    pub(super) radio: RadioColumns,
}

impl Header {
    /// Reads the names; columns not known are ignored with a warning.
    pub(super) fn parse(
        record: &ByteRecord,
        place: &Place,
        warnings: &mut Warnings,
    ) -> Result<Self, LogError> {
        let names: Vec<String> = record.iter().map(name).collect();
        let mut used = vec![false; names.len()];
        let (time_index, time_exponent) = find_time(&names, place)?;
        used[time_index] = true;
        let mut triples = [None; 3];
        for (triple, quantity) in triples.iter_mut().zip(Quantity::ALL) {
            *triple = find_triple(quantity, &names, &mut used, place, warnings)?;
        }
        let mut finder = Finder { names: &names, used: &mut used, place };
        let pressure = finder.measured("pressure", &PRESSURE_UNITS)?;
        let radio = RadioColumns::find(&mut finder)?;
        let ignored = || names.iter().zip(&used).filter(|(_, used)| !**used).map(|(name, _)| name.clone());
        if ignored().next().is_some() {
            warnings.push(LogWarning::IgnoredColumns { place: place.clone(), columns: ignored().collect() });
        }
        Ok(Self { names, time_index, time_exponent, triples, pressure, radio })
    }

    /// Whether all three axes of a quantity are there.
    pub fn has(&self, quantity: Quantity) -> bool {
        self.triples[quantity as usize].is_some()
    }

    /// Whether the log has a barometer.
    pub fn has_pressure(&self) -> bool {
        self.pressure.is_some()
    }

    /// Whether the log has position fixes, signal strengths, ranges or sightings.
    pub fn has_radio(&self) -> bool {
        self.radio.any()
    }

    /// Names as written.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}

/// A column name, without the quotes and blanks some programs put round it.
pub(crate) fn name(field: &[u8]) -> String {
    String::from_utf8_lossy(field).trim().trim_matches('"').trim().to_owned()
}

fn find_time(names: &[String], place: &Place) -> Result<(usize, i32), LogError> {
    let mut found: Option<(usize, i32)> = None;
    let mut odd: Option<&String> = None;
    for (index, name) in names.iter().enumerate() {
        let Some(rest) = name.strip_prefix("time") else { continue };
        let unit = rest.strip_prefix('_').unwrap_or(rest);
        match TIME_UNITS.iter().find(|(suffix, _)| *suffix == unit) {
            Some((_, exponent)) if rest.starts_with('_') => match found {
                Some((first, _)) => return Err(duplicate(&names[first], name, place)),
                None => found = Some((index, *exponent)),
            },
            _ => odd = odd.or(Some(name)),
        }
    }
    match (found, odd) {
        (Some(found), _) => Ok(found),
        (None, Some(odd)) => Err(LogError::UnknownUnit {
            place: place.clone(),
            column: odd.clone(),
            expected: TIME_UNITS.map(|(suffix, _)| format!("time_{suffix}")).join(", "),
        }),
        (None, None) => Err(missing(vec!["time_s".to_owned()], names, place)),
    }
}

fn find_triple(
    quantity: Quantity,
    names: &[String],
    used: &mut [bool],
    place: &Place,
    warnings: &mut Warnings,
) -> Result<Option<[Column; 3]>, LogError> {
    let mut columns: [Option<Column>; 3] = [None; 3];
    let mut normalised = false;
    for (index, name) in names.iter().enumerate() {
        let Some((axis, unit)) = axis_and_unit(quantity, name) else { continue };
        used[index] = true;
        if quantity == Quantity::MagneticField && DIMENSIONLESS.contains(&unit) {
            normalised = true;
            continue;
        }
        let Some(known) = quantity.units().iter().find(|known| known.suffix == unit) else {
            let accepted = quantity.units().iter().map(|u| with_unit(quantity, axis, u.suffix));
            return Err(LogError::UnknownUnit {
                place: place.clone(),
                column: name.clone(),
                expected: accepted.collect::<Vec<_>>().join(", "),
            });
        };
        if let Some(first) = columns[axis].replace(Column { index, gain: known.gain }) {
            return Err(duplicate(&names[first.index], name, place));
        }
    }
    if normalised {
        warnings.push(LogWarning::NormalisedMagneticField { place: place.clone() });
    }
    match columns {
        [Some(x), Some(y), Some(z)] => Ok(Some([x, y, z])),
        [None, None, None] => Ok(None),
        _ => {
            let absent = (0..3).filter(|axis| columns[*axis].is_none());
            Err(missing(absent.map(|axis| expected_name(quantity, axis)).collect(), names, place))
        }
    }
}

/// `acc_x_m_s2` to axis 0 and `m_s2`; a missing unit is an empty one.
fn axis_and_unit(quantity: Quantity, name: &str) -> Option<(usize, &str)> {
    let rest = name.strip_prefix(quantity.prefix())?.strip_prefix('_')?;
    let (axis, unit) = rest.split_once('_').unwrap_or((rest, ""));
    AXES.iter().position(|known| *known == axis).map(|axis| (axis, unit))
}

fn with_unit(quantity: Quantity, axis: usize, suffix: &str) -> String {
    format!("{}_{}_{suffix}", quantity.prefix(), AXES[axis])
}

/// The name in adit's own unit.
pub(super) fn expected_name(quantity: Quantity, axis: usize) -> String {
    with_unit(quantity, axis, quantity.units()[0].suffix)
}

/// The error for absent columns.
pub(crate) fn missing(missing: Vec<String>, names: &[String], place: &Place) -> LogError {
    let found = names.iter().map(|name| crate::error::shown(name.as_bytes())).take(40).collect();
    LogError::MissingColumn { place: place.clone(), missing, found }
}

pub(super) fn duplicate(first: &str, second: &str, place: &Place) -> LogError {
    LogError::DuplicateColumn { place: place.clone(), first: first.to_owned(), second: second.to_owned() }
}
