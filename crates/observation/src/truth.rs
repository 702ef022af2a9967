//! Truth of a recorded or simulated walk: CSV (`NAME_truth.csv`, gzip or not) or TUM text, told by content.
//!
//! ```text
//! time_s,x_m,y_m,z_m,qw,qx,qy,qz
//! 0.000449,0.5684,0.5721,1.5619,0.95621,0.01986,0.278,-0.08932
//! ```
//!
//! - Position in a z-up frame, m; quaternion Hamilton, scalar **first** (TUM has it last), body to that frame.
//! - Position or quaternion may be missing as a whole ([`Truth::has_position`], [`Truth::has_attitude`]), so may the height
//!   ([`Truth::has_height`]); then it is zero or the identity in the trajectory. Time units as in [`crate::csv_log`].
//! - `moving` (0 or 1) marks the rows by which a method is judged. Other columns are ignored with a warning.
//! - A row with an empty field among these is skipped and counted: the cameras lost the walker there. A row that
//!   repeats the time before it is dropped and counted; time that runs backwards is an error.

use crate::csv_log::table::Table;
use crate::csv_log::units::TIME_UNITS;
use crate::csv_log::{missing, name};
use crate::error::{At, LogError, Place, shown};
use crate::files::Input;
use crate::tum::{TumReader, attitude_from};
use crate::warning::{LogWarning, Warnings};
use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Quaternion, Vector3};
use adit_core::trajectory::{Pose, Trajectory};
use csv::ByteRecord;
use std::path::Path;
use std::sync::Arc;

const POSITION: [&str; 3] = ["x_m", "y_m", "z_m"];
const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];
const MOVING: &str = "moving";

/// The truth of one walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Poses in order of time.
    pub trajectory: Trajectory,
    /// Whether positions are known; else they are zero.
    pub has_position: bool,
    /// Whether heights are known; else they are zero.
    pub has_height: bool,
    /// Whether attitudes are known; else they are the identity.
    pub has_attitude: bool,
    /// Per pose, whether methods are judged there; `None` when the file does not say.
    pub moving: Option<Vec<bool>>,
    /// What was odd: skipped and repeated rows, ignored columns.
    pub warnings: Vec<LogWarning>,
}

/// Reads a truth file, CSV or TUM.
pub fn read(path: impl AsRef<Path>) -> Result<Truth, LogError> {
    from_input(Input::open(path)?)
}

/// Reads truth from any input.
pub fn from_input(input: Input) -> Result<Truth, LogError> {
    let text = input.start.trim_ascii_start();
    let heading = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text).trim_ascii_start();
    // A header starts with a name, TUM text with a comment or a number.
    if heading.first().is_some_and(|b| b.is_ascii_alphabetic() || *b == b'"') {
        return read_csv(input);
    }
    let file = Arc::clone(&input.file);
    let trajectory = crate::tum::collect(TumReader::new(input), &file)?;
    let warnings = Vec::new();
    Ok(Truth { trajectory, has_position: true, has_height: true, has_attitude: true, moving: None, warnings })
}

struct Columns {
    names: Vec<String>,
    time: (usize, i32),
    position: Option<[Option<usize>; 3]>,
    quaternion: Option<[usize; 4]>,
    moving: Option<usize>,
}

fn read_csv(input: Input) -> Result<Truth, LogError> {
    let mut warnings = Warnings::default();
    let (mut table, header) = Table::new(input, "a header such as time_s,x_m,y_m,z_m")?;
    let columns = columns(&header, &table.place(), &mut warnings)?;
    let mut poses: Vec<Pose> = Vec::new();
    let mut moving = Vec::new();
    while table.next()? {
        let time = table.time(columns.time.0, columns.time.1, &columns.names)?;
        let Some((position_m, attitude)) = pose(&table, &columns)? else {
            warnings.skipped(table.file(), table.at());
            continue;
        };
        let marked = columns.moving.map(|index| flag(&table, index)).transpose()?;
        if let Some(before) = poses.last().map(|p| p.time) {
            if time < before {
                return Err(LogError::TimeBackwards { place: table.place(), found: time, before });
            }
            if time == before {
                warnings.repeated(table.file(), table.at());
                continue;
            }
        }
        poses.push(Pose { time, position_m, attitude });
        moving.extend(marked);
    }
    let place = Place::new(table.file(), At::File);
    if poses.is_empty() {
        return Err(LogError::NothingRecorded { place, expected: "row without an empty field" });
    }
    Ok(Truth {
        trajectory: crate::tum::trajectory(poses, place)?,
        has_position: columns.position.is_some(),
        has_height: columns.position.is_some_and(|p| p[2].is_some()),
        has_attitude: columns.quaternion.is_some(),
        moving: columns.moving.map(|_| moving),
        warnings: warnings.list().to_vec(),
    })
}

fn columns(header: &ByteRecord, place: &Place, warnings: &mut Warnings) -> Result<Columns, LogError> {
    let names: Vec<String> = header.iter().map(name).collect();
    let index = |wanted: &str| names.iter().position(|n| n == wanted);
    let time = TIME_UNITS
        .iter()
        .find_map(|(unit, exponent)| index(&format!("time_{unit}")).map(|i| (i, *exponent)))
        .ok_or_else(|| missing(vec!["time_s".to_owned()], &names, place))?;
    for (column, expected) in
        names.iter().filter_map(|n| POSITION.iter().find(|p| n.get(..2) == p.get(..2)).map(|p| (n, p)))
    {
        if column != expected {
            let (place, column) = (place.clone(), column.clone());
            return Err(LogError::UnknownUnit { place, column, expected: (*expected).to_owned() });
        }
    }
    let axes = POSITION.map(index);
    let quaternion = QUATERNION.map(index);
    let absent = |wanted: &[&str], found: &[Option<usize>]| {
        let absent = wanted.iter().zip(found).filter(|(_, i)| i.is_none());
        missing(absent.map(|(n, _)| (*n).to_owned()).collect(), &names, place)
    };
    let position = match axes {
        [Some(_), Some(_), _] => Some(axes),
        [None, None, None] => None,
        _ => return Err(absent(&POSITION, &axes)),
    };
    let quaternion = match quaternion {
        [Some(w), Some(x), Some(y), Some(z)] => Some([w, x, y, z]),
        [None, None, None, None] => None,
        _ => return Err(absent(&QUATERNION, &quaternion)),
    };
    if position.is_none() && quaternion.is_none() {
        return Err(absent(&POSITION, &axes));
    }
    let moving = index(MOVING);
    let used = |i: &usize| {
        *i == time.0
            || moving == Some(*i)
            || axes.contains(&Some(*i))
            || quaternion.is_some_and(|q| q.contains(i))
    };
    let ignored: Vec<String> = (0..names.len()).filter(|i| !used(i)).map(|i| names[i].clone()).collect();
    if !ignored.is_empty() {
        warnings.push(LogWarning::IgnoredColumns { place: place.clone(), columns: ignored });
    }
    Ok(Columns { names, time, position, quaternion, moving })
}

/// Position and attitude of a row; `None` when a field is empty.
fn pose(table: &Table, columns: &Columns) -> Result<Option<(Vector3<f64>, Attitude)>, LogError> {
    let axes = columns.position.unwrap_or_default();
    let quaternion = columns.quaternion.as_ref();
    let mut needed = axes.iter().flatten().chain(quaternion.into_iter().flatten());
    if needed.any(|index| table.field(*index).is_empty()) {
        return Ok(None);
    }
    let number = |index: usize| table.number(index, &columns.names);
    let mut position_m = Vector3::zeros();
    for (value, index) in position_m.iter_mut().zip(axes) {
        *value = index.map_or(Ok(0.0), number)?;
    }
    let attitude = match quaternion {
        None => Attitude::identity(),
        Some([w, x, y, z]) => {
            let q = Quaternion::new(number(*w)?, number(*x)?, number(*y)?, number(*z)?);
            attitude_from(q, || table.place())?
        }
    };
    Ok(Some((position_m, attitude)))
}

fn flag(table: &Table, index: usize) -> Result<bool, LogError> {
    match table.field(index) {
        b"0" => Ok(false),
        b"1" => Ok(true),
        other => Err(LogError::BadValue {
            place: table.place(),
            what: MOVING.to_owned(),
            found: format!("\"{}\"", shown(other)),
            expected: "0 or 1".to_owned(),
        }),
    }
}
