use crate::error::{At, LogError, Place, shown};
use crate::files::decimal::{parse_number, parse_time};
use crate::files::{Input, LineLimit, read_error};
use adit_core::attitude::Attitude;
use adit_core::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::sync::Arc;

const FIELDS: [&str; 8] = ["t", "x", "y", "z", "qx", "qy", "qz", "qw"];
/// How far the length of a quaternion in a file may be from 1: files carry as little as two decimals.
const LENGTH_TOLERANCE: f64 = 0.05;
/// A squared length as near to 1 as this is left alone: normalising would only stir the last bits.
const UNIT_TO_THE_LAST_BITS: f64 = 8.0 * f64::EPSILON;

/// Reads a whole TUM file.
pub fn read(path: impl AsRef<Path>) -> Result<Trajectory, LogError> {
    let reader = TumReader::new(Input::open(path)?);
    let file = Arc::clone(&reader.file);
    collect(reader, &file)
}

/// All poses of a reader; at least one.
pub(crate) fn collect(reader: TumReader, file: &Arc<Path>) -> Result<Trajectory, LogError> {
    let poses = reader.collect::<Result<Vec<_>, _>>()?;
    let place = Place::new(file, At::File);
    if poses.is_empty() {
        return Err(LogError::NothingRecorded { place, expected: "pose" });
    }
    trajectory(poses, place)
}

/// Poses whose order and finiteness were checked line by line.
pub(crate) fn trajectory(poses: Vec<Pose>, place: Place) -> Result<Trajectory, LogError> {
    Trajectory::new(poses).map_err(|error| LogError::BadValue {
        place,
        what: "trajectory".to_owned(),
        found: error.to_string(),
        expected: "finite poses in order of time".to_owned(),
    })
}

/// Poses of a TUM file one by one, in bounded memory. After an error the iterator ends.
pub struct TumReader {
    reader: BufReader<LineLimit>,
    file: Arc<Path>,
    gzip: bool,
    text: Vec<u8>,
    line: u64,
    latest: Option<Time>,
    ended: bool,
}

impl TumReader {
    /// Reads poses from any input.
    pub fn new(input: Input) -> Self {
        let Input { file, reader, gzip, .. } = input;
        Self {
            reader: BufReader::with_capacity(1 << 16, LineLimit::new(reader)),
            file,
            gzip,
            text: Vec::new(),
            line: 0,
            latest: None,
            ended: false,
        }
    }

    fn place(&self) -> Place {
        Place::line(&self.file, self.line)
    }

    fn next_pose(&mut self) -> Result<Option<Pose>, LogError> {
        loop {
            self.text.clear();
            match self.reader.read_until(b'\n', &mut self.text) {
                Ok(0) => return Ok(None),
                Ok(_) => self.line += 1,
                Err(source) => return Err(read_error(self.place(), self.gzip, source)),
            }
            let text = self.text.trim_ascii();
            if !text.is_empty() && text[0] != b'#' {
                return self.pose(text).map(Some);
            }
        }
    }

    fn pose(&self, text: &[u8]) -> Result<Pose, LogError> {
        let mut fields = [&[][..]; FIELDS.len()];
        let mut found = 0;
        for field in text.split(u8::is_ascii_whitespace).filter(|f| !f.is_empty()) {
            if let Some(slot) = fields.get_mut(found) {
                *slot = field;
            }
            found += 1;
        }
        if found != FIELDS.len() {
            return Err(LogError::FieldCount {
                place: self.place(),
                found,
                expected: format!("8: {}", FIELDS.join(" ")),
            });
        }
        let time = parse_time(fields[0], 9).ok_or_else(|| LogError::NotATime {
            place: self.place(),
            column: FIELDS[0].to_owned(),
            found: shown(fields[0]),
        })?;
        let mut values = [0.0; 7];
        for ((value, field), name) in values.iter_mut().zip(&fields[1..]).zip(&FIELDS[1..]) {
            *value = parse_number(field).map_err(|_| LogError::NotANumber {
                place: self.place(),
                column: (*name).to_owned(),
                found: shown(field),
            })?;
        }
        let [x, y, z, qx, qy, qz, qw] = values;
        if let Some(before) = self.latest
            && time <= before
        {
            return Err(LogError::TimeBackwards { place: self.place(), found: time, before });
        }
        let attitude = attitude_from(Quaternion::new(qw, qx, qy, qz), || self.place())?;
        Ok(Pose { time, position_m: Vector3::new(x, y, z), attitude })
    }
}

/// A quaternion of a file as an attitude.
pub(crate) fn attitude_from(q: Quaternion<f64>, place: impl FnOnce() -> Place) -> Result<Attitude, LogError> {
    let squared = q.norm_squared();
    if (squared - 1.0).abs() <= UNIT_TO_THE_LAST_BITS {
        return Ok(UnitQuaternion::new_unchecked(q));
    }
    let length = squared.sqrt();
    if length.is_nan() || (length - 1.0).abs() > LENGTH_TOLERANCE {
        return Err(LogError::BadValue {
            place: place(),
            what: "quaternion".to_owned(),
            found: format!("length {length}"),
            expected: "length 1".to_owned(),
        });
    }
    Ok(UnitQuaternion::new_unchecked(q / length))
}

impl Iterator for TumReader {
    type Item = Result<Pose, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.next_pose();
        match &next {
            Ok(Some(pose)) => self.latest = Some(pose.time),
            Ok(None) | Err(_) => self.ended = true,
        }
        next.transpose()
    }
}
