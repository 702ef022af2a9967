//! Places where a tag can be: a square lattice over the surveyed part of each floor.

use adit_core::nalgebra::Vector2;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Points of a square lattice, those near where people walk; one slab to each floor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lattice {
    origin_m: Vector2<f64>,
    step_m: f64,
    columns: usize,
    rows: usize,
    floors: Vec<i32>,
    /// Lattice index of each place, rising: `(slab · rows + row) · columns + column`.
    places: Vec<u32>,
}

/// Points of all slabs together, at most: a mine of 2 × 2 km at 1 m.
const MOST_POINTS: f64 = 4e6;

impl Lattice {
    /// All points within `reach_m` of a spot where people are, on the spot's floor, `step_m` apart.
    ///
    /// `None` of no spots, of steps that are not positive, or where it would have more than four million points.
    pub fn around(spots: &[(Vector2<f64>, i32)], step_m: f64, reach_m: f64) -> Option<Self> {
        let usable = step_m > 0.0 && reach_m >= 0.0 && step_m.is_finite() && reach_m.is_finite();
        if !usable || spots.is_empty() || spots.iter().any(|(spot, _)| !spot.iter().all(|v| v.is_finite())) {
            return None;
        }
        let mut floors: Vec<i32> = spots.iter().map(|(_, floor)| *floor).collect();
        floors.sort_unstable();
        floors.dedup();
        let low = spots.iter().fold(spots[0].0, |low, (spot, _)| low.inf(spot)).add_scalar(-reach_m);
        let high = spots.iter().fold(spots[0].0, |high, (spot, _)| high.sup(spot)).add_scalar(reach_m);
        let count = (high - low).map(|extent| libm::ceil(extent / step_m) + 1.0);
        if count.x * count.y * floors.len() as f64 > MOST_POINTS {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded just above")]
        let (columns, rows) = (count.x as usize, count.y as usize);
        let mut lattice = Self { origin_m: low, step_m, columns, rows, floors, places: Vec::new() };
        let mut open = alloc::vec![false; columns * rows * lattice.floors.len()];
        for (spot, floor) in spots {
            let Some(slab) = lattice.floors.iter().position(|known| known == floor) else { continue };
            lattice.mark(spot, slab, reach_m, &mut open);
        }
        let indices = open.iter().zip(0_u32..).filter(|(open, _)| **open).map(|(_, index)| index);
        lattice.places = indices.collect();
        Some(lattice)
    }

    /// All points of a rectangle on one floor, number 0; `None` as for [`Self::around`].
    pub fn within(low_m: &Vector2<f64>, high_m: &Vector2<f64>, step_m: f64) -> Option<Self> {
        let count = (high_m - low_m).map(|extent| libm::floor(extent / step_m) + 1.0);
        if !(count.x >= 1.0 && count.y >= 1.0 && count.x * count.y <= MOST_POINTS && step_m > 0.0) {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded just above")]
        let (columns, rows, points) = (count.x as usize, count.y as usize, (count.x * count.y) as u32);
        let lattice = Self {
            origin_m: *low_m,
            step_m,
            columns,
            rows,
            floors: alloc::vec![0],
            places: (0..points).collect(),
        };
        lattice.is_sound().then_some(lattice)
    }

    fn mark(&self, spot: &Vector2<f64>, slab: usize, reach_m: f64, open: &mut [bool]) {
        let local = (spot - self.origin_m) / self.step_m;
        let reach = reach_m / self.step_m + 0.5;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the lattice, which was made around the spots"
        )]
        let span = |centre: f64, count: usize| {
            (
                libm::floor(centre - reach).max(0.0) as usize,
                (libm::ceil(centre + reach) as usize).min(count - 1),
            )
        };
        let ((left, right), (bottom, top)) = (span(local.x, self.columns), span(local.y, self.rows));
        for row in bottom..=top {
            for column in left..=right {
                let away = Vector2::new(column as f64, row as f64) - local;
                // Half a step more, so that a spot always has a place.
                if away.norm() <= reach.max(core::f64::consts::FRAC_1_SQRT_2) {
                    open[(slab * self.rows + row) * self.columns + column] = true;
                }
            }
        }
    }

    /// How many places.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there are none; never of a lattice that was made.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// From place to place, m.
    pub fn step_m(&self) -> f64 {
        self.step_m
    }

    /// Floors, rising.
    pub fn floors(&self) -> &[i32] {
        &self.floors
    }

    /// East, north, m, and floor of a place; the last place for an index past the end.
    #[inline]
    pub fn place(&self, index: usize) -> (Vector2<f64>, i32) {
        let point = self.places.get(index).or(self.places.last()).map_or(0, |point| *point as usize);
        let (line, column) = (point / self.columns, point % self.columns);
        let (slab, row) = (line / self.rows, line % self.rows);
        let position = self.origin_m + Vector2::new(column as f64, row as f64) * self.step_m;
        (position, self.floors.get(slab).copied().unwrap_or_default())
    }

    /// All places in order.
    pub fn iter(&self) -> impl Iterator<Item = (Vector2<f64>, i32)> + Clone + '_ {
        (0..self.len()).map(|index| self.place(index))
    }

    /// Columns and lines of the whole slabs, one above the other, and the point of each place in them.
    pub(super) fn slabs(&self) -> (usize, usize, usize, &[u32]) {
        (self.columns, self.rows, self.floors.len(), &self.places)
    }

    /// Whether what was read from a file hangs together.
    pub fn is_sound(&self) -> bool {
        let points = self.columns as f64 * self.rows as f64 * self.floors.len() as f64;
        let rising = self.places.windows(2).all(|pair| pair[0] < pair[1]);
        self.step_m > 0.0
            && self.step_m.is_finite()
            && self.origin_m.iter().all(|value| value.is_finite())
            && points > 0.0
            && points <= MOST_POINTS
            && rising
            && self.places.last().is_some_and(|last| f64::from(*last) < points)
    }
}
