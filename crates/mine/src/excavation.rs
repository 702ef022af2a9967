//! The excavated space: what is air. All else is rock.
//!
//! A roadway is cut into bodies: a box along each straight piece of its centre line, with the floor of that piece and the
//! width and height of the roadway, and a round one at each point of the line, so that bends, ends and
//! junctions are round. A steep piece (over 60°) and a shaft are upright cylinders. A chamber is a prism over its outline. Each body
//! is bounded by planes, a circle or a polygon, so that the part of a straight line inside it is found in closed form; an
//! R*-tree finds the bodies near a line or point.
//!
//! **Limits.** Cross-sections are rectangular; a round end stands half a width beyond the last point.

use crate::geometry::TOUCH_M;
use crate::geometry::plane::{Point, cross, dot, length, minus};
use crate::geometry::polygon::{self, Outline};
use crate::geometry::polyline::Polyline;
use crate::geometry::spans::{Span, covered};
use crate::plan::{Chamber, Roadway};
use adit_core::frames::{MineGrid, Position};
use alloc::vec::Vec;
use nalgebra::Vector3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// Rise over run from which a piece is an upright cylinder: 60°.
const STEEP: f64 = 1.732;

/// A roadway or a chamber of the plan, by its place in the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Opening {
    /// Index in [`MinePlan::roadways`](crate::plan::MinePlan::roadways).
    Roadway(usize),
    /// Index in [`MinePlan::chambers`](crate::plan::MinePlan::chambers).
    Chamber(usize),
}

/// How a point lies to the nearest opening; all zero inside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// The opening.
    pub opening: Opening,
    /// Distance from its walls, outside them, m.
    pub beyond_wall_m: f64,
    /// Height above its roof, m.
    pub above_roof_m: f64,
    /// Depth below its floor, m.
    pub below_floor_m: f64,
    /// Height above its floor, m; negative below it.
    pub height_m: f64,
}

impl Clearance {
    /// Distance from the opening, m.
    pub fn distance_m(&self) -> f64 {
        libm::hypot(self.beyond_wall_m, self.above_roof_m + self.below_floor_m)
    }
}

/// The union of all openings.
#[derive(Debug, Clone, Default)]
pub struct Excavation {
    bodies: RTree<Body>,
}

#[derive(Debug, Clone)]
struct Body {
    opening: Opening,
    height_m: f64,
    form: Form,
}

#[derive(Debug, Clone)]
enum Form {
    Box { start: Vector3<f64>, along: Point, length_m: f64, half_width_m: f64, rise: f64 },
    Cylinder { centre: Point, radius_m: f64, floor_m: f64 },
    Prism { outline: Vec<Point>, floor_m: f64 },
}

impl Excavation {
    /// Cuts the openings into bodies; roadways come with their lines, `None` where they have none.
    pub(crate) fn new<'p>(
        roadways: impl Iterator<Item = (&'p Roadway, Option<&'p Polyline>)>,
        chambers: impl Iterator<Item = &'p Chamber>,
    ) -> Self {
        let mut bodies = Vec::new();
        for (index, (roadway, line)) in roadways.enumerate() {
            if let Some(line) = line {
                let opening = Opening::Roadway(index);
                let body = |form, height_m| Body { opening, height_m, form };
                let (radius_m, height_m) = (0.5 * roadway.width_m, roadway.height_m);
                for (a, b) in line.segments() {
                    bodies.push(along_segment(a, b, radius_m, height_m, body));
                }
                for p in line.points() {
                    bodies
                        .push(body(Form::Cylinder { centre: [p.x, p.y], radius_m, floor_m: p.z }, height_m));
                }
            }
        }
        for (index, chamber) in chambers.enumerate() {
            if chamber.outline_m.len() >= 3 {
                let form = Form::Prism { outline: chamber.outline_m.clone(), floor_m: chamber.floor_m };
                bodies.push(Body { opening: Opening::Chamber(index), height_m: chamber.height_m, form });
            }
        }
        Self { bodies: RTree::bulk_load(bodies) }
    }

    /// Is the point in the air?
    pub fn contains(&self, point: &Position<MineGrid>) -> bool {
        let p = point.raw();
        let here = AABB::from_point([p.x, p.y, p.z]);
        self.bodies
            .locate_in_envelope_intersecting(here)
            .any(|body| body.clearance(p).distance_m() <= TOUCH_M)
    }

    /// How the point lies to the nearest opening; `None` when nothing is excavated.
    pub fn clearance(&self, point: &Position<MineGrid>) -> Option<Clearance> {
        let p = point.raw();
        self.bodies.nearest_neighbor([p.x, p.y, p.z]).map(|body| body.clearance(p))
    }

    /// All openings that the point is in, each once.
    pub fn openings_at(&self, point: &Position<MineGrid>) -> Vec<Opening> {
        let p = point.raw();
        let here = AABB::from_point([p.x, p.y, p.z]);
        let bodies = self.bodies.locate_in_envelope_intersecting(here);
        let mut found: Vec<Opening> =
            bodies.filter(|b| b.clearance(p).distance_m() <= TOUCH_M).map(|b| b.opening).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// All openings that a plumb line through a point meets between two heights, each once.
    pub(crate) fn openings_over(&self, p: Point, (low_m, high_m): (f64, f64)) -> Vec<Opening> {
        let plumb = AABB::from_corners([p[0], p[1], low_m], [p[0], p[1], high_m]);
        let met = self.bodies.locate_in_envelope_intersecting(plumb);
        let at = |body: &&Body| body.clearance(&Vector3::new(p[0], p[1], 0.0)).beyond_wall_m <= TOUCH_M;
        let mut found: Vec<Opening> = met.filter(at).map(|b| b.opening).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Does a plumb line through a point meet any opening between two heights?
    pub(crate) fn reaches(&self, p: Point, band_m: (f64, f64)) -> bool {
        !self.openings_over(p, band_m).is_empty()
    }

    /// How much of the straight line between two points runs through rock, m.
    pub fn rock_m(&self, from: &Position<MineGrid>, to: &Position<MineGrid>) -> f64 {
        let (a, b) = (from.raw(), to.raw());
        let around = AABB::from_corners([a.x, a.y, a.z], [b.x, b.y, b.z]);
        let near = self.bodies.locate_in_envelope_intersecting(around);
        let mut air: Vec<Span> = near.flat_map(|body| body.spans(a, b)).collect();
        let rock = 1.0 - covered(&mut air);
        // What is left after closed forms meet at a common wall is rounding.
        let rock_m = rock * (b - a).norm();
        if rock_m <= TOUCH_M { 0.0 } else { rock_m }
    }
}

/// The body along one straight piece of a centre line.
fn along_segment(
    a: Vector3<f64>,
    b: Vector3<f64>,
    radius_m: f64,
    height_m: f64,
    body: impl Fn(Form, f64) -> Body,
) -> Body {
    let run = minus([b.x, b.y], [a.x, a.y]);
    let length_m = length(run);
    let climb_m = b.z - a.z;
    if climb_m.abs() > STEEP * length_m {
        let centre = [0.5 * (a.x + b.x), 0.5 * (a.y + b.y)];
        let form = Form::Cylinder { centre, radius_m: radius_m + 0.5 * length_m, floor_m: a.z.min(b.z) };
        return body(form, height_m + climb_m.abs());
    }
    let along = [run[0] / length_m, run[1] / length_m];
    let form = Form::Box { start: a, along, length_m, half_width_m: radius_m, rise: climb_m / length_m };
    body(form, height_m)
}

impl Body {
    fn clearance(&self, p: &Vector3<f64>) -> Clearance {
        let (beyond_wall_m, floor_m) = match &self.form {
            Form::Box { start, along, length_m, half_width_m, rise } => {
                let from_start = [p.x - start.x, p.y - start.y];
                let (s, across) = (dot(from_start, *along), cross(*along, from_start));
                let on = s.clamp(0.0, *length_m);
                (length([s - on, (across.abs() - half_width_m).max(0.0)]), start.z + rise * on)
            }
            Form::Cylinder { centre, radius_m, floor_m } => {
                ((length(minus([p.x, p.y], *centre)) - radius_m).max(0.0), *floor_m)
            }
            Form::Prism { outline, floor_m } => (polygon::distance_m(outline, [p.x, p.y]), *floor_m),
        };
        let height_m = p.z - floor_m;
        Clearance {
            opening: self.opening,
            beyond_wall_m,
            above_roof_m: (height_m - self.height_m).max(0.0),
            below_floor_m: (-height_m).max(0.0),
            height_m,
        }
    }

    /// The parts of the line from `a` to `b` inside, as shares of its length.
    fn spans(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> Vec<Span> {
        let d = b - a;
        let roof = self.height_m + TOUCH_M;
        match &self.form {
            Form::Box { start, along, length_m, half_width_m, rise } => {
                let (from, run) = ([a.x - start.x, a.y - start.y], [d.x, d.y]);
                let (s, s_rate) = (dot(from, *along), dot(run, *along));
                let (n, n_rate) = (cross(*along, from), cross(*along, run));
                let half = half_width_m + TOUCH_M;
                Span::WHOLE
                    .where_between(s, s_rate, -TOUCH_M, length_m + TOUCH_M)
                    .and_then(|span| span.where_between(n, n_rate, -half, half))
                    .and_then(|span| {
                        span.where_between(a.z - start.z - rise * s, d.z - rise * s_rate, -TOUCH_M, roof)
                    })
                    .into_iter()
                    .collect()
            }
            Form::Cylinder { centre, radius_m, floor_m } => {
                in_circle(minus([a.x, a.y], *centre), [d.x, d.y], radius_m + TOUCH_M)
                    .and_then(|span| span.where_between(a.z - floor_m, d.z, -TOUCH_M, roof))
                    .into_iter()
                    .collect()
            }
            Form::Prism { outline, floor_m } => {
                let upright = Span::WHOLE.where_between(a.z - floor_m, d.z, -TOUCH_M, roof);
                let chords = polygon::chords(outline, [a.x, a.y], [b.x, b.y], Outline::Inside);
                chords
                    .into_iter()
                    .filter_map(|chord| upright.and_then(|span| span.clipped(chord.from, chord.to)))
                    .collect()
            }
        }
    }
}

/// The part of `from + t d` inside a circle about the origin.
fn in_circle(from: Point, d: Point, radius_m: f64) -> Option<Span> {
    let square = dot(d, d);
    if square == 0.0 {
        return (length(from) <= radius_m).then_some(Span::WHOLE);
    }
    // Half the chord by Pythagoras over the line's distance from the centre: no cancellation far from the circle.
    let middle = -dot(from, d) / square;
    let distance = cross(d, from) / libm::sqrt(square);
    let half_square = (radius_m - distance) * (radius_m + distance);
    if half_square < 0.0 {
        return None;
    }
    let half = libm::sqrt(half_square / square);
    Span::WHOLE.clipped(middle - half, middle + half)
}

impl RTreeObject for Body {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let (mut low, mut high) = match &self.form {
            Form::Box { start, along, length_m, half_width_m, rise } => {
                let (end_x, end_y) = (start.x + along[0] * length_m, start.y + along[1] * length_m);
                let (side_x, side_y) = (along[1].abs() * half_width_m, along[0].abs() * half_width_m);
                let end_z = start.z + rise * length_m;
                (
                    [start.x.min(end_x) - side_x, start.y.min(end_y) - side_y, start.z.min(end_z)],
                    [start.x.max(end_x) + side_x, start.y.max(end_y) + side_y, start.z.max(end_z)],
                )
            }
            Form::Cylinder { centre, radius_m, floor_m } => (
                [centre[0] - radius_m, centre[1] - radius_m, *floor_m],
                [centre[0] + radius_m, centre[1] + radius_m, *floor_m],
            ),
            Form::Prism { outline, floor_m } => {
                let first = outline.first().copied().unwrap_or_default();
                outline.iter().fold(
                    ([first[0], first[1], *floor_m], [first[0], first[1], *floor_m]),
                    |(low, high), p| {
                        (
                            [low[0].min(p[0]), low[1].min(p[1]), low[2]],
                            [high[0].max(p[0]), high[1].max(p[1]), high[2]],
                        )
                    },
                )
            }
        };
        high[2] += self.height_m;
        for axis in 0..3 {
            low[axis] -= TOUCH_M;
            high[axis] += TOUCH_M;
        }
        AABB::from_corners(low, high)
    }
}

impl PointDistance for Body {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let distance_m = self.clearance(&Vector3::from(*point)).distance_m();
        distance_m * distance_m
    }
}
