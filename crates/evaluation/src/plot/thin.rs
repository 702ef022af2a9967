//! Fewer points, the same picture.

/// No curve of a figure has more points than this.
pub const MAX_POINTS: usize = 4000;

/// Movement below this is invisible at the usual size of a figure, px.
const INVISIBLE_PX: f64 = 0.4;

/// A path without the points nearer than [`INVISIBLE_PX`] to the last one kept; coarser when still too long.
///
/// `pixel` is the width and height of one pixel in the units of the points.
pub fn by_distance(points: &[(f64, f64)], pixel: (f64, f64)) -> Vec<(f64, f64)> {
    let mut tolerance_px = INVISIBLE_PX;
    loop {
        let kept = kept_by_distance(points, pixel, tolerance_px);
        if kept.len() <= MAX_POINTS {
            return kept;
        }
        tolerance_px *= 1.5;
    }
}

fn kept_by_distance(points: &[(f64, f64)], pixel: (f64, f64), tolerance_px: f64) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let moved = kept.last().is_none_or(|last| {
            ((point.0 - last.0) / pixel.0).hypot((point.1 - last.1) / pixel.1) >= tolerance_px
        });
        if moved || i + 1 == points.len() {
            kept.push(*point);
        }
    }
    kept
}

/// A curve over time as the lowest and highest point of each of `columns` equal spans: no spike is lost.
///
/// At most two points a column remain, in order of time; a curve that is short enough stays as it is.
pub fn by_columns(points: &[(f64, f64)], columns: usize) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let columns = columns.clamp(1, MAX_POINTS / 2);
    if points.len() <= 2 * columns {
        return points.to_vec();
    }
    let width = (last.0 - first.0) / columns as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates; the column is capped"
    )]
    let column = |point: &(f64, f64)| (((point.0 - first.0) / width) as usize).min(columns - 1);
    let mut kept = Vec::with_capacity(2 * columns);
    for span in points.chunk_by(|a, b| column(a) == column(b)) {
        let lowest = (0..span.len()).fold(0, |best, i| if span[i].1 < span[best].1 { i } else { best });
        let highest = (0..span.len()).fold(0, |best, i| if span[i].1 > span[best].1 { i } else { best });
        kept.push(span[lowest.min(highest)]);
        if lowest != highest {
            kept.push(span[lowest.max(highest)]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_path_becomes_short_and_keeps_its_ends() {
        let path: Vec<(f64, f64)> = (0..200_000)
            .map(|i| (f64::from(i) * 0.01).sin_cos())
            .map(|(s, c)| (s * 500.0, c * 500.0))
            .collect();
        let thinned = by_distance(&path, (1.0, 1.0));
        assert!(thinned.len() <= MAX_POINTS);
        assert_eq!((thinned.first(), thinned.last()), (path.first(), path.last()));
    }

    #[test]
    fn somebody_who_stood_still_leaves_two_points() {
        assert_eq!(by_distance(&[(1.0, 1.0); 500], (0.1, 0.1)), vec![(1.0, 1.0); 2]);
    }

    #[test]
    fn a_spike_of_one_sample_survives() {
        let mut curve: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), 0.5)).collect();
        curve[61_803].1 = 9.0;
        let thinned = by_columns(&curve, 600);
        assert!(thinned.len() <= 1200);
        assert!(thinned.contains(&(61_803.0, 9.0)));
        assert!(thinned.windows(2).all(|two| two[0].0 < two[1].0));
    }
}
