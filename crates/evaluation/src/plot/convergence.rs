//! The least cost that a search has found so far, over its evaluations.

use super::Role;
use super::axes::{Axis, Entry, Frame, Swatch, power_of_ten};
use super::canvas::{self, AXIS, Area, color, stroke};
use crate::EvaluationError;
use plotters::element::PathElement;

/// Costs above the least times this are cut off: what the first guesses cost says little.
const SHOWN_ABOVE_LEAST: f64 = 1e4;
/// Highest over least cost from which on powers of ten are ticks enough.
const WIDE: f64 = 100.0;
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

/// Searches over their evaluations, on a logarithmic axis of the cost, in `unit`; `reference` is a named cost to hold them against.
/// Costs that are not above zero are left out.
pub fn convergence_figure(
    curves: &[ConvergenceCurve],
    reference: Option<(&str, f64)>,
    title: &str,
    unit: &str,
) -> Result<String, EvaluationError> {
    canvas::svg((900, 420), title, |page| draw(page, curves, reference, unit))
}

fn draw(
    area: &Area<'_>,
    curves: &[ConvergenceCurve],
    reference: Option<(&str, f64)>,
    unit: &str,
) -> Result<(), EvaluationError> {
    let reference = reference.filter(|(_, cost)| shown(*cost));
    let costs = curves.iter().flat_map(|curve| &curve.improvements).map(|(_, cost)| *cost);
    let costs = costs.chain(reference.map(|(_, cost)| cost)).filter(|cost| shown(*cost));
    let (least, highest) = costs.fold((f64::INFINITY, 0.0), |(low, high), c| (c.min(low), c.max(high)));
    if !least.is_finite() {
        return Err(EvaluationError::Plot { reason: "no cost above zero to draw".to_owned() });
    }
    let top = highest.min(least * SHOWN_ABOVE_LEAST);
    // A narrow range far from one is shown in a power of ten of the unit: labels stay short.
    let power = least.log10().floor();
    let power = if top < WIDE * least && !(-1.0..4.0).contains(&power) { power } else { 0.0 };
    let (low, high) = (least.log10() - power, top.log10() - power);
    let room = (ROOM * (high - low)).max(0.01);
    let ten = if power < 0.0 || power > 0.0 { format!("{} ", power_of_ten(power)) } else { String::new() };
    let label = format!("least cost so far ({ten}{unit})");
    let y = Axis { label, range: low - room..high + room };
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
        let at =
            |part: u32| (x.range.end * f64::from(part) / f64::from(DASHES), cost.min(top).log10() - power);
        let dashes = (0..DASHES).step_by(2).map(|part| vec![at(part), at(part + 1)]);
        chart.draw_series(dashes.map(|dash| PathElement::new(dash, stroke(AXIS, 1.0))))?;
    }
    for (number, curve) in curves.iter().enumerate().rev() {
        let line = staircase(curve, top, power);
        chart.draw_series([PathElement::new(line, stroke(color(Role::Estimate(number)), 1.5))])?;
    }
    Ok(())
}

fn shown(cost: f64) -> bool {
    cost.is_finite() && cost > 0.0
}

/// Corners of a curve that falls at each improvement, logarithms of costs less `power`.
fn staircase(curve: &ConvergenceCurve, top: f64, power: f64) -> Vec<(f64, f64)> {
    let mut corners: Vec<(f64, f64)> = Vec::new();
    for (evaluation, cost) in curve.improvements.iter().filter(|(_, cost)| shown(*cost)) {
        let (x, y) = (*evaluation as f64, cost.min(top).log10() - power);
        corners.extend(corners.last().map(|(_, before)| (x, *before)));
        corners.push((x, y));
    }
    corners.extend(corners.last().map(|(_, least)| (curve.evaluations as f64, *least)));
    corners
}
