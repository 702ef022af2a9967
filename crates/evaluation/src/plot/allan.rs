//! Allan deviations on logarithmic axes: measured with a bar of ± σ, fitted, and the straight lines of the parts.

use super::Role;
use super::axes::{Axis, Entry, Frame, Swatch};
use super::canvas::{self, Area, FAINT_INK, color, fill, stroke, units};
use crate::EvaluationError;
use plotters::element::{Circle, PathElement};
use std::f64::consts::{LN_2, PI};

/// Points of a drawn fit.
const FIT_POINTS: u32 = 120;
/// Dashes of a drawn part.
const DASHES: u32 = 40;

/// Parts of the Allan variance: `3Q²/τ² + N²/τ + (2 ln 2/π) B² + K²τ/3`, in units of the readings and seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AllanParts {
    /// Q.
    pub quantisation: f64,
    /// N.
    pub white: f64,
    /// B.
    pub instability: f64,
    /// K.
    pub walk: f64,
}

impl AllanParts {
    fn deviations(&self, tau_s: f64) -> [f64; 4] {
        [
            self.quantisation * 3_f64.sqrt() / tau_s,
            self.white / tau_s.sqrt(),
            self.instability * (2.0 * LN_2 / PI).sqrt(),
            self.walk * (tau_s / 3.0).sqrt(),
        ]
    }

    fn deviation(&self, tau_s: f64) -> f64 {
        self.deviations(tau_s).iter().map(|d| d * d).sum::<f64>().sqrt()
    }
}

/// The curve of one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AllanAxis {
    /// Name in the legend.
    pub name: &'static str,
    /// Averaging time, s, deviation, its σ; times and deviations above 0, times rising.
    pub curve: Vec<(f64, f64, f64)>,
    /// What was fitted.
    pub parts: AllanParts,
}

/// The axes of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct AllanPanel {
    /// Name of the sensor.
    pub heading: &'static str,
    /// Unit of the deviation.
    pub unit: &'static str,
    /// Its axes; the parts are drawn of the one with the most white noise.
    pub axes: Vec<AllanAxis>,
}

/// Allan deviations, a panel for each sensor side by side.
pub fn allan_figure(panels: &[AllanPanel], title: &str) -> Result<String, EvaluationError> {
    canvas::svg((1240, 560), title, |page| {
        for (area, panel) in page.split_evenly((1, panels.len().max(1))).iter().zip(panels) {
            draw(area, panel)?;
        }
        Ok(())
    })
}

fn draw(area: &Area<'_>, panel: &AllanPanel) -> Result<(), EvaluationError> {
    let measured = |(number, axis): (usize, &AllanAxis)| Entry {
        label: axis.name.to_owned(),
        color: color(Role::Estimate(number)),
        swatch: Swatch::Ring,
    };
    let mut legend: Vec<Entry> = panel.axes.iter().enumerate().map(measured).collect();
    let line =
        |label: &str, color, width| Entry { label: label.to_owned(), color, swatch: Swatch::Line(width) };
    legend.push(line("fit", color(Role::Truth), 1.5));
    legend.push(line("parts of the worst axis", FAINT_INK, 0.8));
    let frame = Frame::new(area, panel.heading, &legend)?;

    let points = || panel.axes.iter().flat_map(|axis| &axis.curve).map(|(t, d, _)| (t.log10(), d.log10()));
    let span = |of: fn((f64, f64)) -> f64| {
        points().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let (shortest, longest) = span(|p| p.0);
    let (lowest, highest) = span(|p| p.1);
    let x = Axis { label: "averaging time (s)".to_owned(), range: shortest - 0.1..longest + 0.1 };
    let y = Axis { label: format!("Allan deviation ({})", panel.unit), range: lowest - 0.35..highest + 0.15 };
    let (x_range, y_range) = (x.range.clone(), y.range.clone());
    let mut chart = frame.decades(&x, &y)?;

    let worst = panel.axes.iter().max_by(|a, b| a.parts.white.total_cmp(&b.parts.white));
    for part in 0..4 {
        let Some(worst) = worst else { break };
        let at = |share: f64| {
            let x = x_range.start + share * (x_range.end - x_range.start);
            (x, worst.parts.deviations(10_f64.powf(x))[part].log10())
        };
        let dashes = (0..DASHES)
            .map(|i| (at(f64::from(i) / f64::from(DASHES)), at((f64::from(i) + 0.5) / f64::from(DASHES))));
        let inside = dashes.filter(|(from, to)| y_range.contains(&from.1) && y_range.contains(&to.1));
        chart
            .draw_series(inside.map(|(from, to)| PathElement::new(vec![from, to], stroke(FAINT_INK, 0.8))))?;
    }
    for (number, axis) in panel.axes.iter().enumerate() {
        let fitted = (0..=FIT_POINTS).map(|i| {
            let x = shortest + f64::from(i) / f64::from(FIT_POINTS) * (longest - shortest);
            (x, axis.parts.deviation(10_f64.powf(x)).log10().clamp(y_range.start, y_range.end))
        });
        chart.draw_series([PathElement::new(fitted.collect::<Vec<_>>(), stroke(color(Role::Truth), 1.5))])?;
        let color = color(Role::Estimate(number));
        let bars = axis.curve.iter().map(|(tau, deviation, sd)| {
            let end = |value: f64| (tau.log10(), value.log10().clamp(y_range.start, y_range.end));
            PathElement::new(vec![end((deviation - sd).max(0.0)), end(deviation + sd)], stroke(color, 0.8))
        });
        chart.draw_series(bars)?;
        let dots = axis
            .curve
            .iter()
            .map(|(tau, deviation, _)| Circle::new((tau.log10(), deviation.log10()), units(2), fill(color)));
        chart.draw_series(dots)?;
    }
    Ok(())
}
