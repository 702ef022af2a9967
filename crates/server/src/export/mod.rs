//! Tracks, events and alarms as files for other programs: CSV, `GeoJSON`, Parquet.
//!
//! An [`Export`] hands out bytes page by page, to a file or to whoever waits at the other end of a connection; no more than one page of the
//! store is held. Every format has the same columns (`columns`); units stand in their names.
//!
//! - CSV: times twice, in seconds since the Unix epoch as in every log of adit (`time_s`, exact) and as text (`time_utc`, RFC 3339 with ms).
//! - `GeoJSON` (RFC 7946): one feature to a fix, event or alarm; longitude, latitude (WGS-84, degrees) and height where the mine's grid is tied to the Earth, else
//!   coordinates of the grid, which the member `adit_coordinates` tells; no geometry where no place is known.
//! - Parquet: zstd, row groups of some 65,000 rows, times as UTC timestamps in ns.

mod columns;
mod csv;
mod geojson;
mod pages;
mod parquet;

pub use pages::{Exported, TracksQuery};

use crate::ServerError;
use crate::store::{AlarmRecord, EventRecord, FixRecord, LogQuery, Store};
use adit_mine::Georeference;
use pages::FixPages;
use std::io::Write as _;
use std::path::Path;

/// What kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Text, a row to a line.
    Csv,
    /// Features for maps.
    GeoJson,
    /// Compressed columns.
    Parquet,
}

impl Format {
    /// By its name: `csv`, `geojson` or `parquet`.
    pub fn named(name: &str) -> Option<Self> {
        [Self::Csv, Self::GeoJson, Self::Parquet].into_iter().find(|format| format.name() == name)
    }

    /// Its name, which is also how its files end.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::GeoJson => "geojson",
            Self::Parquet => "parquet",
        }
    }

    /// What a server says of it.
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Csv => "text/csv; charset=utf-8",
            Self::GeoJson => "application/geo+json",
            Self::Parquet => "application/vnd.apache.parquet",
        }
    }
}

/// One of the formats, under way.
enum Sheet<T> {
    Csv,
    GeoJson(geojson::Collection),
    Parquet(Box<parquet::RowGroups<T>>),
}

impl<T: Exported> Sheet<T> {
    /// What comes before the first row.
    fn begin(&mut self) -> Result<Vec<u8>, String> {
        match self {
            Self::Csv => csv::head::<T>(),
            Self::GeoJson(collection) => Ok(collection.begin()),
            Self::Parquet(_) => Ok(Vec::new()),
        }
    }

    fn add(&mut self, rows: Vec<T>) -> Result<Vec<u8>, String> {
        match self {
            Self::Csv => csv::rows(&rows),
            Self::GeoJson(collection) => collection.add(&rows),
            Self::Parquet(groups) => groups.add(rows),
        }
    }

    /// What comes after the last row.
    fn end(&mut self) -> Result<Vec<u8>, String> {
        match self {
            Self::Csv => Ok(Vec::new()),
            Self::GeoJson(_) => Ok(geojson::Collection::end()),
            Self::Parquet(groups) => groups.end(),
        }
    }
}

/// Where an export is.
enum Stage<T: Exported> {
    Beginning(Sheet<T>, T::Query),
    Within(Sheet<T>, T::Query),
    Ending(Sheet<T>),
    Done,
}

/// A file in the making.
pub struct Export<T: Exported> {
    store: Store,
    stage: Stage<T>,
}

impl Export<FixRecord> {
    /// Fixes: tag by tag (of a person: all in one), in order of time. `georeference`: that of the mine, for `GeoJSON`.
    pub fn tracks(
        store: Store,
        query: TracksQuery,
        format: Format,
        georeference: Option<Georeference>,
    ) -> Result<Self, ServerError> {
        Self::new(store, FixPages::new(query), format, georeference)
    }
}

impl Export<EventRecord> {
    /// Events; [`LogQuery::limit`] is the size of a page, not of the file.
    pub fn events(
        store: Store,
        query: LogQuery,
        format: Format,
        georeference: Option<Georeference>,
    ) -> Result<Self, ServerError> {
        Self::new(store, query, format, georeference)
    }
}

impl Export<AlarmRecord> {
    /// Alarms; [`LogQuery::limit`] is the size of a page, not of the file.
    pub fn alarms(
        store: Store,
        query: LogQuery,
        format: Format,
        georeference: Option<Georeference>,
    ) -> Result<Self, ServerError> {
        Self::new(store, query, format, georeference)
    }
}

impl<T: Exported> Export<T> {
    fn new(
        store: Store,
        query: T::Query,
        format: Format,
        georeference: Option<Georeference>,
    ) -> Result<Self, ServerError> {
        let sheet = match format {
            Format::Csv => Sheet::Csv,
            Format::GeoJson => Sheet::GeoJson(geojson::Collection::new(georeference)),
            Format::Parquet => {
                Sheet::Parquet(Box::new(parquet::RowGroups::new().map_err(ServerError::Export)?))
            }
        };
        Ok(Self { store, stage: Stage::Beginning(sheet, query) })
    }

    /// The next bytes; `None` at the end. After an error there is nothing more.
    pub async fn next(&mut self) -> Result<Option<Vec<u8>>, ServerError> {
        loop {
            let (stage, bytes) = match std::mem::replace(&mut self.stage, Stage::Done) {
                Stage::Beginning(mut sheet, query) => {
                    let bytes = sheet.begin().map_err(ServerError::Export)?;
                    (Stage::Within(sheet, query), bytes)
                }
                Stage::Within(mut sheet, query) => {
                    let (rows, next) = T::page(&self.store, query).await?;
                    let (sheet, bytes) =
                        off_thread(move || sheet.add(rows).map(|bytes| (sheet, bytes))).await?;
                    let stage = match next {
                        Some(next) => Stage::Within(sheet, next),
                        None => Stage::Ending(sheet),
                    };
                    (stage, bytes)
                }
                Stage::Ending(mut sheet) => {
                    let bytes = off_thread(move || sheet.end()).await?;
                    (Stage::Done, bytes)
                }
                Stage::Done => return Ok(None),
            };
            self.stage = stage;
            if !bytes.is_empty() {
                return Ok(Some(bytes));
            }
        }
    }

    /// All of it into a file, which appears whole or not at all; its size in bytes.
    pub async fn write_file(mut self, path: &Path) -> Result<u64, ServerError> {
        let io = |source: std::io::Error| ServerError::Io { path: path.to_path_buf(), source };
        let folder =
            path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        let mut file = tempfile::Builder::new().prefix(".adit-export-").tempfile_in(folder).map_err(io)?;
        let mut size = 0;
        while let Some(bytes) = self.next().await? {
            size += bytes.len() as u64;
            file.write_all(&bytes).map_err(io)?;
        }
        file.as_file().sync_all().map_err(io)?;
        file.persist(path).map_err(|error| io(error.error))?;
        Ok(size)
    }
}

/// Formatting a page takes some 100 ms: not on the threads that answer others.
async fn off_thread<R: Send + 'static>(
    work: impl FnOnce() -> Result<R, String> + Send + 'static,
) -> Result<R, ServerError> {
    match tokio::task::spawn_blocking(work).await {
        Ok(outcome) => outcome.map_err(ServerError::Export),
        Err(stopped) => Err(ServerError::Export(stopped.to_string())),
    }
}
