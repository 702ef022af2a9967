//! A recording with a file for each sensor, on stamps of their own: all brought to the stamps of the first by straight lines.

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::csv_log::Row;
use adit_observation::sidecar::Sidecar;
use adit_observation::{ImuSample, MagneticSample, Observation, SensorRows};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};

/// What the readings of one file are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sensor {
    Gyro,
    Accelerometer,
    Magnetometer,
}

/// The readings of one file.
struct Readings {
    sensor: Sensor,
    samples: Vec<(Time, Vector3<f64>)>,
}

/// Inertial and magnetic samples at the stamps of the first file, where all the others have a reading before and after.
pub fn joined(files: &[PathBuf], sidecar: Option<&Sidecar>) -> Result<Vec<Observation>> {
    let all = files.iter().map(|file| Readings::of(file)).collect::<Result<Vec<_>>>()?;
    let of = |sensor| all.iter().find(|readings| readings.sensor == sensor);
    let (Some(gyro), Some(accelerometer)) = (of(Sensor::Gyro), of(Sensor::Accelerometer)) else {
        let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        bail!("{}: expected a gyro and an accelerometer among the files to join", names.join(", "));
    };
    let magnetometer = of(Sensor::Magnetometer);
    let mut observations = Vec::new();
    for (time, _) in all.first().map_or(&[][..], |first| &first.samples) {
        let time = *time;
        let (Some(angular_rate_rad_s), Some(specific_force_m_s2)) = (gyro.at(time), accelerometer.at(time))
        else {
            continue;
        };
        let field_ut = magnetometer.map(|magnetometer| magnetometer.at(time));
        // Where the magnetometer is silent there is no sample at all: the log is of one kind throughout.
        let Some(field_ut) = field_ut.map_or(Some(None), |field| field.map(Some)) else { continue };
        observations.push(Observation::Imu(ImuSample { time, angular_rate_rad_s, specific_force_m_s2 }));
        observations
            .extend(field_ut.map(|field_ut| Observation::Magnetic(MagneticSample { time, field_ut })));
    }
    if let Some(sidecar) = sidecar {
        observations = observations.into_iter().map(|observation| sidecar.apply(observation)).collect();
    }
    Ok(observations)
}

impl Readings {
    fn of(file: &Path) -> Result<Self> {
        let mut found: Option<Sensor> = None;
        let mut samples = Vec::new();
        for row in SensorRows::open(file)? {
            let Row { time, angular_rate_rad_s, specific_force_m_s2, field_ut, .. } = row?;
            let values = [
                (Sensor::Gyro, angular_rate_rad_s),
                (Sensor::Accelerometer, specific_force_m_s2),
                (Sensor::Magnetometer, field_ut),
            ];
            let mut told = values.into_iter().filter_map(|(sensor, value)| Some((sensor, value?)));
            let (Some((sensor, value)), None) = (told.next(), told.next()) else {
                bail!("{}: at {time} s: expected the readings of one sensor", file.display());
            };
            if *found.get_or_insert(sensor) != sensor {
                bail!("{}: at {time} s: another sensor than before", file.display());
            }
            samples.push((time, value));
        }
        let Some(sensor) = found else { bail!("{}: no readings", file.display()) };
        Ok(Self { sensor, samples })
    }

    /// On the straight line between two readings; `None` where there is none before.
    fn at(&self, time: Time) -> Option<Vector3<f64>> {
        let after = self.samples.partition_point(|(stamp, _)| *stamp < time);
        let (later, to) = self.samples.get(after)?;
        let (earlier, from) = self.samples.get(after.checked_sub(1)?)?;
        let share = (time - *earlier).seconds() / (*later - *earlier).seconds();
        Some(from + (to - from) * share)
    }
}
