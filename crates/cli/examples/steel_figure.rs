//! What a steel car does to a compass: `steel_figure FIELD.svg HEADING.svg DIR…`, a table of these simulations on stdout.
//!
//! Each `DIR` holds what `adit simulate` made of `scenarios/DIR.toml`, a walk of system S3; the second is drawn, around the
//! moment at which the car overtakes the walker. The compass is levelled by the true roll and pitch, so that its error
//! is that of the magnetometer alone. Called by `ci/results.sh` for the page of the simulation.

use adit_core::attitude::angle_difference;
use adit_core::nalgebra::Vector3;
use adit_evaluation::plot::{TimeCurve, time_figure};
use adit_observation::{Observation, tum};
use adit_simulation::EarthField;
use anyhow::{Context, Result};
use std::path::Path;

/// What is drawn, s.
const SHOWN: std::ops::Range<f64> = 50.0..95.0;
/// An error no swing of the foot makes without steel, °.
const LARGE_DEG: f64 = 15.0;

/// Field norm, µT, and heading error, °, over time, s.
struct Compass {
    norm_ut: Vec<(f64, f64)>,
    error_deg: Vec<(f64, f64)>,
}

impl Compass {
    fn on(folder: &Path) -> Result<Self> {
        let (earth, truth) = (EarthField::harbin(), tum::read(folder.join("truth.tum"))?);
        let mut compass = Self { norm_ut: Vec::new(), error_deg: Vec::new() };
        for observation in adit_observation::open(folder.join("log.mcap"))? {
            let Observation::Magnetic(sample) = observation? else { continue };
            let time_s = sample.time.seconds();
            let pose = truth.at(sample.time).with_context(|| format!("no truth at {time_s} s"))?;
            let level: Vector3<f64> = pose.attitude * sample.field_ut;
            // What it takes for magnetic north lies at this bearing; its heading is off by the same, the other way.
            let bearing_rad = level.x.atan2(level.y);
            let error_rad = angle_difference(earth.declination_rad, bearing_rad);
            compass.norm_ut.push((time_s, sample.field_ut.norm()));
            compass.error_deg.push((time_s, error_rad.to_degrees()));
        }
        Ok(compass)
    }

    fn row(&self, name: &str) -> String {
        let (norm, error) = (range(&self.norm_ut), range(&self.error_deg));
        let steps = self.error_deg.windows(2).filter(|pair| pair[0].1.abs() > LARGE_DEG);
        let large_s = steps.fold(0.0, |sum, pair| sum + pair[1].0 - pair[0].0);
        format!(
            "| [{name}](../scenarios/{name}.toml) | {:.0} to {:.0} | {:.0} to {:.0} | {large_s:.0} |",
            norm.0, norm.1, error.0, error.1
        )
    }
}

fn range(points: &[(f64, f64)]) -> (f64, f64) {
    points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, v)| (low.min(*v), high.max(*v)))
}

fn curve(label: &str, points: &[(f64, f64)]) -> TimeCurve {
    let shown = points.iter().filter(|(time_s, _)| SHOWN.contains(time_s)).copied();
    TimeCurve { label: label.into(), points: shown.collect() }
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [field_svg, heading_svg, folders @ ..] = arguments.as_slice() else {
        anyhow::bail!("usage: steel_figure FIELD.svg HEADING.svg DIR…");
    };
    println!("| scenario | field norm, µT | error of a plain compass, ° | beyond {LARGE_DEG:.0}°, s |");
    println!("|---|---|---|---|");
    let mut walks = Vec::new();
    for folder in folders.iter().map(Path::new) {
        let name = folder.file_name().context("DIR has no name")?.to_string_lossy();
        walks.push(Compass::on(folder).with_context(|| folder.display().to_string())?);
        println!("{}", walks[walks.len() - 1].row(&name));
    }
    let [plain, steel, ..] = walks.as_slice() else { anyhow::bail!("two simulations are needed") };
    let curves =
        |of: fn(&Compass) -> &[(f64, f64)]| [curve("with the car", of(steel)), curve("without", of(plain))];
    let title = "A steel car overtakes the walker";
    let field = time_figure(&curves(|c| &c.norm_ut), &format!("{title}: the field"), "field norm (µT)")?;
    std::fs::write(field_svg, field).with_context(|| field_svg.clone())?;
    let title = format!("{title}: a plain compass");
    let heading = time_figure(&curves(|c| &c.error_deg), &title, "heading error (°)")?;
    std::fs::write(heading_svg, heading).with_context(|| heading_svg.clone())
}
