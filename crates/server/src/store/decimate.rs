//! A long track in few points that keep its shape: Douglas & Peucker (1973), "Algorithms for the reduction of the number of points
//! required to represent a digitized line", Cartographica 10(2); the worst point first, until the points are used up.

use crate::store::packed::PackedFix;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

const METRES_PER_CENTIMETRE: f64 = 0.01;
/// While a track comes in, so many times the points asked for are kept.
const KEPT: usize = 8;

/// A track as it comes, reduced whenever it grows too long.
pub(crate) struct Outline {
    points: usize,
    kept: Vec<PackedFix>,
    of: u64,
    error_cm: f64,
}

impl Outline {
    /// For at most so many points, 2 or more.
    pub(crate) const fn new(points: usize) -> Self {
        Self { points, kept: Vec::new(), of: 0, error_cm: 0.0 }
    }

    /// The next fixes, in order of time.
    pub(crate) fn add(&mut self, fixes: &[PackedFix]) {
        self.of += fixes.len() as u64;
        self.kept.extend_from_slice(fixes);
        let most = self.points.saturating_mul(KEPT).max(100_000);
        if self.kept.len() > most {
            self.reduce(most / 2);
        }
    }

    /// The points, of how many, and the farthest that one left out is from the line, m.
    pub(crate) fn finish(mut self) -> (Vec<PackedFix>, u64, f64) {
        self.reduce(self.points);
        (self.kept, self.of, self.error_cm * METRES_PER_CENTIMETRE)
    }

    fn reduce(&mut self, points: usize) {
        let (chosen, error_cm) = choose(&self.kept, points);
        self.kept = chosen.into_iter().filter_map(|at| self.kept.get(at).copied()).collect();
        // One reduction upon another: their errors add up.
        self.error_cm += error_cm;
    }
}

/// A piece between two chosen points and its worst point.
struct Piece {
    from: usize,
    to: usize,
    worst: usize,
    error_cm: f64,
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Piece {}
impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error_cm.total_cmp(&other.error_cm).then(other.from.cmp(&self.from))
    }
}

/// Which points to keep, in order, and the largest distance of one left out from the line, cm.
fn choose(fixes: &[PackedFix], points: usize) -> (Vec<usize>, f64) {
    if fixes.len() <= points {
        return ((0..fixes.len()).collect(), 0.0);
    }
    let last = fixes.len() - 1;
    let mut chosen = vec![0, last];
    let mut pieces = BinaryHeap::new();
    pieces.extend(piece(fixes, 0, last));
    while chosen.len() < points
        && let Some(worst) = pieces.pop()
    {
        chosen.push(worst.worst);
        pieces.extend(piece(fixes, worst.from, worst.worst));
        pieces.extend(piece(fixes, worst.worst, worst.to));
    }
    chosen.sort_unstable();
    (chosen, pieces.peek().map_or(0.0, |piece| piece.error_cm))
}

/// `None` where every point between lies on the line.
fn piece(fixes: &[PackedFix], from: usize, to: usize) -> Option<Piece> {
    let (start, end) = (point(fixes.get(from)?), point(fixes.get(to)?));
    let along = difference(end, start);
    let length_squared = dot(along, along);
    let mut found = Piece { from, to, worst: from, error_cm: 0.0 };
    for (at, fix) in fixes.get(from + 1..to)?.iter().enumerate() {
        let out = difference(point(fix), start);
        let share =
            if length_squared > 0.0 { (dot(out, along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        let off = difference(out, along.map(|component| component * share));
        let error_cm = dot(off, off).sqrt();
        if error_cm > found.error_cm {
            (found.worst, found.error_cm) = (from + 1 + at, error_cm);
        }
    }
    (found.error_cm > 0.0).then_some(found)
}

fn point(fix: &PackedFix) -> [f64; 3] {
    fix.position_cm.map(|centimetres| centimetres as f64)
}

fn difference(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    [one[0] - other[0], one[1] - other[1], one[2] - other[2]]
}

fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one[0].mul_add(other[0], one[1].mul_add(other[1], one[2] * other[2]))
}
