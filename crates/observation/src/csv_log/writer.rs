use super::row;
use crate::error::LogError;
use crate::files::AtomicFile;
use crate::files::decimal::ShortSeconds;
use crate::imu::{ImuSample, MagneticSample};
use crate::observation::Observation;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use std::io::{self, Write};
use std::path::Path;

/// Which sensors a CSV log has columns for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Sensors {
    /// Accelerometer and gyro.
    Imu,
    /// Accelerometer, gyro and magnetometer; a row without a magnetic reading has empty fields.
    ImuMagnetic,
    /// Accelerometer alone.
    Acceleration,
    /// Magnetometer alone.
    Magnetic,
    /// Barometer alone.
    Pressure,
    /// Position fixes alone, with covariance; without a height these fields are empty.
    Fixes,
    /// Signal strengths alone.
    Signals,
    /// Ranges alone, with how the signal came in; what is not told is empty. Impulse responses have no columns and are left out.
    Ranges,
    /// Sightings alone.
    Sightings,
}

impl Sensors {
    /// The header line.
    pub const fn header(self) -> &'static str {
        match self {
            Self::Imu => "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s",
            Self::ImuMagnetic => {
                "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT"
            }
            Self::Acceleration => "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2",
            Self::Magnetic => "time_s,mag_x_uT,mag_y_uT,mag_z_uT",
            Self::Pressure => "time_s,pressure_Pa",
            Self::Fixes => {
                "time_s,fix_east_m,fix_north_m,fix_cov_e_e_m2,fix_cov_e_n_m2,fix_cov_n_n_m2,fix_up_m,fix_up_sigma_m,fix_source"
            }
            Self::Signals => "time_s,transmitter,rssi_dBm,radio",
            Self::Ranges => {
                "time_s,anchor_id,tag_id,range_m,range_sigma_m,line_of_sight,radio,rx_power_dBm,first_path_power_dBm,\
                 first_path_index_tap,peak_index_tap,first_path_amp1,first_path_amp2,first_path_amp3,noise_std,noise_max,\
                 preamble_count"
            }
            Self::Sightings => "time_s,reader",
        }
    }
}

/// Writes a CSV log observation by observation; the file appears at [`CsvLogWriter::finish`], and not at all when dropped
/// before. A name that ends in `.gz` compresses it.
///
/// Times and values are written as the shortest decimal that reads back the same, so that reading and writing a log
/// changes nothing. A magnetic reading must share its time with the inertial sample before it
/// ([`Sensors::ImuMagnetic`]) or have its own file ([`Sensors::Magnetic`]), as everything else does; MCAP takes any mixture.
pub struct CsvLogWriter {
    file: AtomicFile,
    sensors: Sensors,
    latest: Option<Time>,
    /// The inertial sample whose row is not complete until it is clear whether a magnetic reading follows.
    open_row: Option<ImuSample>,
}

impl CsvLogWriter {
    /// Starts a file.
    pub fn create(path: impl AsRef<Path>, sensors: Sensors) -> Result<Self, LogError> {
        let mut file = AtomicFile::create(path)?;
        writeln!(file, "{}", sensors.header()).map_err(|e| file.error(e))?;
        Ok(Self { file, sensors, latest: None, open_row: None })
    }

    /// Writes one observation; times of the tag's own sensors must rise, what comes by radio may be late.
    pub fn push(&mut self, observation: &Observation) -> Result<(), LogError> {
        match (observation, self.sensors) {
            (Observation::Imu(sample), Sensors::Imu | Sensors::ImuMagnetic) => self.push_imu(*sample),
            (Observation::Magnetic(sample), Sensors::ImuMagnetic) => self.push_beside(sample),
            (Observation::Acceleration(sample), Sensors::Acceleration) => {
                self.push_alone(sample.time, &sample.specific_force_m_s2)
            }
            (Observation::Magnetic(sample), Sensors::Magnetic) => {
                self.push_alone(sample.time, &sample.field_ut)
            }
            (Observation::Pressure(sample), Sensors::Pressure) => {
                self.check(sample.time, [])?;
                self.push_row(observation)
            }
            (Observation::Fix(_), Sensors::Fixes)
            | (Observation::Signal(_), Sensors::Signals)
            | (Observation::Range(_), Sensors::Ranges)
            | (Observation::Sighting(_), Sensors::Sightings) => self.push_row(observation),
            (other, sensors) => {
                let (kind, time) = (other.kind(), other.time());
                Err(self.refuse(format!("{kind:?} at {time} s in a log of {sensors:?}")))
            }
        }
    }

    fn push_row(&mut self, observation: &Observation) -> Result<(), LogError> {
        let (kind, time) = (observation.kind(), observation.time());
        if let Some((name, found, expected)) = observation.fault() {
            return Err(self.refuse(format!("{kind:?} at {time} s: {name} is {found}, expected {expected}")));
        }
        if let Some(name) = row::unwritable_name(observation) {
            return Err(self.refuse(format!("{kind:?} at {time} s: the name {name} has a comma in it")));
        }
        row::write(&mut self.file, observation).map_err(|e| self.file.error(e))
    }

    fn push_imu(&mut self, sample: ImuSample) -> Result<(), LogError> {
        self.check(sample.time, [&sample.specific_force_m_s2, &sample.angular_rate_rad_s])?;
        if self.sensors == Sensors::ImuMagnetic {
            self.close_row(None)?;
            self.open_row = Some(sample);
            return Ok(());
        }
        let triples = [&sample.specific_force_m_s2, &sample.angular_rate_rad_s];
        write_row(&mut self.file, sample.time, &triples, false).map_err(|e| self.file.error(e))
    }

    fn push_alone(&mut self, time: Time, triple: &Vector3<f64>) -> Result<(), LogError> {
        self.check(time, [triple])?;
        write_row(&mut self.file, time, &[triple], false).map_err(|e| self.file.error(e))
    }

    fn push_beside(&mut self, sample: &MagneticSample) -> Result<(), LogError> {
        if self.open_row.is_none_or(|row| row.time != sample.time) {
            let time = sample.time;
            return Err(
                self.refuse(format!("a magnetic reading at {time} s has no inertial sample of that time"))
            );
        }
        if !sample.field_ut.iter().all(|v| v.is_finite()) {
            return Err(self.not_finite(sample.time));
        }
        self.close_row(Some(sample))
    }

    fn close_row(&mut self, magnetic: Option<&MagneticSample>) -> Result<(), LogError> {
        let Some(row) = self.open_row.take() else { return Ok(()) };
        let mut triples = vec![&row.specific_force_m_s2, &row.angular_rate_rad_s];
        triples.extend(magnetic.map(|sample| &sample.field_ut));
        write_row(&mut self.file, row.time, &triples, magnetic.is_none()).map_err(|e| self.file.error(e))
    }

    fn check<const N: usize>(&mut self, time: Time, triples: [&Vector3<f64>; N]) -> Result<(), LogError> {
        if let Some(before) = self.latest
            && time <= before
        {
            return Err(self.refuse(format!("a sample at {time} s after one at {before} s")));
        }
        if !triples.iter().all(|t| t.iter().all(|v| v.is_finite())) {
            return Err(self.not_finite(time));
        }
        self.latest = Some(time);
        Ok(())
    }

    fn not_finite(&self, time: Time) -> LogError {
        self.refuse(format!("the sample at {time} s has a component that is not a finite number"))
    }

    fn refuse(&self, what: String) -> LogError {
        LogError::CannotWrite { file: self.file.target().to_path_buf(), what }
    }

    /// Completes the file and gives it its name.
    pub fn finish(mut self) -> Result<(), LogError> {
        self.close_row(None)?;
        self.file.finish()
    }
}

fn write_row(
    file: &mut AtomicFile,
    time: Time,
    triples: &[&Vector3<f64>],
    empty_magnetic: bool,
) -> io::Result<()> {
    write!(file, "{}", ShortSeconds(time))?;
    for value in triples.iter().flat_map(|t| t.iter()) {
        write!(file, ",{value}")?;
    }
    writeln!(file, "{}", if empty_magnetic { ",,," } else { "" })
}
