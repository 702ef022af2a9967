//! Rows as Parquet: columns compressed with zstd, in row groups.

use crate::export::columns::{Cell, Column};
use crate::export::pages::Exported;
use adit_core::time::Time;
use parquet::basic::{
    Compression, LogicalType, Repetition, TimeUnit, TimestampType, Type as Physical, ZstdLevel,
};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use std::sync::Arc;

/// Rows of a group.
const ROWS: usize = 65_536;

/// A file under way: rows gathered until they make a group.
pub(crate) struct RowGroups<T> {
    file: SerializedFileWriter<Vec<u8>>,
    rows: Vec<T>,
}

impl<T: Exported> RowGroups<T> {
    pub(crate) fn new() -> Result<Self, String> {
        let file = told(begin::<T>())?;
        Ok(Self { file, rows: Vec::new() })
    }

    pub(crate) fn add(&mut self, rows: Vec<T>) -> Result<Vec<u8>, String> {
        self.rows.extend(rows);
        if self.rows.len() < ROWS {
            return Ok(Vec::new());
        }
        told(self.group())?;
        self.written()
    }

    pub(crate) fn end(&mut self) -> Result<Vec<u8>, String> {
        if !self.rows.is_empty() {
            told(self.group())?;
        }
        told(self.file.finish())?;
        self.written()
    }

    /// What is ready to go.
    fn written(&mut self) -> Result<Vec<u8>, String> {
        self.file.flush().map_err(|error| error.to_string())?;
        Ok(std::mem::take(self.file.inner_mut()))
    }

    fn group(&mut self) -> Result<(), ParquetError> {
        let rows = std::mem::take(&mut self.rows);
        let mut group = self.file.next_row_group()?;
        for column in T::COLUMNS {
            let mut writer = group
                .next_column()?
                .ok_or_else(|| ParquetError::General(format!("no column {}", column.name)))?;
            write(&rows, column, &mut writer)?;
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }
}

fn told<R>(outcome: Result<R, ParquetError>) -> Result<R, String> {
    outcome.map_err(|error| error.to_string())
}

fn begin<T: Exported>() -> Result<SerializedFileWriter<Vec<u8>>, ParquetError> {
    let fields = T::COLUMNS.iter().map(|column| field(column).map(Arc::new)).collect::<Result<_, _>>()?;
    let schema = Type::group_type_builder("adit").with_fields(fields).build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by(format!("adit {}", env!("CARGO_PKG_VERSION")))
        .build();
    SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))
}

fn field<T>(column: &Column<T>) -> Result<Type, ParquetError> {
    let (physical, repetition, logical) = match column.cell {
        Cell::Time(_) => (Physical::INT64, Repetition::REQUIRED, Some(TIMESTAMP)),
        Cell::OptionalTime(_) => (Physical::INT64, Repetition::OPTIONAL, Some(TIMESTAMP)),
        Cell::Number(_) => (Physical::DOUBLE, Repetition::REQUIRED, None),
        Cell::Text(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String)),
        Cell::OptionalText(_) => (Physical::BYTE_ARRAY, Repetition::OPTIONAL, Some(LogicalType::String)),
        Cell::Texts(_) => (Physical::BYTE_ARRAY, Repetition::REPEATED, Some(LogicalType::String)),
        Cell::Json(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::Json)),
    };
    Type::primitive_type_builder(column.name, physical)
        .with_repetition(repetition)
        .with_logical_type(logical)
        .build()
}

const TIMESTAMP: LogicalType =
    LogicalType::Timestamp(TimestampType { is_adjusted_to_u_t_c: true, unit: TimeUnit::NANOS });

/// One column of a group. Definition levels: 1 where there is a value; repetition levels: 1 where it belongs to the row of the one before.
fn write<T>(
    rows: &[T],
    column: &Column<T>,
    writer: &mut SerializedColumnWriter<'_>,
) -> Result<(), ParquetError> {
    match &column.cell {
        Cell::Time(of) => {
            let values: Vec<i64> = rows.iter().map(|row| of(row).nanos()).collect();
            writer.typed::<Int64Type>().write_batch(&values, None, None)?;
        }
        Cell::OptionalTime(of) => {
            let values: Vec<i64> = rows.iter().filter_map(|row| of(row).map(Time::nanos)).collect();
            let levels: Vec<i16> = rows.iter().map(|row| i16::from(of(row).is_some())).collect();
            writer.typed::<Int64Type>().write_batch(&values, Some(&levels), None)?;
        }
        Cell::Number(of) => {
            let values: Vec<f64> = rows.iter().map(of).collect();
            writer.typed::<DoubleType>().write_batch(&values, None, None)?;
        }
        Cell::Text(of) => {
            let values: Vec<ByteArray> = rows.iter().map(|row| of(row).into()).collect();
            writer.typed::<ByteArrayType>().write_batch(&values, None, None)?;
        }
        Cell::OptionalText(of) => {
            let values: Vec<ByteArray> = rows.iter().filter_map(|row| of(row).map(Into::into)).collect();
            let levels: Vec<i16> = rows.iter().map(|row| i16::from(of(row).is_some())).collect();
            writer.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None)?;
        }
        Cell::Texts(of) => {
            let (mut values, mut there, mut same_row): (Vec<ByteArray>, Vec<i16>, Vec<i16>) =
                Default::default();
            for row in rows {
                let texts = of(row);
                if texts.is_empty() {
                    there.push(0);
                    same_row.push(0);
                }
                for (place, text) in texts.iter().enumerate() {
                    values.push(text.as_str().into());
                    there.push(1);
                    same_row.push(i16::from(place > 0));
                }
            }
            writer.typed::<ByteArrayType>().write_batch(&values, Some(&there), Some(&same_row))?;
        }
        Cell::Json(of) => {
            let values: Vec<ByteArray> =
                rows.iter().map(|row| of(row).to_string().into_bytes().into()).collect();
            writer.typed::<ByteArrayType>().write_batch(&values, None, None)?;
        }
    }
    Ok(())
}
