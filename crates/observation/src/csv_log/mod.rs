//! Sensor logs as CSV with the unit in each column name.
//!
//! ```text
//! time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT
//! 0,5.69189,1.56538,-7.85785,0.003722,-0.002671,0.005246,-10.872,22.579,35.47
//! 0.005,5.69848,1.58534,-7.85212,0.004526,-0.001656,0.006781,,,
//! ```
//!
//! - Columns in any order. Columns not known are ignored with a warning. Lines that start with `#` are comments.
//! - Units: time `_s _ms _us _ns`; `acc` `_m_s2 _g` (1 g = 9.80665 m/s²); `gyro` `_rad_s _deg_s`; `mag`
//!   `_uT _nT _gauss _mT`; `pressure` `_Pa _hPa _kPa`; `rssi` `_dBm`; `range` `_m _cm _mm`. Any other is an error.
//!   `mag_x_normalised` has no physical unit: such a field is left out with a warning.
//! - Time is read exactly to the nanosecond, with or without an exponent.
//! - Position fixes: `fix_east_m`, `fix_north_m` with `fix_sigma_m`, or with `fix_cov_e_e_m2`, `fix_cov_e_n_m2`,
//!   `fix_cov_n_n_m2`; `fix_up_m` with `fix_up_sigma_m` and `fix_source` may stand beside ([`crate::FixSource`]).
//! - Signal strengths: `rssi_dBm` with `transmitter` (or `access_point`, `beacon`, `receiver`), one to a row; `radio`
//!   ([`crate::Radio`]). Sightings: `reader`.
//! - Ranges: `range_m` with `anchor_id` (or `anchor`), one to a row; or a column `range_NAME_m` for each anchor. Beside them may stand
//!   `tag_id`, `range_sigma_m`, `valid`, `radio`; beside single ones `line_of_sight` and how the signal came in
//!   ([`crate::Reception`]): `rx_power_dBm`, `first_path_power_dBm`, `first_path_index_tap`, `peak_index_tap`, `first_path_amp1`,
//!   `first_path_amp2`, `first_path_amp3`, `noise_std`, `noise_max`, `preamble_count`. Impulse responses have no columns.
//! - Needed: `time`, `acc` and `gyro`; or `acc` without `gyro` ([`crate::Observation::Acceleration`]); or anything else without either. [`RowReader`] also reads one sensor alone.
//! - An empty field in the magnetic triple means that the row has no magnetic reading; so do empty `fix_east_m` and `fix_north_m`, and an
//!   empty `pressure`, `rssi`, `range` or `reader`, each for what it begins, and `valid` 0 for ranges. What may stand beside may be
//!   empty; any other field that is empty or not a finite number is an error.
//! - A row gives what it holds in the order of [`crate::ObservationKind::ALL`], all with the row's time.
//! - Gzip is recognised by content.
//!
//! Memory: one line (at most 64 KiB) and fixed buffers.

mod finder;
mod fix_columns;
mod header;
pub mod labelled;
mod radio_columns;
mod range_columns;
pub mod range_truth;
mod row;
mod rows;
pub(crate) mod table;
pub mod units;
mod writer;

pub use header::Header;
pub(crate) use header::{missing, name};
pub use rows::{Row, RowReader};
pub use writer::{CsvLogWriter, Sensors};

use crate::error::{At, LogError};
use crate::files::Input;
use crate::imu::{AccelerationSample, ImuSample, MagneticSample};
use crate::observation::Observation;
use crate::pressure::PressureSample;
use crate::source::LogSource;
use crate::warning::Warnings;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use units::Quantity;

/// Observations of a CSV log; order and units are not checked here (see [`crate::open`]).
pub struct CsvLog {
    rows: RowReader,
    /// What is left of the row whose first observation was given last, and where it stands.
    pending: VecDeque<Observation>,
    at: At,
}

impl CsvLog {
    /// Reads the header.
    pub fn new(input: Input, warnings: &mut Warnings) -> Result<Self, LogError> {
        let rows = RowReader::new(input, warnings)?;
        let header = rows.header();
        let (acceleration, rate) = (header.has(Quantity::Acceleration), header.has(Quantity::AngularRate));
        let other = header.has(Quantity::MagneticField) || header.has_pressure() || header.has_radio();
        if !acceleration && (rate || !other) {
            return Err(rows.missing(&[Quantity::Acceleration, Quantity::AngularRate]));
        }
        Ok(Self { rows, pending: VecDeque::new(), at: At::File })
    }

    /// Takes a row apart; its first observation, if it has any.
    fn take(&mut self, row: Row) -> Result<Option<Observation>, LogError> {
        let Row { time, specific_force_m_s2, angular_rate_rad_s, field_ut, pressure_pa } = row;
        if let Some(field_ut) = field_ut {
            self.pending.push_back(Observation::Magnetic(MagneticSample { time, field_ut }));
        }
        if let Some(pressure_pa) = pressure_pa {
            let sample = PressureSample { time, pressure_pa };
            self.pending.push_back(self.rows.possible(Observation::Pressure(sample))?);
        }
        if self.rows.header().has_radio() {
            self.rows.radio(time, &mut self.pending)?;
        }
        Ok(match (specific_force_m_s2, angular_rate_rad_s) {
            (Some(specific_force_m_s2), Some(angular_rate_rad_s)) => {
                Some(Observation::Imu(ImuSample { time, angular_rate_rad_s, specific_force_m_s2 }))
            }
            (Some(specific_force_m_s2), None) => {
                Some(Observation::Acceleration(AccelerationSample { time, specific_force_m_s2 }))
            }
            _ => self.pending.pop_front(),
        })
    }
}

impl LogSource for CsvLog {
    fn next_observation(&mut self, _warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError> {
        if let Some(observation) = self.pending.pop_front() {
            return Ok(Some((observation, self.at)));
        }
        while let Some((row, at)) = self.rows.next_row()? {
            self.at = at;
            if let Some(observation) = self.take(row)? {
                return Ok(Some((observation, at)));
            }
        }
        Ok(None)
    }

    fn file(&self) -> &Arc<Path> {
        self.rows.file()
    }
}
