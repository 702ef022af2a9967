//! Logs read as a calibration wants them: each sensor's readings, untouched by any sidecar.

use crate::interrupt;
use crate::progress::{self, Progress, Unit};
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::SensorRows;
use adit_observation::sidecar::{AccelerationSign, Sidecar};
use adit_tuning::Series;
use adit_tuning::magnetometer::Tumble;
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

/// Rows between two looks at the bar and Ctrl-C.
const PULSE: usize = 4096;

/// All readings of all logs.
///
/// A sensor may be spread over several logs that follow each other in time; the same sensor in two logs at the same time is an
/// error. The only thing taken from a log's sidecar is the sign of its accelerometer.
pub fn read(paths: &[PathBuf]) -> Result<Tumble> {
    let mut logs =
        paths.iter().map(|path| read_one(path).map(|log| (path, log))).collect::<Result<Vec<_>>>()?;
    let start = |log: &Tumble| {
        let first = |series: &Series| series.times().first().copied();
        [&log.field_ut, &log.angular_rate_rad_s, &log.specific_force_m_s2].into_iter().filter_map(first).min()
    };
    logs.sort_by_key(|(_, log)| start(log));
    let mut logs = logs.into_iter();
    let Some((_, mut all)) = logs.next() else { bail!("no log to read") };
    for (path, log) in logs {
        append(&mut all.field_ut, &log.field_ut, "magnetometer", path)?;
        append(&mut all.angular_rate_rad_s, &log.angular_rate_rad_s, "gyro", path)?;
        append(&mut all.specific_force_m_s2, &log.specific_force_m_s2, "accelerometer", path)?;
    }
    Ok(all)
}

fn append(all: &mut Series, more: &Series, sensor: &str, path: &Path) -> Result<()> {
    for (time, reading) in more.times().iter().zip(more.readings()) {
        all.push(*time, *reading).with_context(|| {
            format!(
                "{}: its {sensor} overlaps that of another log, expected parts of one recording or one file per sensor",
                path.display()
            )
        })?;
    }
    Ok(())
}

fn read_one(path: &Path) -> Result<Tumble> {
    let sign = match Sidecar::beside(path)? {
        Some((_, sidecar)) if sidecar.frame.acceleration == AccelerationSign::Gravity => -1.0,
        _ => 1.0,
    };
    let mut rows = SensorRows::open(path)?;
    tracing::info!("reading {}", path.display());
    let progress = Progress::new("reading", Unit::Bytes, rows.bytes_total());
    let mut log = Tumble::default();
    for count in 0_usize.. {
        let Some(row) = rows.next().transpose()? else { break };
        if count.is_multiple_of(PULSE) {
            interrupt::check()?;
            progress.at(rows.bytes_read());
        }
        let push = |series: &mut Series, time: Time, reading: Option<Vector3<f64>>| match reading {
            Some(reading) => series.push(time, reading),
            None => Ok(()),
        };
        push(&mut log.field_ut, row.time, row.field_ut)?;
        push(&mut log.angular_rate_rad_s, row.time, row.angular_rate_rad_s)?;
        push(&mut log.specific_force_m_s2, row.time, row.specific_force_m_s2.map(|f| f * sign))?;
    }
    drop(progress);
    progress::warn(rows.warnings());
    Ok(log)
}
