//! A straight piece of a roadway.

use adit_core::nalgebra::{Vector2, Vector3};

/// A straight piece of a centre line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    start_m: Vector3<f64>,
    /// Unit vector from its beginning to its end on the map.
    pub direction: Vector2<f64>,
    /// Length on the map, m.
    pub length_m: f64,
    /// Rise over run.
    pub rise: f64,
    /// Half of the width of its roadway, m.
    pub half_width_m: f64,
    /// Height of its roof above the floor, m.
    pub height_m: f64,
    /// The joints at its beginning and its end.
    pub joints: [u32; 2],
}

/// How a place lies to a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnPiece {
    /// From its beginning along it, m; less than nothing before it, more than its length behind it.
    pub along_m: f64,
    /// Left of it, m.
    pub left_m: f64,
}

impl Piece {
    /// Between two points; `None` where it is upright.
    pub(super) fn new(
        [from, to]: [Vector3<f64>; 2],
        joints: [usize; 2],
        (half_width_m, height_m): (f64, f64),
    ) -> Option<Self> {
        let run = (to - from).xy();
        let length_m = run.norm();
        (length_m > 0.0).then(|| Self {
            start_m: from,
            direction: run / length_m,
            length_m,
            rise: (to.z - from.z) / length_m,
            half_width_m,
            height_m,
            joints: joints.map(|joint| u32::try_from(joint).unwrap_or(u32::MAX)),
        })
    }

    /// A piece that leads nowhere else, of this half width, m.
    #[cfg(test)]
    pub fn between(ends: [Vector3<f64>; 2], half_width_m: f64) -> Option<Self> {
        Self::new(ends, [0, 1], (half_width_m, 3.0))
    }

    /// Unit vector to its left.
    pub fn left(&self) -> Vector2<f64> {
        Vector2::new(-self.direction.y, self.direction.x)
    }

    /// Its beginning, on the floor.
    pub fn start_m(&self) -> &Vector3<f64> {
        &self.start_m
    }

    /// How a place on the map lies to it.
    pub fn on(&self, place_m: &Vector2<f64>) -> OnPiece {
        let off = place_m - self.start_m.xy();
        OnPiece { along_m: self.direction.dot(&off), left_m: self.left().dot(&off) }
    }

    /// Height of the floor this far along, the slope going on beyond the ends, m.
    pub fn floor_m(&self, along_m: f64) -> f64 {
        self.start_m.z + self.rise * along_m
    }

    /// The place on the centre line this far along, going on beyond the ends.
    pub fn at(&self, along_m: f64) -> Vector3<f64> {
        let place = self.start_m.xy() + self.direction * along_m;
        Vector3::new(place.x, place.y, self.floor_m(along_m))
    }

    /// Distance from the centre line on the map, m.
    pub fn distance_m(&self, place_m: &Vector2<f64>) -> f64 {
        let on = self.on(place_m);
        libm::hypot(on.left_m, on.along_m - on.along_m.clamp(0.0, self.length_m))
    }

    /// Number, 0 or 1, of the end at a joint.
    pub fn end_at(&self, joint: u32) -> usize {
        usize::from(self.joints[0] != joint)
    }

    /// Unit vector that leads away from an end along the piece.
    pub fn away_from(&self, end: usize) -> Vector2<f64> {
        if end == 0 { self.direction } else { -self.direction }
    }

    /// Where the line from `a` to `b` crosses it; `None` where it does not.
    pub(super) fn crossed(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> Option<Vector2<f64>> {
        let (from, to) = (self.on(a), self.on(b));
        if (from.left_m > 0.0) == (to.left_m > 0.0) {
            return None;
        }
        let share = from.left_m / (from.left_m - to.left_m);
        let along_m = from.along_m + share * (to.along_m - from.along_m);
        (0.0..=self.length_m).contains(&along_m).then(|| a + (b - a) * share)
    }
}
