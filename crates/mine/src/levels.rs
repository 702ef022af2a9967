//! Which level a height belongs to.

use crate::plan::Level;
use alloc::vec::Vec;

/// Levels by height. A height belongs to the level whose elevation is nearest; borders lie half-way.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Levels {
    /// Elevation and index in the plan, lowest first.
    order: Vec<(f64, usize)>,
}

impl Levels {
    /// Sorts the levels of a plan.
    pub fn new(levels: &[Level]) -> Self {
        let mut order: Vec<(f64, usize)> = levels.iter().map(|l| l.elevation_m).zip(0..).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { order }
    }

    /// Index in the plan of the level that a height belongs to; `None` without levels.
    pub fn of(&self, z_m: f64) -> Option<usize> {
        let above = self.order.partition_point(|(elevation, _)| *elevation < z_m);
        let near = self.order.get(above.saturating_sub(1)..self.order.len().min(above + 1))?;
        let nearest = near.iter().min_by(|a, b| (a.0 - z_m).abs().total_cmp(&(b.0 - z_m).abs()))?;
        Some(nearest.1)
    }

    /// Lowest and highest height of a level; without bound below the lowest and above the highest.
    pub fn band_m(&self, level: usize) -> (f64, f64) {
        let Some(at) = self.order.iter().position(|(_, index)| *index == level) else {
            return (f64::NEG_INFINITY, f64::INFINITY);
        };
        let half_way = |a: usize, b: usize| Some(0.5 * (self.order.get(a)?.0 + self.order.get(b)?.0));
        let low = at.checked_sub(1).and_then(|below| half_way(below, at));
        (low.unwrap_or(f64::NEG_INFINITY), half_way(at, at + 1).unwrap_or(f64::INFINITY))
    }
}
