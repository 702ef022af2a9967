//! The ellipsoid as navigation near one latitude sees it: radii, rates, and what errors do to them.

use adit_core::geodesy::{EARTH_RATE_RAD_S, ECCENTRICITY_SQUARED, SEMI_MAJOR_AXIS_M};
use adit_core::nalgebra::Vector3;

/// Radii of curvature and their derivatives at one latitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// Sine of the latitude.
    pub sin: f64,
    /// Cosine of the latitude.
    pub cos: f64,
    /// In the meridian, `R_M`, m.
    pub meridian_m: f64,
    /// In the prime vertical, `R_N`, m.
    pub vertical_m: f64,
    /// `dR_M/dL`, m/rad.
    pub meridian_slope_m: f64,
    /// `dR_N/dL`, m/rad.
    pub vertical_slope_m: f64,
}

impl Curvature {
    /// At a latitude (rad), from one sine and one square root.
    #[inline]
    pub fn at(latitude_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(latitude_rad);
        let term = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
        let vertical_m = SEMI_MAJOR_AXIS_M / libm::sqrt(term);
        let meridian_m = vertical_m * (1.0 - ECCENTRICITY_SQUARED) / term;
        let slope = ECCENTRICITY_SQUARED * sin * cos / term;
        Self {
            sin,
            cos,
            meridian_m,
            vertical_m,
            meridian_slope_m: 3.0 * slope * meridian_m,
            vertical_slope_m: slope * vertical_m,
        }
    }

    /// Rotation of the Earth, east, north, up, rad/s.
    #[inline]
    pub fn earth_rate(&self) -> Vector3<f64> {
        Vector3::new(0.0, EARTH_RATE_RAD_S * self.cos, EARTH_RATE_RAD_S * self.sin)
    }

    /// Rotation of the level frame of a walker against the Earth (transport rate) at height `h`, rad/s.
    #[inline]
    pub fn transport_rate(&self, velocity: &Vector3<f64>, height_m: f64) -> Vector3<f64> {
        let eastward = velocity.x / (self.vertical_m + height_m);
        let northward = velocity.y / (self.meridian_m + height_m);
        Vector3::new(-northward, eastward, eastward * self.sin / self.cos)
    }

    /// What an error of latitude (rad) does to [`Self::earth_rate`].
    #[inline]
    pub fn earth_rate_error(&self, latitude: f64) -> Vector3<f64> {
        Vector3::new(0.0, -self.sin, self.cos) * (EARTH_RATE_RAD_S * latitude)
    }

    /// What errors of velocity (m/s), latitude (rad) and height (m) do to [`Self::transport_rate`], to first order.
    #[inline]
    pub fn transport_rate_error(
        &self,
        velocity: &Vector3<f64>,
        height_m: f64,
        velocity_error: &Vector3<f64>,
        [latitude, height]: [f64; 2],
    ) -> Vector3<f64> {
        let (vertical, meridian) = (self.vertical_m + height_m, self.meridian_m + height_m);
        let (eastward, northward) = (velocity.x / vertical, velocity.y / meridian);
        let eastward_error =
            (velocity_error.x - eastward * (self.vertical_slope_m * latitude + height)) / vertical;
        let northward_error =
            (velocity_error.y - northward * (self.meridian_slope_m * latitude + height)) / meridian;
        let up = eastward_error * self.sin / self.cos + eastward / (self.cos * self.cos) * latitude;
        Vector3::new(-northward_error, eastward_error, up)
    }
}
