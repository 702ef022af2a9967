//! The Earth's field at one site.

use crate::error::{SimulationError, check_within};
use adit_core::nalgebra::Vector3;
use core::f64::consts::{FRAC_PI_2, PI};
use serde::{Deserialize, Serialize};

/// The undisturbed field, the same over a whole site: `B = F (cos I sin D, cos I cos D, −sin I)` in ENU.
///
/// Magnetic north lies at the true bearing `D`: a compass on this site shows `heading − D`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EarthField {
    /// Flux density `F`, µT.
    pub norm_ut: f64,
    /// Dip (inclination) `I`, rad, positive downwards: the northern hemisphere.
    pub dip_rad: f64,
    /// Declination `D`, rad, positive where magnetic north lies east of true north.
    pub declination_rad: f64,
}

impl Default for EarthField {
    /// The basketball court of spec S3, see [`EarthField::harbin`].
    fn default() -> Self {
        Self::harbin()
    }
}

impl EarthField {
    /// Harbin Engineering University, 45.776° N 126.68° E, 140 m: 55.28 µT, dip 63.39°, declination 10.61° **west**.
    ///
    /// World Magnetic Model `WMM2015v2` at 2015.0 (its own standard errors there: 0.15 µT, 0.2°, 0.4°).
    pub const fn harbin() -> Self {
        Self {
            norm_ut: 55.281,
            dip_rad: 63.387_f64.to_radians(),
            declination_rad: (-10.610_f64).to_radians(),
        }
    }

    /// East, north and up components, µT.
    pub fn enu_ut(&self) -> Vector3<f64> {
        let (sin_dip, cos_dip) = libm::sincos(self.dip_rad);
        let (sin_declination, cos_declination) = libm::sincos(self.declination_rad);
        self.norm_ut * Vector3::new(cos_dip * sin_declination, cos_dip * cos_declination, -sin_dip)
    }

    /// A field of this Earth: 0 (none) to 100 µT; it has 22 to 67 at the surface.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("norm_ut", self.norm_ut, 0.0, 100.0, "0 to 100 µT")?;
        check_within("dip_rad", self.dip_rad, -FRAC_PI_2, FRAC_PI_2, "-90 to 90 degrees")?;
        check_within("declination_rad", self.declination_rad, -PI, PI, "-180 to 180 degrees")
    }
}
