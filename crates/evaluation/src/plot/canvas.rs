//! Ground, colours, type sizes, and the step from plotters' whole pixels to smooth lines.
//!
//! plotters places everything on whole pixels, which shows on slanted lines. A figure is therefore drawn
//! [`FINENESS`] times larger and shrunk by the `viewBox` of the SVG: coordinates are quarter pixels to the viewer.

use super::Role;
use crate::EvaluationError;
use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color as _, FontStyle, IntoFont as _, RGBColor, ShapeStyle, TextStyle};
use std::fmt::Write;

/// Drawing units in a pixel of the figure.
const FINENESS: i32 = 4;
/// plotters divides type sizes by this on the way into SVG.
const PLOTTERS_TYPE_RATIO: f64 = 1.24;
/// Room around everything, px.
const MARGIN_PX: i32 = 14;
/// Height of the title line, px.
const TITLE_PX: i32 = 34;
/// Longest title or label, characters.
const LONGEST_LABEL: usize = 90;

// The console's tokens (web/src/styles/tokens.css): text, muted, line-strong, line, hover, panel.
pub const INK: RGBColor = RGBColor(0x14, 0x20, 0x2A);
pub const FAINT_INK: RGBColor = RGBColor(0x4B, 0x5C, 0x6A);
pub const AXIS: RGBColor = RGBColor(0xA6, 0xB5, 0xC1);
pub const GRID: RGBColor = RGBColor(0xD5, 0xDD, 0xE4);
/// Phases that do not count.
pub const SHADE: RGBColor = RGBColor(0xE6, 0xEC, 0xF1);
pub const GROUND: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);
const TRUTH: RGBColor = RGBColor(0x87, 0x95, 0xA1);
/// Okabe & Ito 2008, the darker ones first; yellow is too pale for thin lines.
const ESTIMATES: [RGBColor; 7] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
    INK,
];
/// What stands in place of each colour where the viewer's page is dark: the console's dark tokens, and estimates bright enough for them.
const DARK: [(RGBColor, RGBColor); 13] = [
    (GROUND, RGBColor(0x12, 0x1A, 0x21)),
    (INK, RGBColor(0xE6, 0xED, 0xF3)),
    (FAINT_INK, RGBColor(0x9D, 0xB0, 0xBF)),
    (AXIS, RGBColor(0x3D, 0x4F, 0x5E)),
    (GRID, RGBColor(0x26, 0x33, 0x3E)),
    (SHADE, RGBColor(0x22, 0x30, 0x3B)),
    (TRUTH, RGBColor(0x7F, 0x93, 0xA3)),
    (ESTIMATES[0], RGBColor(0x6C, 0xC0, 0xFF)),
    (ESTIMATES[1], RGBColor(0xFF, 0x8F, 0x57)),
    (ESTIMATES[2], RGBColor(0x3F, 0xD0, 0xA0)),
    (ESTIMATES[3], RGBColor(0xD9, 0x8C, 0xB8)),
    (ESTIMATES[4], RGBColor(0xFF, 0xAD, 0x42)),
    (ESTIMATES[5], RGBColor(0xA6, 0xDC, 0xFF)),
];
/// The console's type.
pub const FONT: &str =
    "system-ui,-apple-system,\"Segoe UI\",\"Noto Sans\",\"PingFang SC\",\"Microsoft YaHei\",sans-serif";

/// Type sizes, px.
#[derive(Debug, Clone, Copy)]
pub enum Type {
    Title,
    Heading,
    Text,
    Tick,
}

impl Type {
    fn px(self) -> f64 {
        match self {
            Self::Title => 17.0,
            Self::Heading => 14.0,
            Self::Text => 12.5,
            Self::Tick => 11.5,
        }
    }
}

pub type Area<'b> = DrawingArea<SVGBackend<'b>, Shift>;
pub type DrawError = DrawingAreaErrorKind<std::io::Error>;

impl From<DrawError> for EvaluationError {
    fn from(error: DrawError) -> Self {
        Self::Plot { reason: error.to_string() }
    }
}

/// Draws a figure of `size` pixels under a title line.
pub fn svg(
    size: (i32, i32),
    title: &str,
    draw: impl FnOnce(&Area<'_>) -> Result<(), EvaluationError>,
) -> Result<String, EvaluationError> {
    let mut drawn = String::new();
    {
        let units = (units(size.0).unsigned_abs(), units(size.1).unsigned_abs());
        let page = SVGBackend::with_string(&mut drawn, units).into_drawing_area();
        page.fill(&GROUND)?;
        let page = page.margin(
            self::units(MARGIN_PX),
            self::units(MARGIN_PX),
            self::units(MARGIN_PX),
            self::units(MARGIN_PX),
        );
        let title = shown(title);
        if title.is_empty() {
            draw(&page)?;
        } else {
            let (head, body) = page.split_vertically(self::units(TITLE_PX));
            head.draw_text(&title, &text(Type::Title, INK, HPos::Left, VPos::Top), (self::units(4), 0))?;
            draw(&body)?;
        }
        page.present()?;
    }
    Ok(shrink(&drawn, size))
}

/// Replaces the head that plotters wrote by one of the size asked for; joins of lines are round.
fn shrink(drawn: &str, (width, height): (i32, i32)) -> String {
    let body = drawn.split_once('>').map_or("", |(_, body)| body);
    let mut figure = String::with_capacity(drawn.len() + 200);
    // Writing to a String does not fail.
    let _ = write!(
        figure,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {} {}" stroke-linejoin="round" stroke-linecap="round">"#,
        units(width),
        units(height)
    );
    // A colour of a rule goes before that of an attribute.
    let _ = write!(figure, "<style>svg text{{font-family:{FONT}}}@media (prefers-color-scheme:dark){{");
    for (light, dark) in DARK {
        for attribute in ["fill", "stroke"] {
            let _ = write!(figure, "svg [{attribute}=\"{}\"]{{{attribute}:{}}}", hex(light), hex(dark));
        }
    }
    figure.push_str("}</style>");
    figure.push_str(body);
    figure
}

/// As plotters writes it.
fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// Pixels of the figure to drawing units.
pub fn units(px: i32) -> i32 {
    px * FINENESS
}

/// A line of some width, px.
pub fn stroke(color: RGBColor, width_px: f64) -> ShapeStyle {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "widths are a few pixels")]
    let stroke_width = (width_px * f64::from(FINENESS)).round() as u32;
    ShapeStyle { color: color.into(), filled: false, stroke_width }
}

/// A filled shape.
pub fn fill(color: RGBColor) -> ShapeStyle {
    ShapeStyle { color: color.into(), filled: true, stroke_width: 0 }
}

/// A style for text; the anchor says which of its points is placed.
pub fn text(size: Type, color: RGBColor, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    let points = size.px() * PLOTTERS_TYPE_RATIO * f64::from(FINENESS);
    let style = if matches!(size, Type::Title | Type::Heading) { FontStyle::Bold } else { FontStyle::Normal };
    let font = ("sans-serif", points, style).into_font();
    TextStyle { font, color: color.to_backend_color(), pos: Pos::new(horizontal, vertical) }
}

/// Width that a text will hardly exceed, px: each character as wide as in the widest common sans-serif.
pub fn text_width_px(shown: &str, size: Type) -> i32 {
    let in_type_sizes = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' | '!' => 0.33,
        'f' | 'r' | 't' | '-' | '(' | ')' | '/' => 0.41,
        'm' | 'w' | 'M' | 'W' | '%' | '<' | '>' | '=' => 0.95,
        'A'..='Z' => 0.72,
        _ => 0.63,
    };
    #[expect(clippy::cast_possible_truncation, reason = "a label has a hundred characters at most")]
    let width = (shown.chars().map(in_type_sizes).sum::<f64>() * size.px()).ceil() as i32;
    width
}

/// A label as it can stand in an SVG: no control characters, no endless names.
pub fn shown(label: &str) -> String {
    let mut kept: Vec<char> = label.chars().filter(|c| !c.is_control()).collect();
    if kept.len() > LONGEST_LABEL {
        kept.truncate(LONGEST_LABEL - 1);
        kept.push('…');
    }
    kept.into_iter().collect()
}

/// Colour of a curve.
pub fn color(role: Role) -> RGBColor {
    match role {
        Role::Truth => TRUTH,
        Role::Estimate(number) => ESTIMATES[number % ESTIMATES.len()],
    }
}

/// Width of a curve, px.
pub fn width_px(role: Role) -> f64 {
    match role {
        Role::Truth => 3.0,
        Role::Estimate(_) => 1.5,
    }
}
