//! Errors over time, and how they are distributed.

use super::axes::{Axis, Entry, Frame, Swatch};
use super::canvas::{AXIS, Area, FAINT_INK, Type, color, stroke, text, units, width_px};
use super::thin::{by_columns, by_distance};
use super::{DistributionCurve, Role, TimeCurve};
use crate::EvaluationError;
use crate::statistics::Distribution;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::text_anchor::{HPos, VPos};

/// Room above the highest value, as a share.
const HEADROOM: f64 = 1.06;
/// A distribution is cut where its 99th percentile, times this, leaves the largest error far outside.
const OUTLIER_RATIO: f64 = 2.5;

/// Draws values over time. Values below zero are shown when there are any.
pub fn over_time(
    area: &Area<'_>,
    heading: &str,
    y_label: &str,
    series: &[TimeCurve],
) -> Result<(), EvaluationError> {
    let frame = Frame::new(area, heading, &legend(series.iter().map(|curve| curve.label.as_str())))?;
    let points = || series.iter().flat_map(|curve| &curve.points);
    let (start, end) = span(points().map(|p| p.0));
    let (low, high) = span(points().map(|p| p.1));
    let (low, high) = (low.min(0.0), high.max(0.0));
    let x = Axis { label: "time (s)".to_owned(), range: start..end.max(start + 1e-3) };
    let y = Axis { label: y_label.to_owned(), range: low * HEADROOM..(high * HEADROOM).max(low + 1e-6) };
    let mut chart = frame.chart(&x, &y)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a plot has some hundred pixels"
    )]
    let columns = frame.plot_px().0 as usize;
    // The last first: the first curve is the one that matters and lies on top.
    for (number, curve) in series.iter().enumerate().rev() {
        let role = Role::Estimate(number);
        let line = by_columns(&curve.points, columns);
        chart.draw_series([PathElement::new(line, stroke(color(role), 1.2))])?;
    }
    Ok(())
}

/// Draws cumulative distributions, with lines at 50 % and 95 %.
pub fn distributions(
    area: &Area<'_>,
    heading: &str,
    series: &[DistributionCurve],
) -> Result<(), EvaluationError> {
    let legend = legend(series.iter().map(|curve| curve.label.as_str()));
    let frame = Frame::new(area, heading, &legend)?;
    let largest = series.iter().map(|curve| curve.distribution.quantile(1.0)).fold(0.0, f64::max);
    let most = series.iter().map(|curve| curve.distribution.quantile(0.99)).fold(0.0, f64::max);
    let cut = most * OUTLIER_RATIO < largest && most > 0.0;
    let end = if cut { most * 1.3 } else { (largest * 1.02).max(1e-6) };
    let label = if cut {
        format!("error (m); the largest, {largest:.2} m, lies beyond")
    } else {
        "error (m)".to_owned()
    };

    let x = Axis { label, range: 0.0..end };
    let y = Axis { label: "share of poses (%)".to_owned(), range: 0.0..101.0 };
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
