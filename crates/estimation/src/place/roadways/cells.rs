//! Pieces found by place: a grid of square cells over the map.

use super::piece::Piece;
use adit_core::nalgebra::Vector2;
use alloc::vec;
use alloc::vec::Vec;

/// Side of a cell, m, unless the mine is so wide that it takes larger ones.
const CELL_M: f64 = 40.0;
/// Most cells.
const MOST: f64 = 65_536.0;

/// For each cell the pieces that come into it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cells {
    corner_m: Vector2<f64>,
    side_m: f64,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    pieces: Vec<u32>,
}

impl Cells {
    pub fn new(pieces: &[Piece]) -> Self {
        let ends = || pieces.iter().flat_map(|piece| [0.0, piece.length_m].map(|along| piece.at(along).xy()));
        let Some(first) = ends().next() else { return Self::default() };
        let (low, high) = ends().fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
        let span = high - low;
        let mut side_m = CELL_M;
        while (span.x / side_m + 1.0) * (span.y / side_m + 1.0) > MOST {
            side_m *= 2.0;
        }
        let mut cells = Self { corner_m: low, side_m, ..Self::default() };
        (cells.columns, cells.rows) = (cells.step(span.x) + 1, cells.step(span.y) + 1);
        let mut counts = vec![0_u32; cells.columns * cells.rows + 1];
        cells.visit(pieces, |cell, _| counts[cell + 1] += 1);
        for cell in 1..counts.len() {
            counts[cell] += counts[cell - 1];
        }
        let mut filled = counts.clone();
        let mut listed = vec![0; counts.last().map_or(0, |all| *all as usize)];
        cells.visit(pieces, |cell, piece| {
            listed[filled[cell] as usize] = piece;
            filled[cell] += 1;
        });
        (cells.starts, cells.pieces) = (counts, listed);
        cells
    }

    /// Every cell that the box about a piece meets.
    fn visit(&self, pieces: &[Piece], mut each: impl FnMut(usize, u32)) {
        for (index, piece) in (0_u32..).zip(pieces) {
            let [a, b] = [0.0, piece.length_m].map(|along| piece.at(along).xy());
            let (columns, rows) = self.block(&a.inf(&b), &a.sup(&b));
            for row in rows {
                for column in columns.clone() {
                    each(row * self.columns + column, index);
                }
            }
        }
    }

    fn block(
        &self,
        low: &Vector2<f64>,
        high: &Vector2<f64>,
    ) -> (core::ops::RangeInclusive<usize>, core::ops::RangeInclusive<usize>) {
        let (low, high) = (low - self.corner_m, high - self.corner_m);
        let range = |from: f64, to: f64, count: usize| {
            let last = count.saturating_sub(1);
            self.step(from).min(last)..=self.step(to).min(last)
        };
        (range(low.x, high.x, self.columns), range(low.y, high.y, self.rows))
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, as it should")]
    fn step(&self, off_m: f64) -> usize {
        (off_m / self.side_m) as usize
    }

    /// Pieces in the cells within reach, each once, ascending.
    pub fn within(&self, place_m: &Vector2<f64>, reach_m: f64) -> Vec<u32> {
        let mut found = Vec::new();
        if self.pieces.is_empty() {
            return found;
        }
        let (columns, rows) = self.block(&place_m.add_scalar(-reach_m), &place_m.add_scalar(reach_m));
        for row in rows {
            let line = row * self.columns;
            let (from, to) = (self.starts[line + columns.start()], self.starts[line + columns.end() + 1]);
            found.extend_from_slice(&self.pieces[from as usize..to as usize]);
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    pub fn bytes(&self) -> usize {
        4 * (self.starts.len() + self.pieces.len())
    }
}
