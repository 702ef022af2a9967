//! Draws a walk of half an hour by dead reckoning at the belt, with and without roadways: `cargo run -p adit-estimation --example roadway_figure WALK.svg [SEED]`.
#![expect(clippy::unwrap_used, reason = "what tests share")]

#[path = "../tests/support/roadways.rs"]
mod roadways;
#[path = "../tests/support/trial.rs"]
mod trial;

use adit_core::nalgebra::Vector3;
use adit_estimation::place::roadways::Roadways;
use plotters::prelude::*;
use roadways::{Carrier, Walker};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use trial::{follow, params, radius_m, walk};

/// Colours after Okabe & Ito (2008).
const HELD: RGBColor = RGBColor(0, 114, 178);
const FREE: RGBColor = RGBColor(213, 94, 0);
const ROADWAY: RGBColor = RGBColor(222, 226, 229);
/// A walk with straights and turns.
const SEED: u64 = 20;
/// Chance to go straight on.
const GOES_ON: f64 = 0.5;

/// What was said at a moment.
struct Said {
    walked_m: f64,
    at: Vector3<f64>,
    truth: Vector3<f64>,
    off_m: f64,
    radius_m: f64,
    hypotheses: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let out: &'static str = std::env::args().nth(1).ok_or("usage: roadway_figure WALK.svg [SEED]")?.leak();
    let seed: u64 = std::env::args().nth(2).map_or(Ok(SEED), |seed| seed.parse())?;
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    let (mine, _) = adit_mine::file::open(Path::new(file))?;
    let known = Arc::new(Roadways::new(&mine));
    let carrier = Carrier::waist();
    let walked = walk(&mine, &carrier, &Walker { goes_on: GOES_ON, ..Walker::default() }, seed);
    let [held, free] = [Some(&known), None].map(|map| {
        let mut said = Vec::new();
        follow(&walked, map, params(&carrier), seed, |_, estimate, truth, walked_m| {
            said.push(Said {
                walked_m,
                at: estimate.position_m,
                truth: *truth,
                off_m: (estimate.position_m - truth).xy().norm(),
                radius_m: radius_m(estimate),
                hypotheses: estimate.hypotheses,
            });
        });
        said
    });

    let root = SVGBackend::new(out, (1280, 1010)).into_drawing_area();
    root.fill(&WHITE)?;
    let (upper, rest) = root.split_vertically(520);
    let (middle, lower) = rest.split_vertically(320);

    let mut plan = ChartBuilder::on(&upper)
        .caption("Half an hour of steps at the belt, seen from above (both levels drawn)", ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(54)
        .build_cartesian_2d(4950.0..6150.0, 2860.0..3310.0)?;
    plan.configure_mesh().x_desc("east, m").y_desc("north, m").light_line_style(WHITE).draw()?;
    for roadway in &mine.plan().roadways {
        let line = roadway.points_m.iter().map(|p| (p.raw().x, p.raw().y));
        plan.draw_series(LineSeries::new(line, ROADWAY.stroke_width(6)))?;
    }
    let lines = [
        ("the way", BLACK, held.iter().map(|said| said.truth).collect::<Vec<_>>()),
        ("steps alone", FREE, free.iter().map(|said| said.at).collect()),
        ("steps and roadways", HELD, held.iter().map(|said| said.at).collect()),
    ];
    for (name, colour, line) in lines {
        plan.draw_series(LineSeries::new(line.iter().map(|p| (p.x, p.y)), colour.stroke_width(2)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], colour.stroke_width(3)));
    }
    plan.configure_series_labels().border_style(BLACK.mix(0.3)).background_style(WHITE).draw()?;

    let end_m = held.last().map_or(0.0, |said| said.walked_m);
    let mut errors = ChartBuilder::on(&middle)
        .caption("Error", ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(54)
        .build_cartesian_2d(0.0..end_m, 0.0..130.0)?;
    errors.configure_mesh().x_desc("walked, m").y_desc("m").light_line_style(WHITE).draw()?;
    let above = held.iter().map(|said| (said.walked_m, said.radius_m.min(130.0)));
    let outline: Vec<(f64, f64)> = [(0.0, 0.0)].into_iter().chain(above).chain([(end_m, 0.0)]).collect();
    errors
        .draw_series([Polygon::new(outline, HELD.mix(0.2))])?
        .label("stated radius of 95 %, with roadways")
        .legend(|(x, y)| Rectangle::new([(x, y - 5), (x + 22, y + 5)], HELD.mix(0.2).filled()));
    for (name, colour, said) in [("steps alone", FREE, &free), ("steps and roadways", HELD, &held)] {
        errors
            .draw_series(LineSeries::new(
                said.iter().map(|said| (said.walked_m, said.off_m)),
                colour.stroke_width(2),
            ))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], colour.stroke_width(3)));
    }
    errors
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .border_style(BLACK.mix(0.3))
        .background_style(WHITE)
        .draw()?;

    let mut counts = ChartBuilder::on(&lower)
        .caption("Hypotheses", ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(54)
        .build_cartesian_2d(0.0..end_m, 0.0..8.5)?;
    counts.configure_mesh().x_desc("walked, m").y_labels(5).light_line_style(WHITE).draw()?;
    counts.draw_series(LineSeries::new(
        held.iter().map(|said| (said.walked_m, said.hypotheses as f64)),
        HELD.stroke_width(2),
    ))?;
    root.present()?;
    Ok(())
}
