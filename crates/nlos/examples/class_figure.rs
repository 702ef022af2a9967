//! Draws what the network sees: mean amplitudes around the first path of each class, on the left; how well the probabilities hold, on the right.
//!
//! `class_figure MODEL OUT.svg DATA…`, of labelled sets with responses that the model has not seen; `ci/results.sh` calls it.

use adit_nlos::Model;
use adit_nlos::examples::Examples;
use adit_nlos::measures::Measures;
use adit_nlos::network::Scratch;
use adit_nlos::window::{BEFORE, CHANNELS, TAPS};
use adit_observation::csv_log::labelled;
use std::error::Error;
use std::fmt::Write as _;

const COLOURS: [&str; 4] = ["#0072B2", "#E69F00", "#D55E00", "#000000"];
/// A panel, pixels: left, top, width, height.
const LEFT: [f64; 4] = [60.0, 40.0, 380.0, 260.0];
const RIGHT: [f64; 4] = [520.0, 40.0, 260.0, 260.0];
/// Weakest amplitude of the left panel, dB.
const FLOOR_DB: f64 = -40.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, out, data @ ..] = arguments.as_slice() else {
        return Err("usage: class_figure MODEL OUT.svg DATA…".into());
    };
    let model = match Model::named(name) {
        Some(shipped) => shipped?,
        None => Model::from_bytes(name, &std::fs::read(name)?)?,
    };
    let sets = data.iter().map(labelled::read).collect::<Result<Vec<_>, _>>()?;
    let examples = Examples::for_task(model.task, &sets);
    let mut svg = String::from(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="820" height="370" viewBox="0 0 820 370" font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>
"#,
    );
    responses(&mut svg, model.task.classes(), &examples)?;
    reliability(&mut svg, &model, &examples)?;
    svg.push_str("</svg>\n");
    std::fs::write(out, svg)?;
    Ok(())
}

/// Mean amplitude of each tap against the largest, dB.
fn responses(svg: &mut String, classes: &[&str], examples: &Examples) -> Result<(), Box<dyn Error>> {
    let [left, top, width, height] = LEFT;
    let x = |tap: f64| left + width * tap / (TAPS - 1) as f64;
    let y = |db: f64| top + height * db / FLOOR_DB;
    frame(
        svg,
        LEFT,
        "Mean response, by what is in the way",
        "taps of 1 ns after the first path",
        "dB of the largest",
    )?;
    for db in [0.0, -10.0, -20.0, -30.0, -40.0] {
        tick(svg, (left - 6.0, y(db) + 4.0), "end", &format!("{db:.0}"))?;
    }
    for tap in [0.0, 20.0, 40.0, 60.0] {
        tick(svg, (x(tap + BEFORE as f64), top + height + 16.0), "middle", &format!("{tap:.0}"))?;
    }
    for (class, name) in classes.iter().enumerate() {
        let windows: Vec<_> = examples
            .rows
            .iter()
            .filter(|row| row.class == class)
            .filter_map(|row| row.window.as_deref())
            .collect();
        if windows.is_empty() {
            continue;
        }
        let points: Vec<String> = (0..TAPS)
            .map(|tap| {
                let sum: f64 = windows.iter().map(|window| f64::from(window[tap * CHANNELS])).sum();
                let db = 20.0 * (sum / windows.len() as f64).max(1e-6).log10();
                format!("{:.1},{:.1}", x(tap as f64), y(db.max(FLOOR_DB)))
            })
            .collect();
        let colour = COLOURS[class % COLOURS.len()];
        writeln!(
            svg,
            r#"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="1.8"/>"#,
            points.join(" ")
        )?;
        let line = top + 18.0 + 17.0 * class as f64;
        writeln!(
            svg,
            r#"<rect x="{:.1}" y="{:.1}" width="18" height="3" fill="{colour}"/><text x="{:.1}" y="{line:.1}">{name} ({})</text>"#,
            left + width - 150.0,
            line - 5.0,
            left + width - 126.0,
            windows.len()
        )?;
    }
    Ok(())
}

/// Share in sight against the probability told.
fn reliability(svg: &mut String, model: &Model, examples: &Examples) -> Result<(), Box<dyn Error>> {
    let mut scratch = Scratch::default();
    let told: Vec<_> = examples
        .rows
        .iter()
        .map(|row| model.judge_features(&row.features, row.window.as_deref(), &mut scratch))
        .collect();
    let classes = model.task.classes();
    let judged = examples.rows.iter().zip(&told).map(|(row, p)| (row.class, &p[..classes.len()]));
    let measures = Measures::of(classes, judged);
    let [left, top, width, height] = RIGHT;
    let (x, y) = (|p: f64| left + width * p, |share: f64| top + height * (1.0 - share));
    frame(svg, RIGHT, "Does P(line of sight) hold?", "probability told", "share in sight")?;
    for p in [0.0, 0.25, 0.5, 0.75, 1.0] {
        tick(svg, (left - 6.0, y(p) + 4.0), "end", &format!("{p}"))?;
        tick(svg, (x(p), top + height + 16.0), "middle", &format!("{p}"))?;
    }
    writeln!(
        svg,
        r##"<path d="M{:.1} {:.1}L{:.1} {:.1}" stroke="#999" stroke-dasharray="5 4"/>"##,
        x(0.0),
        y(0.0),
        x(1.0),
        y(1.0)
    )?;
    let most = measures.binary.reliability.iter().map(|bin| bin.ranges).max().unwrap_or(1).max(1);
    for bin in measures.binary.reliability.iter().filter(|bin| bin.ranges > 0) {
        let radius = 3.0 + 8.0 * (bin.ranges as f64 / most as f64).sqrt();
        writeln!(
            svg,
            r#"<circle cx="{:.1}" cy="{:.1}" r="{radius:.1}" fill="{}" fill-opacity="0.75"/>"#,
            x(bin.probability),
            y(bin.share),
            COLOURS[0]
        )?;
    }
    Ok(())
}

fn frame(svg: &mut String, panel: [f64; 4], title: &str, below: &str, beside: &str) -> std::fmt::Result {
    let [left, top, width, height] = panel;
    let (middle, bottom, side) = (left + 0.5 * width, top + height + 38.0, left - 38.0);
    let half = top + 0.5 * height;
    writeln!(
        svg,
        r##"<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#777"/>
<text x="{left}" y="{:.1}" font-weight="bold">{title}</text><text x="{middle}" y="{bottom}" text-anchor="middle">{below}</text>
<text transform="translate({side} {half}) rotate(-90)" text-anchor="middle">{beside}</text>"##,
        top - 12.0
    )
}

fn tick(svg: &mut String, (x, y): (f64, f64), anchor: &str, text: &str) -> std::fmt::Result {
    writeln!(svg, r##"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" fill="#555">{text}</text>"##)
}
