//! What is known of a place and of a start beside the log.

use adit_core::attitude::{self, Attitude};
use adit_core::geodesy::Geodetic;
use adit_core::nalgebra::Vector3;
use core::f64::consts::FRAC_PI_2;
use serde::{Deserialize, Serialize};

/// Where on Earth the origin of the level frame lies: fixes and solutions count from there, east, north and up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Site {
    /// Geodetic latitude (WGS-84), deg, −89 to 89.
    pub latitude_deg: f64,
    /// Longitude, east positive, deg.
    pub longitude_deg: f64,
    /// Height above the ellipsoid, m.
    #[serde(default)]
    pub height_m: f64,
}

/// Where the wearer is at the first inertial sample, and how the tag is turned, as somebody told the log.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartPose {
    /// Position (east, north) in the frame of the site, m.
    pub position_m: [f64; 2],
    /// Its standard deviation (east, north), m.
    pub position_sigma_m: [f64; 2],
    /// Heading of the body's x axis, clockwise from north, deg.
    pub heading_deg: f64,
    /// Elevation of the body's x axis above the horizon, deg.
    #[serde(default)]
    pub pitch_deg: f64,
    /// Turn about the body's x axis, left side up positive, deg.
    #[serde(default)]
    pub roll_deg: f64,
    /// Standard deviation of each of the three angles, deg.
    pub attitude_sigma_deg: f64,
}

impl Site {
    /// As a point; `None` when it cannot be one, or lies within a degree of a pole, where east and north end.
    pub fn point(&self) -> Option<Geodetic> {
        let height = (-20_000.0..=20_000.0).contains(&self.height_m);
        Geodetic::from_degrees(self.latitude_deg, self.longitude_deg, self.height_m)
            .filter(|_| height && self.latitude_deg.abs() <= 89.0 && self.longitude_deg.abs() <= 360.0)
    }
}

impl StartPose {
    /// Body to level.
    pub fn attitude(&self) -> Attitude {
        let (heading, pitch, roll) =
            (self.heading_deg.to_radians(), self.pitch_deg.to_radians(), self.roll_deg.to_radians());
        attitude::exp(&(Vector3::z() * (FRAC_PI_2 - heading)))
            * attitude::exp(&(Vector3::y() * -pitch))
            * attitude::exp(&(Vector3::x() * roll))
    }

    /// Heading, pitch and roll of an attitude, deg: the inverse of [`Self::attitude`].
    pub fn angles_deg(attitude: &Attitude) -> [f64; 3] {
        let up = attitude.inverse_transform_vector(&Vector3::z());
        let pitch = libm::asin(up.x.clamp(-1.0, 1.0));
        let roll = libm::atan2(up.y, up.z);
        [attitude::heading(attitude), pitch, roll].map(f64::to_degrees)
    }

    /// All numbers are finite, and no standard deviation is below zero or beyond sense.
    pub fn is_usable(&self) -> bool {
        let [east, north] = self.position_sigma_m;
        let sigma = |v: f64, most: f64| (0.0..=most).contains(&v);
        let finite =
            [self.position_m[0], self.position_m[1], self.heading_deg, self.pitch_deg, self.roll_deg];
        finite.iter().all(|v| v.abs() <= 1e7)
            && sigma(east, 1e7)
            && sigma(north, 1e7)
            && sigma(self.attitude_sigma_deg, 180.0)
    }
}
