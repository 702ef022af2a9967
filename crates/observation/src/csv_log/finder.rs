//! Columns found by name, each once.

use super::header::{Column, duplicate, missing};
use super::units::Unit;
use crate::error::{LogError, Place};

/// The names of a header, and which of them somebody reads.
pub(super) struct Finder<'a> {
    pub names: &'a [String],
    pub used: &'a mut [bool],
    pub place: &'a Place,
}

impl Finder<'_> {
    /// The column of one of these names; two are an error.
    pub fn one(&mut self, spellings: &[&str]) -> Result<Option<usize>, LogError> {
        let mut found = None;
        for (index, name) in self.names.iter().enumerate() {
            if !spellings.contains(&name.as_str()) {
                continue;
            }
            if let Some(first) = found.replace(index) {
                return Err(duplicate(&self.names[first], name, self.place));
            }
            self.used[index] = true;
        }
        Ok(found)
    }

    /// The same, and an error where there is none.
    pub fn needed(&mut self, spellings: &[&str]) -> Result<usize, LogError> {
        match (self.one(spellings)?, spellings) {
            (Some(found), _) => Ok(found),
            (None, spellings) => {
                let names = spellings.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
                Err(missing(vec![names.join(" or ")], self.names, self.place))
            }
        }
    }

    /// The column `QUANTITY_UNIT`; an unknown unit, or none, is an error where there is no other such column.
    pub fn measured(&mut self, quantity: &str, units: &[Unit]) -> Result<Option<Column>, LogError> {
        let mut found: Option<Column> = None;
        let mut odd = None;
        for (index, name) in self.names.iter().enumerate() {
            let unit = match name.strip_prefix(quantity) {
                Some("") => "",
                Some(rest) if rest.starts_with('_') && !rest[1..].contains('_') => &rest[1..],
                _ => continue,
            };
            let Some(Unit { gain, .. }) = Unit::of(units, unit) else {
                odd = odd.or(Some(name));
                continue;
            };
            if let Some(first) = found.replace(Column { index, gain }) {
                return Err(duplicate(&self.names[first.index], name, self.place));
            }
            self.used[index] = true;
        }
        match (found, odd) {
            (None, Some(odd)) => {
                let accepted = units.iter().map(|unit| format!("{quantity}_{}", unit.suffix));
                let expected = accepted.collect::<Vec<_>>().join(", ");
                Err(LogError::UnknownUnit { place: self.place.clone(), column: odd.clone(), expected })
            }
            (found, _) => Ok(found),
        }
    }
}
