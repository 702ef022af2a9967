//! What the coordinates mean.

use super::Checks;
use crate::finding::Place;
use crate::grid_tie::{GridTie, TieError};
use crate::plan::{Fit, Grid};
use crate::problem::Problem;
use alloc::string::ToString;

/// Where a projection is made for, a metre of it is one to within 0.3 %; where it is not, it may be anything.
#[cfg(feature = "std")]
const PROJECTION_LIMIT: f64 = 0.02;
/// Largest difference of a grid's metre from the ground's: projections stay within 0.04 %, great depth and height add
/// 0.02 % each.
const SCALE_LIMIT: f64 = 1e-3;

impl Checks<'_> {
    pub(super) fn grid(&mut self) {
        match &self.plan.grid {
            Grid::Local {} => {}
            Grid::Epsg { code } => self.projection(*code),
            Grid::ControlPoints { fit, tolerance_m, points } => {
                let place = Place::key("grid").at("points");
                let tie = match GridTie::fit(points, *fit) {
                    Ok(tie) => tie,
                    Err(error) => {
                        let place = match error {
                            TieError::NotOnEarth { index } => place.nth(index),
                            _ => place,
                        };
                        return self.report(place, Problem::NoTie { what: error.to_string() });
                    }
                };
                let exact = if *fit == Fit::Similarity { 2 } else { 3 };
                if points.len() == exact {
                    self.report(place.clone(), Problem::NothingSpare { found: exact });
                }
                // One wrong point pulls the others along: the worst is told.
                let residuals = tie.residuals().iter().map(|r| r.horizontal_m.max(r.vertical_m));
                let worst = residuals.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
                if let Some((index, residual_m)) = worst.filter(|(_, residual_m)| residual_m > tolerance_m) {
                    let (id, tolerance_m) = (points[index].id.clone(), *tolerance_m);
                    let problem = Problem::LargeResidual { id, residual_m, tolerance_m };
                    self.report(place.clone().nth(index), problem);
                }
                if (tie.scale() - 1.0).abs() > SCALE_LIMIT {
                    self.report(place, Problem::OddScale { scale: tie.scale() });
                }
            }
        }
    }
    /// The code is one of a projected system, and the roadways lie where it is made for.
    #[cfg(feature = "std")]
    fn projection(&mut self, code: u32) {
        use crate::projection::{Projection, ProjectionError};
        let problem = match Projection::epsg(code) {
            Ok(projection) => {
                let first = self.plan.roadways.iter().flat_map(|roadway| &roadway.points_m).next();
                let Some(first) = first.filter(|p| p.raw().iter().all(|v| v.is_finite())) else { return };
                if projection.scale(first).is_some_and(|scale| (scale - 1.0).abs() < PROJECTION_LIMIT) {
                    return;
                }
                Problem::OffProjection { code, east_m: first.raw().x, north_m: first.raw().y }
            }
            Err(ProjectionError::NotProjected { code }) => Problem::NotProjected { code },
            Err(other) => Problem::NoProjection { what: other.to_string() },
        };
        self.report(Place::key("grid").at("code"), problem);
    }

    /// Without the registry a code is taken as it stands.
    #[cfg(not(feature = "std"))]
    #[expect(clippy::unused_self, reason = "the same call as with the registry")]
    fn projection(&mut self, _code: u32) {}
}
