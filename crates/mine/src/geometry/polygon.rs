//! Simple polygons: corners in order, the first not repeated.

use super::TOUCH_M;
use super::plane::{Point, along, cross, distance_to_segment, meeting, minus};
use super::spans::Span;
use alloc::vec;
use alloc::vec::Vec;

/// Its sides, each as two corners.
pub fn sides(outline: &[Point]) -> impl Iterator<Item = (Point, Point)> + Clone {
    (0..outline.len()).map(|i| (outline[i], outline[(i + 1) % outline.len()]))
}

/// Area, positive when the corners run counter-clockwise, m² (shoelace formula about the first corner).
pub fn signed_area_m2(outline: &[Point]) -> f64 {
    let Some(origin) = outline.first() else { return 0.0 };
    sides(outline).map(|(a, b)| 0.5 * cross(minus(a, *origin), minus(b, *origin))).sum()
}

/// Centre of gravity of the area; the first corner where there is no area.
pub fn centroid(outline: &[Point]) -> Point {
    let Some(origin) = outline.first() else { return [0.0, 0.0] };
    let area = signed_area_m2(outline);
    if area == 0.0 {
        return *origin;
    }
    let moment = sides(outline).fold([0.0, 0.0], |sum, (a, b)| {
        let (a, b) = (minus(a, *origin), minus(b, *origin));
        let weight = cross(a, b) / (6.0 * area);
        [sum[0] + weight * (a[0] + b[0]), sum[1] + weight * (a[1] + b[1])]
    });
    [origin[0] + moment[0], origin[1] + moment[1]]
}

/// Is the point on the outline, to [`TOUCH_M`]?
pub fn on_outline(outline: &[Point], p: Point) -> bool {
    sides(outline).any(|(a, b)| distance_to_segment(a, b, p) <= TOUCH_M)
}

/// Is the point inside by the even-odd rule? On the outline itself either answer may come: see [`contains`].
fn encloses(outline: &[Point], p: Point) -> bool {
    sides(outline)
        .filter(|(a, b)| {
            let (a, b) = (minus(*a, p), minus(*b, p));
            // Half-open in y, so that a corner counts for one of its two sides.
            (a[1] > 0.0) != (b[1] > 0.0) && (cross(a, b) > 0.0) == (b[1] > a[1])
        })
        .count()
        % 2
        == 1
}

/// Is the point inside or on the outline?
pub fn contains(outline: &[Point], p: Point) -> bool {
    on_outline(outline, p) || encloses(outline, p)
}

/// Distance from the polygon, m; 0 inside.
pub fn distance_m(outline: &[Point], p: Point) -> f64 {
    if contains(outline, p) {
        return 0.0;
    }
    sides(outline).map(|(a, b)| distance_to_segment(a, b, p)).fold(f64::INFINITY, f64::min)
}

/// The first two sides that meet where they should not, by number from 0; `None` for a simple polygon.
pub fn self_crossing(outline: &[Point]) -> Option<(usize, usize)> {
    let count = outline.len();
    let all: Vec<(Point, Point)> = sides(outline).collect();
    for i in 0..count {
        for j in i + 1..count {
            let (a, b) = all[i];
            let (c, d) = all[j];
            let next = j == i + 1;
            let last = i == 0 && j == count - 1;
            let bad = if next || last {
                // Neighbours share a corner; more than that is a side that runs back over the other.
                let (far, near) = if next { (d, (a, b)) } else { (c, (a, b)) };
                let other = if next { a } else { b };
                count > 2
                    && (distance_to_segment(near.0, near.1, far) <= TOUCH_M
                        || distance_to_segment(c, d, other) <= TOUCH_M)
            } else {
                segments_meet(a, b, c, d)
            };
            if bad {
                return Some((i, j));
            }
        }
    }
    None
}

/// Do two segments have a point in common, to [`TOUCH_M`]?
pub fn segments_meet(a: Point, b: Point, c: Point, d: Point) -> bool {
    if let Some((s, t)) = meeting(a, b, c, d)
        && (0.0..=1.0).contains(&s)
        && (0.0..=1.0).contains(&t)
    {
        return true;
    }
    [(a, b, c), (a, b, d), (c, d, a), (c, d, b)]
        .iter()
        .any(|(a, b, p)| distance_to_segment(*a, *b, *p) <= TOUCH_M)
}

/// Whether a line that runs along the outline counts as inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outline {
    /// It does: the wall of a room belongs to the room.
    Inside,
    /// It does not: a line that grazes a pillar is not blocked.
    Outside,
}

/// The parts of the segment from `a` to `b` that lie inside, as shares of its length.
pub fn chords(outline: &[Point], a: Point, b: Point, rule: Outline) -> Vec<Span> {
    let d = minus(b, a);
    let inside = |t: f64| {
        let p = along(a, d, t);
        match rule {
            Outline::Inside => contains(outline, p),
            Outline::Outside => !on_outline(outline, p) && encloses(outline, p),
        }
    };
    let mut cuts = vec![0.0, 1.0];
    for (c, e) in sides(outline) {
        if let Some((s, t)) = meeting(a, b, c, e) {
            if (0.0..=1.0).contains(&s) && (-1e-9..=1.0 + 1e-9).contains(&t) {
                cuts.push(s);
            }
        } else {
            // A side that runs along the segment: what changes, changes at its ends.
            let on = [c, e].map(|p| super::plane::nearest_on_segment(a, b, p));
            cuts.extend(on);
        }
    }
    cuts.sort_by(f64::total_cmp);
    cuts.windows(2)
        .filter(|w| w[1] > w[0] && inside(0.5 * (w[0] + w[1])))
        .map(|w| Span { from: w[0], to: w[1] })
        .collect()
}
