//! Errors of ranges over what tells them, what is taken off, and their distribution before and after.

use super::axes::{Axis, Entry, Frame, Swatch};
use super::canvas::{self, AXIS, Area, INK, color, fill, stroke, units};
use super::{DistributionCurve, Role, curves};
use crate::EvaluationError;
use plotters::element::{Circle, PathElement};

/// Dots of each cloud that are drawn.
const CLOUD_POINTS: usize = 2500;
/// Errors beyond this share on either side lie outside the panel.
const BEYOND: f64 = 0.003;

/// Dots of one kind of range.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorDots {
    /// Name in the legend.
    pub label: String,
    /// What tells the error, in its unit, and the error, m.
    pub points: Vec<(f64, f64)>,
}

/// Errors of ranges.
#[derive(Debug, Clone)]
pub struct RangeErrors {
    /// What tells them, with its unit.
    pub of: String,
    /// The ranges.
    pub dots: Vec<ErrorDots>,
    /// What is taken off: value, error, m, and its standard deviation, m, in rising order of the value.
    pub taken_off: Vec<(f64, f64, f64)>,
    /// Sizes of errors before and after.
    pub distributions: Vec<DistributionCurve>,
}

/// Errors over what tells them beside their distributions.
pub fn range_figure(errors: &RangeErrors, title: &str) -> Result<String, EvaluationError> {
    if errors.dots.iter().all(|dots| dots.points.is_empty()) {
        return Err(EvaluationError::Plot { reason: "no range to draw".to_owned() });
    }
    canvas::svg((1240, 480), title, |page| {
        let (left, right) = page.split_horizontally(units(720));
        over_diagnostic(&left, errors)?;
        curves::distributions(&right, "Size of the errors", ("m", "ranges"), &errors.distributions)
    })
}

fn over_diagnostic(area: &Area<'_>, errors: &RangeErrors) -> Result<(), EvaluationError> {
    // Distributions are drawn in the first two colours.
    let of_dots = |number: usize| color(Role::Estimate(number + 2));
    let dots = errors.dots.iter().enumerate();
    let mut legend: Vec<Entry> = dots
        .map(|(k, dots)| Entry { label: dots.label.clone(), color: of_dots(k), swatch: Swatch::Ring })
        .collect();
    if !errors.taken_off.is_empty() {
        let label = "taken off, ± standard deviation".to_owned();
        legend.push(Entry { label, color: INK, swatch: Swatch::Line(2.0) });
    }
    let frame = Frame::new(area, "Errors less the offset", &legend)?;
    let points = || errors.dots.iter().flat_map(|dots| &dots.points);
    let (start, end) = (
        points().map(|p| p.0).fold(f64::INFINITY, f64::min),
        points().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max),
    );
    let mut sizes: Vec<f64> = points().map(|p| p.1).collect();
    sizes.sort_by(f64::total_cmp);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of the count, floored"
    )]
    let beyond = (BEYOND * sizes.len() as f64) as usize;
    let (low, high) = (sizes[beyond].min(-0.05), sizes[sizes.len() - 1 - beyond].max(0.05));
    let room = 0.05 * (high - low);
    let y = Axis { label: "error (m)".to_owned(), range: low - room..high + room };
    let x = Axis { label: errors.of.clone(), range: start..end.max(start + 1e-3) };
    let within = |value: f64| value.clamp(y.range.start, y.range.end);
    let mut chart = frame.chart(&x, &y)?;
    chart
        .draw_series([PathElement::new(vec![(x.range.start, 0.0), (x.range.end, 0.0)], stroke(AXIS, 1.0))])?;
    let stride = points().count().div_ceil(CLOUD_POINTS).max(1);
    for (k, dots) in errors.dots.iter().enumerate() {
        let shown = dots.points.iter().step_by(stride).filter(|p| y.range.contains(&p.1));
        chart.draw_series(shown.map(|point| Circle::new(*point, 4, fill(of_dots(k)))))?;
    }
    let line = |width: f64, at: fn(&(f64, f64, f64)) -> f64| {
        let points = errors.taken_off.iter().map(|point| (point.0, within(at(point)))).collect::<Vec<_>>();
        PathElement::new(points, stroke(INK, width))
    };
    chart.draw_series([line(2.0, |p| p.1), line(0.8, |p| p.1 - p.2), line(0.8, |p| p.1 + p.2)])?;
    Ok(())
}
