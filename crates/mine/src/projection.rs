//! A grid that is a projected coordinate reference system of the EPSG registry.
//!
//! Definitions come from the registry as the crate `crs-definitions` keeps it, projections and datum shifts from `proj4rs`, a port of PROJ.4.
//! A system whose shift to WGS 84 needs a grid file is refused: tie such a mine by control points.
//!
//! **Limits.** A shift given by three or seven parameters is as good as these parameters, often some metres; between WGS 84 and
//! systems of the same ellipsoid and frame (UTM, ETRS89, CGCS2000) it is none. Heights are passed through: what the mine's datum adds to
//! the height above the ellipsoid (the geoid) is not known here.

use adit_core::frames::{Enu, MineGrid, Position};
use adit_core::geodesy::Geodetic;
use alloc::string::{String, ToString};
use core::fmt;
use proj4rs::Proj;
use proj4rs::transform::transform;

/// Step over which differences are taken, m.
const STEP_M: f64 = 10.0;
const WGS84: &str = "+proj=longlat +datum=WGS84 +no_defs";

/// A projected system, to and from latitude and longitude.
#[derive(Clone)]
pub struct Projection {
    code: u16,
    system: Proj,
    wgs84: Proj,
}

/// Why a code is no grid of a mine.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProjectionError {
    /// The registry has no such code.
    #[error("EPSG:{code} is not in the registry")]
    Unknown {
        /// The code.
        code: u32,
    },
    /// Degrees, or metres from the Earth's centre.
    #[error("EPSG:{code} is not a projected system in metres")]
    NotProjected {
        /// The code.
        code: u32,
    },
    /// Feet.
    #[error("EPSG:{code} has a unit of {metres} m, expected metres")]
    NotMetres {
        /// The code.
        code: u32,
        /// Its unit, m, as text.
        metres: String,
    },
    /// A projection, an axis order or a shift grid that is not to be had.
    #[error("EPSG:{code} cannot be computed here: {what}")]
    Unsupported {
        /// The code.
        code: u32,
        /// Why.
        what: String,
    },
}

impl Projection {
    /// The system of an EPSG code.
    pub fn epsg(code: u32) -> Result<Self, ProjectionError> {
        let unknown = ProjectionError::Unknown { code };
        let short = u16::try_from(code).map_err(|_| unknown.clone())?;
        let definition = crs_definitions::from_code(short).ok_or(unknown)?;
        let unsupported = |what: String| ProjectionError::Unsupported { code, what };
        let parsed =
            |text: &str| Proj::from_proj_string(text).map_err(|error| unsupported(error.to_string()));
        if ["+proj=longlat", "+proj=geocent"].iter().any(|geographic| definition.proj4.contains(geographic)) {
            return Err(ProjectionError::NotProjected { code });
        }
        if definition.proj4.trim().is_empty() {
            return Err(unsupported("the registry gives no definition".to_string()));
        }
        let (system, wgs84) = (parsed(definition.proj4)?, parsed(WGS84)?);
        if (system.to_meter() - 1.0).abs() > 0.0 {
            return Err(ProjectionError::NotMetres { code, metres: system.to_meter().to_string() });
        }
        if !system.is_normalized_axis() {
            return Err(unsupported("its axes do not point east, north, up".to_string()));
        }
        if !(system.has_inverse() && system.has_forward()) {
            return Err(unsupported("its projection goes one way only".to_string()));
        }
        Ok(Self { code: short, system, wgs84 })
    }

    /// The EPSG code.
    pub fn code(&self) -> u32 {
        self.code.into()
    }

    /// A point of the grid on the Earth; `None` where the projection has none.
    pub fn to_geodetic(&self, position: &Position<MineGrid>) -> Option<Geodetic> {
        let p = position.raw();
        let mut point = (p.x, p.y, 0.0);
        transform(&self.system, &self.wgs84, &mut point).ok()?;
        let (longitude_rad, latitude_rad) = (point.0, point.1);
        Geodetic::from_degrees(latitude_rad.to_degrees(), longitude_rad.to_degrees(), p.z)
    }

    /// A point of the Earth on the grid; `None` where the projection has none.
    pub fn to_grid(&self, place: &Geodetic) -> Option<Position<MineGrid>> {
        let mut point = (place.longitude_rad, place.latitude_rad, 0.0);
        transform(&self.wgs84, &self.system, &mut point).ok()?;
        let finite = point.0.is_finite() && point.1.is_finite();
        finite.then(|| Position::new(point.0, point.1, place.height_m))
    }

    /// True azimuth of grid north at a point, rad, positive east of true north: by a difference over 10 m.
    pub fn convergence_rad(&self, position: &Position<MineGrid>) -> Option<f64> {
        self.step_north(position).map(|way| libm::atan2(way.raw().x, way.raw().y))
    }

    /// Metres on the ellipsoid to a metre of the grid, northwards, at a point.
    pub fn scale(&self, position: &Position<MineGrid>) -> Option<f64> {
        let p = position.raw();
        let way = self.step_north(&Position::new(p.x, p.y, 0.0))?;
        Some(way.raw().norm() / STEP_M)
    }

    /// Where one goes on the Earth, going [`STEP_M`] north on the grid.
    fn step_north(&self, position: &Position<MineGrid>) -> Option<Position<Enu>> {
        let here = self.to_geodetic(position)?;
        let p = position.raw();
        let north = self.to_geodetic(&Position::new(p.x, p.y + STEP_M, p.z))?;
        Some(here.enu_frame().position(&north.to_ecef()))
    }
}

impl fmt::Debug for Projection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Projection(EPSG:{})", self.code)
    }
}

impl PartialEq for Projection {
    fn eq(&self, other: &Self) -> bool {
        self.code == other.code
    }
}
