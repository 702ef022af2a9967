//! The few SVG elements of a plan view.

use std::fmt::Write as _;

pub const INK: &str = "#22262A";
pub const FAINT_INK: &str = "#5B636B";

/// SVG text under construction; coordinates in px, y down.
pub struct Svg {
    text: String,
}

/// How a line is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    Solid,
    Dashed,
    Dotted,
}

/// A mark on the map, centred on its place.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    Triangle,
    Circle,
    Square,
    Dot,
}

impl Svg {
    pub fn new(width: f64, height: f64) -> Self {
        let mut svg = Self { text: String::new() };
        svg.put(format_args!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0}" height="{height:.0}" viewBox="0 0 {width:.0} {height:.0}" font-family="sans-serif" stroke-linejoin="round" stroke-linecap="round"><rect width="100%" height="100%" fill="#FFFFFF"/>"##
        ));
        svg
    }

    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String does not fail.
        let _ = self.text.write_fmt(element);
        self.text.push('\n');
    }

    pub fn line(&mut self, points: &[[f64; 2]], color: &str, width: f64, stroke: Stroke) {
        let dash = match stroke {
            Stroke::Solid => "",
            Stroke::Dashed => r#" stroke-dasharray="6 4""#,
            Stroke::Dotted => r#" stroke-dasharray="0.1 5""#,
        };
        let points = joined(points);
        self.put(format_args!(
            r#"<polyline points="{points}" fill="none" stroke="{color}" stroke-width="{width:.2}"{dash}/>"#
        ));
    }

    pub fn area(&mut self, points: &[[f64; 2]], fill: &str, opacity: f64, stroke: &str, width: f64) {
        let points = joined(points);
        self.put(format_args!(
            r#"<polygon points="{points}" fill="{fill}" fill-opacity="{opacity}" stroke="{stroke}" stroke-width="{width:.2}"/>"#
        ));
    }

    pub fn mark(&mut self, mark: Mark, [x, y]: [f64; 2], color: &str) {
        match mark {
            Mark::Triangle => {
                let points = joined(&[[x, y - 5.0], [x + 4.6, y + 3.4], [x - 4.6, y + 3.4]]);
                self.put(format_args!(
                    r##"<polygon points="{points}" fill="{color}" stroke="#FFFFFF" stroke-width="0.8"/>"##
                ));
            }
            Mark::Circle | Mark::Dot => {
                let radius = if mark == Mark::Circle { 3.6 } else { 2.0 };
                self.put(format_args!(
                    r##"<circle cx="{x:.1}" cy="{y:.1}" r="{radius}" fill="{color}" stroke="#FFFFFF" stroke-width="0.8"/>"##
                ));
            }
            Mark::Square => {
                let (left, top) = (x - 3.6, y - 3.6);
                self.put(format_args!(
                    r##"<rect x="{left:.1}" y="{top:.1}" width="7.2" height="7.2" fill="{color}" stroke="#FFFFFF" stroke-width="0.8"/>"##
                ));
            }
        }
    }

    /// Text with a white edge, so that it can be read on lines; `anchor` is start, middle or end.
    pub fn label(&mut self, text: &str, [x, y]: [f64; 2], size: f64, color: &str, anchor: &str, bold: bool) {
        let weight = if bold { r#" font-weight="bold""# } else { "" };
        let text = escaped(text);
        self.put(format_args!(
            r##"<text x="{x:.1}" y="{y:.1}" font-size="{size}" fill="{color}" text-anchor="{anchor}"{weight} paint-order="stroke" stroke="#FFFFFF" stroke-width="2.5">{text}</text>"##
        ));
    }

    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

fn joined(points: &[[f64; 2]]) -> String {
    points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

/// Text as it can stand in XML: no markup, no control characters, no endless names.
fn escaped(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(80).fold(String::new(), |mut escaped, c| {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c => escaped.push(c),
        }
        escaped
    })
}

/// Width that a text will hardly exceed, px.
pub fn text_width(text: &str, size: f64) -> f64 {
    0.62 * size * text.chars().take(80).count() as f64
}
