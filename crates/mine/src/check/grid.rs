//! What the coordinates mean.

use super::Checks;
use crate::finding::Place;
use crate::grid_tie::{GridTie, TieError};
use crate::plan::{Fit, Grid};
use crate::problem::Problem;
use alloc::string::ToString;

/// Geographic systems that people give by mistake: WGS 84, CGCS2000, NAD83, ETRS89, NAD27, Pulkovo 1942, Xian 1980,
/// Beijing 1954, geocentric and three-dimensional WGS 84.
const GEOGRAPHIC: [u32; 10] = [4326, 4490, 4269, 4258, 4267, 4284, 4610, 4214, 4978, 4979];
/// Codes of coordinate reference systems.
const CODES: core::ops::RangeInclusive<u32> = 1024..=32767;
/// Largest difference of a grid's metre from the ground's: projections stay within 0.04 %, great depth and height add
/// 0.02 % each.
const SCALE_LIMIT: f64 = 1e-3;

impl Checks<'_> {
    pub(super) fn grid(&mut self) {
        match &self.plan.grid {
            Grid::Local {} => {}
            Grid::Epsg { code } => {
                if GEOGRAPHIC.contains(code) || !CODES.contains(code) {
                    self.report(Place::key("grid").at("code"), Problem::NotProjected { code: *code });
                }
            }
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
}
