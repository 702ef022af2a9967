//! Where a local grid lies on the Earth: a similarity or an affine map fitted through control points.
//!
//! Control points are plumbed onto the plane that touches the ellipsoid's height of their mean, `p` (east, north); about the
//! means of both, with `g` the centred grid coordinates, the fit is `p = M g`:
//!
//! - similarity: `M = [a −b; b a]`, `a = Σ (g·p) / Σ |g|²`, `b = Σ (g × p) / Σ |g|²`;
//! - affine: `M = (Σ p gᵀ) (Σ g gᵀ)⁻¹`;
//!
//! the least-squares solutions (Ghilani, *Adjustment Computations*, 6th edition, chapter 18, which iterates to the same).
//! Heights differ by a constant. A mine is plumbed down its shafts, so a point below another has the same grid coordinates and the
//! same latitude and longitude.
//!
//! **Limits.** The plane is the tangent plane: 10 km from the middle it is 4 mm short, 30 km 0.1 m. The geoid's slope
//! against the ellipsoid is not modelled.

use crate::plan::{ControlPoint, Fit};
use adit_core::frames::{Enu, GridPlacement, MineGrid, Position};
use adit_core::geodesy::Geodetic;
use alloc::vec::Vec;
use nalgebra::{Matrix2, Vector2};

/// Narrowest spread of control points, as a share of the widest, for which an affine fit is not a guess across it.
const NARROWEST: f64 = 1e-3;
/// Control points closer together than this are one point, m.
const CLOSEST_M: f64 = 1.0;

/// A fitted grid.
#[derive(Debug, Clone, PartialEq)]
pub struct GridTie {
    origin: Geodetic,
    centre: Vector2<f64>,
    centre_height_m: f64,
    matrix: Matrix2<f64>,
    residuals: Vec<Residual>,
}

/// How far a control point lies from where the fit puts it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// In the plane, m.
    pub horizontal_m: f64,
    /// In height, m.
    pub vertical_m: f64,
}

/// Why no fit can be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TieError {
    /// Not enough points.
    #[error("found {found} control points, expected {expected} or more")]
    TooFew {
        /// Points given.
        found: usize,
        /// Points needed.
        expected: usize,
    },
    /// Points on one line, or in one place.
    #[error("the control points lie on one line to within {spread_m:.3} m")]
    OneLine {
        /// Spread across the line, m.
        spread_m: f64,
    },
    /// A latitude, longitude or height that is none.
    #[error("control point {index} is not on the Earth")]
    NotOnEarth {
        /// Which, from 0.
        index: usize,
    },
}

impl GridTie {
    /// Fits the map from the grid to the Earth.
    pub fn fit(points: &[ControlPoint], fit: Fit) -> Result<Self, TieError> {
        let expected = if fit == Fit::Similarity { 2 } else { 3 };
        let count = points.len();
        if count < expected {
            return Err(TieError::TooFew { found: count, expected });
        }
        let mut on_earth = Vec::with_capacity(count);
        for (index, p) in points.iter().enumerate() {
            let place = Geodetic::from_degrees(p.latitude_deg, p.longitude_deg, p.height_m);
            let grid = p.grid_m.raw();
            let finite = grid.iter().all(|v| v.is_finite());
            let fine = place.filter(|_| finite && p.longitude_deg.abs() <= 360.0 && p.height_m.abs() < 1e5);
            on_earth.push(fine.ok_or(TieError::NotOnEarth { index })?);
        }
        let origin = middle(&on_earth).ok_or(TieError::NotOnEarth { index: 0 })?;

        let plane: Vec<Vector2<f64>> = on_earth.iter().map(|p| onto_plane(&origin, p)).collect();
        let grid: Vec<Vector2<f64>> = points.iter().map(|p| p.grid_m.raw().xy()).collect();
        let mean = |v: &[Vector2<f64>]| v.iter().sum::<Vector2<f64>>() / count as f64;
        let (centre, plane_centre) = (mean(&grid), mean(&plane));
        let pairs = || grid.iter().zip(&plane).map(|(g, p)| (g - centre, p - plane_centre));

        let spread = pairs().map(|(g, _)| g * g.transpose()).sum::<Matrix2<f64>>();
        let (wide, narrow) = spreads_m(&spread);
        if wide < CLOSEST_M {
            return Err(TieError::OneLine { spread_m: wide });
        }
        let matrix = match fit {
            Fit::Similarity => {
                let square = spread.trace();
                let a = pairs().map(|(g, p)| g.dot(&p)).sum::<f64>() / square;
                let b = pairs().map(|(g, p)| g.x * p.y - g.y * p.x).sum::<f64>() / square;
                Matrix2::new(a, -b, b, a)
            }
            Fit::Affine => {
                let across = TieError::OneLine { spread_m: narrow };
                if narrow < NARROWEST * wide {
                    return Err(across);
                }
                let product = pairs().map(|(g, p)| p * g.transpose()).sum::<Matrix2<f64>>();
                product * spread.try_inverse().ok_or(across)?
            }
        };
        let offsets = || points.iter().map(|p| p.height_m - p.grid_m.raw().z);
        let offset = offsets().sum::<f64>() / count as f64;
        let residuals = pairs()
            .zip(offsets())
            .map(|((g, p), own)| Residual {
                horizontal_m: (matrix * g - p).norm(),
                vertical_m: (own - offset).abs(),
            })
            .collect();
        // The plane's own origin is moved to where the grid's middle is.
        let middle = from_plane(&origin, &plane_centre).ok_or(TieError::NotOnEarth { index: 0 })?;
        let centre_height_m = middle.height_m - offset;
        Ok(Self { origin: middle, centre, centre_height_m, matrix, residuals })
    }

    /// Residual of each control point, in their order.
    pub fn residuals(&self) -> &[Residual] {
        &self.residuals
    }

    /// Metres on the ground to a metre on the grid (the mean of all directions).
    pub fn scale(&self) -> f64 {
        libm::sqrt(self.matrix.determinant().abs())
    }

    /// True azimuth of grid north, rad; positive when it lies east of true north.
    pub fn convergence_rad(&self) -> f64 {
        libm::atan2(self.matrix[(0, 1)], self.matrix[(1, 1)])
    }

    /// Middle of the control points on the Earth: origin of [`Self::placement`]'s ENU frame.
    pub fn origin(&self) -> Geodetic {
        self.origin
    }

    /// The rigid part of the map, for [`adit_core`]: it leaves the scale and a skew out.
    pub fn placement(&self) -> GridPlacement {
        let origin = Position::new(self.centre.x, self.centre.y, self.centre_height_m);
        GridPlacement { origin, convergence_rad: self.convergence_rad() }
    }

    /// A point of the grid on the Earth; `None` when a coordinate is not finite or far from the Earth.
    pub fn to_geodetic(&self, position: &Position<MineGrid>) -> Option<Geodetic> {
        let p = position.raw();
        let plane = self.matrix * (p.xy() - self.centre);
        let place = from_plane(&self.origin, &plane)?;
        let height_m = p.z - self.centre_height_m + self.origin.height_m;
        height_m.is_finite().then_some(Geodetic { height_m, ..place })
    }

    /// A point of the Earth on the grid; `None` when the grid has no extent.
    pub fn to_grid(&self, place: &Geodetic) -> Option<Position<MineGrid>> {
        let grid = self.matrix.try_inverse()? * onto_plane(&self.origin, place) + self.centre;
        Some(Position::new(grid.x, grid.y, place.height_m - self.origin.height_m + self.centre_height_m))
    }
}

/// Mean of points that lie close together, by their mean in space.
fn middle(points: &[Geodetic]) -> Option<Geodetic> {
    let count = points.len() as f64;
    let sum = points.iter().map(|p| *p.to_ecef().raw()).sum::<nalgebra::Vector3<f64>>();
    let height_m = points.iter().map(|p| p.height_m).sum::<f64>() / count;
    Geodetic::from_ecef(&Position::from_raw(sum / count)).map(|middle| Geodetic { height_m, ..middle })
}

/// Plumbed to the height of `origin`, then east and north of it, m.
fn onto_plane(origin: &Geodetic, place: &Geodetic) -> Vector2<f64> {
    let plumbed = Geodetic { height_m: origin.height_m, ..*place };
    let enu: Position<Enu> = origin.enu_frame().position(&plumbed.to_ecef());
    enu.raw().xy()
}

/// The way back: the point of `origin`'s height above or below the plane's point.
fn from_plane(origin: &Geodetic, plane: &Vector2<f64>) -> Option<Geodetic> {
    let to_ecef = origin.enu_frame().inverse();
    let mut up_m = 0.0;
    let mut place = *origin;
    // The Earth curves away by d²/2R; each round leaves d²/R² of the error.
    for _ in 0..4 {
        place = Geodetic::from_ecef(&to_ecef.position(&Position::<Enu>::new(plane.x, plane.y, up_m)))?;
        up_m += origin.height_m - place.height_m;
    }
    Some(Geodetic { height_m: origin.height_m, ..place })
}

/// Root of the larger and of the smaller eigenvalue of a spread matrix, m.
fn spreads_m(spread: &Matrix2<f64>) -> (f64, f64) {
    let half_trace = 0.5 * spread.trace();
    let root = libm::hypot(0.5 * (spread[(0, 0)] - spread[(1, 1)]), spread[(0, 1)]);
    (libm::sqrt(half_trace + root), libm::sqrt((half_trace - root).max(0.0)))
}
