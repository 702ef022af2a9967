//! The least cost that a search has found so far, over its evaluations.

use super::Role;
use super::axes::{Axis, Entry, Frame, Swatch};
use super::canvas::{self, AXIS, Area, color, stroke};
use crate::EvaluationError;
use plotters::element::PathElement;

/// Costs above the least times this are cut off: what the first guesses cost says little.
const SHOWN_ABOVE_LEAST: f64 = 1e4;
/// Room above and below, as a share of the height.
const ROOM: f64 = 0.06;
/// Dashes of the line of reference.
const DASHES: u32 = 60;

/// The convergence of one search.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvergenceCurve {
    /// Name in the legend.
    pub label: String,
    /// Evaluations and least cost at each improvement, evaluations rising, costs falling.
    pub improvements: Vec<(usize, f64)>,
    /// Evaluations in all.
    pub evaluations: usize,
}

/// Searches over their evaluations, on a logarithmic axis of the cost; `reference` is a named cost to hold them against. Costs that
/// are not above zero are left out.
pub fn convergence_figure(
    curves: &[ConvergenceCurve],
    reference: Option<(&str, f64)>,
    title: &str,
    y_label: &str,
) -> Result<String, EvaluationError> {
    canvas::svg((900, 420), title, |page| draw(page, curves, reference, y_label))
}

fn draw(
    area: &Area<'_>,
    curves: &[ConvergenceCurve],
    reference: Option<(&str, f64)>,
    y_label: &str,
) -> Result<(), EvaluationError> {
    let reference = reference.filter(|(_, cost)| shown(*cost));
    let costs = curves.iter().flat_map(|curve| &curve.improvements).map(|(_, cost)| *cost);
    let costs = costs.chain(reference.map(|(_, cost)| cost)).filter(|cost| shown(*cost));
    let (least, highest) = costs.fold((f64::INFINITY, 0.0), |(low, high), c| (c.min(low), c.max(high)));
    if !least.is_finite() {
        return Err(EvaluationError::Plot { reason: "no cost above zero to draw".to_owned() });
    }
    let top = highest.min(least * SHOWN_ABOVE_LEAST);
    let (low, high) = (least.log10(), top.log10());
    let room = (ROOM * (high - low)).max(0.01);
    let y = Axis { label: y_label.to_owned(), range: low - room..high + room };
    let last = curves.iter().map(|curve| curve.evaluations).max().unwrap_or(1);
    let x = Axis { label: "evaluations".to_owned(), range: 0.0..last.max(1) as f64 };

    let entry = |(number, curve): (usize, &ConvergenceCurve)| Entry {
        label: curve.label.clone(),
        color: color(Role::Estimate(number)),
        swatch: Swatch::Line(1.5),
    };
    let mut legend: Vec<Entry> = curves.iter().enumerate().map(entry).collect();
    legend.extend(reference.map(|(label, _)| Entry {
        label: label.to_owned(),
        color: AXIS,
        swatch: Swatch::Line(1.0),
    }));
    let frame = Frame::new(area, "", &legend)?;
    let mut chart = frame.magnitudes(&x, &y)?;
    if let Some((_, cost)) = reference {
        let at = |part: u32| (x.range.end * f64::from(part) / f64::from(DASHES), cost.min(top).log10());
        let dashes = (0..DASHES).step_by(2).map(|part| vec![at(part), at(part + 1)]);
        chart.draw_series(dashes.map(|dash| PathElement::new(dash, stroke(AXIS, 1.0))))?;
    }
    for (number, curve) in curves.iter().enumerate().rev() {
        let line = staircase(curve, top);
        chart.draw_series([PathElement::new(line, stroke(color(Role::Estimate(number)), 1.5))])?;
    }
    Ok(())
}

fn shown(cost: f64) -> bool {
    cost.is_finite() && cost > 0.0
}

/// Corners of a curve that falls at each improvement, logarithms of costs.
fn staircase(curve: &ConvergenceCurve, top: f64) -> Vec<(f64, f64)> {
    let mut corners: Vec<(f64, f64)> = Vec::new();
    for (evaluation, cost) in curve.improvements.iter().filter(|(_, cost)| shown(*cost)) {
        let (x, y) = (*evaluation as f64, cost.min(top).log10());
        corners.extend(corners.last().map(|(_, before)| (x, *before)));
        corners.push((x, y));
    }
    corners.extend(corners.last().map(|(_, least)| (curve.evaluations as f64, *least)));
    corners
}
