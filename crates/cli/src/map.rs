//! A path as a small picture of Braille characters: two dots across and four down in each.

use adit_core::trajectory::Trajectory;

/// First character of the Braille block; bit `n` of the offset is dot `n + 1`.
const BRAILLE_BLANK: u32 = 0x2800;
/// Bit of the dot in column `x` (0–1) and row `y` (0–3) of a cell.
const DOT: [[u32; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
/// A dot is as high as wide, so that scales agree.
const DOTS_ACROSS: usize = 2;
const DOTS_DOWN: usize = 4;

/// A map of the horizontal path, east to the right and north up, and its scale; at most `columns` by `rows` characters.
pub fn draw(path: &Trajectory, columns: usize, rows: usize) -> String {
    let points: Vec<(f64, f64)> = path.poses().iter().map(|p| (p.position_m.x, p.position_m.y)).collect();
    let Some(((west, east), (south, north))) = bounds(&points) else { return String::new() };
    let (width_m, height_m) = (east - west, north - south);
    let dots = |cells: usize, per_cell: usize| (cells * per_cell - 1) as f64;
    let metres_per_dot =
        (width_m / dots(columns, DOTS_ACROSS)).max(height_m / dots(rows, DOTS_DOWN)).max(1e-6);

    let cells = |length_m: f64, per_cell: usize| 1 + nearest(length_m / metres_per_dot) / per_cell;
    let (columns, rows) = (cells(width_m, DOTS_ACROSS), cells(height_m, DOTS_DOWN));
    let mut picture = vec![vec![0; columns]; rows];
    for (x, y) in points {
        let (across, down) = (nearest((x - west) / metres_per_dot), nearest((north - y) / metres_per_dot));
        picture[down / DOTS_DOWN][across / DOTS_ACROSS] |= DOT[down % DOTS_DOWN][across % DOTS_ACROSS];
    }
    let line = |cells: Vec<u32>| -> String {
        cells.iter().filter_map(|dots| char::from_u32(BRAILLE_BLANK + dots)).collect()
    };
    let lines: Vec<String> = picture.into_iter().map(|cells| format!("  {}\n", line(cells))).collect();
    format!("{}  {width_m:.1} m by {height_m:.1} m\n", lines.concat())
}

type Range = (f64, f64);

fn bounds(points: &[(f64, f64)]) -> Option<(Range, Range)> {
    let first = points.first()?;
    let start = ((first.0, first.0), (first.1, first.1));
    let widen = |(low, high): Range, v: f64| (low.min(v), high.max(v));
    Some(points.iter().fold(start, |(x, y), point| (widen(x, point.0), widen(y, point.1))))
}

fn nearest(dots: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative, and no more than the dots of the picture"
    )]
    let dots = dots.round() as usize;
    dots
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use adit_core::attitude::Attitude;
    use adit_core::nalgebra::Vector3;
    use adit_core::time::Time;
    use adit_core::trajectory::Pose;

    fn path(points: &[(f64, f64)]) -> Trajectory {
        let pose = |(i, (x, y)): (i64, &(f64, f64))| Pose {
            time: Time::from_nanos(i),
            position_m: Vector3::new(*x, *y, 0.0),
            attitude: Attitude::identity(),
        };
        Trajectory::new((0..).zip(points).map(pose).collect()).unwrap()
    }

    #[test]
    fn corners_land_in_the_corners() {
        let square = path(&[(0.0, 0.0), (7.0, 0.0), (7.0, 7.0), (0.0, 7.0)]);
        assert_eq!(draw(&square, 4, 2), "  ⠁⠀⠀⠈\n  ⡀⠀⠀⢀\n  7.0 m by 7.0 m\n");
    }

    #[test]
    fn a_walk_that_goes_nowhere_is_a_dot() {
        assert_eq!(draw(&path(&[(3.0, 3.0), (3.0, 3.0)]), 60, 10), "  ⠁\n  0.0 m by 0.0 m\n");
        assert_eq!(draw(&path(&[]), 60, 10), "");
    }
}
