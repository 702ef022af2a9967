//! WGS-84: the ellipsoid, its gravity, and the way between latitude, ECEF and a local level frame.
//!
//! Sources: NIMA TR8350.2, *Department of Defense World Geodetic System 1984*, 3rd edition (2000), chapters 3 and 4;
//! Bowring, *The accuracy of geodetic latitude and height equations*, Survey Review 28 (1985);
//! Heiskanen & Moritz, *Physical Geodesy* (1967), §4-3 for gravity inside rock.
//!
//! Latitude is geodetic, longitude east of Greenwich, height above the **ellipsoid** (a survey's height above sea
//! level differs by the geoid, up to ±100 m). Angles in rad, lengths in m.

use crate::attitude;
use crate::frames::{Ecef, Enu, Position, Rotation, Transform, Vector};
use nalgebra::{Matrix3, RowVector3};
use serde::{Deserialize, Serialize};

/// Semi-major axis `a`, m (TR8350.2, table 3.1; defining).
pub const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;
/// Flattening `f` (TR8350.2, table 3.1; defining).
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Gravitational constant times the Earth's mass with its atmosphere, m³/s² (TR8350.2, table 3.1; defining).
pub const GM_M3_S2: f64 = 3.986_004_418e14;
/// Rotation rate of the Earth `ω_ie`, rad/s (TR8350.2, table 3.1; defining).
pub const EARTH_RATE_RAD_S: f64 = 7.292_115e-5;
/// Semi-minor axis `b = a (1 − f)`, m.
pub const SEMI_MINOR_AXIS_M: f64 = SEMI_MAJOR_AXIS_M * (1.0 - FLATTENING);
/// First eccentricity squared `e² = f (2 − f)`.
pub const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);
/// Normal gravity on the ellipsoid at the equator, m/s² (TR8350.2, table 3.4).
pub const GRAVITY_EQUATOR_M_S2: f64 = 9.780_325_335_9;
/// Normal gravity on the ellipsoid at the poles, m/s² (TR8350.2, table 3.4).
pub const GRAVITY_POLE_M_S2: f64 = 9.832_184_937_8;
/// Usual density of the upper crust, kg/m³ (Heiskanen & Moritz 1967, §3-3).
pub const CRUST_DENSITY_KG_M3: f64 = 2670.0;
/// Newton's constant, m³/(kg s²) (CODATA 2018).
pub const GRAVITATIONAL_CONSTANT: f64 = 6.674_30e-11;

/// No mine is deeper; above it the latitude of a point is unique and [`Geodetic::from_ecef`] keeps its accuracy.
const LEAST_DISTANCE_FROM_CENTRE_M: f64 = 6.0e6;

/// A point by latitude, longitude and height above the WGS-84 ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Geodetic {
    /// Geodetic latitude, rad, −π/2 to π/2.
    pub latitude_rad: f64,
    /// Longitude, east positive, rad.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m; negative below it.
    pub height_m: f64,
}

impl Geodetic {
    /// From degrees; `None` when a number is not finite or the latitude is past a pole.
    pub fn from_degrees(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Option<Self> {
        let finite = longitude_deg.is_finite() && height_m.is_finite();
        (finite && latitude_deg.abs() <= 90.0).then(|| Self {
            latitude_rad: latitude_deg.to_radians(),
            longitude_rad: longitude_deg.to_radians(),
            height_m,
        })
    }

    /// Earth-fixed coordinates.
    pub fn to_ecef(&self) -> Position<Ecef> {
        let (sin_lat, cos_lat) = libm::sincos(self.latitude_rad);
        let (sin_lon, cos_lon) = libm::sincos(self.longitude_rad);
        let n = prime_vertical_radius_m(self.latitude_rad);
        let from_axis = (n + self.height_m) * cos_lat;
        let z = (n * (1.0 - ECCENTRICITY_SQUARED) + self.height_m) * sin_lat;
        Position::new(from_axis * cos_lon, from_axis * sin_lon, z)
    }

    /// From Earth-fixed coordinates, longitude in [−π, π]; at the poles it is what `atan2` makes of x and y.
    ///
    /// Bowring's formula with one repetition and his height formula, which hold at the poles as at the equator. From
    /// 100 km below the ellipsoid to 1000 km above it the point returned is within 5 nm of the one given: a few
    /// roundings of an `f64`. `None` when a coordinate is not finite or the point is within 6000 km of the
    /// Earth's centre.
    ///
    /// ```
    /// use adit_core::{frames::Position, geodesy::Geodetic};
    /// // EPSG Guidance Note 7-2, method 9602.
    /// let p = Geodetic::from_ecef(&Position::new(3_771_793.968, 140_253.342, 5_124_304.349)).unwrap();
    /// assert!((p.height_m - 73.0).abs() < 1e-3);
    /// ```
    pub fn from_ecef(position: &Position<Ecef>) -> Option<Self> {
        let (x, y, z) = (position.raw().x, position.raw().y, position.raw().z);
        let p = libm::hypot(x, y);
        let distance = libm::hypot(p, z);
        if !distance.is_finite() || distance < LEAST_DISTANCE_FROM_CENTRE_M {
            return None;
        }
        let (a, b, e2) = (SEMI_MAJOR_AXIS_M, SEMI_MINOR_AXIS_M, ECCENTRICITY_SQUARED);
        let second_e2 = e2 / (1.0 - e2);
        // Reduced latitude of the foot point, first guess: exact on the ellipsoid.
        let (mut sin_beta, mut cos_beta) = direction(z / b, p / a);
        let (mut sin_lat, mut cos_lat) = (0.0, 1.0);
        for _ in 0..2 {
            let rise = z + second_e2 * b * sin_beta * sin_beta * sin_beta;
            let run = p - e2 * a * cos_beta * cos_beta * cos_beta;
            (sin_lat, cos_lat) = direction(rise, run);
            (sin_beta, cos_beta) = direction(b * sin_lat, a * cos_lat);
        }
        Some(Self {
            latitude_rad: libm::atan2(sin_lat, cos_lat),
            longitude_rad: libm::atan2(y, x),
            height_m: p * cos_lat + z * sin_lat - a * libm::sqrt(1.0 - e2 * sin_lat * sin_lat),
        })
    }

    /// The local east-north-up frame with its origin at this point, as seen from the Earth-fixed one.
    ///
    /// ```
    /// use adit_core::{frames::Position, geodesy::Geodetic};
    /// let portal = Geodetic::from_degrees(48.0, 7.8, 310.0).unwrap();
    /// let to_enu = portal.enu_frame();
    /// let tag = to_enu.inverse().position(&Position::new(1200.0, -340.0, -95.0));
    /// assert!((to_enu.position(&tag).raw().x - 1200.0).abs() < 1e-8);
    /// ```
    pub fn enu_frame(&self) -> Transform<Ecef, Enu> {
        let (sin_lat, cos_lat) = libm::sincos(self.latitude_rad);
        let (sin_lon, cos_lon) = libm::sincos(self.longitude_rad);
        let axes = Matrix3::from_rows(&[
            RowVector3::new(-sin_lon, cos_lon, 0.0),
            RowVector3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
            RowVector3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
        ]);
        Transform::new(Rotation::from_raw(attitude::from_matrix(&axes)), self.to_ecef())
    }
}

/// Sine and cosine of `atan2(rise, run)`.
fn direction(rise: f64, run: f64) -> (f64, f64) {
    let length = libm::hypot(rise, run);
    (rise / length, run / length)
}

/// `1 − e² sin² φ`.
fn ellipse_term(latitude_rad: f64) -> f64 {
    let sin_lat = libm::sin(latitude_rad);
    1.0 - ECCENTRICITY_SQUARED * sin_lat * sin_lat
}

/// Radius of curvature in the meridian `R_M = a (1 − e²) / (1 − e² sin² φ)^{3/2}`, m.
pub fn meridian_radius_m(latitude_rad: f64) -> f64 {
    let term = ellipse_term(latitude_rad);
    SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / (term * libm::sqrt(term))
}

/// Radius of curvature in the prime vertical `R_N = a / (1 − e² sin² φ)^{1/2}`, m.
pub fn prime_vertical_radius_m(latitude_rad: f64) -> f64 {
    SEMI_MAJOR_AXIS_M / libm::sqrt(ellipse_term(latitude_rad))
}

/// Normal gravity on the ellipsoid, m/s²: Somigliana's closed form (TR8350.2, chapter 4), from the gravities at the
/// equator and at the poles.
pub fn normal_gravity_m_s2(latitude_rad: f64) -> f64 {
    const K: f64 = SEMI_MINOR_AXIS_M * GRAVITY_POLE_M_S2 / (SEMI_MAJOR_AXIS_M * GRAVITY_EQUATOR_M_S2) - 1.0;
    let sin_lat = libm::sin(latitude_rad);
    GRAVITY_EQUATOR_M_S2 * (1.0 + K * sin_lat * sin_lat) / libm::sqrt(ellipse_term(latitude_rad))
}

/// Normal gravity at a height above the ellipsoid, **in free air**, m/s²: second-order series in the height
/// (TR8350.2, chapter 4).
///
/// Within 7e-7 m/s² of the exact normal gravity from −4 km to 10 km: the gradient stops at first order in the
/// flattening. Real gravity differs from the normal one by some
/// 1e-3 m/s² at most (the local anomaly). Below ground this is too large by 2.2e-6 m/s² per metre of rock overhead: see
/// [`gravity_in_rock_m_s2`].
pub fn gravity_at_height_m_s2(latitude_rad: f64, height_m: f64) -> f64 {
    const M: f64 =
        EARTH_RATE_RAD_S * EARTH_RATE_RAD_S * SEMI_MAJOR_AXIS_M * SEMI_MAJOR_AXIS_M * SEMI_MINOR_AXIS_M
            / GM_M3_S2;
    let sin_lat = libm::sin(latitude_rad);
    let h = height_m / SEMI_MAJOR_AXIS_M;
    let gradient = 2.0 * (1.0 + FLATTENING + M - 2.0 * FLATTENING * sin_lat * sin_lat);
    normal_gravity_m_s2(latitude_rad) * (1.0 - gradient * h + 3.0 * h * h)
}

/// Normal gravity in a mine, `depth_m` of rock under the surface, m/s². `height_m` above the ellipsoid is that of the
/// point in the mine, not of the surface.
///
/// Poincaré and Prey's reduction: the rock overhead, taken as a wide flat plate, pulls up instead of down, so that
/// gravity grows with depth by 8.5e-7 m/s² per metre, not by the 3.1e-6 of free air (Heiskanen & Moritz 1967, §4-3).
/// 1000 m down the difference is 2.2e-3 m/s², as large as a good accelerometer's bias.
/// `density_kg_m3` is the mean over the depth, [`CRUST_DENSITY_KG_M3`] when unknown.
pub fn gravity_in_rock_m_s2(latitude_rad: f64, height_m: f64, depth_m: f64, density_kg_m3: f64) -> f64 {
    let plate_twice = 4.0 * core::f64::consts::PI * GRAVITATIONAL_CONSTANT * density_kg_m3 * depth_m;
    gravity_at_height_m_s2(latitude_rad, height_m) - plate_twice
}

/// Rotation of the Earth in local level axes, rad/s: `ω_ie (0, cos φ, sin φ)`.
pub fn earth_rate_rad_s(latitude_rad: f64) -> Vector<Enu> {
    let (sin_lat, cos_lat) = libm::sincos(latitude_rad);
    Vector::new(0.0, EARTH_RATE_RAD_S * cos_lat, EARTH_RATE_RAD_S * sin_lat)
}
