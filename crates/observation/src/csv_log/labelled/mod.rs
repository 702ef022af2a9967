//! Ranges of which somebody has told how the signal came: what a classifier of line of sight learns from and is judged on.
//!
//! ```text
//! geometry_id,label,true_range_m,range_m,first_path_index_tap,preamble_count,rx_power_dBm,first_path_power_dBm,…
//! 1,LOS,2.49243,2.69315,745.312,274,-78.9641,-81.7507,…
//! ```
//!
//! - One range to a row, no time. Which rows belong together, because anchor and tag stood where they stood: `geometry_id`, `tag_location_id`,
//!   `room_id` or `group_id`; without these, rows of the same `tag_height_m` and `true_range_m` (the static set of `uwb-outdoor`). Rows of one group are near
//!   copies of each other. `anchor_id` where there are several anchors.
//! - `label`: `LOS`, `NLOS` or `NDP` (no direct path); or `nlos`: 0 or 1.
//! - `range_m`, `true_range_m` and the columns of a reception (see `docs/formats.md`), each empty where the device did not tell;
//!   `pre_first_path_amplitude_std` is another name of `noise_std`.
//! - A folder has the table as `meta.csv` and the impulse responses as `cir_i16le.bin`, or the table alone as `ranges.csv`, all plain or `.gz`.
//!   Responses follow each other in the order of the rows, each [`TAPS`] taps from tap [`FIRST_TAP`] of the accumulator on: in-phase, then
//!   quadrature amplitude, 16 bits each, little endian (the layout of the set `uwb-cir`).
//! - A folder of `adit simulate` (`log.mcap`, `ranges_truth.csv`) is a set too: its group is the folder that holds it, as all people of a mine walk in the same.
//!
//! Memory: all rows; a response takes 800 bytes.

mod log;
mod responses;
mod rows;

use super::header::name;
use super::table::Table;
use crate::device::DeviceId;
use crate::error::{At, LogError, Place};
use crate::files::Input;
use crate::radio::{InTheWay, Reception};
use crate::warning::LogWarning;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Taps of a response in a folder.
pub const TAPS: usize = 200;
/// Index in the accumulator of the first of them.
pub const FIRST_TAP: u16 = 700;

/// How a signal came from anchor to tag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum LinkClass {
    /// Nothing in the way.
    Los,
    /// Something in the way that the direct path came through or round, or (in sets of two classes) anything.
    Nlos,
    /// The direct path was not received: what was taken for it is an echo.
    Ndp,
}

/// One range and the truth of it.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledRange {
    /// Index of its group in [`LabelledRanges::groups`].
    pub group: usize,
    /// What somebody has told.
    pub class: LinkClass,
    /// What stood in the way, where the set tells.
    pub in_the_way: Option<InTheWay>,
    /// When, where the set tells: a log does, a table does not.
    pub time: Option<Time>,
    /// The anchor, where the set tells.
    pub anchor: Option<DeviceId>,
    /// The range as measured, m.
    pub range_m: Option<f64>,
    /// The distance, m.
    pub true_range_m: Option<f64>,
    /// How the signal came in.
    pub reception: Reception,
}

/// A set of labelled ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledRanges {
    /// What was read: the folder or the table.
    pub path: PathBuf,
    /// The file that tells the classes.
    pub file: PathBuf,
    /// Names of the groups, in order of the first row of each.
    pub groups: Vec<String>,
    /// The ranges in order of the file.
    pub ranges: Vec<LabelledRange>,
    /// Whether the set tells [`LinkClass::Ndp`] from [`LinkClass::Nlos`].
    pub tells_ndp: bool,
    /// Whether it tells of every range what stood in the way.
    pub tells_in_the_way: bool,
    /// What was odd: ignored columns.
    pub warnings: Vec<LogWarning>,
}

impl LinkClass {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Los, Self::Nlos, Self::Ndp];

    /// As written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Los => "LOS",
            Self::Nlos => "NLOS",
            Self::Ndp => "NDP",
        }
    }

    /// From its name, in capitals or not.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.name().eq_ignore_ascii_case(name))
    }
}

/// Whether a table is one of labelled ranges: it tells a class, or line of sight, and no time.
pub fn is_labelled(path: impl AsRef<Path>) -> Result<bool, LogError> {
    let (_, header) = Table::new(Input::open(path)?, "a header such as geometry_id,label,range_m")?;
    let has = |wanted: fn(&str) -> bool| header.iter().any(|field| wanted(&name(field)));
    Ok(has(|name| matches!(name, "label" | "nlos")) && !has(|name| name.starts_with("time_")))
}

/// Reads a folder or a table.
pub fn read(path: impl AsRef<Path>) -> Result<LabelledRanges, LogError> {
    let path = path.as_ref();
    let mut set = if path.is_dir() { folder(path) } else { from_inputs(Input::open(path)?, None) }?;
    set.path = path.to_path_buf();
    Ok(set)
}

fn folder(path: &Path) -> Result<LabelledRanges, LogError> {
    if let (Some(log), Some(truth)) = (beside(path, "log.mcap"), beside(path, "ranges_truth.csv")) {
        return log::read(path, &log, &truth);
    }
    match (beside(path, "meta.csv"), beside(path, "cir_i16le.bin"), beside(path, "ranges.csv")) {
        (Some(table), Some(responses), _) => from_inputs(Input::open(table)?, Some(Input::open(responses)?)),
        (None, None, Some(table)) => from_inputs(Input::open(table)?, None),
        (table, responses, _) => Err(LogError::BadValue {
            place: Place::file(path),
            what: "folder of labelled ranges".to_owned(),
            found: match (table, responses) {
                (Some(_), None) => "meta.csv without cir_i16le.bin".to_owned(),
                (None, Some(_)) => "cir_i16le.bin without meta.csv".to_owned(),
                _ => "neither".to_owned(),
            },
            expected: "meta.csv and cir_i16le.bin, or ranges.csv (each plain or .gz), or log.mcap and ranges_truth.csv".to_owned(),
        }),
    }
}

/// Reads a table, and the responses of its rows where there are any.
pub fn from_inputs(table: Input, responses: Option<Input>) -> Result<LabelledRanges, LogError> {
    let mut set = rows::read(table)?;
    if let Some(responses) = responses {
        responses::read(responses, &mut set)?;
    }
    Ok(set)
}

/// The file of this name in a folder, plain or gzip.
fn beside(folder: &Path, name: &str) -> Option<PathBuf> {
    [name.to_owned(), format!("{name}.gz")].into_iter().map(|name| folder.join(name)).find(|p| p.is_file())
}

fn whole(file: &std::sync::Arc<Path>) -> Place {
    Place::new(file, At::File)
}

#[cfg(test)]
mod tests;
