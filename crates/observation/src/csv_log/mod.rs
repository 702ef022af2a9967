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
//!   `_uT _nT _gauss _mT`. Any other is an error. `mag_x_normalised` has no physical unit: such a field is left out with
//!   a warning.
//! - Time is read exactly to the nanosecond, with or without an exponent.
//! - Position fixes: `fix_east_m`, `fix_north_m` with `fix_sigma_m`, or with `fix_cov_e_e_m2`, `fix_cov_e_n_m2`,
//!   `fix_cov_n_n_m2`; `fix_up_m` with `fix_up_sigma_m` and `fix_source` may stand beside ([`crate::FixSource`]).
//! - Needed: `time`, `acc` and `gyro`; or `time` and `mag` or `fix` without either. [`RowReader`] also reads one sensor alone.
//! - An empty field in the magnetic triple means that the row has no magnetic reading, empty `fix_east_m` and `fix_north_m`
//!   that it has no fix; any other field that is empty or not a finite number is an error.
//! - A row gives its inertial observation first, then the magnetic one, then the fix, all with the row's time.
//! - Gzip is recognised by content.
//!
//! Memory: one line (at most 64 KiB) and fixed buffers.

mod fix_columns;
mod header;
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
use crate::fix::PositionFix;
use crate::imu::{ImuSample, MagneticSample};
use crate::observation::Observation;
use crate::source::LogSource;
use crate::warning::Warnings;
use std::path::Path;
use std::sync::Arc;
use units::Quantity;

/// Observations of a CSV log; order and units are not checked here (see [`crate::open`]).
pub struct CsvLog {
    rows: RowReader,
    /// What is left of the row whose first observation was given last.
    pending: (Option<MagneticSample>, Option<PositionFix>, At),
}

impl CsvLog {
    /// Reads the header.
    pub fn new(input: Input, warnings: &mut Warnings) -> Result<Self, LogError> {
        let rows = RowReader::new(input, warnings)?;
        let has = |quantity| rows.header().has(quantity);
        let (acceleration, rate) = (has(Quantity::Acceleration), has(Quantity::AngularRate));
        let other = has(Quantity::MagneticField) || rows.header().has_fixes();
        if acceleration != rate || !(rate || other) {
            return Err(rows.missing(&[Quantity::Acceleration, Quantity::AngularRate]));
        }
        Ok(Self { rows, pending: (None, None, At::File) })
    }
}

impl LogSource for CsvLog {
    fn next_observation(&mut self, _warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError> {
        loop {
            let (magnetic, fix, at) = &mut self.pending;
            if let Some(sample) = magnetic.take() {
                return Ok(Some((Observation::Magnetic(sample), *at)));
            }
            if let Some(fix) = fix.take() {
                return Ok(Some((Observation::Fix(fix), *at)));
            }
            let Some((row, at)) = self.rows.next_row()? else { return Ok(None) };
            let magnetic = row.field_ut.map(|field_ut| MagneticSample { time: row.time, field_ut });
            self.pending = (magnetic, row.fix, at);
            if let (Some(specific_force_m_s2), Some(angular_rate_rad_s)) =
                (row.specific_force_m_s2, row.angular_rate_rad_s)
            {
                let sample = ImuSample { time: row.time, angular_rate_rad_s, specific_force_m_s2 };
                return Ok(Some((Observation::Imu(sample), at)));
            }
        }
    }

    fn file(&self) -> &Arc<Path> {
        self.rows.file()
    }
}
