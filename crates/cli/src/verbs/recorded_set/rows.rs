//! Tables of a set as the readers of adit want them: some of the rows, columns by their usual names.

use crate::suite_file::RowChoice;
use adit_observation::files::Input;
use anyhow::{Context, Result, bail};
use csv::{ReaderBuilder, StringRecord, WriterBuilder};
use std::path::Path;

/// What the places of a tag are called beside its true ranges.
const TAG: [(&str, &str); 3] = [("tag_x_m", "x_m"), ("tag_y_m", "y_m"), ("tag_z_m", "z_m")];

/// A truth, or the places of a tag beside its true ranges; of its rows those that are chosen.
pub fn of_truth(path: &Path, choice: Option<&RowChoice>) -> Result<Input> {
    of(path, choice, |header| {
        let has = |wanted: &str| header.iter().any(|name| name == wanted);
        let renamed = |name: &str| {
            let tag = TAG.iter().find(|(known, usual)| *known == name && !has(usual));
            tag.map_or_else(|| name.to_owned(), |(_, usual)| (*usual).to_owned())
        };
        header.iter().map(renamed).collect()
    })
}

/// A table, of its rows those that are chosen.
pub fn chosen(path: &Path, choice: Option<&RowChoice>) -> Result<Input> {
    of(path, choice, StringRecord::clone)
}

/// As it is where nothing is to be changed: errors then tell lines of the file.
fn of(
    path: &Path,
    choice: Option<&RowChoice>,
    rename: impl FnOnce(&StringRecord) -> StringRecord,
) -> Result<Input> {
    let mut reader = ReaderBuilder::new().from_reader(Input::open(path)?.reader);
    let place = || path.display().to_string();
    let header = reader.headers().with_context(place)?.clone();
    let named = rename(&header);
    if choice.is_none() && named == header {
        return Ok(Input::open(path)?);
    }
    let column = match choice {
        None => None,
        Some(RowChoice { column, .. }) => {
            let Some(at) = header.iter().position(|name| name == column) else {
                let found: Vec<&str> = header.iter().collect();
                bail!("{}:1: no column {column}; found {}", place(), found.join(", "));
            };
            Some(at)
        }
    };
    let mut writer = WriterBuilder::new().from_writer(Vec::new());
    writer.write_record(&named)?;
    for row in reader.records() {
        let row = row.with_context(place)?;
        let wanted = |(at, choice): (usize, &RowChoice)| row.get(at) == Some(choice.is.as_str());
        if column.zip(choice).is_none_or(wanted) {
            writer.write_record(&row)?;
        }
    }
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    Ok(Input::from_bytes(&place(), &bytes)?)
}
