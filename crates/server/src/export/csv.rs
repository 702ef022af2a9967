//! Rows as CSV with the unit in each name.

use crate::export::columns::{Cell, utc};
use crate::export::pages::Exported;
use csv::{Writer, WriterBuilder};

/// Between several names in one field.
const BETWEEN: &str = ";";

/// The line of names.
pub(crate) fn head<T: Exported>() -> Result<Vec<u8>, String> {
    let mut names = Vec::new();
    for column in T::COLUMNS {
        match column.cell {
            Cell::Time(_) | Cell::OptionalTime(_) => {
                names.extend([format!("{}_s", column.name), format!("{}_utc", column.name)]);
            }
            _ => names.push(column.name.to_owned()),
        }
    }
    let mut writer = writer();
    writer.write_record(names).map_err(|error| error.to_string())?;
    bytes(writer)
}

pub(crate) fn rows<T: Exported>(rows: &[T]) -> Result<Vec<u8>, String> {
    let mut writer = writer();
    let mut fields: Vec<String> = Vec::new();
    for row in rows {
        fields.clear();
        for column in T::COLUMNS {
            let time = match &column.cell {
                Cell::Time(of) => Some(of(row)),
                Cell::OptionalTime(of) => of(row),
                _ => None,
            };
            match &column.cell {
                Cell::Time(_) | Cell::OptionalTime(_) => {
                    fields.push(time.map(|time| time.to_string()).unwrap_or_default());
                    fields.push(time.map(utc).unwrap_or_default().into_owned());
                }
                Cell::Number(of) => fields.push(of(row).to_string()),
                Cell::Text(of) => fields.push(of(row).to_owned()),
                Cell::OptionalText(of) => fields.push(of(row).unwrap_or_default().to_owned()),
                Cell::Texts(of) => fields.push(of(row).join(BETWEEN)),
                Cell::Json(of) => fields.push(of(row).to_string()),
            }
        }
        writer.write_record(&fields).map_err(|error| error.to_string())?;
    }
    bytes(writer)
}

fn writer() -> Writer<Vec<u8>> {
    WriterBuilder::new().from_writer(Vec::new())
}

fn bytes(writer: Writer<Vec<u8>>) -> Result<Vec<u8>, String> {
    writer.into_inner().map_err(|error| error.to_string())
}
