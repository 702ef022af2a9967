//! Where on Earth a mine's grid lies, whichever way the file says it.

use crate::grid_tie::GridTie;
use crate::plan::{Grid, MinePlan};
#[cfg(feature = "std")]
use crate::projection::Projection;
use adit_core::frames::{MineGrid, Position};
use adit_core::geodesy::Geodetic;
#[cfg(feature = "std")]
use alloc::boxed::Box;

/// The way from the mine's grid to the Earth and back.
#[derive(Debug, Clone, PartialEq)]
pub enum Georeference {
    /// A grid of the mine's own, tied by control points.
    Tied(GridTie),
    /// A projected system of the EPSG registry.
    #[cfg(feature = "std")]
    Projected(Box<Projection>),
}

impl Georeference {
    /// That of a plan; `None` for a local grid, or where the grid has an error that [`check`](crate::check()) tells (and, without
    /// the feature `std`, for an EPSG code).
    pub(crate) fn of(plan: &MinePlan) -> Option<Self> {
        match &plan.grid {
            Grid::Local {} => None,
            Grid::ControlPoints { fit, points, .. } => GridTie::fit(points, *fit).ok().map(Self::Tied),
            #[cfg(feature = "std")]
            Grid::Epsg { code } => Projection::epsg(*code).ok().map(Box::new).map(Self::Projected),
            #[cfg(not(feature = "std"))]
            Grid::Epsg { .. } => None,
        }
    }

    /// A point of the grid on the Earth (WGS-84; heights as far as the grid tells them); `None` where there is none.
    pub fn to_geodetic(&self, position: &Position<MineGrid>) -> Option<Geodetic> {
        match self {
            Self::Tied(tie) => tie.to_geodetic(position),
            #[cfg(feature = "std")]
            Self::Projected(projection) => projection.to_geodetic(position),
        }
    }

    /// A point of the Earth on the grid; `None` where there is none.
    pub fn to_grid(&self, place: &Geodetic) -> Option<Position<MineGrid>> {
        match self {
            Self::Tied(tie) => tie.to_grid(place),
            #[cfg(feature = "std")]
            Self::Projected(projection) => projection.to_grid(place),
        }
    }

    /// True azimuth of grid north, rad, positive when it lies east of true north: what a compass or a gyro on the grid must add.
    pub fn convergence_rad(&self, position: &Position<MineGrid>) -> Option<f64> {
        match self {
            Self::Tied(tie) => position.raw().x.is_finite().then(|| tie.convergence_rad()),
            #[cfg(feature = "std")]
            Self::Projected(projection) => projection.convergence_rad(position),
        }
    }
}
