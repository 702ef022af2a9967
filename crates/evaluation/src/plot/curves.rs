//! Errors over time, and how they are distributed.

use super::axes::{Axis, Entry, Frame, Swatch};
use super::canvas::{AXIS, Area, FAINT_INK, SHADE, Type, color, fill, stroke, text, units, width_px};
use super::thin::{by_columns, by_distance};
use super::{DistributionCurve, Role, TimeCurve};
use crate::EvaluationError;
use crate::statistics::Distribution;
use plotters::element::{EmptyElement, PathElement, Rectangle, Text};
use plotters::style::text_anchor::{HPos, VPos};

/// Room above the highest value, as a share.
const HEADROOM: f64 = 1.06;
/// A distribution is cut where its 99th percentile, times this, leaves the largest error far outside.
const OUTLIER_RATIO: f64 = 2.5;

/// Phases of a curve over time that are not scored, s.
pub type Phases = [(f64, f64)];

/// Draws values over time. Values below zero are shown when there are any. Phases that are not scored are shaded; values
/// there may be far off and do not squeeze the others: the axis grows by its own length each way at most.
pub fn over_time(
    area: &Area<'_>,
    heading: &str,
    y_label: &str,
    series: &[TimeCurve],
    unscored: &Phases,
) -> Result<(), EvaluationError> {
    let points = || series.iter().flat_map(|curve| &curve.points);
    let scored = |p: &&(f64, f64)| !unscored.iter().any(|(from, to)| (*from..=*to).contains(&p.0));
    let (start, end) = span(points().map(|p| p.0));
    let (low, high) = span(points().filter(scored).map(|p| p.1));
    let (low, high) = (low.min(0.0), high.max(0.0));
    let (lowest, highest) = span(points().map(|p| p.1));
    let bounds = (lowest.clamp(2.0 * low - high, low), highest.clamp(high, 2.0 * high - low));
    let cut = lowest < bounds.0 || highest > bounds.1;

    let mut entries = legend(series.iter().map(|curve| curve.label.as_str()));
    if !unscored.is_empty() {
        let label = if cut { "not scored, cut off where far out" } else { "not scored" };
        entries.push(Entry { label: label.to_owned(), color: SHADE, swatch: Swatch::Square });
    }
    let frame = Frame::new(area, heading, &entries)?;
    let x = Axis { label: "time (s)".to_owned(), range: start..end.max(start + 1e-3) };
    let room = bounds.0 * HEADROOM..(bounds.1 * HEADROOM).max(bounds.0 + 1e-6);
    let y = Axis { label: y_label.to_owned(), range: room.clone() };
    let mut chart = frame.chart(&x, &y)?;
    let shaded = |(from, to): &(f64, f64)| {
        let corners = [(from.max(start), room.start), (to.min(end), room.end)];
        (corners[0].0 < corners[1].0).then(|| Rectangle::new(corners, fill(SHADE)))
    };
    chart.draw_series(unscored.iter().filter_map(shaded))?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a plot has some hundred pixels"
    )]
    let columns = frame.plot_px().0 as usize;
    // The last first: the first curve is the one that matters and lies on top.
    for (number, curve) in series.iter().enumerate().rev() {
        let role = Role::Estimate(number);
        for piece in pieces(&curve.points, unscored) {
            let mut line = by_columns(piece, columns);
            for point in &mut line {
                point.1 = point.1.clamp(bounds.0, bounds.1);
            }
            chart.draw_series([PathElement::new(line, stroke(color(role), 1.2))])?;
        }
    }
    Ok(())
}

/// A curve in pieces: no line runs through a phase in which it has no points.
fn pieces<'p>(points: &'p [(f64, f64)], unscored: &'p Phases) -> impl Iterator<Item = &'p [(f64, f64)]> {
    points.chunk_by(|a, b| !unscored.iter().any(|(from, to)| a.0 < *from && *to < b.0))
}

/// Draws cumulative distributions of errors in this unit, with lines at 50 % and 95 %; `of` says what is counted.
pub fn distributions(
    area: &Area<'_>,
    heading: &str,
    (unit, of): (&str, &str),
    series: &[DistributionCurve],
) -> Result<(), EvaluationError> {
    let legend = legend(series.iter().map(|curve| curve.label.as_str()));
    let frame = Frame::new(area, heading, &legend)?;
    let largest = series.iter().map(|curve| curve.distribution.quantile(1.0)).fold(0.0, f64::max);
    let most = series.iter().map(|curve| curve.distribution.quantile(0.99)).fold(0.0, f64::max);
    let cut = most * OUTLIER_RATIO < largest && most > 0.0;
    let end = if cut { most * 1.3 } else { (largest * 1.02).max(1e-6) };
    let label = if cut {
        let space = if unit == "°" { "" } else { " " };
        format!("error ({unit}); the largest, {largest:.2}{space}{unit}, lies beyond")
    } else {
        format!("error ({unit})")
    };

    let x = Axis { label, range: 0.0..end };
    let y = Axis { label: format!("share of {of} (%)"), range: 0.0..101.0 };
    let mut chart = frame.chart(&x, &y)?;
    let beneath = text(Type::Tick, FAINT_INK, HPos::Right, VPos::Top);
    for level in [50.0, 95.0] {
        // Right and beneath: where a distribution has long passed.
        let name = Text::new(format!("{level} %"), (0, units(3)), &beneath);
        chart.draw_series([EmptyElement::at((end * 0.995, level)) + name])?;
        let dashes = (0..60).step_by(2).map(|i| {
            let at = |i: i32| (end * f64::from(i) / 60.0, level);
            PathElement::new(vec![at(i), at(i + 1)], stroke(AXIS, 1.0))
        });
        chart.draw_series(dashes)?;
    }
    let (width_px, height_px) = frame.plot_px();
    for (number, curve) in series.iter().enumerate().rev() {
        let role = Role::Estimate(number);
        let line = by_distance(&staircase(&curve.distribution, end), (end / width_px, 101.0 / height_px));
        chart.draw_series([PathElement::new(line, stroke(color(role), width_px_of(role)))])?;
    }
    Ok(())
}

fn width_px_of(role: Role) -> f64 {
    width_px(role) + 0.5
}

fn legend<'l>(labels: impl Iterator<Item = &'l str>) -> Vec<Entry> {
    let entry = |(number, label): (usize, &str)| Entry {
        label: label.to_owned(),
        color: color(Role::Estimate(number)),
        swatch: Swatch::Line(width_px_of(Role::Estimate(number))),
    };
    labels.enumerate().map(entry).collect()
}

fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values
        .fold(None, |span: Option<(f64, f64)>, v| {
            span.map_or(Some((v, v)), |(a, b)| Some((a.min(v), b.max(v))))
        })
        .unwrap_or((0.0, 0.0))
}

/// Corners of the empirical distribution up to `end`: share (%) not above each error.
fn staircase(distribution: &Distribution, end: f64) -> Vec<(f64, f64)> {
    let sorted = distribution.sorted();
    let percent = |count: usize| 100.0 * count as f64 / sorted.len() as f64;
    let mut corners = vec![(0.0, 0.0)];
    for (i, error) in sorted.iter().enumerate().take_while(|(_, error)| **error <= end) {
        corners.push((*error, percent(i)));
        corners.push((*error, percent(i + 1)));
    }
    let reached = corners[corners.len() - 1].1;
    corners.push((end, reached));
    corners
}
