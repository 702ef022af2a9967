//! The Earth's magnetic field: where compass north is, how steep and how strong the field.
//!
//! The World Magnetic Model of NOAA and the British Geological Survey (Chulliat et al. 2025), by the crate `world_magnetic_model`, which
//! carries the coefficients of 2020 and 2025: days from 2020-01-01 to 2029-12-31. The model holds the field of the Earth's core; rock
//! (magnetite, basalt) bends it by degrees over an ore body, and steel supports do so anywhere. Its own error of the declination
//! is 0.26° and 5417 nT/H (WMM2025, section 3.4).

use crate::error::TuningError;
use adit_core::time::Time;
use serde::Serialize;
use std::fmt;
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::{Date, Month, OffsetDateTime};
use world_magnetic_model::uom::si::angle::degree;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;
use world_magnetic_model::uom::si::magnetic_flux_density::microtesla;

/// Years for which coefficients are at hand.
const FIRST_YEAR: i32 = 2020;
const LAST_YEAR: i32 = 2029;
/// Lowest height of the model, m. Deeper mines take it: a kilometre changes the field by 0.05 %.
const LOWEST_M: f64 = -1000.0;

/// A place on the Earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Geodetic latitude, WGS 84, deg, north positive.
    pub latitude_deg: f64,
    /// Longitude, deg, east positive.
    pub longitude_deg: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
}

/// A day of the calendar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Day {
    /// Year.
    pub year: i32,
    /// Month, from 1.
    pub month: u8,
    /// Day of the month, from 1.
    pub day: u8,
}

impl Day {
    /// The day of a Unix time (UTC); `None` for times that are counted from elsewhere, like the start of a log: days on which the model
    /// does not hold.
    pub fn of_unix(time: Time) -> Option<Self> {
        let date = OffsetDateTime::from_unix_timestamp_nanos(i128::from(time.nanos())).ok()?.date();
        (FIRST_YEAR..=LAST_YEAR).contains(&date.year()).then(|| Self {
            year: date.year(),
            month: date.month().into(),
            day: date.day(),
        })
    }
}

impl fmt::Display for Day {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

/// The field of a place and a day.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SiteField {
    /// From true to magnetic north, east positive, deg.
    pub declination_deg: f64,
    /// σ of the model's declination, deg.
    pub declination_sd_deg: f64,
    /// Below the horizontal, deg.
    pub dip_deg: f64,
    /// Magnetic flux density, µT.
    pub norm_ut: f64,
    /// Near a magnetic pole (horizontal field below 6 µT), where a compass is not to be trusted.
    pub near_pole: bool,
}

/// The field by the World Magnetic Model.
pub fn field(site: &Site, day: &Day) -> Result<SiteField, TuningError> {
    let fail = |reason: String| TuningError::NoMagneticModel { reason };
    let date = Month::try_from(day.month)
        .and_then(|month| Date::from_calendar_date(day.year, month, day.day))
        .map_err(|error| fail(error.to_string()))?;
    // The model wants −180° to 180°.
    let longitude_deg = (site.longitude_deg + 180.0).rem_euclid(360.0) - 180.0;
    #[expect(clippy::cast_possible_truncation, reason = "the model calculates in single precision")]
    let [latitude, longitude, height] =
        [site.latitude_deg, longitude_deg, site.height_m.max(LOWEST_M)].map(|value| value as f32);
    let field = GeomagneticField::new(
        Length::new::<meter>(height),
        Angle::new::<degree>(latitude),
        Angle::new::<degree>(longitude),
        date,
    )
    .map_err(|error| fail(error.to_string()))?;
    Ok(SiteField {
        declination_deg: f64::from(field.declination().get::<degree>()),
        declination_sd_deg: f64::from(field.declination_uncertainty().get::<degree>()),
        dip_deg: f64::from(field.inclination().get::<degree>()),
        norm_ut: f64::from(field.f().get::<microtesla>()),
        near_pole: field.declination_warning().is_some(),
    })
}
