//! Draws where people of `mines/two-level.toml` go within a shift: `cargo run -p adit-simulation --example people_plan PLAN.svg`.

use adit_mine::Mine;
use adit_simulation::people::{Activity, Population, PopulationSpec, ShiftSpec, VehicleSpec};
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

/// Colours after Okabe & Ito (2008).
const PEOPLE: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];
const ROADWAY: RGBColor = RGBColor(225, 229, 232);
const RIDE: RGBColor = RGBColor(230, 159, 0);

fn main() -> Result<(), Box<dyn Error>> {
    let out: &'static str = std::env::args().nth(1).ok_or("usage: people_plan PLAN.svg")?.leak();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    let (mine, _) = adit_mine::file::open(Path::new(file))?;
    let spec = PopulationSpec {
        people: 4,
        shift: ShiftSpec { duration_s: 5.0 * 3600.0, ride_share: 1.0, reach_m: 40.0, ..ShiftSpec::default() },
        vehicles: vec![VehicleSpec::on("ore")],
        ..PopulationSpec::default()
    };
    let population = Population::new(&mine, &spec, 8)?;

    let root = SVGBackend::new(out, (1280, 1240)).into_drawing_area();
    root.fill(&WHITE)?;
    let (upper, lower) = root.split_vertically(540);
    let all = ((4650.0, 6250.0), (2750.0, 3400.0));
    let detail = ((5290.0, 5530.0), (2992.0, 3122.0));
    draw(&upper, &mine, &population, "Four shifts of 5 h (orange: riding), all levels", all, 2)?;
    draw(&lower, &mine, &population, "A part of the 300 m level: keeping right, places of work", detail, 1)?;
    root.present()?;
    Ok(())
}

fn draw<'a>(
    area: &DrawingArea<SVGBackend<'a>, plotters::coord::Shift>,
    mine: &Mine,
    population: &Population,
    title: &str,
    ((x0, x1), (y0, y1)): ((f64, f64), (f64, f64)),
    width: u32,
) -> Result<(), Box<dyn Error + 'a>> {
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(54)
        .build_cartesian_2d(x0..x1, y0..y1)?;
    chart.configure_mesh().x_desc("east, m").y_desc("north, m").light_line_style(WHITE).draw()?;
    let close = x1 - x0 < 400.0;
    for roadway in &mine.plan().roadways {
        if close && roadway.level.as_deref() != Some("l300") {
            continue;
        }
        let px_m = 1200.0 / (x1 - x0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some pixels")]
        let wide = (roadway.width_m * px_m).max(3.0) as u32;
        let inside = |(x, y): &(f64, f64)| (x0..x1).contains(x) && (y0..y1).contains(y);
        let pieces = roadway.points_m.windows(2).flat_map(|pair| {
            let (a, b) = (pair[0].raw(), pair[1].raw());
            let at = move |i: u32| a + (b - a) * (f64::from(i) / 100.0);
            (0..=100).map(at).map(|p| (p.x, p.y))
        });
        chart.draw_series(LineSeries::new(pieces.filter(inside), ROADWAY.stroke_width(wide)))?;
    }
    for (index, color) in PEOPLE.iter().enumerate() {
        let Some(person) = population.person(index) else { continue };
        let person = person?;
        let mut line: Vec<(f64, f64)> = Vec::new();
        let mut riding = false;
        let mut t = 0.0;
        while t < person.duration_s() {
            let at = person.at(t);
            let rides = at.activity == Activity::Ride;
            let elsewhere = close && !(100.0..130.0).contains(&at.floor_m.z);
            if rides != riding || elsewhere {
                let ink = if riding { RIDE } else { *color };
                chart.draw_series(LineSeries::new(line.drain(..), ink.stroke_width(width)))?;
                riding = rides;
            }
            let here = (at.floor_m.x, at.floor_m.y);
            let moved =
                line.last().is_none_or(|last| (last.0 - here.0).hypot(last.1 - here.1) > (x1 - x0) / 400.0);
            if moved && !elsewhere {
                line.push(here);
            }
            t += 0.5;
        }
        let ink = if riding { RIDE } else { *color };
        chart.draw_series(LineSeries::new(line, ink.stroke_width(width)))?;
    }
    Ok(())
}
