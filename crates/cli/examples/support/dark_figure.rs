//! A walk through a blackout over the mine, as SVG: a panel for each level with the truth before, during and after, and where the path of
//! a method went meanwhile.

use crate::dark_hour::Dark;
use crate::tracked::{Moment, Simulated};
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_mine::Mine;
use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

/// Colours after Okabe & Ito (2008).
const BEFORE: RGBColor = RGBColor(0, 114, 178);
const DARK: RGBColor = RGBColor(213, 94, 0);
const AFTER: RGBColor = RGBColor(0, 158, 115);
const ESTIMATE: RGBColor = RGBColor(34, 38, 42);
const ROADWAY: RGBColor = RGBColor(225, 229, 232);
/// Farther than this above or below its floor is not of a level, m.
const OF_LEVEL_M: f64 = 12.0;
/// Between drawn places, m.
const THINNED_M: f64 = 1.5;
/// Room round the way, m.
const MARGIN_M: f64 = 25.0;

/// A way: its places in order of time, with the time, s.
type Way = Vec<(f64, Vector3<f64>)>;

/// Draws one run of the method of this name.
pub fn figure(simulated: &Simulated, dark: &Dark, name: &str, moments: &[Moment]) -> Result<String> {
    let truth: Way =
        simulated.truth.poses().iter().map(|pose| (pose.time.seconds(), pose.position_m)).collect();
    // Where the method was: the truth and its error.
    let at = |moment: &Moment| {
        let error_m = Vector3::new(moment.error_m.x, moment.error_m.y, moment.above_m);
        let true_m = simulated.truth.at(Time::from_seconds(moment.time_s)?)?.position_m;
        Some((moment.time_s, true_m + error_m))
    };
    let estimate: Way = moments.iter().filter_map(at).collect();
    let mine = simulated.mine()?;
    let mut svg = String::new();
    let picture = Picture { mine: &mine, dark, name, truth: &truth, estimate: &estimate };
    picture.draw(&mut svg).map_err(|error| anyhow!("the figure: {error}"))?;
    Ok(svg)
}

struct Picture<'a> {
    mine: &'a Mine,
    dark: &'a Dark,
    name: &'a str,
    truth: &'a Way,
    estimate: &'a Way,
}

type Drawn<'s> = Result<(), Box<dyn std::error::Error + 's>>;

impl Picture<'_> {
    fn draw<'s>(&self, svg: &'s mut String) -> Drawn<'s> {
        let Self { mine, dark, name: method, truth, .. } = self;
        let range = |of: fn(&Vector3<f64>) -> f64| {
            let values = || truth.iter().map(|(_, at)| of(at));
            values().fold(f64::INFINITY, f64::min) - MARGIN_M
                ..values().fold(f64::NEG_INFINITY, f64::max) + MARGIN_M
        };
        let (x, y) = (range(|at| at.x), range(|at| at.y));
        let of_level = |at: &Vector3<f64>, elevation_m: f64| (at.z - elevation_m).abs() < OF_LEVEL_M;
        let levels: Vec<_> = mine
            .plan()
            .levels
            .iter()
            .filter(|level| truth.iter().any(|(_, at)| of_level(at, level.elevation_m)))
            .collect();
        let wide = 1180.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred pixels")]
        let high = (wide * (y.end - y.start) / (x.end - x.start)) as u32 + 90;
        let panels = u32::try_from(levels.len())?;
        let root = SVGBackend::with_string(svg, (1260, panels * high)).into_drawing_area();
        root.fill(&WHITE)?;
        let areas = root.split_evenly((levels.len(), 1));
        for (area, level) in areas.iter().zip(&levels) {
            let name = level.name.as_deref().unwrap_or(&level.id);
            let title = format!(
                "{name}: before (blue), {:.0} min in the dark (red), after (green); {method} in the dark (black)",
                (dark.until_s - dark.from_s) / 60.0
            );
            // What leads from level to level is drawn where it is nearer to this one.
            let here = |at: &Vector3<f64>| {
                let nearest = levels
                    .iter()
                    .min_by(|a, b| (at.z - a.elevation_m).abs().total_cmp(&(at.z - b.elevation_m).abs()));
                nearest.is_some_and(|nearest| nearest.id == level.id)
            };
            self.panel(area, &title, (x.clone(), y.clone()), here)?;
        }
        root.present()?;
        Ok(())
    }

    fn panel<'s>(
        &self,
        area: &DrawingArea<SVGBackend<'s>, Shift>,
        title: &str,
        (x, y): (Range<f64>, Range<f64>),
        here: impl Fn(&Vector3<f64>) -> bool,
    ) -> Drawn<'s> {
        let Self { mine, dark, truth, estimate, .. } = self;
        let px_m = 1180.0 / (x.end - x.start);
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 16))
            .margin(10)
            .x_label_area_size(30)
            .y_label_area_size(64)
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .x_desc("east, m")
            .y_desc("north, m")
            .light_line_style(WHITE)
            .x_label_formatter(&|x| format!("{x:.0}"))
            .y_label_formatter(&|y| format!("{y:.0}"))
            .draw()?;
        let inside = |at: &Vector3<f64>| x.contains(&at.x) && y.contains(&at.y) && here(at);
        for roadway in &mine.plan().roadways {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some pixels")]
            let wide = (roadway.width_m * px_m).max(3.0) as u32;
            for pair in roadway.points_m.windows(2) {
                let (a, b) = (pair[0].raw(), pair[1].raw());
                let places = (0..=100).map(|i| a + (b - a) * (f64::from(i) / 100.0));
                let line: Vec<(f64, f64)> = places.filter(inside).map(|at| (at.x, at.y)).collect();
                chart.draw_series(LineSeries::new(line, ROADWAY.stroke_width(wide)))?;
            }
        }
        let parts = [
            (f64::NEG_INFINITY..dark.from_s, BEFORE),
            (dark.from_s..dark.until_s, DARK),
            (dark.until_s..f64::INFINITY, AFTER),
        ];
        for (times, ink) in parts {
            for line in lines(truth, &times, inside) {
                chart.draw_series(LineSeries::new(line, ink.stroke_width(2)))?;
            }
        }
        for line in lines(estimate, &(dark.from_s..dark.until_s), inside) {
            chart.draw_series(LineSeries::new(line, ESTIMATE.stroke_width(1)))?;
        }
        Ok(())
    }
}

/// The pieces of a way in a time that are drawn here.
fn lines(way: &Way, times: &Range<f64>, inside: impl Fn(&Vector3<f64>) -> bool) -> Vec<Vec<(f64, f64)>> {
    let mut all = vec![Vec::new()];
    let mut last: Option<Vector3<f64>> = None;
    for (_, at) in way.iter().filter(|(time_s, _)| times.contains(time_s)) {
        if last.is_some_and(|last| (last - at).norm() < THINNED_M) {
            continue;
        }
        last = Some(*at);
        if !inside(at) {
            all.push(Vec::new());
        } else if let Some(line) = all.last_mut() {
            line.push((at.x, at.y));
        }
    }
    all.retain(|line| !line.is_empty());
    all
}
