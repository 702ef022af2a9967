//! Coordinates as clients want and give them.

use crate::api::ApiError;
use adit_core::frames::{MineGrid, Position};
use adit_core::geodesy::Geodetic;
use adit_mine::projection::Projection;
use adit_mine::{Georeference, Mine};

/// A coordinate reference system.
#[derive(Debug, Clone)]
pub(super) enum Crs {
    /// The mine's grid.
    Local,
    /// Longitude and latitude, degrees, height above the ellipsoid, m (EPSG:4326 in the order of `GeoJSON`).
    Wgs84(Box<Georeference>),
    /// Easting, northing, height of another projected system.
    Projected(Box<Georeference>, Box<Projection>),
}

impl Crs {
    /// The system of that name; `local` where none is given.
    pub(super) fn named(name: Option<&str>, mine: &Mine) -> Result<Self, ApiError> {
        let name = name.unwrap_or("local");
        if name.eq_ignore_ascii_case("local") {
            return Ok(Self::Local);
        }
        let unknown =
            || ApiError::invalid(format!("crs: expected `local` or `EPSG:` and a code, found {name:?}"));
        let (authority, code) = name.split_once(':').ok_or_else(unknown)?;
        let code: u32 = code.parse().map_err(|_| unknown())?;
        if !authority.eq_ignore_ascii_case("epsg") {
            return Err(unknown());
        }
        let nowhere =
            || ApiError::invalid("crs: where on Earth the mine lies is not known; only `local` can be given");
        let earth = Box::new(mine.georeference().ok_or_else(nowhere)?);
        // 4979 is 4326 with the height; 4490 is CGCS2000, the same within decimetres.
        if matches!(code, 4326 | 4979 | 4490) {
            return Ok(Self::Wgs84(earth));
        }
        match Projection::epsg(code) {
            Ok(projection) => Ok(Self::Projected(earth, Box::new(projection))),
            Err(error) => Err(ApiError::invalid(format!("crs: {error}"))),
        }
    }

    /// As it is written.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Local => "local".into(),
            Self::Wgs84(_) => "EPSG:4326".into(),
            Self::Projected(_, projection) => format!("EPSG:{}", projection.code()),
        }
    }

    /// East (or longitude), north (or latitude), height; `None` where the system does not reach.
    pub(super) fn write(&self, position: &Position<MineGrid>) -> Option<[f64; 3]> {
        match self {
            Self::Local => Some((*position.raw()).into()),
            Self::Wgs84(earth) => {
                let place = earth.to_geodetic(position)?;
                Some([place.longitude_rad.to_degrees(), place.latitude_rad.to_degrees(), place.height_m])
            }
            Self::Projected(earth, projection) => {
                Some((*projection.to_grid(&earth.to_geodetic(position)?)?.raw()).into())
            }
        }
    }

    /// A position on the mine's grid.
    pub(super) fn read(&self, [x, y, z]: [f64; 3]) -> Option<Position<MineGrid>> {
        match self {
            Self::Local => Some(Position::new(x, y, z)),
            Self::Wgs84(earth) => earth.to_grid(&Geodetic::from_degrees(y, x, z)?),
            Self::Projected(earth, projection) => {
                earth.to_grid(&projection.to_geodetic(&Position::new(x, y, z))?)
            }
        }
    }
}

/// The floor of a level as omlox counts: 0 for the highest, −1 for the one below.
pub(super) fn floor_of(mine: &Mine, level: &str) -> Option<i64> {
    let levels = &mine.plan().levels;
    let of = levels.iter().find(|known| known.id == level)?;
    let above = levels.iter().filter(|other| other.elevation_m > of.elevation_m).count();
    Some(-i64::try_from(above).ok()?)
}

/// The level of a floor.
pub(super) fn level_of(mine: &Mine, floor: f64) -> Option<&adit_mine::plan::Level> {
    mine.plan()
        .levels
        .iter()
        .find(|level| floor_of(mine, &level.id).is_some_and(|of| (of as f64 - floor).abs() < 0.5))
}
