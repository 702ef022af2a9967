//! Paths from above, on equal axes.

use super::axes::{Axis, Chart, Entry, Frame, Swatch};
use super::canvas::{Area, FAINT_INK, GROUND, color, fill, stroke, units, width_px};
use super::thin::by_distance;
use super::{PathCurve, Role};
use crate::EvaluationError;
use plotters::element::{Circle, EmptyElement, PathElement, Rectangle};
use plotters::style::RGBColor;

/// Free room round the paths, as a share of their extent.
const BREATHING: f64 = 1.1;
/// Extent shown of somebody who stands still, m.
const SMALLEST_EXTENT_M: f64 = 0.2;
/// A truth of fewer poses is a list of surveyed points: they are marked.
const FEW_POSES: usize = 150;

/// Coordinates beyond this are shown from a round origin: mine grids have seven digits before the point, m.
const LONGEST_COORDINATE_M: f64 = 10_000.0;

/// Width over height of what the paths cover, both at least [`SMALLEST_EXTENT_M`].
pub fn aspect(paths: &[PathCurve<'_>]) -> f64 {
    let Some((low, high)) = extent(paths.iter().flat_map(from_above)) else { return 1.0 };
    (high.0 - low.0).max(SMALLEST_EXTENT_M) / (high.1 - low.1).max(SMALLEST_EXTENT_M)
}

/// Draws paths, truth first, with marks at start and end, legend and scale bar.
pub fn draw(area: &Area<'_>, heading: &str, paths: &[PathCurve<'_>]) -> Result<(), EvaluationError> {
    let frame = Frame::new(area, heading, &legend(paths))?;
    let (width_px, height_px) = frame.plot_px();
    let (low, high) = extent(paths.iter().flat_map(from_above)).ok_or(EvaluationError::TooFewPoses {
        what: "the path",
        found: 0,
        expected: 1,
    })?;
    let origin = (round_origin(low.0, high.0), round_origin(low.1, high.1));
    let (low, high) = ((low.0 - origin.0, low.1 - origin.1), (high.0 - origin.0, high.1 - origin.1));
    let lines: Vec<(Role, Vec<(f64, f64)>)> = paths
        .iter()
        .map(|path| (path.role, from_above(path).map(|(x, y)| (x - origin.0, y - origin.1)).collect()))
        .collect();

    let extent_m = |low: f64, high: f64| (high - low).max(SMALLEST_EXTENT_M) * BREATHING;
    let pixel_m = (extent_m(low.0, high.0) / width_px).max(extent_m(low.1, high.1) / height_px);
    let axis = |name: &str, origin: f64, low: f64, high: f64, length_px: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * pixel_m * length_px);
        Axis { label: axis_label(name, origin), range: middle - half..middle + half }
    };
    let mut chart = frame
        .map(&axis("x", origin.0, low.0, high.0, width_px), &axis("y", origin.1, low.1, high.1, height_px))?;

    let (truths, estimates): (Vec<_>, Vec<_>) = lines.iter().partition(|(role, _)| *role == Role::Truth);
    for (role, line) in truths.iter().chain(&estimates) {
        draw_line(&mut chart, *role, line, pixel_m)?;
    }
    for (role, line) in truths.iter().chain(&estimates) {
        draw_ends(&mut chart, color(*role), line)?;
    }
    frame.scale_bar(1.0 / pixel_m)
}

fn from_above<'p>(path: &PathCurve<'p>) -> impl Iterator<Item = (f64, f64)> + use<'p> {
    path.trajectory.poses().iter().map(|pose| (pose.position_m.x, pose.position_m.y))
}

/// A round number just below `low`, or 0 where coordinates are short enough to be read.
fn round_origin(low: f64, high: f64) -> f64 {
    if low.abs().max(high.abs()) < LONGEST_COORDINATE_M {
        return 0.0;
    }
    let unit = 10_f64.powf((high - low).max(10.0).log10().ceil());
    (low / unit).floor() * unit
}

fn axis_label(name: &str, origin: f64) -> String {
    if origin == 0.0 {
        return format!("{name} (m)");
    }
    let sign = if origin < 0.0 { '+' } else { '−' };
    format!("{name} {sign} {:.0} (m)", origin.abs())
}

fn legend(paths: &[PathCurve<'_>]) -> Vec<Entry> {
    let line = |path: &PathCurve<'_>| Entry {
        label: path.label.to_owned(),
        color: color(path.role),
        swatch: Swatch::Line(width_px(path.role)),
    };
    let mark = |label: &str, swatch| Entry { label: label.to_owned(), color: FAINT_INK, swatch };
    let marks = [mark("start", Swatch::Ring), mark("end", Swatch::Square)];
    paths.iter().map(line).chain(marks).collect()
}

fn extent(points: impl Iterator<Item = (f64, f64)>) -> Option<((f64, f64), (f64, f64))> {
    points.fold(None, |extent, (x, y)| {
        let (low, high) = extent.unwrap_or(((x, y), (x, y)));
        Some(((low.0.min(x), low.1.min(y)), (high.0.max(x), high.1.max(y))))
    })
}

fn draw_line(
    chart: &mut Chart<'_, '_>,
    role: Role,
    line: &[(f64, f64)],
    pixel_m: f64,
) -> Result<(), EvaluationError> {
    let thinned = by_distance(line, (pixel_m, pixel_m));
    chart.draw_series([PathElement::new(thinned, stroke(color(role), width_px(role)))])?;
    if role == Role::Truth && line.len() < FEW_POSES {
        let dots = line.iter().map(|point| Circle::new(*point, units(3), fill(color(role))));
        chart.draw_series(dots)?;
    }
    Ok(())
}

/// A ring at the start and a square at the end, each on a light ground so that they stand out of the lines; a square in
/// a ring when they meet.
fn draw_ends(chart: &mut Chart<'_, '_>, color: RGBColor, line: &[(f64, f64)]) -> Result<(), EvaluationError> {
    let (Some(start), Some(end)) = (line.first(), line.last()) else { return Ok(()) };
    let square = |half_px: i32| [(-units(half_px), -units(half_px)), (units(half_px), units(half_px))];
    chart.draw_series([EmptyElement::at(*start)
        + Circle::new((0, 0), units(8), fill(GROUND))
        + Circle::new((0, 0), units(6), stroke(color, 2.0))])?;
    chart.draw_series([EmptyElement::at(*end)
        + Rectangle::new(square(4), fill(GROUND))
        + Rectangle::new(square(3), fill(color))])?;
    Ok(())
}
