//! A line of points in space, measured along.

use super::TOUCH_M;
use alloc::vec::Vec;
use nalgebra::Vector3;

/// At least two points, each apart from the one before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    points: Vec<Vector3<f64>>,
    /// Way from the first point to each, m.
    reached: Vec<f64>,
}

/// A place on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnLine {
    /// Way from the line's first point, m.
    pub along_m: f64,
    /// The place itself, m.
    pub point_m: Vector3<f64>,
}

impl Polyline {
    /// Points that repeat the one before them are left out; `None` when fewer than two remain.
    pub fn new(points: impl IntoIterator<Item = Vector3<f64>>) -> Option<Self> {
        let (mut kept, mut reached): (Vec<Vector3<f64>>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut way = 0.0;
        for point in points {
            if let Some(last) = kept.last() {
                let step = (point - last).norm();
                if step <= TOUCH_M {
                    continue;
                }
                way += step;
            }
            kept.push(point);
            reached.push(way);
        }
        (kept.len() >= 2).then_some(Self { points: kept, reached })
    }

    /// Its points, m.
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// Length, m.
    pub fn length_m(&self) -> f64 {
        self.reached.last().copied().unwrap_or(0.0)
    }

    /// Its straight pieces.
    pub fn segments(&self) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + '_ {
        self.points.windows(2).map(|w| (w[0], w[1]))
    }

    /// Number of the straight piece at this way from the start; a point between two belongs to the later one.
    fn segment_at(&self, along_m: f64) -> usize {
        self.reached.partition_point(|r| *r <= along_m).clamp(1, self.points.len() - 1) - 1
    }

    /// The place this far from the start; the ends beyond them.
    pub fn at(&self, along_m: f64) -> Vector3<f64> {
        let i = self.segment_at(along_m);
        let (from, to) = (self.reached[i], self.reached[i + 1]);
        let share = ((along_m - from) / (to - from)).clamp(0.0, 1.0);
        self.points[i] + (self.points[i + 1] - self.points[i]) * share
    }

    /// Unit vector in which the line runs this far from the start.
    pub fn direction_at(&self, along_m: f64) -> Vector3<f64> {
        let i = self.segment_at(along_m);
        (self.points[i + 1] - self.points[i]).normalize()
    }

    /// The nearest place on straight piece `index`, in space.
    pub fn nearest_on_segment(&self, index: usize, point: &Vector3<f64>) -> OnLine {
        let i = index.min(self.points.len() - 2);
        let (a, b) = (self.points[i], self.points[i + 1]);
        let length = self.reached[i + 1] - self.reached[i];
        let share = ((point - a).dot(&(b - a)) / (length * length)).clamp(0.0, 1.0);
        OnLine { along_m: self.reached[i] + share * length, point_m: a + (b - a) * share }
    }

    /// The nearest place on the line, in space.
    pub fn nearest(&self, point: &Vector3<f64>) -> OnLine {
        let ends = OnLine { along_m: 0.0, point_m: self.points[0] };
        let places = (0..self.points.len() - 1).map(|i| self.nearest_on_segment(i, point));
        let distance = |place: &OnLine| (place.point_m - point).norm_squared();
        places.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(ends)
    }

    /// The points strictly between two places.
    pub fn between(&self, from_m: f64, to_m: f64) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let inside = move |(_, r): &(&Vector3<f64>, &f64)| **r > from_m && **r < to_m;
        self.points.iter().zip(&self.reached).filter(inside).map(|(p, _)| *p)
    }
}
