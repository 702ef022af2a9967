//! The figure: mean shape of the responses and distributions of some features, recorded and simulated.

use super::responses::{FEATURES, Response, values};
use super::sites::Class;
use super::stats::{median, quantile};
use std::fmt::Write as _;

const PANEL: (f64, f64) = (330.0, 210.0);
const MARGIN: (f64, f64) = (46.0, 44.0);
/// Features that are drawn.
const DRAWN: [usize; 5] = [0, 3, 5, 7, 6];
const RECORDED: &str = "#1f4e79";
const SIMULATED: &str = "#d1662b";

struct Panel {
    x: f64,
    y: f64,
    low: f64,
    high: f64,
}

impl Panel {
    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let (width, height) = (PANEL.0 - MARGIN.0 - 14.0, PANEL.1 - MARGIN.1 - 22.0);
        let share = ((x - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        (self.x + MARGIN.0 + share * width, self.y + 22.0 + (1.0 - y) * height)
    }

    fn frame(&self, title: &str, label: &str) -> String {
        let ((left, bottom), (right, top)) = (self.place(self.low, 0.0), self.place(self.high, 1.0));
        let mut text = format!(
            "<text x=\"{left}\" y=\"{}\" font-weight=\"bold\">{title}</text>\n<path d=\"M{left} {top}V{bottom}H{right}\" fill=\"none\" stroke=\"#666\"/>\n",
            self.y + 14.0
        );
        for step in 0..=4 {
            let share = f64::from(step) / 4.0;
            let value = self.low + share * (self.high - self.low);
            let (x, _) = self.place(value, 0.0);
            let digits = if self.high - self.low < 4.0 { 2 } else { 0 };
            let _ = writeln!(
                text,
                "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{value:.digits$}</text>",
                bottom + 14.0
            );
            let (_, y) = self.place(self.low, share);
            let _ = writeln!(
                text,
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{share:.2}</text>",
                left - 4.0,
                y + 4.0
            );
        }
        let _ = writeln!(
            text,
            "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            0.5 * (left + right),
            bottom + 29.0
        );
        text
    }

    fn curve(&self, points: impl Iterator<Item = (f64, f64)>, color: &str, dashed: bool) -> String {
        let path: Vec<String> = points
            .map(|(x, y)| {
                let (x, y) = self.place(x, y);
                format!("{x:.1},{y:.1}")
            })
            .collect();
        let dash = if dashed { " stroke-dasharray=\"5 3\"" } else { "" };
        format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\"{dash}/>\n",
            path.join(" ")
        )
    }
}

/// Median over the responses of a class, tap by tap.
fn shape(responses: &[Response], class: Class) -> Vec<(f64, f64)> {
    (0..80)
        .map(|tap| {
            let of = responses.iter().filter(|r| r.class == class);
            let amplitudes: Vec<f64> = of.filter_map(|r| r.shape.get(tap).copied()).collect();
            (tap as f64 - 10.0, median(&amplitudes))
        })
        .collect()
}

/// Rows: the shape, then the features; columns: the classes.
pub fn draw(recorded: &[Response], simulated: &[Response]) -> String {
    let (columns, lines) = (3.0, 1.0 + DRAWN.len() as f64);
    let (width, height) = (columns * PANEL.0, lines * PANEL.1 + 30.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"46\" y=\"18\" font-size=\"13\" fill=\"{RECORDED}\">recorded (uwb-cir)</text><text x=\"190\" y=\"18\" font-size=\"13\" fill=\"{SIMULATED}\">simulated (dashed)</text>\n"
    );
    for (column, class) in Class::ALL.into_iter().enumerate() {
        let x = column as f64 * PANEL.0;
        let panel = Panel { x, y: 30.0, low: -10.0, high: 70.0 };
        text +=
            &panel.frame(&format!("{}: amplitude / peak, median", class.name()), "taps after the first path");
        text += &panel.curve(shape(recorded, class).into_iter(), RECORDED, false);
        text += &panel.curve(shape(simulated, class).into_iter(), SIMULATED, true);
        for (row, feature) in DRAWN.into_iter().enumerate() {
            let (a, b) = (values(recorded, class, feature), values(simulated, class, feature));
            let low = quantile(&a, 0.01).min(quantile(&b, 0.01));
            let high = quantile(&a, 0.99).max(quantile(&b, 0.99)).max(low + 1e-6);
            let panel = Panel { x, y: 30.0 + (row as f64 + 1.0) * PANEL.1, low, high };
            text += &panel.frame(&format!("{}: share below", class.name()), FEATURES[feature]);
            for (values, color, dashed) in [(&a, RECORDED, false), (&b, SIMULATED, true)] {
                let steps = (0..=100).map(|i| f64::from(i) / 100.0);
                text += &panel.curve(steps.map(|share| (quantile(values, share), share)), color, dashed);
            }
        }
    }
    text + "</svg>\n"
}
