//! What stands between an antenna and a tag: people, vehicles, pillars, the wearer.
//!
//! Frames: mine grid, m; headings from north, clockwise. Every obstacle becomes a screen: people are upright cylinders, vehicles
//! upright boxes, pillars upright prisms.

use super::screen::{Detour, Screen};
use adit_core::nalgebra::{Vector2, Vector3};

/// A tag's antenna at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Antenna {
    /// Where it is, mine grid, m.
    pub position_m: Vector3<f64>,
    /// Which way it looks, away from the body that wears it, as a heading, rad; `None` for a tag that nobody wears.
    pub facing_rad: Option<f64>,
}

/// Somebody or something in the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// The middle of where it stands on the floor, mine grid, m.
    pub foot_m: Vector3<f64>,
    /// How high it is, m.
    pub height_m: f64,
    /// How it looks from above.
    pub shape: Shape,
}

/// An obstacle from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A person.
    Round {
        /// Radius of the trunk, m.
        radius_m: f64,
    },
    /// A vehicle.
    Box {
        /// Half its length, m.
        half_length_m: f64,
        /// Half its width, m.
        half_width_m: f64,
        /// Which way it looks, from north, clockwise, rad.
        heading_rad: f64,
    },
}

/// What is around a tag at one time, apart from the mine itself.
#[derive(Debug, Clone, Copy, Default)]
pub struct Surroundings<'a> {
    /// Other people and vehicles, not the wearer; those far away cost next to nothing.
    pub obstacles: &'a [Obstacle],
    /// The conveyors run.
    pub conveyors_run: bool,
}

impl Obstacle {
    /// A person of common size who stands here.
    pub fn person(foot_m: Vector3<f64>) -> Self {
        Self { foot_m, height_m: 1.75, shape: Shape::Round { radius_m: 0.2 } }
    }

    /// Radius of a circle that holds it, m.
    pub(crate) fn reach_m(&self) -> f64 {
        match self.shape {
            Shape::Round { radius_m } => radius_m,
            Shape::Box { half_length_m, half_width_m, .. } => libm::hypot(half_length_m, half_width_m),
        }
    }

    /// As a screen across a line; `None` when it is not between the ends.
    pub(crate) fn screen(&self, line: &Line) -> Option<Screen> {
        let (along, left) = line.seen(&self.foot_m.xy());
        match self.shape {
            Shape::Round { radius_m } => {
                if along <= 0.0 || along >= line.level_m || line.level_m <= 2.0 * radius_m {
                    return None;
                }
                Some(line.screen(along, [left - radius_m, left + radius_m], self.foot_m.z + self.height_m))
            }
            Shape::Box { half_length_m, half_width_m, heading_rad } => {
                let (sin, cos) = libm::sincos(heading_rad);
                let ahead = Vector2::new(sin, cos) * half_length_m;
                let aside = Vector2::new(cos, -sin) * half_width_m;
                let middle = self.foot_m.xy();
                let corners = [ahead + aside, ahead - aside, -ahead - aside, aside - ahead];
                let corners = corners.map(|c| middle + c);
                line.screen_of(&corners, self.foot_m.z + self.height_m)
            }
        }
    }
}

/// A straight line from a tag to an antenna, seen from above.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    from_m: Vector3<f64>,
    forward: Vector2<f64>,
    rise: f64,
    level_m: f64,
}

impl Line {
    /// `None` for ends that stand above each other.
    pub fn new(from_m: &Vector3<f64>, to_m: &Vector3<f64>) -> Option<Self> {
        let run = to_m - from_m;
        let level_m = libm::hypot(run.x, run.y);
        (level_m > 0.05).then(|| Self {
            from_m: *from_m,
            forward: run.xy() / level_m,
            rise: run.z / level_m,
            level_m,
        })
    }

    /// Does it pass a circle this near?
    pub fn passes(&self, place_m: &Vector2<f64>, reach_m: f64) -> bool {
        let (along, left) = self.seen(place_m);
        left.abs() < reach_m && along > -reach_m && along < self.level_m + reach_m
    }

    /// Way along the line and distance left of it.
    fn seen(&self, place_m: &Vector2<f64>) -> (f64, f64) {
        let off = place_m - self.from_m.xy();
        (off.dot(&self.forward), self.forward.perp(&off))
    }

    fn screen(&self, along_m: f64, sides_m: [f64; 2], top_z_m: f64) -> Screen {
        Screen { along: along_m, sides: sides_m, top: top_z_m - (self.from_m.z + self.rise * along_m) }
    }

    /// An upright prism as a screen: its sides are those of the part that lies between the ends of the line.
    pub fn screen_of(&self, corners: &[Vector2<f64>], top_z_m: f64) -> Option<Screen> {
        let (mut low, mut high, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
        let before = corners.iter().cycle().skip(corners.len().saturating_sub(1));
        for (a, b) in before.zip(corners) {
            let ((s0, l0), (s1, l1)) = (self.seen(a), self.seen(b));
            let Some((from, to)) = clipped(s0, s1, self.level_m) else { continue };
            for share in [from, to] {
                let left = l0 + share * (l1 - l0);
                low = low.min(left);
                high = high.max(left);
                sum += s0 + share * (s1 - s0);
                count += 1.0;
            }
        }
        (count > 0.0).then(|| self.screen(sum / count, [low, high], top_z_m))
    }

    pub fn detour(&self, screen: &Screen, wavelength_m: f64) -> Detour {
        screen.detour(self.level_m, wavelength_m)
    }
}

/// The shares between which `a + t (b − a)` lies in 0 to `length`.
fn clipped(a: f64, b: f64, length: f64) -> Option<(f64, f64)> {
    if (a - b).abs() < 1e-12 {
        return (0.0..=length).contains(&a).then_some((0.0, 1.0));
    }
    let (at_start, at_end) = ((0.0 - a) / (b - a), (length - a) / (b - a));
    let (from, to) = (at_start.min(at_end).max(0.0), at_start.max(at_end).min(1.0));
    (from <= to).then_some((from, to))
}

/// The wearer's trunk behind the tag, as an obstacle.
pub(crate) fn wearer(antenna: &Antenna, body: &super::spec::BodySpec) -> Option<Obstacle> {
    let heading = antenna.facing_rad.filter(|_| body.shades)?;
    let (sin, cos) = libm::sincos(heading);
    let behind = body.half_width_m + body.gap_m;
    let foot_m = antenna.position_m - Vector3::new(sin * behind, cos * behind, body.tag_height_m);
    Some(Obstacle { foot_m, height_m: body.height_m, shape: Shape::Round { radius_m: body.half_width_m } })
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop")]

    use super::*;

    const TAG: Vector3<f64> = Vector3::new(0.0, 0.0, 1.3);

    fn detour(obstacle: &Obstacle, to: Vector3<f64>) -> Detour {
        let line = Line::new(&TAG, &to).unwrap();
        obstacle.screen(&line).map_or_else(Detour::default, |screen| line.detour(&screen, 0.05))
    }

    #[test]
    fn a_person_blocks_where_the_trunk_stands_and_not_beside_or_behind() {
        let anchor = Vector3::new(0.0, 10.0, 1.3);
        assert!(detour(&Obstacle::person(Vector3::new(0.1, 4.0, 0.0)), anchor).blocked);
        assert!(!detour(&Obstacle::person(Vector3::new(0.3, 4.0, 0.0)), anchor).blocked);
        assert!(!detour(&Obstacle::person(Vector3::new(0.0, -4.0, 0.0)), anchor).blocked);
        assert!(!detour(&Obstacle::person(Vector3::new(0.0, 14.0, 0.0)), anchor).blocked);
        // Over the head: the line to an anchor at 3 m is at 2.0 m there.
        assert!(
            !detour(&Obstacle::person(Vector3::new(0.0, 4.2, 0.0)), Vector3::new(0.0, 10.0, 3.0)).blocked
        );
    }

    #[test]
    fn the_way_round_a_person_is_the_side_triangle() {
        let around = detour(&Obstacle::person(Vector3::new(0.0, 5.0, 0.0)), Vector3::new(0.0, 10.0, 1.3));
        let expected = 2.0 * (0.2_f64.hypot(5.0) - 5.0);
        assert!((around.excess_m - expected).abs() < 1e-12, "{}", around.excess_m);
    }

    #[test]
    fn a_vehicle_blocks_by_its_outline() {
        let truck = |heading_rad| Obstacle {
            foot_m: Vector3::new(2.0, 6.0, 0.0),
            height_m: 2.5,
            shape: Shape::Box { half_length_m: 4.0, half_width_m: 1.2, heading_rad },
        };
        let anchor = Vector3::new(0.0, 12.0, 1.3);
        // Along the line it keeps 0.8 m off it; across the line it reaches 2 m over it.
        assert!(!detour(&truck(0.0), anchor).blocked);
        let across = detour(&truck(core::f64::consts::FRAC_PI_2), anchor);
        assert!(across.blocked);
        let expected = 1.2_f64.hypot(6.0) * 2.0 - 12.0;
        assert!((across.excess_m - expected).abs() < 1e-9, "{}", across.excess_m);
    }

    #[test]
    fn the_wearer_blocks_behind_and_not_in_front() {
        let body = super::super::spec::BodySpec::default();
        let trunk = wearer(&Antenna { position_m: TAG, facing_rad: Some(0.0) }, &body).unwrap();
        let front = detour(&trunk, Vector3::new(0.0, 10.0, 2.5));
        let back = detour(&trunk, Vector3::new(0.0, -10.0, 1.5));
        assert!(!front.blocked && front.loss_db.abs() < 0.1);
        assert!(back.blocked && back.loss_db > 8.0, "{}", back.loss_db);
        assert!(wearer(&Antenna { position_m: TAG, facing_rad: None }, &body).is_none());
    }
}
