//! Calibration of a magnetometer, and the field it should see.
//!
//! `field = matrix · (reading − offset)` (Renaudin, Afzal & Lachapelle 2010, eq. 8): the offset is hard iron and the sensor's
//! own zero, the matrix undoes soft iron, scale and axes that are not square, and turns the axes of the magnetometer into
//! those of the inertial sensor. It stands before the mounting rotation.

use adit_core::nalgebra::{Matrix3, Vector3};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

/// Largest ratio of the matrix's longest to its shortest axis: iron that does more leaves no compass to calibrate.
const LARGEST_RATIO: f64 = 100.0;

/// Hard and soft iron of a magnetometer, sensor axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MagnetometerCalibration {
    offset_ut: Vector3<f64>,
    matrix: Matrix3<f64>,
}

impl MagnetometerCalibration {
    /// From the offset (µT) and the matrix; an error says what is wrong with them.
    pub fn new(offset_ut: Vector3<f64>, matrix: Matrix3<f64>) -> Result<Self, String> {
        if let Some(bad) = offset_ut.iter().chain(matrix.iter()).find(|v| !v.is_finite()) {
            return Err(format!("found {bad}, expected finite numbers"));
        }
        let lengths = matrix.singular_values();
        let (longest, shortest) = (lengths.max(), lengths.min());
        if shortest * LARGEST_RATIO > longest {
            return Ok(Self { offset_ut, matrix });
        }
        Err(format!(
            "found a matrix with axes of length {longest:.3e} to {shortest:.3e}, expected a ratio below {LARGEST_RATIO}"
        ))
    }

    /// Reading of the sensor where there is no field, µT.
    pub fn offset_ut(&self) -> &Vector3<f64> {
        &self.offset_ut
    }

    /// Readings less the offset to the field.
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.matrix
    }

    /// The field, µT, in the axes of the inertial sensor, from a reading.
    #[inline]
    pub fn field_ut(&self, reading_ut: &Vector3<f64>) -> Vector3<f64> {
        self.matrix * (reading_ut - self.offset_ut)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    offset_ut: [f64; 3],
    matrix: [[f64; 3]; 3],
}

impl<'de> Deserialize<'de> for MagnetometerCalibration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Written { offset_ut, matrix } = Written::deserialize(deserializer)?;
        Self::new(Vector3::from(offset_ut), Matrix3::from_fn(|r, c| matrix[r][c])).map_err(D::Error::custom)
    }
}

/// The undisturbed field of a site, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MagneticFieldReference {
    /// Magnetic flux density, µT.
    #[serde(default, deserialize_with = "super::positive")]
    pub norm_ut: Option<f64>,
    /// Angle below the horizontal, deg, within ±90.
    #[serde(default, deserialize_with = "dip")]
    pub dip_deg: Option<f64>,
}

fn dip<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let value = f64::deserialize(deserializer)?;
    if (-90.0..=90.0).contains(&value) {
        return Ok(Some(value));
    }
    Err(D::Error::custom(format!("found {value}, expected a dip from -90 to 90")))
}
