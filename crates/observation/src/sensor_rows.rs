//! What each sensor said, as it said it: the door for calibrations.
//!
//! Unlike [`crate::open`] this applies no sidecar (a calibration is made in the sensor's own axes, from readings that no
//! earlier calibration has touched) and reads a log of any one sensor, also an accelerometer or a gyro alone. What other
//! devices say (fixes, signal strengths, ranges, sightings) is passed over unread. Order is checked as everywhere: time that runs
//! backwards is an error, a repeated stamp is dropped and counted.

use crate::csv_log::{Row, RowReader};
use crate::error::{At, LogError, Place};
use crate::files::Input;
use crate::mcap_log::{self, McapLog};
use crate::observation::Observation;
use crate::source::LogSource;
use crate::warning::{LogWarning, Warnings};
use adit_core::time::Time;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Rows of a log of any kind, pulled one at a time, in bounded memory.
///
/// A row of a CSV log holds what stands in its line; an MCAP log gives one row for each message. After the first error the
/// iterator ends.
pub struct SensorRows {
    source: Source,
    file: Arc<Path>,
    warnings: Warnings,
    progress: (Arc<AtomicU64>, Option<u64>),
    latest: Option<Time>,
    /// Last stamp of inertial sensor, magnetometer, barometer.
    latest_of: [Option<Time>; 3],
    ended: bool,
}

enum Source {
    Csv(Box<RowReader>),
    Mcap(Box<McapLog>),
}

impl SensorRows {
    /// Opens a log; a wrong header is an error here.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, LogError> {
        Self::from_input(Input::open(path)?)
    }

    /// Reads from bytes of any origin.
    pub fn from_input(input: Input) -> Result<Self, LogError> {
        let mut warnings = Warnings::default();
        let (progress, file) = (input.progress(), Arc::clone(&input.file));
        let source = if input.start.starts_with(mcap_log::MAGIC) {
            Source::Mcap(Box::new(McapLog::new(input, &[])))
        } else {
            Source::Csv(Box::new(RowReader::new(input, &mut warnings)?))
        };
        Ok(Self { source, file, warnings, progress, latest: None, latest_of: [None; 3], ended: false })
    }

    /// What was odd so far; complete once the iterator has ended.
    pub fn warnings(&self) -> &[LogWarning] {
        self.warnings.list()
    }

    /// The file, as named when it was opened.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Bytes of the file read so far (before gzip is undone), for a progress bar.
    pub fn bytes_read(&self) -> u64 {
        self.progress.0.load(Ordering::Relaxed)
    }

    /// Length of the file in bytes; `None` for a pipe.
    pub fn bytes_total(&self) -> Option<u64> {
        self.progress.1
    }

    fn pull(&mut self) -> Result<Option<(Row, At)>, LogError> {
        match &mut self.source {
            Source::Csv(rows) => rows.next_row(),
            Source::Mcap(log) => {
                let next = log.next_observation(&mut self.warnings)?;
                Ok(next.map(|(observation, at)| (row(&observation), at)))
            }
        }
    }

    fn next_row(&mut self) -> Result<Option<Row>, LogError> {
        while let Some((mut row, at)) = self.pull()? {
            if !row.says_something() {
                continue;
            }
            if let Some(before) = self.latest.replace(row.time)
                && row.time < before
            {
                let place = Place::new(&self.file, at);
                return Err(LogError::TimeBackwards { place, found: row.time, before });
            }
            let [inertial, magnetic, pressure] = &mut self.latest_of;
            let mut repeated = false;
            let has_inertial = row.specific_force_m_s2.is_some() || row.angular_rate_rad_s.is_some();
            if has_inertial && inertial.replace(row.time) == Some(row.time) {
                (row.specific_force_m_s2, row.angular_rate_rad_s, repeated) = (None, None, true);
            }
            if row.field_ut.is_some() && magnetic.replace(row.time) == Some(row.time) {
                (row.field_ut, repeated) = (None, true);
            }
            if row.pressure_pa.is_some() && pressure.replace(row.time) == Some(row.time) {
                (row.pressure_pa, repeated) = (None, true);
            }
            if repeated {
                self.warnings.repeated(&self.file, at);
            }
            if row.says_something() {
                return Ok(Some(row));
            }
        }
        Ok(None)
    }
}

/// What an observation of the tag's own sensors says, as a row.
fn row(observation: &Observation) -> Row {
    let mut row = Row::empty(observation.time());
    match observation {
        Observation::Imu(sample) => {
            row.specific_force_m_s2 = Some(sample.specific_force_m_s2);
            row.angular_rate_rad_s = Some(sample.angular_rate_rad_s);
        }
        Observation::Acceleration(sample) => row.specific_force_m_s2 = Some(sample.specific_force_m_s2),
        Observation::Magnetic(sample) => row.field_ut = Some(sample.field_ut),
        Observation::Pressure(sample) => row.pressure_pa = Some(sample.pressure_pa),
        Observation::Fix(_) | Observation::Signal(_) | Observation::Range(_) | Observation::Sighting(_) => {}
    }
    row
}

impl Iterator for SensorRows {
    type Item = Result<Row, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.next_row().transpose();
        self.ended = !matches!(next, Some(Ok(_)));
        next
    }
}
