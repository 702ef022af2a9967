//! A panel: heading, legend, axes with round ticks, grid.

use super::canvas::{
    AXIS, Area, FAINT_INK, GRID, INK, Type, fill, shown, stroke, text, text_width_px, units,
};
use crate::EvaluationError;
use plotters::backend::SVGBackend;
use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::element::{Circle, PathElement, Rectangle};
use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};
use std::ops::Range;

/// Coordinates of a panel.
pub type Axes = Cartesian2d<Scale, Scale>;
/// A panel ready for curves.
pub type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Axes>;

/// Room for tick labels and the name of the axis, px.
const LEFT_PX: i32 = 62;
const BOTTOM_PX: i32 = 44;
/// Room under the name of the x axis, px.
const FOOT_PX: i32 = 10;
/// Room right of the plot, so that the last tick label is whole, px.
const RIGHT_PX: i32 = 22;
/// Room above the plot, below the legend, px.
const TOP_PX: i32 = 6;
const HEADING_PX: i32 = 24;
const LEGEND_ROW_PX: i32 = 20;
/// From swatch to name, px.
const SWATCH_GAP_PX: i32 = 6;
/// Between entries of the legend, px.
const LEGEND_GAP_PX: i32 = 16;
/// Smallest distance of ticks that reads well along an axis, px.
const X_TICK_EVERY_PX: f64 = 70.0;
const Y_TICK_EVERY_PX: f64 = 34.0;
/// Fewer ticks do not tell the scale of a logarithmic axis.
const FEWEST_TICKS: usize = 3;

/// One axis: name with unit, range shown.
#[derive(Debug, Clone)]
pub struct Axis {
    pub label: String,
    pub range: Range<f64>,
}

/// What stands before a name in the legend.
#[derive(Debug, Clone, Copy)]
pub enum Swatch {
    Line(f64),
    Ring,
    Square,
}

impl Swatch {
    fn width_px(self) -> i32 {
        match self {
            Self::Line(_) => 22,
            Self::Ring | Self::Square => 12,
        }
    }
}

/// One entry of a legend.
#[derive(Debug, Clone)]
pub struct Entry {
    pub label: String,
    pub color: RGBColor,
    pub swatch: Swatch,
}

/// A panel without its ranges: the head is drawn, the size of the plot is known.
pub struct Frame<'b> {
    body: Area<'b>,
}

impl<'b> Frame<'b> {
    /// Draws heading and legend, as many rows as they take.
    pub fn new(area: &Area<'b>, heading: &str, legend: &[Entry]) -> Result<Self, EvaluationError> {
        let heading_px = if heading.is_empty() { 0 } else { HEADING_PX };
        let rows = legend_rows(legend, px(area.dim_in_pixel().0) - LEFT_PX - RIGHT_PX);
        let rows_px = LEGEND_ROW_PX * i32::try_from(rows.len()).unwrap_or(0);
        let (head, body) = area.split_vertically(units(heading_px + rows_px + TOP_PX));
        if !heading.is_empty() {
            head.draw_text(heading, &text(Type::Heading, INK, HPos::Left, VPos::Top), (units(LEFT_PX), 0))?;
        }
        let mut y = heading_px + LEGEND_ROW_PX / 2;
        for row in rows {
            let mut x = LEFT_PX;
            for entry in row {
                draw_entry(&head, entry, x, y)?;
                x += entry_width_px(entry);
            }
            y += LEGEND_ROW_PX;
        }
        Ok(Self { body })
    }

    /// Width and height of the plot, px.
    pub fn plot_px(&self) -> (f64, f64) {
        let (width, height) = self.body.dim_in_pixel();
        let across = (px(width) - LEFT_PX - RIGHT_PX).max(1);
        (f64::from(across), f64::from((px(height) - BOTTOM_PX - FOOT_PX).max(1)))
    }

    /// Draws axes and a grid as fine as either allows.
    pub fn chart(&self, x: &Axis, y: &Axis) -> Result<Chart<'_, 'b>, EvaluationError> {
        self.chart_with_ticks(x, y, Y_TICK_EVERY_PX)
    }

    /// Draws axes of equal scale and a grid of squares.
    pub fn map(&self, x: &Axis, y: &Axis) -> Result<Chart<'_, 'b>, EvaluationError> {
        self.chart_with_ticks(x, y, X_TICK_EVERY_PX)
    }

    /// Draws logarithmic axes: ranges and points are common logarithms, ticks are powers of ten.
    pub fn decades(&self, x: &Axis, y: &Axis) -> Result<Chart<'_, 'b>, EvaluationError> {
        self.chart_on(x, y, &Scale::decades(&x.range), &Scale::decades(&y.range))
    }

    /// Draws a linear axis across and a logarithmic one up, of which range and points are common logarithms; ticks are round numbers.
    pub fn magnitudes(&self, x: &Axis, y: &Axis) -> Result<Chart<'_, 'b>, EvaluationError> {
        let (width, height) = self.plot_px();
        let x_scale = Scale::over(&x.range, width / X_TICK_EVERY_PX);
        self.chart_on(x, y, &x_scale, &Scale::magnitudes(&y.range, height / Y_TICK_EVERY_PX))
    }

    fn chart_with_ticks(
        &self,
        x: &Axis,
        y: &Axis,
        y_tick_every_px: f64,
    ) -> Result<Chart<'_, 'b>, EvaluationError> {
        let (width, height) = self.plot_px();
        let (x_scale, y_scale) =
            (Scale::over(&x.range, width / X_TICK_EVERY_PX), Scale::over(&y.range, height / y_tick_every_px));
        self.chart_on(x, y, &x_scale, &y_scale)
    }

    fn chart_on(
        &self,
        x: &Axis,
        y: &Axis,
        x_scale: &Scale,
        y_scale: &Scale,
    ) -> Result<Chart<'_, 'b>, EvaluationError> {
        for axis in [x, y] {
            let span = axis.range.end - axis.range.start;
            if !(span.is_finite() && span > 0.0) {
                let reason = format!(
                    "axis \"{}\" would run from {} to {}",
                    axis.label, axis.range.start, axis.range.end
                );
                return Err(EvaluationError::Plot { reason });
            }
        }
        let mut chart = ChartBuilder::on(&self.body)
            .margin_right(units(RIGHT_PX))
            .margin_bottom(units(FOOT_PX))
            .x_label_area_size(units(BOTTOM_PX))
            .y_label_area_size(units(LEFT_PX))
            .build_cartesian_2d(x_scale.clone(), y_scale.clone())?;
        chart
            .configure_mesh()
            .bold_line_style(stroke(GRID, 1.0))
            .light_line_style(stroke(GRID, 0.0))
            .axis_style(stroke(AXIS, 1.0))
            .set_all_tick_mark_size(units(4))
            .label_style(text(Type::Tick, FAINT_INK, HPos::Center, VPos::Center))
            .axis_desc_style(text(Type::Text, INK, HPos::Center, VPos::Center))
            .x_label_formatter(&|v| x_scale.label(*v))
            .y_label_formatter(&|v| y_scale.label(*v))
            .x_desc(x.label.as_str())
            .y_desc(y.label.as_str())
            .draw()?;
        Ok(chart)
    }

    /// Draws a scale bar right of the name of the x axis, where no curve runs; `metre_px` pixels are a metre.
    pub fn scale_bar(&self, metre_px: f64) -> Result<(), EvaluationError> {
        let (width, height) = self.body.dim_in_pixel();
        let length_m = step_at_least(60.0 / metre_px);
        #[expect(clippy::cast_possible_truncation, reason = "150 px at most")]
        let length_px = (length_m * metre_px).round() as i32;
        let (right, y) = (px(width) - RIGHT_PX, px(height) - FOOT_PX - 5);
        let left = right - length_px;
        let bar = [(left, y - 4), (left, y), (right, y), (right, y - 4)];
        let bar = bar.map(|(x, y)| (units(x), units(y))).to_vec();
        self.body.draw(&PathElement::new(bar, stroke(INK, 1.5)))?;
        let label = format!("{} m", plain(length_m));
        let style = text(Type::Tick, INK, HPos::Right, VPos::Center);
        self.body.draw_text(&label, &style, (units(left - 7), units(y - 2)))?;
        Ok(())
    }
}

fn px(units_of_area: u32) -> i32 {
    i32::try_from(units_of_area).unwrap_or(i32::MAX) / units(1)
}

fn entry_width_px(entry: &Entry) -> i32 {
    entry.swatch.width_px() + SWATCH_GAP_PX + text_width_px(&shown(&entry.label), Type::Text) + LEGEND_GAP_PX
}

fn legend_rows(legend: &[Entry], width_px: i32) -> Vec<Vec<&Entry>> {
    let mut rows: Vec<Vec<&Entry>> = Vec::new();
    let mut used = i32::MAX;
    for entry in legend {
        let width = entry_width_px(entry);
        if used.saturating_add(width - LEGEND_GAP_PX) > width_px {
            rows.push(Vec::new());
            used = 0;
        }
        used += width;
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

fn draw_entry(head: &Area<'_>, entry: &Entry, x: i32, y: i32) -> Result<(), EvaluationError> {
    let width_px = entry.swatch.width_px();
    let middle = (units(x + width_px / 2), units(y));
    match entry.swatch {
        Swatch::Line(stroke_px) => {
            let line = vec![(units(x), units(y)), (units(x + width_px), units(y))];
            head.draw(&PathElement::new(line, stroke(entry.color, stroke_px)))?;
        }
        Swatch::Ring => head.draw(&Circle::new(middle, units(5), stroke(entry.color, 2.0)))?,
        Swatch::Square => {
            let half = units(4);
            let corners = [(middle.0 - half, middle.1 - half), (middle.0 + half, middle.1 + half)];
            head.draw(&Rectangle::new(corners, fill(entry.color)))?;
        }
    }
    let style = text(Type::Text, INK, HPos::Left, VPos::Center);
    head.draw_text(&shown(&entry.label), &style, (units(x + width_px + SWATCH_GAP_PX), units(y)))?;
    Ok(())
}

/// What the ticks of an axis say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Labels {
    /// The value, with so many decimals.
    Decimals(usize),
    /// The power of ten of which it is the logarithm.
    Powers,
    /// The number of which it is the logarithm.
    Magnitudes,
}

/// A linear axis with ticks at round values, or one of logarithms with ticks at powers of ten or at round numbers.
#[derive(Debug, Clone)]
pub struct Scale {
    range: Range<f64>,
    ticks: Vec<f64>,
    labels: Labels,
}

impl Scale {
    /// As many ticks as there is room for, `most` at most.
    fn over(range: &Range<f64>, most: f64) -> Self {
        let step = step_at_least((range.end - range.start) / most);
        let first = (range.start / step).ceil();
        // A step is 1/30 of an axis at least, at the sizes figures have.
        let ticks = (0..40).map(|i| (first + f64::from(i)) * step).take_while(|v| *v <= range.end).collect();
        Self { range: range.clone(), ticks, labels: Labels::Decimals(decimals(step)) }
    }

    /// Every power of ten in a range of logarithms.
    fn decades(range: &Range<f64>) -> Self {
        let first = range.start.ceil();
        // No figure spans 40 powers of ten.
        let ticks = (0..40).map(|i| first + f64::from(i)).take_while(|v| *v <= range.end).collect();
        Self { range: range.clone(), ticks, labels: Labels::Powers }
    }

    /// Round numbers in a range of logarithms, `most` at most: powers of ten where three lie in it, else 1, 2, 5 and so on, else even steps.
    fn magnitudes(range: &Range<f64>, most: f64) -> Self {
        let decades = Self::decades(range);
        if decades.ticks.len() >= FEWEST_TICKS {
            return decades;
        }
        let within = |tick: &f64| range.contains(tick);
        let first = range.start.floor();
        let halves = (0..40).map(|i| first + f64::from(i)).take_while(|power| *power <= range.end);
        let halves = halves.flat_map(|power| [1.0_f64, 2.0, 5.0].map(|m| power + m.log10()));
        let mut ticks: Vec<f64> = halves.filter(within).collect();
        if ticks.len() < FEWEST_TICKS {
            let linear = 10_f64.powf(range.start)..10_f64.powf(range.end);
            let even = Self::over(&linear, most.min(8.0)).ticks.into_iter();
            ticks = even.map(f64::log10).filter(within).collect();
        }
        Self { range: range.clone(), ticks, labels: Labels::Magnitudes }
    }

    fn label(&self, value: f64) -> String {
        let decimals = match self.labels {
            Labels::Decimals(decimals) => decimals,
            Labels::Powers => return power_of_ten(value),
            Labels::Magnitudes => return magnitude(10_f64.powf(value)),
        };
        let shown = format!("{:.decimals$}", value.abs());
        // No minus before a zero.
        let negative = value < 0.0 && shown.contains(|c: char| ('1'..='9').contains(&c));
        if negative { format!("−{shown}") } else { shown }
    }
}

impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (low, high): (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        #[expect(clippy::cast_possible_truncation, reason = "saturates")]
        let units = (f64::from(low) + share * f64::from(high - low)).round() as i32;
        units
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // Asked a second time for the fine grid, which these figures do without.
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `least`.
fn step_at_least(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].map(|m| m * power).into_iter().find(|step| *step >= least * 0.999).unwrap_or(10.0 * power)
}

/// Decimals that tell multiples of a round step apart.
fn decimals(step: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0 to 9")]
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    decimals
}

/// A number above zero in four digits at most: a power of ten behind it where it would be long.
fn magnitude(value: f64) -> String {
    let scientific = format!("{value:.3e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    match exponent.parse::<i32>() {
        Ok(power @ -3..=4) => {
            let decimals = usize::try_from(3 - power).unwrap_or(0);
            let plain = format!("{value:.decimals$}");
            if plain.contains('.') {
                plain.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                plain
            }
        }
        _ => format!("{digits}·10{}", exponent.chars().map(superscript).collect::<String>()),
    }
}

/// Ten to a whole power.
pub fn power_of_ten(power: f64) -> String {
    let digits = format!("{power:.0}");
    format!("10{}", digits.chars().map(superscript).collect::<String>())
}

/// A digit or minus as an exponent; anything else as it is.
fn superscript(c: char) -> char {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match c.to_digit(10).and_then(|d| digits.get(d as usize)) {
        Some(digit) => *digit,
        None if c == '-' => '⁻',
        None => c,
    }
}

fn plain(round: f64) -> String {
    format!("{round:.*}", decimals(round))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (least, step) in [(0.7, 1.0), (1.0, 1.0), (1.1, 2.0), (3.0, 5.0), (6.0, 10.0), (0.013, 0.02)] {
            assert!((step_at_least(least) - step).abs() < 1e-12, "{least}");
        }
    }

    #[test]
    fn ticks_carry_the_decimals_they_need() {
        let scale = Scale::over(&(-0.11..0.13), 6.0);
        let labels: Vec<String> = scale.ticks.iter().map(|v| scale.label(*v)).collect();
        assert_eq!(labels, ["−0.10", "−0.05", "0.00", "0.05", "0.10"]);
    }

    #[test]
    fn decades_are_powers_of_ten() {
        let scale = Scale::decades(&(-3.2..0.4));
        let labels: Vec<String> = scale.ticks.iter().map(|v| scale.label(*v)).collect();
        assert_eq!(labels, ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
    }

    #[test]
    fn a_range_of_magnitudes_has_round_ticks_whether_it_is_wide_or_narrow() {
        let labels = |low: f64, high: f64| -> Vec<String> {
            let scale = Scale::magnitudes(&(low.log10()..high.log10()), 9.0);
            scale.ticks.iter().map(|v| scale.label(*v)).collect()
        };
        assert_eq!(labels(0.009, 11.0), ["10⁻²", "10⁻¹", "10⁰", "10¹"]);
        assert_eq!(labels(0.009, 0.06), ["0.01", "0.02", "0.05"]);
        assert_eq!(labels(0.0101, 0.0129), ["0.0105", "0.011", "0.0115", "0.012", "0.0125"]);
        assert_eq!(labels(1.9e-5, 1.1e-4), ["2·10⁻⁵", "5·10⁻⁵", "1·10⁻⁴"]);
        assert_eq!(labels(180.0, 1100.0), ["200", "500", "1000"]);
    }

    #[test]
    fn a_long_legend_takes_several_rows_and_none_is_empty() {
        let entry =
            |n: usize| Entry { label: format!("method number {n}"), color: INK, swatch: Swatch::Line(1.5) };
        let legend: Vec<Entry> = (0..9).map(entry).collect();
        let rows = legend_rows(&legend, 500);
        assert!(rows.len() > 1 && rows.iter().all(|row| !row.is_empty()));
        assert_eq!(rows.iter().map(Vec::len).sum::<usize>(), 9);
    }
}
