//! The level frame of a site: where geodetic coordinates become the metres of a roadway.
//!
//! East and north as in the plane that touches the ellipsoid at the origin; up is the height above the origin, as a mine
//! levels it: it follows the level surface, which falls below that plane by 2 cm in 500 m.
//! Limits: within some 20 km of the origin, away from the poles.

use crate::frames::{Enu, Position};
use crate::geodesy::{ECCENTRICITY_SQUARED, Geodetic, prime_vertical_radius_m};
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// A frame of metres around an origin on Earth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LevelFrame {
    origin: Geodetic,
    sin: f64,
    cos: f64,
    /// Distance of the origin from the Earth's axis and from the equator's plane, m.
    from_axis_m: f64,
    from_equator_m: f64,
}

impl LevelFrame {
    /// The frame with this origin.
    pub fn new(origin: Geodetic) -> Self {
        let (sin, cos) = libm::sincos(origin.latitude_rad);
        let (from_axis_m, from_equator_m) = meridian_plane_m(&origin, sin, cos);
        Self { origin, sin, cos, from_axis_m, from_equator_m }
    }

    /// The origin.
    pub fn origin(&self) -> &Geodetic {
        &self.origin
    }

    /// East, north, up of a point, m.
    ///
    /// ```
    /// use adit_core::{geodesy::Geodetic, level_frame::LevelFrame, nalgebra::Vector2};
    /// let frame = LevelFrame::new(Geodetic::from_degrees(45.7, 121.38, -320.0).unwrap());
    /// let face = frame.point(&Vector2::new(1_450.0, -820.0), -3.5).unwrap();
    /// assert!((frame.position_m(&face).y + 820.0).abs() < 1e-6);
    /// assert!((face.height_m + 323.5).abs() < 1e-9);
    /// ```
    #[inline]
    pub fn position_m(&self, point: &Geodetic) -> Vector3<f64> {
        let (sin_lat, cos_lat) = libm::sincos(point.latitude_rad);
        let (sin, cos) = libm::sincos(point.longitude_rad - self.origin.longitude_rad);
        let (from_axis, from_equator) = meridian_plane_m(point, sin_lat, cos_lat);
        let outward = from_axis * cos - self.from_axis_m;
        Vector3::new(
            from_axis * sin,
            self.cos * (from_equator - self.from_equator_m) - self.sin * outward,
            point.height_m - self.origin.height_m,
        )
    }

    /// The point at these level coordinates (east, north) and this height above the origin; `None` far from this Earth.
    pub fn point(&self, level_m: &Vector2<f64>, up_m: f64) -> Option<Geodetic> {
        // The level surface lies below the plane; what is left moves the point by 1 mm in 20 km.
        let below_m = level_m.norm_squared() / (2.0 * prime_vertical_radius_m(self.origin.latitude_rad));
        let in_plane = Position::<Enu>::new(level_m.x, level_m.y, up_m - below_m);
        let mut point = Geodetic::from_ecef(&self.origin.enu_frame().inverse().position(&in_plane))?;
        point.height_m = self.origin.height_m + up_m;
        Some(point)
    }
}

/// Distances from the Earth's axis and from the equator's plane, m.
fn meridian_plane_m(point: &Geodetic, sin: f64, cos: f64) -> (f64, f64) {
    let radius = prime_vertical_radius_m(point.latitude_rad);
    ((radius + point.height_m) * cos, (radius * (1.0 - ECCENTRICITY_SQUARED) + point.height_m) * sin)
}
