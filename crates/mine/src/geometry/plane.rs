//! Points and segments in the plane.

/// East and north, m.
pub type Point = [f64; 2];

/// `b − a`.
pub fn minus(b: Point, a: Point) -> Point {
    [b[0] - a[0], b[1] - a[1]]
}

/// `a + t d`.
pub fn along(a: Point, d: Point, t: f64) -> Point {
    [a[0] + t * d[0], a[1] + t * d[1]]
}

/// Scalar product.
pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Twice the signed area between two arrows; positive when `b` is left of `a`.
pub fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Length, m.
pub fn length(a: Point) -> f64 {
    libm::hypot(a[0], a[1])
}

/// Where on the segment from `a` to `b` the point nearest to `p` is: 0 at `a`, 1 at `b`.
pub fn nearest_on_segment(a: Point, b: Point, p: Point) -> f64 {
    let d = minus(b, a);
    let square = dot(d, d);
    if square > 0.0 { (dot(minus(p, a), d) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// Distance of `p` from the segment from `a` to `b`, m.
pub fn distance_to_segment(a: Point, b: Point, p: Point) -> f64 {
    let foot = along(minus(a, p), minus(b, a), nearest_on_segment(a, b, p));
    length(foot)
}

/// Where the lines through `a b` and `c d` meet, as shares of both segments; `None` when they are parallel.
pub fn meeting(a: Point, b: Point, c: Point, d: Point) -> Option<(f64, f64)> {
    let (u, v, w) = (minus(b, a), minus(d, c), minus(c, a));
    let turn = cross(u, v);
    // Parallel to within 1e-12 rad: beyond that the meeting point has no digits left.
    if turn.abs() <= 1e-12 * length(u) * length(v) {
        return None;
    }
    Some((cross(w, v) / turn, cross(w, u) / turn))
}
