//! Heading from the magnetic field, levelled by gravity.
//!
//! A field `B` in body axes is turned into a level frame; its horizontal part points to magnetic north, which stands
//! `D` (declination) clockwise of true north. In vectors, with `u` the direction of the specific force at rest (up) and
//! `f` the reference axis of the body laid level:
//!
//! ```text
//! heading of the body's x axis   ψ = D − atan2(e·B, n·B),     n = f level,  e = n × u
//! ```
//!
//! which is, written out in roll `φ` and pitch `θ` of a forward-right-down body, the usual
//! `ψ = D + atan2(B_z sin φ − B_y cos φ, B_x cos θ + B_y sin θ sin φ + B_z sin θ cos φ)` (Ozyagcilar 2015, AN4248,
//! eq. 22; Groves 2013, eq. 6.5–6.6; Kang 2023, eq. 4). The vector form has no pole: where the x axis points up or down
//! within 2.6°, the body's z axis takes its place, as in [`attitude::level`].
//!
//! # How sure
//! A tilt error `τ` turns part of the vertical field into the level: to first order the heading is off by
//! `τ tan I` for a tilt about the magnetic meridian (`I` dip, 60–70° in middle latitudes: a degree of tilt costs two
//! degrees of heading). A field error `b` across the meridian turns it by `b / H`, `H` the horizontal field.
//!
//! The heading is that of the body frame: the log reader has applied the declared mounting (x forward, z up), so that a
//! tag on a waist or a foot gives the heading of its wearer; without a declared mounting it is that of the sensor's x axis.

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A magnetic field in a level frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LevelField {
    /// Length, µT.
    pub norm_ut: f64,
    /// Length of the horizontal part, µT.
    pub horizontal_ut: f64,
    /// Angle below the horizontal, rad, −π/2 to π/2.
    pub dip_rad: f64,
    /// Direction of the horizontal part, clockwise from the frame's y axis, rad.
    pub azimuth_rad: f64,
}

/// A heading from accelerometer and magnetometer alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compass {
    /// Body to local level, with that heading.
    pub attitude: Attitude,
    /// Heading of the body's x axis (of its z axis where x is within 2.6° of the vertical), clockwise from true north, rad.
    pub heading_rad: f64,
    /// The field in that level frame.
    pub field: LevelField,
}

impl LevelField {
    /// A field given in a level frame (x, y horizontal, z up), µT. `None` when it is zero or not finite.
    pub fn new(field_ut: &Vector3<f64>) -> Option<Self> {
        let horizontal_ut = libm::hypot(field_ut.x, field_ut.y);
        let norm_ut = libm::hypot(horizontal_ut, field_ut.z);
        (norm_ut.is_finite() && norm_ut > 0.0).then(|| Self {
            norm_ut,
            horizontal_ut,
            dip_rad: libm::atan2(-field_ut.z, horizontal_ut),
            azimuth_rad: libm::atan2(field_ut.x, field_ut.y),
        })
    }

    /// What has to be added to the heading of the level frame for its field to stand at `declination_rad`, in (−π, π] rad.
    pub fn heading_offset_rad(&self, declination_rad: f64) -> f64 {
        attitude::angle_difference(declination_rad, self.azimuth_rad)
    }

    /// Derivative of the azimuth by the field in the level frame, rad/µT.
    pub fn azimuth_gradient(&self) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(self.azimuth_rad);
        Vector3::new(cos, -sin, 0.0) / self.horizontal_ut
    }

    /// Standard deviation of a heading from this field, rad, from those of the tilt and of the field across the meridian.
    ///
    /// At most that of an unknown direction, π/√3.
    pub fn heading_sigma_rad(&self, field_sigma_ut: f64, tilt_sigma_rad: f64) -> f64 {
        let unknown = core::f64::consts::PI / libm::sqrt(3.0);
        let vertical_ut = self.norm_ut * libm::sin(self.dip_rad);
        let across_ut = libm::hypot(field_sigma_ut, vertical_ut * tilt_sigma_rad);
        let sigma = across_ut / self.horizontal_ut;
        if sigma < unknown { sigma } else { unknown }
    }
}

/// Tilt-compensated heading of a body at rest.
///
/// `specific_force` (any unit, up at rest) and `field_ut` in body axes; `declination_rad` is the angle from true to
/// magnetic north, positive to the east. `None` when either is zero or not finite, or the field has no horizontal part.
///
/// ```
/// use adit_core::nalgebra::Vector3;
/// use adit_estimation::magnetic::heading::tilt_compensated;
/// // x forward, y left, z up; the field of middle latitudes; facing east, north is to the left.
/// let compass = tilt_compensated(&Vector3::z(), &Vector3::new(0.0, 20.0, -45.0), 0.0).unwrap();
/// assert!((compass.heading_rad.to_degrees() - 90.0).abs() < 1e-12);
/// ```
pub fn tilt_compensated(
    specific_force: &Vector3<f64>,
    field_ut: &Vector3<f64>,
    declination_rad: f64,
) -> Option<Compass> {
    let facing_north = attitude::level(specific_force, 0.0)?;
    let field = LevelField::new(&(facing_north * field_ut))?;
    if field.horizontal_ut <= 0.0 {
        return None;
    }
    let heading_rad = field.heading_offset_rad(declination_rad);
    let attitude = attitude::level(specific_force, heading_rad)?;
    Some(Compass { attitude, heading_rad, field })
}
