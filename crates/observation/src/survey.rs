//! Radio surveys: what was heard at known spots, and where the transmitters are.
//!
//! ```text
//! x_m,y_m,floor,ap2_rtt_range_m,ap3_rtt_range_m,ap2_rssi_dBm,ap3_rssi_dBm
//! 0,0.6,1,3.148,10.791,-67,-72
//! 0.6,0.6,1,3.3,,-68,
//! ```
//!
//! - A row is one scan at one spot: east and north, m, in the mine's grid or any local level frame; `floor` a whole number, 0 where there is none.
//! - `NAME_rssi_dBm`: signal strength of transmitter NAME; `NAME_rtt_range_m` or `NAME_range_m`: range to it. An empty field is not heard.
//!   Columns in any order; others are ignored with a warning.
//!
//! ```text
//! ap,x_m,y_m,z_m,floor,id_2g4,id_5g
//! 1,48.152,18.698,,1,mac1,mac2
//! ```
//!
//! - The list of transmitters: a column of names (`ap`, `access_point`, `beacon`, `receiver`, `anchor_id`, `anchor`, `transmitter` or `id`), east, north,
//!   height (0 where not told) and floor. Columns `id_…` are further names of the same place, one to a radio.
//!
//! Memory: all rows.

use crate::csv_log::table::Table;
use crate::csv_log::{missing, name};
use crate::device::DeviceId;
use crate::error::{At, LogError, Place, shown};
use crate::files::Input;
use crate::warning::{LogWarning, Warnings};
use std::path::Path;

/// Scans at known spots.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    /// Every transmitter that has a column, in order of the first.
    pub transmitters: Vec<DeviceId>,
    /// The scans in order of the file.
    pub scans: Vec<Scan>,
    /// What was odd: ignored columns.
    pub warnings: Vec<LogWarning>,
}

/// One scan at one spot.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// East, north of the spot, m.
    pub position_m: [f64; 2],
    /// Floor; 0 where the file has none.
    pub floor: i32,
    /// Signal strength of each transmitter, dBm, in the order of [`Survey::transmitters`].
    pub rssi_dbm: Vec<Option<f64>>,
    /// Range to each of them, m.
    pub range_m: Vec<Option<f64>>,
}

/// Where a transmitter is.
#[derive(Debug, Clone, PartialEq)]
pub struct TransmitterPlace {
    /// Its name, as in logs and surveys.
    pub id: DeviceId,
    /// East, north, height, m.
    pub position_m: [f64; 3],
    /// Its floor, where the file tells.
    pub floor: Option<i32>,
}

/// What a survey must have besides its spots.
const READING: &str = "<transmitter>_rssi_dBm or <transmitter>_range_m";
const STRENGTH_ENDS: [&str; 2] = ["_rssi_dBm", "_rssi_dbm"];
const RANGE_ENDS: [&str; 2] = ["_rtt_range_m", "_range_m"];
const NAMES: [&str; 8] =
    ["ap", "access_point", "beacon", "receiver", "anchor_id", "anchor", "transmitter", "id"];
/// Floors beyond are a mistake.
const FARTHEST_FLOOR: f64 = 1000.0;
/// As in logs.
const STRENGTHS_DBM: std::ops::RangeInclusive<f64> = -200.0..=50.0;
const RANGES_M: std::ops::RangeInclusive<f64> = -1e3..=1e6;
/// A spot farther from the origin is a mistake, m.
const FARTHEST_M: f64 = 1e7;

/// Whether a file begins like a survey: its header has spots and a reading of a transmitter, and no time.
pub fn is_survey(path: &Path) -> Result<bool, LogError> {
    let (_, header) = Table::new(Input::open(path)?, "a header such as x_m,y_m,ap1_rssi_dBm")?;
    let names: Vec<String> = header.iter().map(name).collect();
    let timed = names.iter().any(|n| n.starts_with("time"));
    Ok(!timed && names.iter().any(|n| reading(n).is_some()))
}

/// Reads a survey.
pub fn read(path: impl AsRef<Path>) -> Result<Survey, LogError> {
    from_input(Input::open(path)?)
}

/// Reads a survey from any input.
pub fn from_input(input: Input) -> Result<Survey, LogError> {
    let mut warnings = Warnings::default();
    let (mut table, header) = Table::new(input, "a header such as x_m,y_m,ap1_rssi_dBm")?;
    let names: Vec<String> = header.iter().map(name).collect();
    let place = table.place();
    let [east, north] = columns(["x_m", "y_m"], &names, &place)?;
    let floor = column("floor", &names);
    let mut transmitters: Vec<DeviceId> = Vec::new();
    // Of each column with a reading: its index, its transmitter, whether it is a strength.
    let mut readings: Vec<(usize, usize, bool)> = Vec::new();
    let mut ignored = Vec::new();
    for (index, column) in names.iter().enumerate() {
        let Some((device, strength)) = reading(column) else {
            if ![Some(east), Some(north), floor].contains(&Some(index)) {
                ignored.push(column.clone());
            }
            continue;
        };
        let id = device_id(device, column, &place)?;
        let transmitter = transmitters.iter().position(|known| *known == id).unwrap_or_else(|| {
            transmitters.push(id);
            transmitters.len() - 1
        });
        let twice = readings.iter().find(|(_, other, kind)| (*other, *kind) == (transmitter, strength));
        if let Some((first, ..)) = twice {
            return Err(LogError::DuplicateColumn {
                place,
                first: names[*first].clone(),
                second: column.clone(),
            });
        }
        readings.push((index, transmitter, strength));
    }
    if readings.is_empty() {
        return Err(missing(vec![READING.to_owned()], &names, &place));
    }
    if !ignored.is_empty() {
        warnings.push(LogWarning::IgnoredColumns { place, columns: ignored });
    }
    let mut scans = Vec::new();
    while table.next()? {
        let position_m = [coordinate(&table, east, &names)?, coordinate(&table, north, &names)?];
        let floor =
            floor.map_or(Ok(0), |index| whole(&table, index, &names).map(Option::unwrap_or_default))?;
        let mut scan = Scan {
            position_m,
            floor,
            rssi_dbm: vec![None; transmitters.len()],
            range_m: vec![None; transmitters.len()],
        };
        for (index, transmitter, strength) in &readings {
            if table.field(*index).is_empty() {
                continue;
            }
            let (values, limits) =
                if *strength { (&mut scan.rssi_dbm, STRENGTHS_DBM) } else { (&mut scan.range_m, RANGES_M) };
            values[*transmitter] = Some(within(&table, *index, &names, &limits)?);
        }
        scans.push(scan);
    }
    if scans.is_empty() {
        let place = Place::new(table.file(), At::File);
        return Err(LogError::NothingRecorded { place, expected: "row of the survey" });
    }
    Ok(Survey { transmitters, scans, warnings: warnings.list().to_vec() })
}

/// Reads a list of transmitters.
pub fn read_transmitters(path: impl AsRef<Path>) -> Result<Vec<TransmitterPlace>, LogError> {
    transmitters_from_input(Input::open(path)?)
}

/// Reads a list of transmitters from any input.
pub fn transmitters_from_input(input: Input) -> Result<Vec<TransmitterPlace>, LogError> {
    let (mut table, header) = Table::new(input, "a header such as ap,x_m,y_m,z_m")?;
    let names: Vec<String> = header.iter().map(name).collect();
    let place = table.place();
    let [east, north] = columns(["x_m", "y_m"], &names, &place)?;
    let own = names.iter().position(|n| NAMES.contains(&n.as_str()));
    let own = own.ok_or_else(|| missing(vec!["ap".to_owned()], &names, &place))?;
    let further = names.iter().enumerate().filter(|(_, n)| n.starts_with("id_")).map(|(index, _)| index);
    let named_by: Vec<usize> = [own].into_iter().chain(further).collect();
    let (height, floor) = (column("z_m", &names), column("floor", &names));
    let mut list: Vec<TransmitterPlace> = Vec::new();
    while table.next()? {
        let up = match height.filter(|index| !table.field(*index).is_empty()) {
            Some(index) => coordinate(&table, index, &names)?,
            None => 0.0,
        };
        let position_m = [coordinate(&table, east, &names)?, coordinate(&table, north, &names)?, up];
        let floor = floor.map_or(Ok(None), |index| whole(&table, index, &names))?;
        for index in named_by.iter().filter(|index| !table.field(**index).is_empty()) {
            let id = device_id(&name(table.field(*index)), &names[*index], &table.place())?;
            if list.iter().any(|known| known.id == id) {
                return Err(LogError::BadValue {
                    place: table.place(),
                    what: names[*index].clone(),
                    found: id.to_string(),
                    expected: "a name that no other line has".to_owned(),
                });
            }
            list.push(TransmitterPlace { id, position_m, floor });
        }
    }
    if list.is_empty() {
        let place = Place::new(table.file(), At::File);
        return Err(LogError::NothingRecorded { place, expected: "transmitter" });
    }
    Ok(list)
}

/// The transmitter of a column of readings, and whether they are strengths.
fn reading(column: &str) -> Option<(&str, bool)> {
    let strength = STRENGTH_ENDS.iter().find_map(|end| column.strip_suffix(end));
    let range = || RANGE_ENDS.iter().find_map(|end| column.strip_suffix(end));
    strength.map(|device| (device, true)).or_else(|| range().map(|device| (device, false)))
}

fn device_id(text: &str, column: &str, place: &Place) -> Result<DeviceId, LogError> {
    DeviceId::new(text).ok_or_else(|| LogError::BadValue {
        place: place.clone(),
        what: column.to_owned(),
        found: format!("\"{}\"", shown(text.as_bytes())),
        expected: format!("a name of 1 to {} bytes", DeviceId::LONGEST),
    })
}

fn column(wanted: &str, names: &[String]) -> Option<usize> {
    names.iter().position(|name| name == wanted)
}

fn columns<const N: usize>(
    wanted: [&str; N],
    names: &[String],
    place: &Place,
) -> Result<[usize; N], LogError> {
    let absent: Vec<String> =
        wanted.iter().filter(|name| column(name, names).is_none()).map(|name| (*name).to_owned()).collect();
    if absent.is_empty() {
        Ok(wanted.map(|name| column(name, names).unwrap_or_default()))
    } else {
        Err(missing(absent, names, place))
    }
}

fn coordinate(table: &Table, index: usize, names: &[String]) -> Result<f64, LogError> {
    within(table, index, names, &(-FARTHEST_M..=FARTHEST_M))
}

fn within(
    table: &Table,
    index: usize,
    names: &[String],
    limits: &std::ops::RangeInclusive<f64>,
) -> Result<f64, LogError> {
    let value = table.number(index, names)?;
    if limits.contains(&value) {
        return Ok(value);
    }
    Err(LogError::BadValue {
        place: table.place(),
        what: names[index].clone(),
        found: value.to_string(),
        expected: format!("{} to {}", limits.start(), limits.end()),
    })
}

/// A whole number; `None` of an empty field.
fn whole(table: &Table, index: usize, names: &[String]) -> Result<Option<i32>, LogError> {
    if table.field(index).is_empty() {
        return Ok(None);
    }
    let value = within(table, index, names, &(-FARTHEST_FLOOR..=FARTHEST_FLOOR))?;
    #[expect(clippy::cast_possible_truncation, reason = "whole and within ±1000")]
    if value.fract() == 0.0 {
        return Ok(Some(value as i32));
    }
    Err(LogError::BadValue {
        place: table.place(),
        what: names[index].clone(),
        found: value.to_string(),
        expected: "a whole number".to_owned(),
    })
}
