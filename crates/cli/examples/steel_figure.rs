//! What steel cars do to the field at the foot of the walk of S3: `steel_figure NORM.svg HEADING.svg` draws it, and prints a table.
//!
//! The cars are those of `scenarios/s3-steel*.toml`. Called by `ci/results.sh` for the page of the simulation.

use adit_core::attitude::angle_difference;
use adit_core::nalgebra::Vector3;
use adit_evaluation::plot::{TimeCurve, time_figure};
use adit_simulation::{
    Course, EarthField, FootWalk, FootWalkScenario, MagneticWorld, Motion, Move, SimulationError, SteelBody,
};
use anyhow::{Context, Result};

/// What is drawn and tabled, s, and how often.
const SHOWN: std::ops::Range<u32> = 0..260;
const POINTS_PER_S: u32 = 20;
/// A compass that is off by more than this misleads, °.
const MISLEADING_DEG: f64 = 3.0;

fn main() -> Result<()> {
    let mut names = std::env::args().skip(1);
    let mut name = || names.next().context("usage: steel_figure NORM.svg HEADING.svg");
    let (norm_svg, heading_svg) = (name()?, name()?);

    let walk = FootWalkScenario::court_walk().walk(1)?;
    let cars = [
        ("s3-steel", "passes", passing()?),
        ("s3-steel-stop", "stops for 20 s", stopping()?),
        ("s3-steel-beside", "keeps beside", beside(&walk)?),
        ("s3-steel-start", "is there at the start", leaving()?),
    ];
    println!(
        "| scenario | the car | field norm, µT | heading error of a compass | more than {MISLEADING_DEG}° for |"
    );
    println!("|---|---|---|---|---|");
    let (mut norms, mut headings) = (Vec::new(), Vec::new());
    for (scenario, label, course) in cars {
        let world = with_car(course, &walk)?;
        let over_time = |value: &dyn Fn(&Vector3<f64>) -> f64| TimeCurve {
            label: label.into(),
            points: (SHOWN.start * POINTS_PER_S..SHOWN.end * POINTS_PER_S)
                .map(|i| f64::from(i) / f64::from(POINTS_PER_S))
                .map(|time_s| (time_s, value(&world.field_ut(&walk.at(time_s).position_m, time_s))))
                .collect(),
        };
        let north = bearing(&world.earth.enu_ut());
        let norm = over_time(&|field| field.norm());
        let heading = over_time(&|field| angle_difference(bearing(field), north).to_degrees());
        let misled = heading.points.iter().filter(|(_, error)| error.abs() > MISLEADING_DEG).count();
        let ((least_ut, most_ut), (left_deg, right_deg)) = (span(&norm), span(&heading));
        println!(
            "| [{scenario}.toml](../scenarios/{scenario}.toml) | {label} | {least_ut:.0} to {most_ut:.0} \
             | {left_deg:.0}° to {right_deg:.0}° | {:.0} s |",
            misled as f64 / f64::from(POINTS_PER_S)
        );
        norms.push(norm);
        headings.push(heading);
    }
    let norm = time_figure(&norms, "Field at the foot while a steel car is near", "flux density (µT)")?;
    let heading = time_figure(&headings, "Heading error of a compass at the foot", "error (°)")?;
    std::fs::write(&norm_svg, norm).with_context(|| norm_svg.clone())?;
    std::fs::write(&heading_svg, heading).with_context(|| heading_svg.clone())
}

/// Smallest and largest value.
fn span(curve: &TimeCurve) -> (f64, f64) {
    let values = curve.points.iter().map(|(_, value)| *value);
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// The world of the court with one car on this course, 30 µT at most where the sensor is.
fn with_car(course: Course, walk: &FootWalk) -> Result<MagneticWorld, SimulationError> {
    let earth = EarthField::harbin();
    let car =
        SteelBody::new(course, Vector3::new(250.0, 80.0, -400.0)).with_peak_along(&earth, 30.0, walk)?;
    Ok(MagneticWorld { steel: vec![car], ..MagneticWorld::undisturbed(earth) })
}

fn passing() -> Result<Course, SimulationError> {
    Course::moving([80.0, -1.5, 0.6], 139.0, &[Move::Go { to_m: [-40.0, -1.5, 0.6], speed_m_s: 1.5 }])
}

fn stopping() -> Result<Course, SimulationError> {
    let moves = [
        Move::Go { to_m: [13.0, -1.5, 0.6], speed_m_s: 0.5 },
        Move::Stop { seconds: 20.0 },
        Move::Go { to_m: [-40.0, -1.5, 0.6], speed_m_s: 0.5 },
    ];
    Course::moving([43.0, -1.5, 0.6], 60.0, &moves)
}

fn beside(walk: &FootWalk) -> Result<Course, SimulationError> {
    Course::beside(walk, [0.0, -1.5, 0.6], 165.0, 405.0)
}

fn leaving() -> Result<Course, SimulationError> {
    Course::moving([0.5, -1.4, 0.6], 90.0, &[Move::Go { to_m: [-60.0, -1.5, 0.6], speed_m_s: 1.0 }])
}

/// Where the horizontal field points, clockwise from north, rad.
fn bearing(field_ut: &Vector3<f64>) -> f64 {
    field_ut.x.atan2(field_ut.y)
}
