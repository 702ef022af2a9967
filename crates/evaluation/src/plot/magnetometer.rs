//! A magnetometer before and after its calibration: length of the field over time, and its points in the three planes.

use super::Role;
use super::axes::{Axis, Chart, Entry, Frame, Swatch};
use super::canvas::{self, AXIS, Area, FAINT_INK, color, fill, stroke, units};
use super::thin::by_columns;
use crate::EvaluationError;
use plotters::element::{Circle, PathElement};
use plotters::style::RGBColor;
use std::f64::consts::TAU;

/// Points of each cloud that are drawn: enough to show a sphere, few enough for a small file.
const CLOUD_POINTS: usize = 600;
/// Corners of a drawn circle.
const CORNERS: u32 = 120;
const PLANES: [(&str, usize, &str, usize); 3] = [("x", 0, "y", 1), ("x", 0, "z", 2), ("y", 1, "z", 2)];

/// Readings of a magnetometer, raw and calibrated, µT; all slices of one length.
#[derive(Debug, Clone, Copy)]
pub struct MagneticCloud<'a> {
    /// Time, s, rising.
    pub time_s: &'a [f64],
    /// As read.
    pub raw_ut: &'a [[f64; 3]],
    /// As calibrated.
    pub calibrated_ut: &'a [[f64; 3]],
    /// Length that the calibrated field should have.
    pub norm_ut: f64,
}

/// Length of the field over time, and the readings seen along each axis, before and after.
pub fn magnetometer_figure(cloud: &MagneticCloud<'_>, title: &str) -> Result<String, EvaluationError> {
    let lengths = [cloud.time_s.len(), cloud.raw_ut.len(), cloud.calibrated_ut.len()];
    if lengths.contains(&0) {
        return Err(EvaluationError::TooFewPoses { what: "the tumble", found: 0, expected: 1 });
    }
    canvas::svg((1240, 800), title, |page| {
        let (above, below) = page.split_vertically(units(300));
        let above = above.split_evenly((1, 2));
        over_time(&above[0], cloud)?;
        deviation(&above[1], cloud)?;
        for (area, plane) in below.split_evenly((1, 3)).iter().zip(PLANES) {
            draw_plane(area, cloud, plane)?;
        }
        Ok(())
    })
}

fn raw_color() -> RGBColor {
    color(Role::Estimate(1))
}

fn calibrated_color() -> RGBColor {
    color(Role::Estimate(0))
}

fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

type Curve = Vec<(f64, f64)>;

fn curve(cloud: &MagneticCloud<'_>, field: &[[f64; 3]]) -> Curve {
    cloud.time_s.iter().copied().zip(field.iter().map(length)).collect()
}

/// Mean, and standard deviation over the mean, %.
fn mean_and_percent(curve: &[(f64, f64)]) -> (f64, f64) {
    let count = curve.len().max(1) as f64;
    let mean = curve.iter().map(|p| p.1).sum::<f64>() / count;
    let variance = curve.iter().map(|p| (p.1 - mean).powi(2)).sum::<f64>() / count;
    (mean, if mean > 0.0 { 100.0 * variance.sqrt() / mean } else { 0.0 })
}

fn over_time(area: &Area<'_>, cloud: &MagneticCloud<'_>) -> Result<(), EvaluationError> {
    let (raw, calibrated) = (curve(cloud, cloud.raw_ut), curve(cloud, cloud.calibrated_ut));
    let entry = |name: &str, curve: &Curve, color| Entry {
        label: format!("{name}, sd {:.2} %", mean_and_percent(curve).1),
        color,
        swatch: Swatch::Line(1.5),
    };
    let legend = [entry("raw", &raw, raw_color()), entry("calibrated", &calibrated, calibrated_color())];
    let frame = Frame::new(area, "Length of the field", &legend)?;
    let highest = raw.iter().chain(&calibrated).map(|p| p.1).fold(0.0, f64::max);
    let y = Axis { label: "field (µT)".to_owned(), range: 0.0..(highest * 1.06).max(1e-3) };
    draw_curves(&frame, &y, cloud, &[(raw, raw_color()), (calibrated, calibrated_color())])
}

/// What is left after calibration, enlarged: noise is a band, an uneven place is a slow wave.
fn deviation(area: &Area<'_>, cloud: &MagneticCloud<'_>) -> Result<(), EvaluationError> {
    let mut curve = curve(cloud, cloud.calibrated_ut);
    let (mean, percent) = mean_and_percent(&curve);
    for (_, value) in &mut curve {
        *value = if mean > 0.0 { 100.0 * (*value / mean - 1.0) } else { 0.0 };
    }
    let frame = Frame::new(area, "Calibrated length off its mean", &[])?;
    // Outliers leave the panel, lest they flatten the rest.
    let largest = curve.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
    let reach = (1.1 * largest).min(6.0 * percent).max(1e-6);
    for (_, value) in &mut curve {
        *value = value.clamp(-reach, reach);
    }
    let y = Axis { label: "deviation (%)".to_owned(), range: -reach..reach };
    draw_curves(&frame, &y, cloud, &[(curve, calibrated_color())])
}

fn draw_curves(
    frame: &Frame<'_>,
    y: &Axis,
    cloud: &MagneticCloud<'_>,
    curves: &[(Curve, RGBColor)],
) -> Result<(), EvaluationError> {
    let start = cloud.time_s.first().copied().unwrap_or(0.0);
    let end = cloud.time_s.last().copied().unwrap_or(0.0);
    let x = Axis { label: "time (s)".to_owned(), range: start..end.max(start + 1e-3) };
    let mut chart = frame.chart(&x, y)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a plot has some hundred pixels"
    )]
    let columns = frame.plot_px().0 as usize;
    for (curve, color) in curves {
        chart.draw_series([PathElement::new(by_columns(curve, columns), stroke(*color, 1.2))])?;
    }
    Ok(())
}

fn draw_plane(
    area: &Area<'_>,
    cloud: &MagneticCloud<'_>,
    (right, right_axis, up, up_axis): (&str, usize, &str, usize),
) -> Result<(), EvaluationError> {
    let legend = [
        Entry { label: "raw".to_owned(), color: raw_color(), swatch: Swatch::Ring },
        Entry { label: "calibrated".to_owned(), color: calibrated_color(), swatch: Swatch::Ring },
        Entry { label: "sphere".to_owned(), color: FAINT_INK, swatch: Swatch::Line(1.2) },
    ];
    let frame = Frame::new(area, &format!("{right}–{up} plane"), &legend)?;
    let (width_px, height_px) = frame.plot_px();
    let reach =
        cloud.raw_ut.iter().chain(cloud.calibrated_ut).flatten().fold(cloud.norm_ut, |r, v| r.max(v.abs()));
    let pixel_ut = 2.1 * reach.max(1e-3) / width_px.min(height_px);
    let axis = |name: &str, length_px: f64| {
        let half = 0.5 * pixel_ut * length_px;
        Axis { label: format!("{name} (µT)"), range: -half..half }
    };
    let mut chart = frame.map(&axis(right, width_px), &axis(up, height_px))?;
    let line = |points: Vec<(f64, f64)>, color, width| PathElement::new(points, stroke(color, width));
    let cross = [vec![(-reach, 0.0), (reach, 0.0)], vec![(0.0, -reach), (0.0, reach)]];
    chart.draw_series(cross.map(|points| line(points, AXIS, 0.8)))?;
    let at = |v: &[f64; 3]| (v[right_axis], v[up_axis]);
    dots(&mut chart, cloud.raw_ut.iter().map(at), raw_color())?;
    dots(&mut chart, cloud.calibrated_ut.iter().map(at), calibrated_color())?;
    let circle = (0..=CORNERS).map(|i| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(CORNERS)).sin_cos();
        (cloud.norm_ut * cos, cloud.norm_ut * sin)
    });
    chart.draw_series([line(circle.collect(), FAINT_INK, 1.2)])?;
    Ok(())
}

fn dots(
    chart: &mut Chart<'_, '_>,
    points: impl ExactSizeIterator<Item = (f64, f64)>,
    color: RGBColor,
) -> Result<(), EvaluationError> {
    let stride = points.len().div_ceil(CLOUD_POINTS).max(1);
    chart.draw_series(points.step_by(stride).map(|point| Circle::new(point, 5, fill(color))))?;
    Ok(())
}
