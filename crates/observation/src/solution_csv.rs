//! Solutions with covariance as CSV: what a method answered and how sure it was.
//!
//! | columns | what |
//! |---|---|
//! | `time_s` | time of validity |
//! | `x_m,y_m,z_m` | position east, north, up |
//! | `vx_m_s,vy_m_s,vz_m_s` | velocity east, north, up |
//! | `qw,qx,qy,qz` | attitude, scalar first, body to navigation frame |
//! | `quality` | `fixed`, `dead-reckoning` or `lost` |
//! | `cov_x_x_m2` … `cov_rz_rz_rad2` | upper triangle, row by row, of the covariance of position (`x y z`), velocity (`vx vy vz`) and attitude error (rotation vector in the navigation frame, `rx ry rz`) |
//! | `radius_95_m,protection_level_m` | level circles about the position: with 95 % probability, and with all but the integrity risk of 0.1 % |
//!
//! All columns but the last two are needed, in any order; others are ignored. Numbers are written as the shortest decimal that reads back the same.

use crate::csv_log::table::Table;
use crate::csv_log::{missing, name};
use crate::error::{LogError, shown};
use crate::files::decimal::ShortSeconds;
use crate::files::{AtomicFile, Input};
use crate::tum::attitude_from;
use adit_core::nalgebra::{Quaternion, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use std::io::{self, Write};
use std::path::Path;

const FIRST: [&str; 12] =
    ["time_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "qw", "qx", "qy", "qz", "quality"];
const STATES: [&str; 9] = ["x", "y", "z", "vx", "vy", "vz", "rx", "ry", "rz"];
/// Unit of the covariance of two of position, velocity, attitude, by `state / 3`.
const UNITS: [[&str; 3]; 3] =
    [["m2", "m2_s", "m_rad"], ["m2_s", "m2_s2", "m_rad_s"], ["m_rad", "m_rad_s", "rad2"]];
const QUALITIES: [(Quality, &str); 3] =
    [(Quality::Fixed, "fixed"), (Quality::DeadReckoning, "dead-reckoning"), (Quality::Lost, "lost")];

/// Rows and columns of the upper triangle, in the order of the file.
fn upper_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..STATES.len()).flat_map(|row| (row..STATES.len()).map(move |column| (row, column)))
}

fn column_names() -> Vec<String> {
    let covariance =
        upper_triangle().map(|(r, c)| format!("cov_{}_{}_{}", STATES[r], STATES[c], UNITS[r / 3][c / 3]));
    FIRST.iter().map(|name| (*name).to_owned()).chain(covariance).collect()
}

/// Writes solutions one by one; the file appears at [`SolutionWriter::finish`], and not at all when dropped before.
pub struct SolutionWriter {
    file: AtomicFile,
    latest: Option<Time>,
}

impl SolutionWriter {
    /// Starts a file; `.gz` at the end of the name compresses it.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, LogError> {
        let mut file = AtomicFile::create(path)?;
        writeln!(file, "{},{}", column_names().join(","), CIRCLES.join(",")).map_err(|e| file.error(e))?;
        Ok(Self { file, latest: None })
    }

    /// Writes one solution; its time must come after the one before and its numbers must be finite.
    pub fn push(&mut self, solution: &Solution) -> Result<(), LogError> {
        let time = solution.time;
        let refuse = |what| Err(LogError::CannotWrite { file: self.file.target().to_path_buf(), what });
        if let Some(before) = self.latest
            && time <= before
        {
            return refuse(format!("a solution at {time} s after one at {before} s"));
        }
        if !numbers(solution).all(f64::is_finite) {
            return refuse(format!("the solution at {time} s has a component that is not a finite number"));
        }
        self.latest = Some(time);
        write_row(&mut self.file, solution).map_err(|e| self.file.error(e))
    }

    /// Completes the file and gives it its name.
    pub fn finish(self) -> Result<(), LogError> {
        self.file.finish()
    }
}

/// What follows from the covariance: written for readers, not read.
const CIRCLES: [&str; 2] = ["radius_95_m", "protection_level_m"];

/// Number of columns of numbers before the quality: position, velocity, quaternion.
const STATE_NUMBERS: usize = 10;

fn numbers(solution: &Solution) -> impl Iterator<Item = f64> {
    let Solution { position_m: p, velocity_m_s: v, attitude: q, covariance, .. } = solution;
    let state = [p.x, p.y, p.z, v.x, v.y, v.z, q.w, q.i, q.j, q.k];
    state.into_iter().chain(upper_triangle().map(|place| covariance[place]))
}

fn write_row(file: &mut AtomicFile, solution: &Solution) -> io::Result<()> {
    let quality = QUALITIES.iter().find(|(q, _)| *q == solution.quality).map_or("", |(_, text)| text);
    write!(file, "{}", ShortSeconds(solution.time))?;
    for (index, value) in numbers(solution).enumerate() {
        if index == STATE_NUMBERS {
            write!(file, ",{quality}")?;
        }
        write!(file, ",{value}")?;
    }
    writeln!(file, ",{},{}", solution.radius_95_m(), solution.protection_level_m())
}

/// Solutions of a file one by one, in order of time. After an error the iterator ends.
pub struct SolutionReader {
    table: Table,
    names: Vec<String>,
    /// Where each of [`column_names`] stands.
    indices: Vec<usize>,
    latest: Option<Time>,
    ended: bool,
}

impl SolutionReader {
    /// Opens a file.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, LogError> {
        Self::new(Input::open(path)?)
    }

    /// Reads from any input.
    pub fn new(input: Input) -> Result<Self, LogError> {
        let (table, header) = Table::new(input, "a header such as time_s,x_m,y_m,z_m,…")?;
        let names: Vec<String> = header.iter().map(name).collect();
        let mut indices = Vec::new();
        let mut absent = Vec::new();
        for wanted in column_names() {
            match names.iter().position(|n| *n == wanted) {
                Some(index) => indices.push(index),
                None => absent.push(wanted),
            }
        }
        if absent.is_empty() {
            return Ok(Self { table, names, indices, latest: None, ended: false });
        }
        Err(missing(absent, &names, &table.place()))
    }

    fn next_solution(&mut self) -> Result<Option<Solution>, LogError> {
        if !self.table.next()? {
            return Ok(None);
        }
        let number = |column: usize| self.table.number(self.indices[column], &self.names);
        let vector = |from: usize| Ok(Vector3::new(number(from)?, number(from + 1)?, number(from + 2)?));
        let time = self.table.time(self.indices[0], 9, &self.names)?;
        if let Some(before) = self.latest
            && time <= before
        {
            return Err(LogError::TimeBackwards { place: self.table.place(), found: time, before });
        }
        let (position_m, velocity_m_s) = (vector(1)?, vector(4)?);
        let q = Quaternion::new(number(7)?, number(8)?, number(9)?, number(10)?);
        let attitude = attitude_from(q, || self.table.place())?;
        let quality = self.quality()?;
        let mut covariance = SolutionCovariance::zeros();
        for (column, (r, c)) in (FIRST.len()..).zip(upper_triangle()) {
            let value = number(column)?;
            if r == c && value < 0.0 {
                return Err(LogError::BadValue {
                    place: self.table.place(),
                    what: self.names[self.indices[column]].clone(),
                    found: value.to_string(),
                    expected: "a variance of zero or more".to_owned(),
                });
            }
            covariance[(r, c)] = value;
            covariance[(c, r)] = value;
        }
        Ok(Some(Solution { time, position_m, velocity_m_s, attitude, covariance, quality }))
    }

    fn quality(&self) -> Result<Quality, LogError> {
        let field = self.table.field(self.indices[FIRST.len() - 1]);
        QUALITIES.iter().find(|(_, text)| text.as_bytes() == field).map(|(quality, _)| *quality).ok_or_else(
            || LogError::BadValue {
                place: self.table.place(),
                what: "quality".to_owned(),
                found: format!("\"{}\"", shown(field)),
                expected: QUALITIES.map(|(_, text)| text).join(", "),
            },
        )
    }
}

impl Iterator for SolutionReader {
    type Item = Result<Solution, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.next_solution();
        match &next {
            Ok(Some(solution)) => self.latest = Some(solution.time),
            Ok(None) | Err(_) => self.ended = true,
        }
        next.transpose()
    }
}
