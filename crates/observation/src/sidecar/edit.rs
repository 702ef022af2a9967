//! Changing a sidecar without losing what else stands in it: other keys, their order, comments.

use super::{Location, MagneticFieldReference, MagnetometerCalibration, Sidecar, text_of};
use crate::error::{LogError, Place};
use crate::files::AtomicFile;
use crate::imu::ImuSpecification;
use crate::start::{Site, StartPose};
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml_edit::{Array, DocumentMut, Item, Value};

/// Digits of a number after the first.
const DIGITS: usize = 6;

/// A sidecar under change. Nothing is written before [`Self::write`].
#[derive(Debug, Clone)]
pub struct SidecarEdit {
    path: PathBuf,
    document: DocumentMut,
}

impl SidecarEdit {
    /// Reads the sidecar at `path`, or starts an empty one where there is none.
    ///
    /// A file that is not a valid sidecar is an error: it is not adit's to overwrite.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        let text = match File::open(path) {
            Ok(file) => text_of(path, file)?,
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            Err(source) => {
                return Err(LogError::Io { file: path.to_path_buf(), doing: "read it", source });
            }
        };
        Self::parse(path, &text)
    }

    /// Starts from a text; `path` is where it will be written.
    pub fn parse(path: &Path, text: &[u8]) -> Result<Self, LogError> {
        Sidecar::parse(&Arc::from(path), text)?;
        let broken = |what: String| LogError::Sidecar { place: Place::file(path), what };
        let text = std::str::from_utf8(text).map_err(|e| broken(e.to_string()))?;
        let document = text.parse::<DocumentMut>().map_err(|e| broken(e.message().to_owned()))?;
        Ok(Self { path: path.to_path_buf(), document })
    }

    /// Sets `[magnetometer]`.
    pub fn set_magnetometer(&mut self, calibration: &MagnetometerCalibration) {
        let matrix = calibration.matrix();
        let row = |row: usize| array((0..3).map(|column| number(matrix[(row, column)])));
        self.set("magnetometer", "offset_ut", array(calibration.offset_ut().iter().map(|v| number(*v))));
        self.set("magnetometer", "matrix", array((0..3).map(row)));
    }

    /// Sets what is known in `[magnetic_field]`; what is not known stays as it is.
    pub fn set_magnetic_field(&mut self, field: &MagneticFieldReference) {
        for (key, value) in [("norm_ut", field.norm_ut), ("dip_deg", field.dip_deg)] {
            if let Some(value) = value {
                self.set("magnetic_field", key, number(value));
            }
        }
    }

    /// Sets `[frame] magnetic_declination_deg`, east positive.
    pub fn set_declination_deg(&mut self, declination_deg: f64) {
        self.set("frame", "magnetic_declination_deg", number(declination_deg));
    }

    /// Sets `[mounting] location`.
    pub fn set_location(&mut self, location: Location) {
        self.set("mounting", "location", Value::from(location.name()));
    }

    /// Sets `[noise]`.
    pub fn set_noise(&mut self, noise: &ImuSpecification) {
        for (key, density) in [
            ("angle_random_walk_rad_sqrt_s", noise.angle_random_walk_rad_sqrt_s),
            ("velocity_random_walk_m_s_sqrt_s", noise.velocity_random_walk_m_s_sqrt_s),
            ("gyro_bias_walk_rad_s_sqrt_s", noise.gyro_bias_walk_rad_s_sqrt_s),
            ("acc_bias_walk_m_s2_sqrt_s", noise.acc_bias_walk_m_s2_sqrt_s),
        ] {
            self.set("noise", key, number(density));
        }
    }

    /// Sets `[site]`, to the last digit.
    pub fn set_site(&mut self, site: &Site) {
        let values = [
            ("latitude_deg", site.latitude_deg),
            ("longitude_deg", site.longitude_deg),
            ("height_m", site.height_m),
        ];
        for (key, value) in values {
            self.set("site", key, Value::from(value));
        }
    }

    /// Sets `[start]`, to the last digit.
    pub fn set_start(&mut self, start: &StartPose) {
        self.set("start", "position_m", array(start.position_m.into_iter().map(Value::from)));
        self.set("start", "position_sigma_m", array(start.position_sigma_m.into_iter().map(Value::from)));
        for (key, value) in [
            ("heading_deg", start.heading_deg),
            ("pitch_deg", start.pitch_deg),
            ("roll_deg", start.roll_deg),
            ("attitude_sigma_deg", start.attitude_sigma_deg),
        ] {
            self.set("start", key, Value::from(value));
        }
    }

    /// The text, checked: what is written will be read.
    pub fn text(&self) -> Result<String, LogError> {
        let text = self.document.to_string();
        Sidecar::parse(&Arc::from(self.path.as_path()), text.as_bytes())?;
        Ok(text)
    }

    /// Writes the sidecar, whole or not at all.
    pub fn write(&self) -> Result<(), LogError> {
        let text = self.text()?;
        let mut file = AtomicFile::create(&self.path)?;
        file.write_all(text.as_bytes()).map_err(|source| file.error(source))?;
        file.finish()
    }

    /// Puts a value in the place of the one before, whose comment stays.
    fn set(&mut self, table: &str, key: &str, mut value: Value) {
        let item = self.document.entry(table).or_insert_with(toml_edit::table);
        // In a valid sidecar, and no other comes here, these names are tables.
        let Some(table) = item.as_table_like_mut() else { return };
        if let Some(before) = table.get(key).and_then(Item::as_value) {
            *value.decor_mut() = before.decor().clone();
        }
        table.insert(key, Item::Value(value));
    }
}

fn array(values: impl Iterator<Item = Value>) -> Value {
    Value::Array(values.collect::<Array>())
}

/// The shortest text of the number rounded to as many digits as a sensor can mean.
fn number(value: f64) -> Value {
    let rounded = format!("{value:.DIGITS$e}").parse().unwrap_or(value);
    // `{:?}` always has a point or an exponent, as a TOML float must.
    let text = format!("{rounded:?}");
    text.parse().unwrap_or_else(|_| Value::from(rounded))
}
